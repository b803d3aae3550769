//! A first-order dual number with `N` derivatives.
//!
//! The generic `num-dual` type is the reference in the tests; this bare array form is kept because
//! a full HGO tangent costs less than half with it (docs/performance.md, `just bench`).

use crate::scalar::{Over, Scalar};
use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

/// Value and `N` derivatives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jet<const N: usize> {
    /// The value.
    pub re: f64,
    /// The derivatives.
    pub eps: [f64; N],
}

impl<const N: usize> Jet<N> {
    /// A constant: all derivatives zero.
    #[inline(always)]
    pub const fn constant(re: f64) -> Self {
        Self { re, eps: [0.0; N] }
    }

    /// The `i`-th independent variable. Panics when `i >= N`.
    #[inline(always)]
    pub const fn variable(re: f64, i: usize) -> Self {
        let mut eps = [0.0; N];
        eps[i] = 1.0;
        Self { re, eps }
    }

    #[inline(always)]
    fn map(mut self, re: f64, f: impl Fn(f64) -> f64) -> Self {
        for e in &mut self.eps {
            *e = f(*e);
        }
        self.re = re;
        self
    }
}

impl<const N: usize> From<f64> for Jet<N> {
    #[inline(always)]
    fn from(re: f64) -> Self {
        Self::constant(re)
    }
}

impl<const N: usize> Add for Jet<N> {
    type Output = Self;
    #[inline(always)]
    fn add(mut self, o: Self) -> Self {
        self += o;
        self
    }
}
impl<const N: usize> Sub for Jet<N> {
    type Output = Self;
    #[inline(always)]
    fn sub(mut self, o: Self) -> Self {
        self -= o;
        self
    }
}
impl<const N: usize> Mul for Jet<N> {
    type Output = Self;
    #[inline(always)]
    fn mul(mut self, o: Self) -> Self {
        for i in 0..N {
            self.eps[i] = self.eps[i] * o.re + self.re * o.eps[i];
        }
        self.re *= o.re;
        self
    }
}
impl<const N: usize> Div for Jet<N> {
    type Output = Self;
    #[inline(always)]
    fn div(mut self, o: Self) -> Self {
        let q = self.re / o.re;
        let r = 1.0 / o.re;
        for i in 0..N {
            self.eps[i] = (self.eps[i] - q * o.eps[i]) * r;
        }
        self.re = q;
        self
    }
}
impl<const N: usize> Neg for Jet<N> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.map(-self.re, |e| -e)
    }
}
impl<const N: usize> Add<f64> for Jet<N> {
    type Output = Self;
    #[inline(always)]
    fn add(mut self, o: f64) -> Self {
        self.re += o;
        self
    }
}
impl<const N: usize> Sub<f64> for Jet<N> {
    type Output = Self;
    #[inline(always)]
    fn sub(mut self, o: f64) -> Self {
        self.re -= o;
        self
    }
}
impl<const N: usize> Mul<f64> for Jet<N> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, o: f64) -> Self {
        self.map(self.re * o, |e| e * o)
    }
}
impl<const N: usize> Div<f64> for Jet<N> {
    type Output = Self;
    #[inline(always)]
    fn div(self, o: f64) -> Self {
        self.map(self.re / o, |e| e / o)
    }
}
impl<const N: usize> AddAssign for Jet<N> {
    #[inline(always)]
    fn add_assign(&mut self, o: Self) {
        self.re += o.re;
        for i in 0..N {
            self.eps[i] += o.eps[i];
        }
    }
}
impl<const N: usize> SubAssign for Jet<N> {
    #[inline(always)]
    fn sub_assign(&mut self, o: Self) {
        self.re -= o.re;
        for i in 0..N {
            self.eps[i] -= o.eps[i];
        }
    }
}
impl<const N: usize> MulAssign<f64> for Jet<N> {
    #[inline(always)]
    fn mul_assign(&mut self, o: f64) {
        *self = *self * o;
    }
}

impl<const N: usize> Scalar for Jet<N> {
    const PLAIN: bool = false;

    #[inline(always)]
    fn is_constant(&self) -> bool {
        self.eps == [0.0; N]
    }
    #[inline(always)]
    fn value(self) -> f64 {
        self.re
    }
    #[inline(always)]
    fn chain(self, f: f64, slope: f64) -> Self {
        self.map(f, |e| e * slope)
    }
    #[inline]
    fn is_finite(self) -> bool {
        self.re.is_finite() && self.eps.iter().all(|e| e.is_finite())
    }
}

impl<const N: usize> Over<f64> for Jet<N> {
    #[inline(always)]
    fn lift(x: f64) -> Self {
        Self::constant(x)
    }
    #[inline(always)]
    fn times(self, x: f64) -> Self {
        self * x
    }
    #[inline(always)]
    fn over(self, x: f64) -> Self {
        self / x
    }
}
impl<const N: usize> Over<Jet<N>> for Jet<N> {
    #[inline(always)]
    fn lift(x: Self) -> Self {
        x
    }
    #[inline(always)]
    fn times(self, x: Self) -> Self {
        self * x
    }
    #[inline(always)]
    fn over(self, x: Self) -> Self {
        self / x
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use num_dual::{Dual64, DualNum};
    use proptest::prelude::*;

    fn ours(x: Jet<1>) -> Jet<1> {
        (x * x + 1.0).sqrt() / (x.exp() + 2.0) - x.ln_1p() * x.recip() + x.sin() * x.cos() + x.powf(1.7)
            - x.tan()
            + x.cbrt()
    }
    fn theirs(x: Dual64) -> Dual64 {
        (x * x + 1.0).sqrt() / (x.exp() + 2.0) - x.ln_1p() * x.recip() + x.sin() * x.cos() + x.powf(1.7)
            - x.tan()
            + x.cbrt()
    }

    proptest! {
        #[test]
        fn agrees_with_num_dual(x in 0.05f64..1.4) {
            let a = ours(Jet::variable(x, 0));
            let b = theirs(Dual64::new(x, 1.0));
            prop_assert!((a.re - b.re).abs() < 1e-13);
            prop_assert!((a.eps[0] - b.eps).abs() < 1e-11 * (1.0 + b.eps.abs()));
        }

        #[test]
        fn erf_has_its_slope(x in -2.0f64..2.0) {
            let h = 1e-5;
            let fd = (libm::erf(x + h) - libm::erf(x - h)) / (2.0 * h);
            prop_assert!((Jet::<1>::variable(x, 0).erf().eps[0] - fd).abs() < 1e-9);
        }
    }

    #[test]
    fn the_inactive_side_of_a_bracket_has_no_derivative() {
        assert_eq!(Jet::<1>::variable(-0.5, 0).positive_part(), Jet::constant(0.0));
        assert_eq!(Jet::<1>::variable(0.5, 0).positive_part().eps[0], 1.0);
    }
}
