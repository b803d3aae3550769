//! Every bulk law of the registry through one battery, and each against its closed forms.

mod closed_forms;

use constitutive::{Context, Law, PointLaw, tangent_by_jets_9, tensor, testing};
use input::{LawRegistry, LawSite, OptionValue};
use laws::{BulkLaw, Settings};
use params::ParamSpec;
use proptest::prelude::*;
use std::sync::Arc;

type Params = Vec<f64>;

/// Every law under every word or number that its settings allow.
fn variants() -> Vec<(String, Arc<dyn PointLaw<9>>)> {
    let registry = laws::registry();
    let mut all = Vec::new();
    for law in registry.all_bulk() {
        let name = law.card().name;
        for settings in combinations(law) {
            all.push((format!("{name} {settings:?}"), law.law(&settings)));
        }
    }
    all
}

fn combinations(law: &BulkLaw) -> Vec<Settings> {
    let mut all = vec![Settings::new()];
    for option in law.options() {
        let values: Vec<OptionValue> = match option.kind {
            input::OptionKind::Bool => vec![OptionValue::Bool(true), OptionValue::Bool(false)],
            input::OptionKind::Integer { min, max } => (min..=max).map(OptionValue::Integer).collect(),
            input::OptionKind::Choice(words) => words.into_iter().map(OptionValue::Text).collect(),
            _ => continue,
        };
        let with = |s: &Settings, v: &OptionValue| {
            let mut s = s.clone();
            s.insert(option.name.clone(), v.clone());
            s
        };
        all = all.iter().flat_map(|s| values.iter().map(|v| with(s, v)).collect::<Vec<_>>()).collect();
    }
    all
}

/// Ordinary values: the starts, moved by factors near one; D such that the volume matters too. Stiffening is held low
/// enough for the exponentials over the deformations below.
fn values(specs: &[ParamSpec], factors: &[f64]) -> Params {
    let of = |(spec, factor): (&ParamSpec, &f64)| {
        let v = spec.start * factor;
        match spec.name.as_ref() {
            "d" => 2.0 * v,
            "fibre_onset" => 0.0,
            "kappa" => v.min(0.33),
            name if name.starts_with('b') || name.starts_with("k2") => 0.2 * v.min(8.0),
            _ => v,
        }
    };
    specs.iter().zip(factors.iter().cycle()).map(of).collect()
}

/// F = Q diag(λ) R with principal stretches from 0.75 to 1.5.
fn deformations() -> impl Strategy<Value = [f64; 9]> {
    let angle = || -3.1f64..3.1;
    let rotation = move || (angle(), angle(), angle()).prop_map(|(a, b, c)| testing::rotation(a, b, c));
    // Pairs and triples of equal stretches among them.
    let stretch =
        prop_oneof![Just([1.2, 1.2, 0.8]), Just([1.3, 1.3, 1.3]), [0.75f64..1.5, 0.75..1.5, 0.75..1.5]];
    (rotation(), stretch, rotation()).prop_map(|(q, [a, b, c], r)| {
        tensor::mul(&q, &tensor::mul(&[a, 0.0, 0.0, 0.0, b, 0.0, 0.0, 0.0, c], &r))
    })
}

fn factors() -> impl Strategy<Value = Vec<f64>> {
    proptest::collection::vec(0.6f64..1.6, 7)
}

fn largest<'a>(x: impl IntoIterator<Item = &'a f64>) -> f64 {
    x.into_iter().fold(1e-300, |m: f64, x| m.max(x.abs()))
}

/// Whether a fibre family switches on or off within a step of one component of F: there the tangent jumps.
fn near_a_switch(law: &dyn PointLaw<9>, f: &[f64; 9], p: &Params, step: f64) -> bool {
    let families = law.offers().bulk.map(|b| b.fibres).unwrap_or_default();
    let moved = |i: usize, h: f64| {
        let mut f = *f;
        f[i] += h;
        f
    };
    families.iter().any(|family| {
        let active = |f: &[f64; 9]| constitutive::part_response(&family.response, f, p).energy > 0.0;
        let here = active(f);
        (0..9).any(|i| active(&moved(i, step)) != here || active(&moved(i, -step)) != here)
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, ..ProptestConfig::default() })]

    #[test]
    fn the_analytic_tangent_is_that_of_the_jets(f in deformations(), x in factors()) {
        for (name, law) in variants() {
            let p = values(&law.parameters(), &x);
            let jets = tangent_by_jets_9(&*law, &Context::default(), &f, &p, &[], &mut []);
            let error = testing::analytic_tangent_error(&*law, &Context::default(), &f, &p, &[], jets);
            prop_assert!(error.expect("every law has one") < 1e-11, "{}: {:?}", name, error);
        }
    }

    #[test]
    fn stress_is_the_slope_of_the_energy_and_the_tangent_that_of_the_stress(f in deformations(), x in factors()) {
        for (name, law) in variants() {
            let p = values(&law.parameters(), &x);
            let (force, a) = tangent_by_jets_9(&*law, &Context::default(), &f, &p, &[], &mut []);
            let stiffness = largest(a.iter().flatten());
            let h = 1e-6;
            // Where a family switches within the difference, its stiffness takes part in a part of it.
            let allowed = if near_a_switch(&*law, &f, &p, h) { h } else { 1e-8 };
            for i in 0..9 {
                let (mut up, mut down) = (f, f);
                up[i] += h;
                down[i] -= h;
                let energy = |f: &[f64; 9]| testing::respond(&*law, &Context::default(), f, &p, &[]).1;
                let slope = (energy(&up) - energy(&down)) / (2.0 * h);
                prop_assert!((slope - force[i]).abs() < allowed * stiffness, "{} {}: {} {}", name, i, slope, force[i]);
            }
            if near_a_switch(&*law, &f, &p, 1e-3) {
                continue;
            }
            let error = testing::tangent_error_9(&*law, &Context::default(), &f, &p, &[], 1e-6);
            prop_assert!(error < 2e-6, "{}: {}", name, error);
            for (i, j) in (0..9).flat_map(|i| (0..i).map(move |j| (i, j))) {
                prop_assert!((a[i][j] - a[j][i]).abs() < 1e-11 * stiffness, "{} is not symmetric", name);
            }
        }
    }

    #[test]
    fn a_rotation_of_the_strip_turns_the_stress(f in deformations(), x in factors(), a in -3.0f64..3.0, b in -3.0f64..3.0) {
        let q = testing::rotation(a, b, 0.4);
        for (name, law) in variants() {
            let p = values(&law.parameters(), &x);
            let ctx = Context::default();
            let (_, tangent) = tangent_by_jets_9(&*law, &ctx, &f, &p, &[], &mut []);
            let (force, _, _) = testing::respond(&*law, &ctx, &f, &p, &[]);
            let (turned, _, _) = testing::respond(&*law, &ctx, &tensor::mul(&q, &f), &p, &[]);
            let expected = tensor::mul(&q, &force);
            let scale = largest(tangent.iter().flatten());
            for i in 0..9 {
                prop_assert!((turned[i] - expected[i]).abs() < 1e-12 * scale, "{}", name);
            }
            let tau = tensor::kirchhoff(&force, &f);
            prop_assert!((tau[1] - tau[3]).abs().max((tau[2] - tau[6]).abs()) < 1e-12 * scale, "{}", name);
        }
    }

    #[test]
    fn parameters_have_their_slopes(f in deformations(), x in factors()) {
        for (name, law) in variants() {
            let p = values(&law.parameters(), &x);
            if near_a_switch(&*law, &f, &p, 1e-3) {
                continue;
            }
            // One by one: a slope near zero beside a large one is rounding of the difference.
            let (_, a) = tangent_by_jets_9(&*law, &Context::default(), &f, &p, &[], &mut []);
            for k in 0..p.len() {
                let mut jets: Vec<constitutive::Jet<1>> =
                    p.iter().map(|&v| constitutive::Jet::constant(v)).collect();
                jets[k].eps[0] = 1.0;
                let exact = Law::<constitutive::Jet<1>, 9>::respond(
                    &*law, &Context::default(), &f.map(constitutive::Jet::constant), &jets, &[], &mut []);
                let h = 1e-5 * p[k].abs().max(1e-3);
                let at = |d: f64| {
                    let mut p = p.clone();
                    p[k] += d;
                    testing::respond(&*law, &Context::default(), &f, &p, &[]).0
                };
                let (up, down) = (at(h), at(-h));
                let noise = 1e-12 * largest(a.iter().flatten()) / h;
                for i in 0..9 {
                    let difference = (up[i] - down[i]) / (2.0 * h);
                    let size = largest(exact.force.iter().map(|x| &x.eps[0]));
                    let error = (exact.force[i].eps[0] - difference).abs();
                    prop_assert!(error < 1e-5 * size + noise, "{} parameter {}: {}", name, k, error);
                }
            }
        }
    }

    /// The parts that a law offers are parts: the volume's has no shear stiffness, and without it and the fibres an
    /// isotropic matrix is left.
    #[test]
    fn what_is_left_without_fibres_and_volume_is_isochoric(f in deformations(), x in factors(), s in 0.9f64..1.1) {
        for (name, law) in variants() {
            let p = values(&law.parameters(), &x);
            let parts = law.offers().bulk.expect("a bulk law says what it consists of");
            if !parts.rest_is_isochoric {
                continue;
            }
            let volume = parts.volumetric.expect("every law of the registry splits");
            let rest = |f: &[f64; 9]| {
                let whole = testing::respond(&*law, &Context::default(), f, &p, &[]).1;
                whole - constitutive::part_response(&volume, f, &p).energy
            };
            let (a, b) = (rest(&f), rest(&f.map(|v| v * s)));
            prop_assert!((a - b).abs() < 1e-11 * (1.0 + a.abs()), "{}: {} {}", name, a, b);
            for family in &parts.fibres {
                let part = |f: &[f64; 9]| constitutive::part_response(&family.isochoric, f, &p);
                let error = (part(&f).energy - part(&f.map(|v| v * s)).energy).abs();
                prop_assert!(error < 1e-11 * (1.0 + part(&f).energy), "{}", name);
            }
        }
    }
}

#[test]
fn the_reference_is_free_of_stress() {
    for (name, law) in variants() {
        let p = values(&law.parameters(), &[1.0]);
        let (force, energy, _) =
            testing::respond(&*law, &Context::default(), &tensor::identity::<f64>(), &p, &[]);
        assert_eq!((force, energy), ([0.0; 9], 0.0), "{name}");
    }
}

#[test]
fn what_is_out_of_domain_is_seen_not_thrown() {
    for (name, law) in variants() {
        let p = values(&law.parameters(), &[1.0]);
        for f in [[0.0; 9], [f64::NAN; 9], [-1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]] {
            let (force, _, _) = testing::respond(&*law, &Context::default(), &f, &p, &[]);
            assert!(force.iter().any(|x| !x.is_finite()), "{name} {f:?}: {force:?}");
            let answer = law.analytic_tangent(&Context::default(), &f, &p, &[], &mut []);
            assert!(answer.is_none_or(|(p, _)| p.iter().any(|x| !x.is_finite())), "{name}");
        }
    }
}

#[test]
fn every_law_says_what_a_file_and_a_search_need() {
    for (name, law) in variants() {
        let specs = law.parameters();
        for s in &specs {
            assert!(
                s.lower <= s.start && s.start <= s.upper && !s.description.is_empty(),
                "{name} {}",
                s.name
            );
            let (low, high) = s.admissible.unwrap_or((s.lower, s.upper));
            assert!(low <= s.start && s.start <= high, "{name} {}", s.name);
            assert!(s.internal || s.transform.forward(s.start).is_finite(), "{name} {}", s.name);
            assert!(s.fixed || s.expected.is_some() || s.name.starts_with("alpha"), "{name} {}", s.name);
        }
        let starts =
            law.offers().bulk.and_then(|b| b.starts).expect("every law of the registry offers starts");
        assert_eq!(starts.template.len(), specs.len(), "{name}");
        assert!(starts.axes.iter().all(|(i, n)| *i < specs.len() && *n > 0), "{name}");
        assert!(law.history().is_empty() && !law.rate_dependent(), "{name}");
    }
    let names = laws::registry().law_names(LawSite::Bulk);
    assert_eq!(names[0], "hgo", "the default");
}
