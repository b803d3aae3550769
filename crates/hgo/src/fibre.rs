//! One family of dispersed fibres: direction, strain, energy and stress.

use crate::kinematics::{Kinematics, Part, Planar};
use crate::law::{FIBRE_ONSET, FibreInvariants, GAMMA, Hgo, K1, K2, KAPPA, at_rest};
use constitutive::{Over, Response, Scalar};

/// Number of fibre families.
pub const FAMILIES: usize = 2;

/// Mean direction of a family in the reference state, a = (± sin γ, cos γ, 0); family 0 has the
/// plus sign. `gamma` in rad, measured from the load axis y.
pub fn fibre_direction<S: Scalar>(gamma: S, family: usize) -> [S; 3] {
    let s = gamma.sin();
    [if family == 0 { s } else { -s }, gamma.cos(), S::zero()]
}

/// Generalised structure tensors H = κ I + (1 − 3κ) a⊗a of the families (Gasser, Ogden & Holzapfel
/// 2006); their trace is 1. Both from one sine and cosine: they differ in the sign of xy.
#[inline(always)]
fn structure_tensors<S: Scalar>(params: &[S]) -> [Planar<S>; FAMILIES] {
    let kappa = params[KAPPA];
    let aligned = kappa * -3.0 + 1.0;
    let [x, y, _] = fibre_direction(params[GAMMA], 0);
    let first = Planar {
        xx: aligned * (x * x) + kappa,
        yy: aligned * (y * y) + kappa,
        zz: kappa,
        xy: aligned * (x * y),
    };
    [first, Planar { xy: -first.xy, ..first }]
}

/// What the stress and the tangent need of one family.
pub(crate) struct Family<S> {
    /// Structure tensor H.
    pub h: Planar<S>,
    /// H : C, the fibre invariant before its isochoric factor.
    pub invariant: S,
    /// Fibre strain counted from the onset, without bracket.
    pub strain: S,
}

impl<S: Scalar> Family<S> {
    /// Both families.
    #[inline(always)]
    pub fn both<X: Scalar>(law: &Hgo, kin: &Kinematics<X>, params: &[S]) -> [Self; FAMILIES]
    where
        S: Over<X>,
    {
        // Not `map`, which is not inlined here and costs a fifth of the analytic tangent.
        let [a, b] = structure_tensors(params);
        [Self::new(law, kin, params[FIBRE_ONSET], a), Self::new(law, kin, params[FIBRE_ONSET], b)]
    }

    #[inline(always)]
    fn new<X: Scalar>(law: &Hgo, kin: &Kinematics<X>, onset: S, h: Planar<S>) -> Self
    where
        S: Over<X>,
    {
        // H : (C − I) instead of H : C − 1: exact near the reference state.
        let excess = h.dot(&kin.c_minus_i);
        let strain = match law.fibre_invariants {
            FibreInvariants::Isochoric => excess.times(kin.m) + S::lift(kin.m - 1.0),
            FibreInvariants::Full => excess,
        };
        Self { h, invariant: excess + 1.0, strain: strain - onset }
    }

    /// Whether the family carries load. A NaN strain counts as active, so that it is seen.
    #[inline(always)]
    pub fn active(&self, law: &Hgo) -> bool {
        !(law.tension_only && self.strain.value() <= 0.0)
    }

    /// Stress and energy of an active family.
    #[inline(always)]
    pub fn part<X: Scalar>(&self, law: &Hgo, kin: &Kinematics<X>, params: &[S]) -> Part<S>
    where
        S: Over<X>,
    {
        let square = self.strain * self.strain;
        let (exp, ratio) = exp_and_ratio(params[K2] * square);
        let slope = params[K1] * self.strain * exp * 2.0;
        let energy = params[K1] * square * ratio * 0.5;
        match law.fibre_invariants {
            FibreInvariants::Full => Part { along: self.h.scaled(slope), across: S::zero(), energy },
            FibreInvariants::Isochoric => {
                let slope = slope.times(kin.m);
                let across = (slope * self.invariant).over(kin.j * -3.0);
                Part { along: self.h.scaled(slope), across, energy }
            }
        }
    }
}

/// eˣ and (eˣ − 1)/x from one exponential. The second is smooth through x = 0, where it is 1 with
/// slope 1/2: this is what makes k2 → 0 a value and not a division by zero.
#[inline(always)]
pub(crate) fn exp_and_ratio<S: Scalar>(x: S) -> (S, S) {
    let v = x.value();
    let em1 = v.exp_m1();
    let exp = em1 + 1.0;
    let ratio = if v == 0.0 { 1.0 } else { em1 / v };
    (x.chain(exp, exp), x.chain(ratio, ratio_slope(v, exp, ratio)))
}

/// d/dx of (eˣ − 1)/x: (eˣ − ratio)/x, by its series where that cancels.
#[inline(always)]
fn ratio_slope(v: f64, exp: f64, ratio: f64) -> f64 {
    if v.abs() > 0.5 {
        return (exp - ratio) / v;
    }
    // Σ n xⁿ⁻¹/(n+1)!, summed from the small end; the 13th term is below 1e-15 at |x| = 1/2.
    (1..=13).rev().fold(0.0, |sum, n| sum * v + SERIES[n])
}

/// n/(n+1)!.
const SERIES: [f64; 14] = {
    let (mut c, mut factorial, mut n) = ([0.0; 14], 1.0, 0);
    while n < 14 {
        factorial *= (n + 1) as f64;
        c[n] = n as f64 / factorial;
        n += 1;
    }
    c
};

/// First Piola stress (MPa, row-major) and energy (MPa) of one fibre family, 0 or 1: the third
/// term of the paper's eq. 1, with the bracket and the invariants `law` asks for.
pub fn fibre_response<S: Scalar>(law: &Hgo, f: &[S; 9], params: &[S], family: usize) -> Response<S, 9> {
    match at_rest(f) {
        Some(f) => response_of(law, &Kinematics::new(&f), params, family),
        None => response_of(law, &Kinematics::new(f), params, family),
    }
}

#[inline(always)]
fn response_of<X: Scalar, S: Scalar + Over<X>>(
    law: &Hgo,
    kin: &Kinematics<X>,
    params: &[S],
    family: usize,
) -> Response<S, 9> {
    let fibre = &Family::both(law, kin, params)[family];
    let part = if fibre.active(law) { fibre.part(law, kin, params) } else { Part::zero() };
    part.response(kin)
}

/// Fictitious second Piola stress 2 ∂Ψ_f/∂C̄ of one fibre family, 0 or 1, at C̄ = J^(−2/3) C: MPa, as
/// [xx, yy, zz, xy, yz, xz]. Its deviator with respect to C, times J^(−2/3), is the family's stress
/// (with isochoric invariants, whatever `law` says of them).
pub fn fibre_fictitious_stress<S: Scalar>(law: &Hgo, f: &[S; 9], params: &[S], family: usize) -> [S; 6] {
    match at_rest(f) {
        Some(f) => fictitious_of(law, &Kinematics::new(&f), params, family),
        None => fictitious_of(law, &Kinematics::new(f), params, family),
    }
}

#[inline(always)]
fn fictitious_of<X: Scalar, S: Scalar + Over<X>>(
    law: &Hgo,
    kin: &Kinematics<X>,
    params: &[S],
    family: usize,
) -> [S; 6] {
    let law = Hgo { fibre_invariants: FibreInvariants::Isochoric, ..*law };
    let fibre = &Family::both(&law, kin, params)[family];
    let zero = S::zero();
    if !fibre.active(&law) {
        return [zero; 6];
    }
    let (exp, _) = exp_and_ratio(params[K2] * fibre.strain * fibre.strain);
    let s = fibre.h.scaled(params[K1] * fibre.strain * exp * 2.0);
    [s.xx, s.yy, s.zz, s.xy, zero, zero]
}

/// Fibre strain of one family, 0 or 1: E_f − E_r with E_f of the paper's eq. 3 and E_r the fibre
/// onset; negative where the family is shortened (no bracket).
pub fn fibre_strain<S: Scalar>(law: &Hgo, f: &[S; 9], params: &[S], family: usize) -> S {
    Family::both::<S>(law, &Kinematics::new(f), params)[family].strain
}

#[cfg(test)]
mod tests {
    use super::*;
    use constitutive::Jet;

    #[test]
    fn the_exponential_ratio_is_smooth_through_zero() {
        let at = |x: f64| exp_and_ratio(Jet::<1>::variable(x, 0)).1;
        assert_eq!(at(0.0), Jet { re: 1.0, eps: [0.5] });
        for x in [-0.7f64, -0.5, -1e-3, 1e-9, 1e-3, 0.1, 0.4999, 0.5, 0.5001, 2.0] {
            let exact =
                0.5 + x / 3.0 + x * x / 8.0 + x.powi(3) / 30.0 + x.powi(4) / 144.0 + x.powi(5) / 840.0;
            let r = at(x);
            assert!((r.re - x.exp_m1() / x).abs() <= 1e-15 * r.re.abs());
            assert!((r.eps[0] - exact).abs() < 3e-4 * x.abs().powi(6) + 1e-15, "{x}: {} {exact}", r.eps[0]);
        }
        let (left, right) = (at(0.5).eps[0], at(0.5 + 1e-15).eps[0]);
        assert!((left - right).abs() < 1e-14, "series meets quotient");
    }
}
