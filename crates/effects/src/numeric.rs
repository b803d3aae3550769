//! Small functions over a scalar that keep neutral values exact and limits finite.

use constitutive::{Response, Scalar};

/// x + y where a vanishing y leaves every bit of x alone.
///
/// Plain addition turns −0.0 + 0.0 into 0.0; a zero increment is therefore made −0.0, the true
/// neutral element of floating-point addition. Derivatives of y are kept: they are the column the
/// score test needs at a neutral amplitude.
#[inline(always)]
pub fn plus<S: Scalar>(x: S, y: S) -> S {
    if y.value() == 0.0 { x + y.chain(-0.0, 1.0) } else { x + y }
}

/// Adds `factor` · `by` to a force, bit for bit nothing where that vanishes.
#[inline(always)]
pub fn add_scaled<S: Scalar, const G: usize>(force: &mut [S; G], factor: S, by: &[S; G]) {
    for (f, b) in force.iter_mut().zip(by) {
        *f = plus(*f, factor * *b);
    }
}

/// The isochoric rest of a response: force and energy without the volumetric part.
#[inline(always)]
pub fn difference<S: Scalar, const G: usize>(a: &Response<S, G>, b: &Response<S, G>) -> Response<S, G> {
    let mut out = *a;
    for (o, x) in out.force.iter_mut().zip(&b.force) {
        *o -= *x;
    }
    out.energy -= b.energy;
    out
}

/// e⁻ˣ for x ≥ 0, with its slope.
#[inline(always)]
pub fn decay<S: Scalar>(x: S) -> S {
    (-x).exp()
}

/// φ(x) = (1 − e⁻ˣ)/x, the mean of e⁻ˢ over 0 … x: 1 at x = 0, 1/x for large x.
pub fn mean_decay<S: Scalar>(x: S) -> S {
    let v = x.value();
    if v < 1e-3 {
        // Four terms of Σ (−x)ⁿ/(n + 1)!; the next is below 1e-14.
        let f = 1.0 - v / 2.0 * (1.0 - v / 3.0 * (1.0 - v / 4.0 * (1.0 - v / 5.0)));
        let s = -0.5 + v / 3.0 - v * v / 8.0 + v * v * v / 30.0;
        return x.chain(f, s);
    }
    let (e, f) = ((-v).exp(), -(-v).exp_m1() / v);
    x.chain(f, (e - f) / v)
}

/// (1 − φ(x))/x, the weight of a linear rise in the mean response: 1/2 at x = 0.
pub fn mean_rise<S: Scalar>(x: S) -> S {
    let v = x.value();
    if v < 0.5 {
        // Σ (−x)ⁿ/(n + 2)! and its slope, from the small end: the quotient below cancels here.
        let (mut f, mut s) = (0.0, 0.0);
        let mut factorial = (1..=15).map(f64::from).product::<f64>();
        for n in (0..=13).rev() {
            s = s * v + f;
            let sign = if n % 2 == 0 { 1.0 } else { -1.0 };
            f = f * v + sign / factorial;
            factorial /= f64::from(n + 2);
        }
        return x.chain(f, s);
    }
    let f = (1.0 + (-v).exp_m1() / v) / v;
    let phi = -(-v).exp_m1() / v;
    let phi_slope = ((-v).exp() - phi) / v;
    x.chain(f, (-phi_slope - f) / v)
}

/// ln(1 + eˣ) without overflow; its slope is the logistic function.
pub fn softplus<S: Scalar>(x: S) -> S {
    let v = x.value();
    let f = v.max(0.0) + (-v.abs()).exp().ln_1p();
    let slope = if v >= 0.0 { 1.0 / (1.0 + (-v).exp()) } else { v.exp() / (1.0 + v.exp()) };
    x.chain(f, slope)
}

/// ∫₀ᶻ erf = z erf z + (e^(−z²) − 1)/√π.
pub fn erf_integral<S: Scalar>(z: S) -> S {
    let v = z.value();
    let e = S::erf(z).value();
    z.chain(v * e + (-v * v).exp_m1() * std::f64::consts::FRAC_2_SQRT_PI / 2.0, e)
}

#[cfg(test)]
mod tests {
    use super::*;
    use constitutive::Jet;

    fn slope_error(f: impl Fn(Jet<1>) -> Jet<1>, x: f64) -> f64 {
        let h = 1e-5 * x.abs().max(0.1);
        let at = |x: f64| f(Jet::constant(x)).re;
        (f(Jet::variable(x, 0)).eps[0] - (at(x + h) - at(x - h)) / (2.0 * h)).abs()
    }

    #[test]
    fn slopes_are_those_of_the_functions() {
        for x in [1e-8, 9e-4, 1.1e-3, 9e-3, 1.1e-2, 0.3, 2.0, 50.0, 1e6] {
            assert!(slope_error(mean_decay, x) < 1e-7, "φ at {x}");
            assert!(slope_error(mean_rise, x) < 1e-7, "rise at {x}");
            assert!(slope_error(softplus, x) < 1e-7 && slope_error(softplus, -x) < 1e-7, "softplus at {x}");
            assert!(slope_error(erf_integral, x) < 1e-7, "∫erf at {x}");
        }
    }

    #[test]
    fn limits_are_finite() {
        assert_eq!(mean_decay(0.0), 1.0);
        assert_eq!(mean_rise(0.0), 0.5);
        assert_eq!(mean_decay(1e12), 1e-12);
        assert!(mean_rise(1e12) > 0.0 && mean_rise(1e12) <= 1e-12);
        assert_eq!(softplus(-1e4), 0.0);
        assert_eq!(softplus(1e4), 1e4);
    }

    #[test]
    fn a_vanishing_increment_leaves_every_bit() {
        for x in [-0.0, 0.0, 1.5, f64::INFINITY] {
            for y in [0.0, -0.0] {
                assert_eq!(plus(x, y).to_bits(), x.to_bits());
            }
        }
        let j = plus(Jet::<1>::constant(2.0), Jet { re: 0.0, eps: [3.0] });
        assert_eq!((j.re, j.eps[0]), (2.0, 3.0));
    }
}
