//! The number a law is written over.

use std::fmt::Debug;
use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

/// A real number that may carry derivatives: `f64` or [`crate::Jet`].
///
/// Comparisons in a law are made on [`Scalar::value`]: a switch takes the active branch, and its
/// derivative is the derivative of that branch.
pub trait Scalar:
    Copy
    + Debug
    + PartialEq
    + Send
    + Sync
    + 'static
    + From<f64>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Add<f64, Output = Self>
    + Sub<f64, Output = Self>
    + Mul<f64, Output = Self>
    + Div<f64, Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
    + MulAssign<f64>
    + Over<f64>
    + Over<Self>
{
    /// Whether there is nothing but the value.
    const PLAIN: bool;

    /// Whether all derivatives are zero.
    fn is_constant(&self) -> bool;

    /// The number without its derivatives.
    fn value(self) -> f64;

    /// The scalar f(self), given the value f and the slope f' at `self.value()`: how any smooth
    /// function of one variable is lifted.
    fn chain(self, f: f64, slope: f64) -> Self;

    /// Whether value and every derivative are finite.
    fn is_finite(self) -> bool;

    /// Zero.
    #[inline(always)]
    fn zero() -> Self {
        Self::from(0.0)
    }
    /// One.
    #[inline(always)]
    fn one() -> Self {
        Self::from(1.0)
    }
    /// eˣ.
    #[inline]
    fn exp(self) -> Self {
        let e = self.value().exp();
        self.chain(e, e)
    }
    /// eˣ − 1, exact near 0.
    #[inline]
    fn exp_m1(self) -> Self {
        let x = self.value();
        self.chain(x.exp_m1(), x.exp())
    }
    /// Natural logarithm.
    #[inline]
    fn ln(self) -> Self {
        let x = self.value();
        self.chain(x.ln(), 1.0 / x)
    }
    /// ln(1 + x), exact near 0.
    #[inline]
    fn ln_1p(self) -> Self {
        let x = self.value();
        self.chain(x.ln_1p(), 1.0 / (1.0 + x))
    }
    /// Square root. At 0 the slope is infinite: guard before calling.
    #[inline]
    fn sqrt(self) -> Self {
        let r = self.value().sqrt();
        self.chain(r, 0.5 / r)
    }
    /// xᵖ with a plain exponent.
    #[inline]
    fn powf(self, p: f64) -> Self {
        let x = self.value();
        self.chain(x.powf(p), p * x.powf(p - 1.0))
    }
    /// 1/x.
    #[inline]
    fn recip(self) -> Self {
        let r = 1.0 / self.value();
        self.chain(r, -r * r)
    }
    /// Cubic root of a positive number; NaN for negative ones. By logarithm and exponential, which
    /// take half the time of the library's root.
    #[inline]
    fn cbrt(self) -> Self {
        let r = (self.value().ln() / 3.0).exp();
        self.chain(r, 1.0 / (3.0 * r * r))
    }
    /// sin x.
    #[inline]
    fn sin(self) -> Self {
        let (s, c) = self.value().sin_cos();
        self.chain(s, c)
    }
    /// cos x.
    #[inline]
    fn cos(self) -> Self {
        let (s, c) = self.value().sin_cos();
        self.chain(c, -s)
    }
    /// tan x.
    #[inline]
    fn tan(self) -> Self {
        let t = self.value().tan();
        self.chain(t, 1.0 + t * t)
    }
    /// Error function.
    #[inline]
    fn erf(self) -> Self {
        let x = self.value();
        self.chain(libm::erf(x), std::f64::consts::FRAC_2_SQRT_PI * (-x * x).exp())
    }
    /// Macaulay bracket ⟨x⟩: x where positive, else 0 without derivative.
    #[inline]
    fn positive_part(self) -> Self {
        if self.value() > 0.0 { self } else { Self::zero() }
    }
    /// The larger of two, with its derivative.
    #[inline]
    fn max_of(self, other: Self) -> Self {
        if self.value() >= other.value() { self } else { other }
    }
    /// x².
    #[inline(always)]
    fn square(self) -> Self {
        self * self
    }
}

impl Scalar for f64 {
    const PLAIN: bool = true;

    #[inline(always)]
    fn is_constant(&self) -> bool {
        true
    }
    #[inline(always)]
    fn value(self) -> f64 {
        self
    }
    #[inline(always)]
    fn chain(self, f: f64, _slope: f64) -> f64 {
        f
    }
    #[inline(always)]
    fn is_finite(self) -> bool {
        f64::is_finite(self)
    }
}

/// A scalar that can be combined with a poorer one: kinematics in plain `f64` under a law in jets
/// (only parameters move), or both in jets (displacements move too).
pub trait Over<X> {
    /// The poorer number as this scalar.
    fn lift(x: X) -> Self;
    /// self · x.
    fn times(self, x: X) -> Self;
    /// self / x.
    fn over(self, x: X) -> Self;
}

impl Over<f64> for f64 {
    #[inline(always)]
    fn lift(x: f64) -> f64 {
        x
    }
    #[inline(always)]
    fn times(self, x: f64) -> f64 {
        self * x
    }
    #[inline(always)]
    fn over(self, x: f64) -> f64 {
        self / x
    }
}
