//! Every interface law of the registry through one battery: work, damage, unloading, tangents.

use cohesive::{DELTA_MAX, GC, PENALTY, SIGMA_C, effective_opening};
use constitutive::{Context, Energy, Jet, Law, PointLaw, tangent_by_jets_3, testing};
use input::{LawRegistry, LawSite};
use laws::Settings;
use proptest::prelude::*;
use std::sync::Arc;

type Opening = [f64; 3];

fn laws_of_the_registry() -> Vec<(&'static str, Arc<dyn PointLaw<3>>)> {
    let registry = laws::registry();
    let all: Vec<_> = registry.all_interface().cloned().collect();
    all.iter().map(|l| (l.card().name, l.law(&Settings::new()))).collect()
}

/// Gc, σc, λ, K, then the shape somewhere between its bounds.
fn values(law: &dyn PointLaw<3>, common: [f64; 4], shape: f64) -> Vec<f64> {
    let within = |s: &params::ParamSpec| s.lower + (0.1 + 0.8 * shape) * (s.upper - s.lower);
    common.into_iter().chain(law.parameters().iter().skip(4).map(within)).collect()
}

fn common() -> impl Strategy<Value = ([f64; 4], f64)> {
    let four = (0.05f64..2.0, 0.01f64..1.0, prop_oneof![Just(1.0), 0.2f64..3.0], 1.0f64..100.0);
    (four.prop_map(|(g, s, l, k)| [g, s, l, k]), 0.0f64..1.0)
}

/// Openings in units of Gc/σc, which is beyond every peak and about half the last opening: mixed mode and closing.
fn openings() -> impl Strategy<Value = Opening> {
    [-0.4f64..2.0, -1.2..1.2, -1.2..1.2]
}

fn scaled(o: &Opening, p: &[f64]) -> Opening {
    o.map(|x| x * p[GC] / p[SIGMA_C])
}

fn respond(law: &dyn PointLaw<3>, o: &Opening, p: &[f64], old: f64) -> (Opening, f64, f64) {
    let (force, energy, new) = testing::respond(law, &Context::default(), o, p, &[old]);
    (force, energy, new[DELTA_MAX])
}

/// Work along straight segments from zero, by Simpson's rule on `parts` pieces each; the energies at the end.
fn along(law: &dyn PointLaw<3>, points: &[Opening], p: &[f64], parts: usize) -> (f64, Energy) {
    let (mut at, mut old, mut sum) = ([0.0; 3], 0.0, 0.0);
    for to in points {
        // A corner where it passes δn = 0: there the stiffness jumps.
        let mut corners = Vec::new();
        if at[0] * to[0] < 0.0 {
            let s = at[0] / (at[0] - to[0]);
            corners.push([0.0, at[1] + s * (to[1] - at[1]), at[2] + s * (to[2] - at[2])]);
        }
        corners.push(*to);
        for to in corners {
            let step: Opening = std::array::from_fn(|i| (to[i] - at[i]) / parts as f64);
            for n in 0..parts {
                for (s, weight) in [(0.0, 1.0), (0.5, 4.0), (1.0, 1.0)] {
                    let o = std::array::from_fn(|i| at[i] + (n as f64 + s) * step[i]);
                    let (t, _, new) = respond(law, &o, p, old);
                    old = new;
                    sum += weight / 6.0 * t.iter().zip(&step).map(|(t, s)| t * s).sum::<f64>();
                }
            }
            at = to;
        }
    }
    (sum, law.energies(&Context::default(), &at, p, &[old], &[old]))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 96, ..ProptestConfig::default() })]

    #[test]
    fn the_analytic_tangent_is_that_of_the_jets((c, shape) in common(), o in openings(), old in 0.0f64..2.0) {
        for (name, law) in laws_of_the_registry() {
            let p = values(&*law, c, shape);
            let (o, old) = (scaled(&o, &p), [old * p[GC] / p[SIGMA_C]]);
            let jets = tangent_by_jets_3(&*law, &Context::default(), &o, &p, &old, &mut [0.0]);
            let error = testing::analytic_tangent_error(&*law, &Context::default(), &o, &p, &old, jets);
            prop_assert!(error.expect("every law has one") < 1e-11, "{}: {:?}", name, error);
        }
    }

    /// Away from the corners of the curves, where the slope jumps.
    #[test]
    fn tangents_and_parameter_slopes_are_differences((c, shape) in common(), o in openings()) {
        for (name, law) in laws_of_the_registry() {
            let p = values(&*law, c, shape);
            let o = scaled(&o, &p);
            let delta = effective_opening(&o, p[2]);
            let secant = |d: f64| respond(&*law, &[d, 0.0, 0.0], &p, 0.0).0[0] / d;
            // One-sided slopes agree: no corner here.
            let h = 1e-5 * delta;
            let (right, left) = (secant(delta + h) - secant(delta), secant(delta) - secant(delta - h));
            let corner = (right - left).abs() > 1e-3 * right.abs().max(left.abs()) + 1e-12 * secant(delta);
            if corner || delta == 0.0 || o[0].abs() <= 1e-4 * delta {
                continue;
            }
            let error = testing::tangent_error_3(&*law, &Context::default(), &o, &p, &[0.0], 1e-7 * delta);
            prop_assert!(error < 1e-4, "{}: {}", name, error);
            for k in 0..p.len() {
                let jets: Vec<Jet<1>> = p.iter().enumerate()
                    .map(|(i, &v)| if i == k { Jet::variable(v, 0) } else { Jet::constant(v) }).collect();
                let exact = Law::<Jet<1>, 3>::respond(
                    &*law, &Context::default(), &o.map(Jet::constant), &jets, &[Jet::constant(0.0)],
                    &mut [Jet::constant(0.0)]).force;
                let h = 1e-7 * p[k];
                let at = |d: f64| {
                    let mut p = p.clone();
                    p[k] += d;
                    respond(&*law, &o, &p, 0.0).0
                };
                let (up, down) = (at(h), at(-h));
                for i in 0..3 {
                    let difference = (up[i] - down[i]) / (2.0 * h);
                    let error = (exact[i].eps[0] - difference).abs();
                    let scale = exact[i].eps[0].abs().max(p[SIGMA_C] / p[k]);
                    prop_assert!(error < 2e-3 * scale, "{} parameter {}: {} {}", name, k, exact[i].eps[0], difference);
                }
            }
        }
    }

    #[test]
    fn damage_grows_from_zero_to_one((c, shape) in common(), a in 0.0f64..30.0, b in 0.0f64..30.0) {
        for (name, law) in laws_of_the_registry() {
            let p = values(&*law, c, shape);
            let scales = law.offers().cohesion.expect("an interface law has scales");
            let unit = p[GC] / p[SIGMA_C];
            let (low, high) = (scales.damage(a.min(b) * unit, &p), scales.damage(a.max(b) * unit, &p));
            prop_assert!((0.0..=1.0).contains(&low) && low <= high && high <= 1.0, "{}: {} {}", name, low, high);
            prop_assert!(scales.damage(0.0, &p) == 0.0 && scales.damage(60.0 * unit, &p) > 1.0 - 1e-12, "{}", name);
        }
    }

    /// Any closed polygon, mixed mode and closing: no work is gained, and what is lost is what the law says.
    #[test]
    fn a_closed_path_never_gives_work((c, shape) in common(), path in proptest::collection::vec(openings(), 1..5)) {
        for (name, law) in laws_of_the_registry() {
            let p = values(&*law, c, shape);
            let points: Vec<Opening> = path.iter().map(|o| scaled(o, &p)).collect();
            let (sum, energy) = along(&*law, &points, &p, 400);
            let scale = p[GC] + energy.stored;
            prop_assert!((sum - energy.stored - energy.dissipated).abs() < 2e-3 * scale, "{}: {} {:?}", name, sum, energy);
            prop_assert!(energy.dissipated >= -1e-12 * p[GC], "{}: {:?}", name, energy);
        }
    }

    #[test]
    fn unloading_is_the_secant_through_the_origin((c, shape) in common(), o in openings(), s in 0.0f64..1.0) {
        for (name, law) in laws_of_the_registry() {
            let p = values(&*law, c, shape);
            let o = scaled(&[o[0].abs(), o[1], o[2]], &p);
            let (top, energy, old) = respond(&*law, &o, &p, 0.0);
            let (part, rest, new) = respond(&*law, &o.map(|x| s * x), &p, old);
            prop_assert_eq!(new, old);
            for i in 0..3 {
                prop_assert!((part[i] - s * top[i]).abs() <= 1e-13 * top[i].abs(), "{}", name);
            }
            prop_assert!((rest - s * s * energy).abs() <= 1e-13 * energy, "{}", name);
        }
    }

    /// The secant never rises: unloading gives back no more than was put in.
    #[test]
    fn the_secant_never_rises((c, shape) in common(), x in 0.001f64..3.0, factor in 1.0f64..3.0) {
        for (name, law) in laws_of_the_registry() {
            let p = values(&*law, c, shape);
            let d = x * p[GC] / p[SIGMA_C];
            let secant = |d: f64| respond(&*law, &[d, 0.0, 0.0], &p, 0.0).0[0] / d;
            prop_assert!(secant(factor * d) <= secant(d) * (1.0 + 1e-12), "{}", name);
        }
    }

    #[test]
    fn the_peak_is_the_strength_at_delta_c((c, shape) in common(), x in 0.0f64..4.0) {
        for (name, law) in laws_of_the_registry() {
            let p = values(&*law, c, shape);
            let (peak, slopes) = law.offers().cohesion.expect("scales").delta_c(&p);
            let traction = |d: f64| respond(&*law, &[d, 0.0, 0.0], &p, 0.0).0[0];
            prop_assert!((traction(peak) / p[SIGMA_C] - 1.0).abs() < 1e-12, "{}: {}", name, traction(peak));
            prop_assert!(traction(x * p[GC] / p[SIGMA_C]) <= p[SIGMA_C] * (1.0 + 1e-12), "{}", name);
            let end = law.offers().cohesion.expect("scales").softening_end(&p);
            prop_assert!((traction(end * peak) / p[SIGMA_C] - 0.2).abs() < 1e-3, "{}: {}", name, end);
            // δc scales with Gc and with 1/σc.
            prop_assert!((slopes[0] * p[GC] / peak - 1.0).abs() < 1e-12, "{}", name);
            prop_assert!((slopes[1] * p[SIGMA_C] / peak + 1.0).abs() < 1e-12, "{}", name);
        }
    }
}

/// The work of the traction to full opening is Gc, in any mode.
#[test]
fn work_to_full_opening_is_the_fracture_energy() {
    for (name, law) in laws_of_the_registry() {
        let mut worst = 0.0f64;
        for (c, shape) in [
            ([0.23, 0.2, 1.0, 10.0], 0.5),
            ([1.346, 0.001, 0.7, 10.0], 0.1),
            ([0.089, 0.572, 2.0, 10.0], 0.9),
        ] {
            let p = values(&*law, c, shape);
            for direction in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.6, 0.3, -0.5]] {
                let unit = effective_opening(&direction, p[2]);
                let end = direction.map(|x| 15.0 * p[GC] / p[SIGMA_C] * x / unit);
                let (sum, energy) = along(&*law, &[end], &p, 200_000);
                worst = worst.max((sum / p[GC] - 1.0).abs());
                assert!(
                    (energy.dissipated / p[GC] - 1.0).abs() < 1e-12 && energy.stored < 1e-12 * p[GC],
                    "{name}"
                );
            }
        }
        assert!(worst < 1e-6, "{name}: {worst}");
        println!("{name}: work of separation within {worst:.1e} of Gc");
    }
}

#[test]
fn closing_is_the_penalty_alone() {
    for (name, law) in laws_of_the_registry() {
        let p = values(&*law, [0.23, 0.2, 1.0, 10.0], 0.5);
        let (t, energy, new) = respond(&*law, &[-0.01, 0.0, 0.0], &p, 0.0);
        assert_eq!((t, new), ([-0.01 * p[PENALTY], 0.0, 0.0], 0.0), "{name}");
        assert!((energy - 0.5 * p[PENALTY] * 1e-4).abs() < 1e-17, "{name}");
        let (t, _, _) = respond(&*law, &[f64::NAN, 0.0, 0.0], &p, 0.1);
        assert!(t[0].is_nan(), "{name}");
        assert!(respond(&*law, &[1e4, 0.0, 0.0], &p, 0.0).0[0].abs() < 1e-300, "{name}");
    }
}

#[test]
fn every_law_begins_as_the_site_asks() {
    for (name, law) in laws_of_the_registry() {
        let specs = law.parameters();
        let common = cohesive::common_parameters();
        assert_eq!(specs[..common.len()], common[..], "{name}");
        assert_eq!(law.history()[DELTA_MAX].name, "delta_max", "{name}");
        // Shapes are held unless freed, and neither bound makes a law of another kind.
        assert!(specs[common.len()..].iter().all(|s| s.fixed && !s.description.is_empty()), "{name}");
    }
    assert_eq!(laws::registry().law_names(LawSite::Interface)[0], "exponential", "the default");
}
