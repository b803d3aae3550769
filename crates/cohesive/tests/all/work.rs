//! What the paper says of the law, and what thermodynamics asks: work, damage, dissipation.

use crate::common;

use cohesive::{
    Cohesive, DELTA_MAX, GC, LAMBDA, SEPARATION_DAMAGE, SIGMA_C, damage, delta_c, dissipated,
    effective_opening, envelope, separated, work,
};
use common::*;
use constitutive::{Context, Describe, Energy, Jet};
use proptest::prelude::*;

/// Work ∫T·dδ along straight segments through `points` (mm) from zero opening and virgin tissue,
/// by Simpson's rule on `parts` pieces of each; the energies the law reports at the end.
fn along(points: &[Opening], p: &Params, parts: usize) -> (f64, Energy) {
    let (mut at, mut old, mut sum) = ([0.0; 3], 0.0, 0.0);
    for to in &split_at_contact(points) {
        let step: Opening = std::array::from_fn(|i| (to[i] - at[i]) / parts as f64);
        let power = |t: &[f64; 3]| t.iter().zip(&step).map(|(t, s)| t * s).sum::<f64>();
        for n in 0..parts {
            let point = |s: f64| std::array::from_fn(|i| at[i] + (n as f64 + s) * step[i]);
            for (s, weight) in [(0.0, 1.0), (0.5, 4.0), (1.0, 1.0)] {
                let (r, new) = respond(&point(s), p, old);
                old = new;
                sum += weight / 6.0 * power(&r.force);
            }
        }
        at = *to;
    }
    (sum, Cohesive.energies(&Context::default(), &at, p, &[old], &[old]))
}

/// The same polygon with a corner wherever it passes δn = 0: there the stiffness jumps, and a
/// quadrature across a jump is not exact.
fn split_at_contact(points: &[Opening]) -> Vec<Opening> {
    let (mut at, mut out) = ([0.0; 3], Vec::new());
    for &to in points {
        if at[0] * to[0] < 0.0 {
            let s = at[0] / (at[0] - to[0]);
            out.push([0.0, at[1] + s * (to[1] - at[1]), at[2] + s * (to[2] - at[2])]);
        }
        out.push(to);
        at = to;
    }
    out
}

fn close(a: f64, b: f64, tolerance: f64) {
    assert!((a - b).abs() < tolerance, "{a} {b}");
}

proptest! {
    #[test]
    fn damage_grows_from_zero_and_never_exceeds_one(p in parameters(), a in 0.0f64..60.0, b in 0.0f64..60.0) {
        let dc = delta_c(p[GC], p[SIGMA_C]);
        let (low, high) = (a.min(b) * dc, a.max(b) * dc);
        let (d, e) = (damage(low, p[GC], p[SIGMA_C]), damage(high, p[GC], p[SIGMA_C]));
        prop_assert!((0.0..=1.0).contains(&d) && d <= e + 2e-16 && e <= 1.0);
        prop_assert!((damage(low, p[GC], p[SIGMA_C]) < 1.0) || low > 30.0 * dc);
        let (lost, more) = (dissipated(low, p[GC], p[SIGMA_C]), dissipated(high, p[GC], p[SIGMA_C]));
        prop_assert!(0.0 <= lost && lost <= more * (1.0 + 1e-14) && lost <= d * p[GC] * (1.0 + 1e-14));
    }

    #[test]
    fn the_history_never_falls(p in parameters(), path in proptest::collection::vec(openings(), 1..20)) {
        let mut old = 0.0;
        for o in path {
            let (_, new) = respond(&scaled(&o, &p), &p, old);
            prop_assert!(new >= old);
            old = new;
        }
    }

    /// Any closed polygon from zero opening, mixed mode and closing: no work is gained, and what
    /// is lost is what the law says.
    #[test]
    fn a_closed_path_never_gives_work(p in parameters(), mut path in proptest::collection::vec(openings(), 1..7)) {
        path.push([0.0; 3]);
        let points: Vec<Opening> = path.iter().map(|o| scaled(o, &p)).collect();
        let (sum, energy) = along(&points, &p, 400);
        prop_assert!(sum >= -1e-9 * p[GC]);
        prop_assert!(energy.stored == 0.0);
        prop_assert!((sum - energy.dissipated).abs() < 2e-4 * p[GC], "{} {:?}", sum, energy);
    }

    #[test]
    fn work_is_stored_plus_dissipated_anywhere(p in parameters(), path in proptest::collection::vec(openings(), 1..5)) {
        let points: Vec<Opening> = path.iter().map(|o| scaled(o, &p)).collect();
        let (sum, energy) = along(&points, &p, 400);
        let scale = p[GC] + energy.stored;
        prop_assert!((sum - energy.stored - energy.dissipated).abs() < 2e-4 * scale);
    }

    #[test]
    fn unloading_is_the_secant_through_the_origin(p in parameters(), o in openings(), s in 0.0f64..1.0) {
        let o = scaled(&[o[0].abs(), o[1], o[2]], &p);
        let (top, old) = respond(&o, &p, 0.0);
        let (part, new) = respond(&o.map(|x| s * x), &p, old);
        prop_assert_eq!(new, old);
        for i in 0..3 {
            prop_assert!((part.force[i] - s * top.force[i]).abs() <= 1e-14 * top.force[i].abs());
        }
        prop_assert!((part.energy - s * s * top.energy).abs() <= 1e-14 * top.energy);
    }

    #[test]
    fn the_peak_is_the_strength_at_delta_c(p in parameters(), x in 0.0f64..10.0) {
        let dc = delta_c(p[GC], p[SIGMA_C]);
        prop_assert!((envelope(dc, p[GC], p[SIGMA_C]) / p[SIGMA_C] - 1.0).abs() < 1e-14);
        prop_assert!(envelope(x * dc, p[GC], p[SIGMA_C]) <= p[SIGMA_C] * (1.0 + 1e-14));
        let slope = envelope(Jet::<1>::variable(dc, 0), p[GC].into(), p[SIGMA_C].into()).eps[0];
        prop_assert!(slope.abs() < 1e-13 * p[SIGMA_C] / dc);
    }

    /// In pure opening t(δ) is the traction; in pure shear λ t(δ).
    #[test]
    fn the_traction_is_the_envelope(p in parameters(), x in 0.01f64..5.0) {
        let opening = x * delta_c(p[GC], p[SIGMA_C]);
        let (r, _) = respond(&[opening, 0.0, 0.0], &p, 0.0);
        prop_assert!((r.force[0] / envelope(opening, p[GC], p[SIGMA_C]) - 1.0).abs() < 1e-14);
        let (r, _) = respond(&[0.0, 0.0, opening], &p, 0.0);
        let expected = p[LAMBDA] * envelope(p[LAMBDA] * opening, p[GC], p[SIGMA_C]);
        prop_assert!((r.force[2] / expected - 1.0).abs() < 1e-13);
    }

    #[test]
    fn work_damage_and_loss_have_their_slopes(p in parameters(), x in 0.0f64..8.0) {
        let delta = x * delta_c(p[GC], p[SIGMA_C]);
        let t = envelope(delta, p[GC], p[SIGMA_C]);
        let (gc, sigma_c) = (Jet::<1>::constant(p[GC]), Jet::constant(p[SIGMA_C]));
        let phi = work(Jet::variable(delta, 0), gc, sigma_c);
        prop_assert!((phi.eps[0] - t).abs() < 1e-14 * p[SIGMA_C]);
        prop_assert!((damage(delta, p[GC], p[SIGMA_C]) * p[GC] - phi.re).abs() < 1e-15);
        // dissipated = φ − ½ t δ, value and slope.
        let lost = dissipated(Jet::variable(delta, 0), gc, sigma_c);
        let recoverable = envelope(Jet::variable(delta, 0), gc, sigma_c) * Jet::variable(delta, 0) * 0.5;
        let expected = phi - recoverable;
        prop_assert!((lost.re - expected.re).abs() < 1e-14 * p[GC]);
        prop_assert!((lost.eps[0] - expected.eps[0]).abs() < 1e-13 * p[SIGMA_C]);
    }

    #[test]
    fn parameters_have_their_slopes(p in parameters(), x in 0.05f64..8.0) {
        let delta = x * delta_c(p[GC], p[SIGMA_C]);
        for k in [0, 1] {
            let seed = |i: usize| if i == k { Jet::<1>::variable(p[i], 0) } else { Jet::constant(p[i]) };
            let h = 1e-6 * p[k];
            let (mut up, mut down) = (p, p);
            up[k] += h;
            down[k] -= h;
            let difference = |f: &dyn Fn(f64, f64) -> f64| (f(up[0], up[1]) - f(down[0], down[1])) / (2.0 * h);
            let d = Jet::constant(delta);
            let tolerance = 1e-7 / p[k];
            prop_assert!((damage(d, seed(0), seed(1)).eps[0]
                - difference(&|g, s| damage(delta, g, s))).abs() < tolerance);
            prop_assert!((work(d, seed(0), seed(1)).eps[0]
                - difference(&|g, s| work(delta, g, s))).abs() < tolerance * p[GC]);
            prop_assert!((dissipated(d, seed(0), seed(1)).eps[0]
                - difference(&|g, s| dissipated(delta, g, s))).abs() < tolerance * p[GC]);
        }
    }
}

/// The work of the traction to full opening is Gc, in any mode: 60 δc is beyond every digit.
#[test]
fn work_to_full_opening_is_the_fracture_energy() {
    for p in [[0.23, 0.2, 1.0, 10.0], [1.346, 0.001, 0.7, 10.0], [0.089, 0.572, 2.0, 10.0]] {
        let dc = delta_c(p[GC], p[SIGMA_C]);
        for direction in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.6, 0.3, -0.5]] {
            let unit = effective_opening(&direction, p[LAMBDA]);
            let (sum, energy) = along(&[direction.map(|x| 60.0 * dc * x / unit)], &p, 20_000);
            close(sum / p[GC], 1.0, 1e-8);
            close(energy.dissipated / p[GC], 1.0, 1e-12);
        }
    }
}

/// At the peak a share 1 − 2/e of Gc has been spent, of which ½ σc δc = Gc/(2e) would come back.
#[test]
fn damage_is_not_dissipation() {
    let (gc, sigma_c) = (0.23f64, 0.2f64);
    let dc = delta_c(gc, sigma_c);
    let e = std::f64::consts::E;
    close(dc, gc / (e * sigma_c), 1e-16);
    close(damage(dc, gc, sigma_c), 1.0 - 2.0 / e, 1e-15);
    close(dissipated(dc, gc, sigma_c), gc * (1.0 - 2.5 / e), 1e-15);
    let energy =
        Cohesive.energies(&Context::default(), &[dc, 0.0, 0.0], &[gc, sigma_c, 1.0, 10.0], &[0.0], &[dc]);
    close(energy.stored, 0.5 * sigma_c * dc, 1e-15);
    close(energy.stored + energy.dissipated, work(dc, gc, sigma_c), 1e-15);
    assert_eq!(DELTA_MAX, 0);
}

#[test]
fn separation_is_a_threshold_below_one() {
    let (gc, sigma_c) = (0.23, 0.2);
    let dc = delta_c(gc, sigma_c);
    // (1 + x) e⁻ˣ = 0.001 at x = 9.2334.
    assert!(!separated(damage(9.233 * dc, gc, sigma_c), SEPARATION_DAMAGE));
    assert!(separated(damage(9.234 * dc, gc, sigma_c), SEPARATION_DAMAGE));
}
