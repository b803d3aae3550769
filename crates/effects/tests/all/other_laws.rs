//! Effects around every law of the registry: neutral to the bit, analytic tangents as by jets, and refused where the law
//! lacks what they ask for.

use crate::battery::*;
use constitutive::{Capability, PointLaw, tangent_by_jets_9, testing};
use input::{EffectConfig, EffectRegistry};
use laws::Settings;
use model::{Bulk, Effect, Interface, Options, Site};

/// Every bulk law with ordinary values, its exponentials tame enough for the battery's stretches.
fn bulk_laws() -> Vec<(String, Bulk, Vec<f64>)> {
    let of = |law: &laws::BulkLaw| {
        let point = law.law(&Settings::new());
        let value = |p: &params::ParamSpec| match p.name.as_ref() {
            name if name.starts_with('b') || name.starts_with("k2") => 2.0,
            _ => p.start,
        };
        let params = point.parameters().iter().map(value).collect();
        (law.card().name.to_owned(), point, params)
    };
    laws::registry().all_bulk().map(of).collect()
}

fn interface_laws() -> Vec<(String, Interface, Vec<f64>)> {
    let of = |law: &laws::InterfaceLaw| {
        let point = law.law(&Settings::new());
        let shape = point.parameters().into_iter().skip(TEAR.len()).map(|p| p.start);
        (law.card().name.to_owned(), point, TEAR.into_iter().chain(shape).collect())
    };
    laws::registry().all_interface().map(of).collect()
}

fn acts_on<const G: usize>(effect: &dyn Effect, options: &Options, law: &dyn PointLaw<G>) -> bool {
    let offers = law.offers();
    effect.asks(options).iter().all(|a| offers.has(*a))
}

fn assert_neutral<const G: usize>(
    name: &str,
    inner: &dyn PointLaw<G>,
    outer: &dyn PointLaw<G>,
    base: &[f64],
    shape: &[f64],
    steps: &Steps<G>,
) {
    let (a, b) = (drive(inner, base, steps), drive(outer, &joined(base, shape), steps));
    for s in 0..steps.len() {
        assert_eq!(bits(&a.force[s]), bits(&b.force[s]), "{name}: force of step {s}");
        assert_eq!(a.energy[s].to_bits(), b.energy[s].to_bits(), "{name}: energy of step {s}");
    }
}

#[test]
fn neutral_values_are_every_law_bit_for_bit() {
    let mut pairs = 0;
    for (law, inner, base) in bulk_laws() {
        for e in all(Site::Bulk).iter().filter(|e| acts_on(&***e, &Options::new(), &*inner)) {
            let outer = wrap_bulk(&**e, inner.clone()).unwrap();
            let name = format!("{} on {law}", e.card().name);
            for shape in e.shapes(&SCALES) {
                assert_neutral(&name, &*inner, &*outer, &base, &shape, &stretching(3));
            }
            pairs += 1;
        }
    }
    for (law, inner, base) in interface_laws() {
        for e in all(Site::Interface).iter().filter(|e| acts_on(&***e, &Options::new(), &*inner)) {
            let outer = wrap_interface(&**e, inner.clone()).unwrap();
            let name = format!("{} on {law}", e.card().name);
            for shape in e.shapes(&SCALES) {
                assert_neutral(&name, &*inner, &*outer, &base, &shape, &opening(3));
            }
            pairs += 1;
        }
    }
    println!("{pairs} pairs of effect and law");
}

#[test]
fn tangents_and_energies_hold_on_every_law() {
    for (law, inner, base) in bulk_laws() {
        for e in all(Site::Bulk) {
            let forms = [(Options::new(), active(&*e))].into_iter();
            for (options, own) in forms.chain(e.richer(&Options::new(), &active(&*e))) {
                if !acts_on(&*e, &options, &*inner) {
                    continue;
                }
                let name = format!("{} {options:?} on {law}", e.card().name);
                let outer = wrap_bulk_with(&*e, &options, inner.clone()).unwrap();
                let params = joined(&base, &own);
                let steps = off_switches(stretching(2));
                let trace = drive(&*outer, &params, &steps);
                for (s, ((ctx, f), old)) in steps[1..].iter().zip(&trace.history).enumerate() {
                    let jets = tangent_by_jets_9(&*outer, ctx, f, &params, old, &mut old.clone());
                    if let Some(error) = testing::analytic_tangent_error(&*outer, ctx, f, &params, old, jets)
                    {
                        assert!(error < 1e-10, "{name}: step {s}: {error:e}");
                    }
                }
                // Nothing is gained: stored + dissipated stays at the work put in, within the trapezoid's error, and
                // dissipation does not fall. (The clock of stiffness_drift does work of its own.)
                let fine = refine(&stretching(2)[..8].to_vec(), 60);
                let ledger = ledger(&*outer, &params, &fine);
                let scale = ledger.iter().fold(1e-12f64, |m, l| m.max(l[0].abs()));
                let closure = |l: &[f64; 3]| (l[0] - l[1] - l[2]).abs() / scale;
                let worst = ledger.iter().map(closure).fold(0.0, f64::max);
                assert!(e.card().name == "stiffness_drift" || worst < 0.06, "{name}: {worst:e}");
            }
        }
    }
}

#[test]
fn a_law_that_lacks_something_is_told_so() {
    let catalogue = effects::catalogue();
    let bulk = |law: &str| input::BulkConfig {
        law: law.into(),
        options: Options::new(),
        parameters: Default::default(),
        specs: Vec::new(),
    };
    let interface = |law: &str| input::InterfaceConfig {
        law: law.into(),
        options: Options::new(),
        areas: 1,
        profile: input::Profile::Piecewise,
        gc: Vec::new(),
        sigma_c: Vec::new(),
        parameters: Default::default(),
        specs: Vec::new(),
    };
    let effect = |name: &str| EffectConfig {
        name: name.into(),
        parameters: Default::default(),
        specs: Vec::new(),
        options: Options::new(),
        location: Default::default(),
    };
    let told = |e: &str, b: &str, i: &str| catalogue.lacks(&effect(e), &bulk(b), &interface(i));
    for (name, on, interface_law, lacking) in [
        ("fiber_damage", "neo_hooke", "exponential", "law `neo_hooke` has no fibre families"),
        ("fiber_damage", "ogden", "exponential", "law `ogden` has no fibre families"),
        (
            "fiber_recruitment",
            "yeoh",
            "exponential",
            "law `yeoh` has no fibre strain from which fibres carry load",
        ),
        (
            "law_shape",
            "hgo",
            "bilinear",
            "law `bilinear` has no exponential curve of traction against opening",
        ),
    ] {
        assert_eq!(told(name, on, interface_law).as_deref(), Some(lacking));
    }
    for (name, on, interface_law) in [
        ("fiber_damage", "four_fiber", "bilinear"),
        ("fiber_recruitment", "holzapfel_ogden", "ppr"),
        ("mullins", "ogden", "bilinear"),
        ("bridging", "neo_hooke", "trapezoidal"),
        ("law_shape", "yeoh", "exponential"),
    ] {
        assert_eq!(told(name, on, interface_law), None);
    }
    assert_eq!(Capability::Fibres.words(), "fibre families");
}
