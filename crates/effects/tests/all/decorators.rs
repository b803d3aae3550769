//! Every bulk and interface decorator of the catalogue against the battery.
// Steps, their traces and their predecessors go by one index.
#![allow(clippy::needless_range_loop)]

use crate::battery;

use battery::*;
use constitutive::{Jet, PointLaw};
use model::{Bulk, Effect, Interface, Site};

/// The law inside an effect when every effect of smaller rank is in force.
fn bulk_inside(effect: &dyn Effect) -> (Bulk, Vec<f64>) {
    let (mut law, mut params) = (base_bulk(), TISSUE.to_vec());
    for e in all(Site::Bulk).iter().filter(|e| e.card().rank < effect.card().rank) {
        law = wrap_bulk(&**e, law).unwrap();
        params.extend(active(&**e));
    }
    (law, params)
}

fn interface_inside(effect: &dyn Effect) -> (Interface, Vec<f64>) {
    let (mut law, mut params) = (base_interface(), TEAR.to_vec());
    for e in all(Site::Interface).iter().filter(|e| e.card().rank < effect.card().rank) {
        law = wrap_interface(&**e, law).unwrap();
        params.extend(active(&**e));
    }
    (law, params)
}

fn assert_neutral<const G: usize>(
    name: &str,
    inner: &dyn PointLaw<G>,
    outer: &dyn PointLaw<G>,
    base: &[f64],
    shape: &[f64],
    steps: &Steps<G>,
) {
    let a = drive(inner, base, steps);
    let b = drive(outer, &joined(base, shape), steps);
    for s in 0..steps.len() {
        assert_eq!(bits(&a.force[s]), bits(&b.force[s]), "{name}: force of step {s}");
        assert_eq!(a.energy[s].to_bits(), b.energy[s].to_bits(), "{name}: energy of step {s}");
        let n = a.history[s].len();
        assert_eq!(bits(&a.history[s]), bits(&b.history[s][..n]), "{name}: inner history of step {s}");
    }
    let (e, f) = (ledger(inner, base, steps), ledger(outer, &joined(base, shape), steps));
    for (x, y) in e.iter().zip(&f) {
        assert!((x[1] - y[1]).abs() <= 1e-14 * x[1].abs(), "{name}: stored {} {}", x[1], y[1]);
        assert!((x[2] - y[2]).abs() <= 1e-12 * (x[1].abs() + x[2].abs()), "{name}: lost {} {}", x[2], y[2]);
    }
}

#[test]
fn neutral_values_are_the_inner_law_bit_for_bit() {
    for seed in 1..8 {
        for e in all(Site::Bulk) {
            for (inner, base) in [(base_bulk(), TISSUE.to_vec()), bulk_inside(&*e)] {
                let outer = wrap_bulk(&*e, inner.clone()).unwrap();
                for shape in e.shapes(&SCALES) {
                    assert_neutral(e.card().name, &*inner, &*outer, &base, &shape, &stretching(seed));
                }
            }
        }
        for e in all(Site::Interface) {
            for (inner, base) in [(base_interface(), TEAR.to_vec()), interface_inside(&*e)] {
                let outer = wrap_interface(&*e, inner.clone()).unwrap();
                for shape in e.shapes(&SCALES) {
                    assert_neutral(e.card().name, &*inner, &*outer, &base, &shape, &opening(seed));
                }
            }
        }
    }
}

/// A step of differencing that suits a parameter's size.
fn assert_columns<const G: usize>(
    name: &str,
    law: &dyn PointLaw<G>,
    base: &[f64],
    own: &[f64],
    typical: &[f64],
    steps: &Steps<G>,
) {
    let params = joined(base, own);
    for k in base.len()..params.len() {
        let h = step(params[k], typical[k - base.len()]);
        let still = column_error(law, &params, steps, k, &[0.0; G], h);
        assert!(still < 3e-5, "{name}: parameter {} at {own:?}: {still:e}", k - base.len());
        // The equilibrium moves with the parameter too: derivatives through gradient and history.
        let along: [f64; G] =
            std::array::from_fn(|i| 0.01 * (1.0 + i as f64) / typical[k - base.len()].abs().max(0.05));
        let total = column_error(law, &params, steps, k, &along, h);
        assert!(total < 1e-4, "{name}: total, parameter {} at {own:?}: {total:e}", k - base.len());
    }
}

/// Differences across a switch are no derivatives: holds and returns to the same maximum must not
/// sit exactly on one. Of F only the stretch along the load moves: a change of volume alone would
/// leave every isochoric switch where it is, and the reference state is itself a switch of the
/// fibres.
#[test]
fn columns_are_the_differences_also_after_a_history() {
    for e in all(Site::Bulk) {
        let law = wrap_bulk(&*e, base_bulk()).unwrap();
        let typical = active(&*e);
        for own in e.shapes(&SCALES).into_iter().chain([typical.clone()]) {
            assert_columns(e.card().name, &*law, &TISSUE, &own, &typical, &off_switches(stretching(3)));
        }
    }
    for e in all(Site::Interface) {
        let law = wrap_interface(&*e, base_interface()).unwrap();
        let typical = active(&*e);
        for own in e.shapes(&SCALES).into_iter().chain([typical.clone()]) {
            assert_columns(e.card().name, &*law, &TEAR, &own, &typical, &off_switches(opening(3)));
        }
    }
}

#[test]
fn base_parameters_are_differentiated_through_every_decorator() {
    for e in all(Site::Bulk) {
        let (law, params) = (wrap_bulk(&*e, base_bulk()).unwrap(), joined(&TISSUE, &active(&*e)));
        for k in 0..5 {
            let error = column_error(
                &*law,
                &params,
                &off_switches(stretching(5)),
                k,
                &[0.0; 9],
                step(params[k], 0.0),
            );
            assert!(error < 3e-5, "{}: base parameter {k}: {error:e}", e.card().name);
        }
    }
    for e in all(Site::Interface) {
        let (law, params) = (wrap_interface(&*e, base_interface()).unwrap(), joined(&TEAR, &active(&*e)));
        for k in 0..2 {
            let error =
                column_error(&*law, &params, &off_switches(opening(5)), k, &[0.0; 3], step(params[k], 0.0));
            assert!(error < 3e-5, "{}: base parameter {k}: {error:e}", e.card().name);
        }
    }
}

#[test]
fn bounds_keep_every_law_finite() {
    let finite = |name: &str, own: &[f64], ok: bool| assert!(ok, "{name} at {own:?}");
    for e in effects() {
        let (name, specs, typical) = (e.card().name, e.parameters(&Default::default()), active(&*e));
        for k in 0..specs.len() {
            for value in [specs[k].lower, specs[k].upper] {
                let mut own = typical.clone();
                own[k] = value;
                if let Some(law) = wrap_bulk(&*e, base_bulk()) {
                    let t = drive(&*law, &joined(&TISSUE, &own), &stretching(6));
                    finite(name, &own, t.force.iter().flatten().all(|x| x.is_finite()));
                    let j = testing_jets(&*law, &joined(&TISSUE, &own), &stretching(6), 7 + k);
                    finite(name, &own, j);
                }
                if let Some(law) = wrap_interface(&*e, base_interface()) {
                    let t = drive(&*law, &joined(&TEAR, &own), &opening(6));
                    finite(name, &own, t.force.iter().flatten().all(|x| x.is_finite()));
                    let j = testing_jets(&*law, &joined(&TEAR, &own), &opening(6), 4 + k);
                    finite(name, &own, j);
                }
            }
        }
    }
}

fn testing_jets<const G: usize>(
    law: &dyn PointLaw<G>,
    params: &[f64],
    steps: &Steps<G>,
    seed: usize,
) -> bool {
    let t = drive_jets(law, params, steps, seed, &[0.0; G]);
    let fine = |j: &Jet<1>| j.re.is_finite() && j.eps[0].is_finite();
    t.force.iter().flatten().all(fine) && t.history.iter().flatten().all(fine)
}
