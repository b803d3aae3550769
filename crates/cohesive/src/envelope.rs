//! The scalar relation between effective opening and effective traction (paper eqs. 4–7).
//!
//! Generic over [`Scalar`], so that derivatives with respect to opening, fracture energy and
//! strength come from the same lines. Units: opening mm, strength MPa, fracture energy N/mm.

use constitutive::Scalar;
use std::f64::consts::E;

/// Damage from which an interface point counts as separated, the paper's δ_sep: d = 1 itself is
/// reached only at infinite opening.
pub const SEPARATION_DAMAGE: f64 = 0.999;

/// Opening of the peak, δc = Gc/(e σc), mm (eq. 6).
pub fn delta_c<S: Scalar>(gc: S, sigma_c: S) -> S {
    gc / (sigma_c * E)
}

/// Initial stiffness e σc/δc = (e σc)²/Gc, N/mm³, the slope of eq. 4 at zero.
pub fn initial_stiffness<S: Scalar>(gc: S, sigma_c: S) -> S {
    let s = sigma_c * E;
    s * s / gc
}

/// Secant stiffness t(δ)/δ of the envelope, N/mm³; at δ = 0 its limit, the initial stiffness.
#[inline]
pub fn secant_stiffness<S: Scalar>(delta: S, gc: S, sigma_c: S) -> S {
    initial_stiffness(gc, sigma_c) * (-(delta / delta_c(gc, sigma_c))).exp()
}

/// Traction of the envelope, t = e σc (δ/δc) exp(−δ/δc), MPa (eq. 4); its peak is σc at δc.
pub fn envelope<S: Scalar>(delta: S, gc: S, sigma_c: S) -> S {
    secant_stiffness(delta, gc, sigma_c) * delta
}

/// Damage d = 1 − (1 + δmax/δc) exp(−δmax/δc) (eq. 7): the work done up to `delta_max`, over Gc.
/// It is not the dissipated share, see [`dissipated`].
pub fn damage<S: Scalar>(delta_max: S, gc: S, sigma_c: S) -> S {
    let x = delta_max / delta_c(gc, sigma_c);
    let v = x.value();
    x.chain(incomplete_gamma::<2>(v), v * (-v).exp())
}

/// Work of the envelope up to `delta`, φ(δ) = ∫t dδ = d(δ) Gc, N/mm.
pub fn work<S: Scalar>(delta: S, gc: S, sigma_c: S) -> S {
    damage(delta, gc, sigma_c) * gc
}

/// Work lost up to `delta_max`, N/mm: φ(δmax) − ½ t_max δmax, the work done less what unloading
/// gives back.
pub fn dissipated<S: Scalar>(delta_max: S, gc: S, sigma_c: S) -> S {
    // φ − ½ t δ = Gc [1 − (1 + x + x²/2) e⁻ˣ]: one function, no difference of near-equal works.
    let x = delta_max / delta_c(gc, sigma_c);
    let v = x.value();
    x.chain(incomplete_gamma::<3>(v), 0.5 * v * v * (-v).exp()) * gc
}

/// Whether a point of damage `damage` is separated at the `threshold` (see [`SEPARATION_DAMAGE`]).
pub fn separated(damage: f64, threshold: f64) -> bool {
    damage >= threshold
}

/// Effective opening δ = sqrt(⟨δn⟩² + λ² δs²), mm, of an opening [δn, δs1, δs2].
///
/// At zero the root has no slope; the answer there carries no derivative, which is exact for the
/// traction, whose derivative through δ vanishes with the opening.
#[inline]
pub fn effective_opening<S: Scalar>(opening: &[S; 3], lambda: S) -> S {
    let [n, s, t] = *opening;
    let n = n.positive_part();
    let square = n * n + lambda * lambda * (s * s + t * t);
    if square.value() == 0.0 { S::zero() } else { square.sqrt() }
}

/// Regularised lower incomplete gamma function P(A, x) for integer A, 1 − e⁻ˣ Σ_{n<A} xⁿ/n!.
/// Below x = 1 by the tail of the series, whose terms are all positive: no cancellation.
fn incomplete_gamma<const A: usize>(x: f64) -> f64 {
    let mut term = 1.0;
    let mut head = 0.0;
    for n in 0..A {
        head += term;
        term *= x / (n + 1) as f64;
    }
    if x > 1.0 {
        return 1.0 - head * (-x).exp();
    }
    let mut tail = 0.0;
    for n in A..A + 18 {
        tail += term;
        term *= x / (n + 1) as f64;
    }
    tail * (-x).exp()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn series_meets_closed_form_at_one() {
        let exact = |x: f64| 1.0 - (1.0 + x) * (-x).exp();
        for x in [0.5, 0.9999, 1.0, 1.0001, 3.0, 40.0] {
            assert!((incomplete_gamma::<2>(x) - exact(x)).abs() < 4e-16, "{x}");
        }
        // x²/2 − x³/3 where the closed form has lost every digit.
        assert!((incomplete_gamma::<2>(1e-9) / 0.5e-18 - 1.0).abs() < 1e-8);
        assert!((incomplete_gamma::<3>(1e-9) / (1e-27 / 6.0) - 1.0).abs() < 1e-8);
    }
}
