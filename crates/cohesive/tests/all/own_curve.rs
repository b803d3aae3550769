//! `Irreversible` over a curve of one's own: over the exponential one it is `Cohesive`, whose formulas are written out; over a
//! polynomial it has that one's closed forms.

use crate::common;

use cohesive::{Cohesive, Curve, GC, Irreversible, LAMBDA, PENALTY, SIGMA_C};
use common::*;
use constitutive::{Cohesion, Context, Describe, Jet, Law, Scalar, testing};
use params::ParamSpec;
use proptest::prelude::*;

/// The curve of `Cohesive`.
#[derive(Clone)]
struct Exponential;

impl Curve for Exponential {
    fn shape(&self) -> Vec<ParamSpec> {
        Vec::new()
    }
    fn secant<S: Scalar>(&self, delta: S, params: &[S]) -> S {
        cohesive::secant_stiffness(delta, params[GC], params[SIGMA_C])
    }
    fn work<S: Scalar>(&self, delta: S, params: &[S]) -> S {
        cohesive::work(delta, params[GC], params[SIGMA_C])
    }
    fn delta_c<S: Scalar>(&self, params: &[S]) -> S {
        cohesive::delta_c(params[GC], params[SIGMA_C])
    }
}

/// Needleman's polynomial, t = 27/4 σc x (1 − x)² with x = δ/δf and δf = 16/9 Gc/σc, peak at x = ⅓
/// (doi:10.1115/1.3173064, normal separation).
#[derive(Clone)]
struct Polynomial;

impl Polynomial {
    fn last<S: Scalar>(params: &[S]) -> S {
        params[GC] * (16.0 / 9.0) / params[SIGMA_C]
    }

    /// δ/δf, no further than the end.
    fn share<S: Scalar>(delta: S, params: &[S]) -> S {
        let x = delta / Self::last(params);
        if x.value() < 1.0 { x } else { S::one() }
    }
}

impl Curve for Polynomial {
    fn shape(&self) -> Vec<ParamSpec> {
        Vec::new()
    }
    fn secant<S: Scalar>(&self, delta: S, params: &[S]) -> S {
        let left = -Self::share(delta, params) + 1.0;
        params[SIGMA_C] * 6.75 / Self::last(params) * left * left
    }
    fn work<S: Scalar>(&self, delta: S, params: &[S]) -> S {
        let x = Self::share(delta, params);
        params[GC] * (x * x * 6.0 - x * x * x * 8.0 + x * x * x * x * 3.0)
    }
    fn delta_c<S: Scalar>(&self, params: &[S]) -> S {
        Self::last(params) / 3.0
    }
}

/// Openings of a path, in units of δc, with the largest effective one before them.
fn states() -> impl Strategy<Value = (Params, Opening, f64)> {
    (parameters(), openings(), 0.0f64..4.0).prop_map(|(p, o, old)| {
        let unit = cohesive::delta_c(p[GC], p[SIGMA_C]);
        (p, scaled(&o, &p), old * unit)
    })
}

fn near(a: f64, b: f64, scale: f64) -> bool {
    (a - b).abs() <= 1e-12 * scale
}

proptest! {
    #[test]
    fn over_the_exponential_curve_it_is_the_exponential_law((p, o, old) in states()) {
        let (ctx, law) = (Context::default(), Irreversible(Exponential));
        let (expected, delta_max) = respond(&o, &p, old);
        let mut new = [f64::NAN];
        let found = law.respond(&ctx, &o, &p, &[old], &mut new);
        prop_assert_eq!(new[0], delta_max);
        let scale = p[SIGMA_C] + p[PENALTY] * o[0].abs();
        for i in 0..3 {
            prop_assert!(near(found.force[i], expected.force[i], scale));
        }
        prop_assert!(near(found.energy, expected.energy, p[GC] + scale * o[0].abs()));
        // d = 1 − (1 + x) exp(−x), eq. 7.
        let x = delta_max / cohesive::delta_c(p[GC], p[SIGMA_C]);
        let damage = [law.damage(delta_max, &p), Cohesive.damage(delta_max, &p)];
        prop_assert!(damage.iter().all(|d| near(*d, 1.0 - (1.0 + x) * (-x).exp(), 1.0)), "{damage:?}");
        let energies = |law: &dyn Describe<3>| law.energies(&ctx, &o, &p, &[old], &[delta_max]);
        let (a, b) = (energies(&law), energies(&Cohesive));
        prop_assert!(near(a.stored, b.stored, p[GC] + scale * o[0].abs()));
        prop_assert!((a.dissipated - b.dissipated).abs() <= 1e-9 * p[GC], "{} {}", a.dissipated, b.dissipated);
    }

    #[test]
    fn its_tangent_is_that_of_the_exponential_law((p, o, old) in states()) {
        let (ctx, law) = (Context::default(), Irreversible(Exponential));
        for old in [0.0, old] {
            let mut new = [f64::NAN; 2];
            let (at, after) = new.split_at_mut(1);
            let found = law.analytic_tangent(&ctx, &o, &p, &[old], at).unwrap();
            let expected = Cohesive.analytic_tangent(&ctx, &o, &p, &[old], after).unwrap();
            prop_assert_eq!(at[0], after[0]);
            let stiffness = cohesive::initial_stiffness(p[GC], p[SIGMA_C]) * p[LAMBDA].powi(4).max(1.0) + p[PENALTY];
            for i in 0..3 {
                prop_assert!(near(found.0[i], expected.0[i], p[SIGMA_C] + p[PENALTY] * o[0].abs()));
                for j in 0..3 {
                    prop_assert!(near(found.1[i][j], expected.1[i][j], stiffness), "{found:?} {expected:?}");
                }
            }
        }
    }

    #[test]
    fn any_curve_has_the_tangent_of_its_traction((p, o, old) in states()) {
        let (ctx, law) = (Context::default(), Irreversible(Polynomial));
        let mut new = [0.0];
        let jets = constitutive::tangent_by_jets_3(&law, &ctx, &o, &p, &[old], &mut new);
        let error = testing::analytic_tangent_error(&law, &ctx, &o, &p, &[old], jets);
        prop_assert!(error.unwrap() < 1e-12);
    }

    #[test]
    fn the_peak_and_its_slopes_are_those_of_the_exponential_law(p in parameters()) {
        let (found, expected) = (Irreversible(Exponential).delta_c(&p), Cohesive.delta_c(&p));
        prop_assert!(near(found.0, expected.0, expected.0));
        for i in 0..2 {
            prop_assert!(near(found.1[i], expected.1[i], expected.1[i].abs()));
        }
        // δc = Gc/(e σc): by central differences.
        for (i, k) in [GC, SIGMA_C].into_iter().enumerate() {
            let moved = |factor: f64| {
                let mut q = p;
                q[k] *= factor;
                Cohesive.delta_c(&q).0
            };
            let slope = (moved(1.0 + 1e-6) - moved(1.0 - 1e-6)) / (2e-6 * p[k]);
            prop_assert!((slope - expected.1[i]).abs() < 1e-8 * slope.abs(), "{slope} {expected:?}");
        }
        let jets: Vec<Jet<1>> = p.iter().map(|&v| Jet::constant(v)).collect();
        prop_assert_eq!(Exponential.delta_c(&jets).re, found.0);
    }

    #[test]
    fn a_polynomial_has_its_own_damage_and_end(p in parameters(), x in 0.0f64..1.5) {
        let law = Irreversible(Polynomial);
        let last = Polynomial::last(&p);
        // ∫ 27/4 y (1 − y)² dy, over its value at 1, by Simpson's rule, which is exact to the third power.
        let t = |y: f64| 12.0 * y * (1.0 - y) * (1.0 - y);
        let end = x.min(1.0);
        let done = end / 6.0 * (t(0.0) + 4.0 * t(0.5 * end) + t(end));
        prop_assert!(near(law.damage(x * last, &p), done, 1.0));
        // A fifth of the strength is left there, behind the peak.
        let spent = law.softening_end(&p) / 3.0;
        prop_assert!((6.75 * spent * (1.0 - spent).powi(2) - 0.2).abs() < 1e-9 && spent > 1.0 / 3.0, "{spent}");
        // The exponential one: x e¹⁻ˣ = 0.2.
        let end = Irreversible(Exponential).softening_end(&p);
        prop_assert!((end * (1.0 - end).exp() - 0.2).abs() < 1e-9 && end > 1.0, "{end}");
    }
}

/// A curve that never falls far enough is followed no further than a million times its peak.
#[test]
fn a_curve_without_an_end_is_not_followed_for_ever() {
    #[derive(Clone)]
    struct Lasting;
    impl Curve for Lasting {
        fn shape(&self) -> Vec<ParamSpec> {
            Vec::new()
        }
        fn secant<S: Scalar>(&self, delta: S, params: &[S]) -> S {
            params[SIGMA_C] / (delta + 1e-9)
        }
        fn work<S: Scalar>(&self, delta: S, params: &[S]) -> S {
            params[SIGMA_C] * delta
        }
        fn delta_c<S: Scalar>(&self, params: &[S]) -> S {
            params[GC] / params[SIGMA_C]
        }
    }
    let end = Irreversible(Lasting).softening_end(&[0.2, 0.1, 1.0, 10.0]);
    assert!((1e6..2.1e6).contains(&end), "{end}");
}

/// Where nothing is open yet the interface has its first stiffness, and no 0/0.
#[test]
fn a_closed_interface_has_its_first_stiffness() {
    let p = [0.2, 0.1, 0.5, 10.0];
    let (force, a) = Irreversible(Polynomial)
        .analytic_tangent(&Context::default(), &[0.0; 3], &p, &[0.0], &mut [0.0])
        .expect("an analytic tangent");
    // 27/4 σc/δf with δf = 3.556 mm.
    assert_eq!(force, [0.0; 3]);
    let first = 6.75 * 0.1 / (16.0 / 9.0 * 2.0);
    let expected = [first, 0.25 * first, 0.25 * first];
    for (i, row) in a.iter().enumerate() {
        for (j, k) in row.iter().enumerate() {
            let exact = if i == j { expected[i] } else { 0.0 };
            assert!((k - exact).abs() < 1e-15, "{a:?}");
        }
    }
}

#[test]
fn what_the_law_says_of_itself() {
    let law = Irreversible(Polynomial);
    assert_eq!(law.parameters().len(), cohesive::PARAMETERS);
    assert_eq!(law.history().iter().map(|h| (&*h.name, h.initial)).collect::<Vec<_>>(), [("delta_max", 0.0)]);
    assert!(!law.rate_dependent());
    let offered = law.offers().cohesion.expect("a cohesion");
    assert!(!offered.is_exponential() && Cohesive.is_exponential());
    assert_eq!(offered.softening_end(&[0.2, 0.1, 1.0, 10.0]), law.softening_end(&[0.2, 0.1, 1.0, 10.0]));
}
