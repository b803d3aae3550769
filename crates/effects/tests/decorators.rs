//! Every bulk and interface decorator of the catalogue against the battery.
// Steps, their traces and their predecessors go by one index.
#![allow(clippy::needless_range_loop)]

mod battery;

use battery::*;
use constitutive::{Context, Jet, PointLaw, tangent_by_jets_3, tangent_by_jets_9, testing};
use model::{Bulk, Effect, Interface, Site};
use std::sync::Arc;

fn base_bulk() -> Bulk {
    Arc::new(hgo::Hgo::default())
}

fn base_interface() -> Interface {
    Arc::new(cohesive::Cohesive)
}

fn all(site: Site) -> Vec<Arc<dyn Effect>> {
    let mut list: Vec<_> = effects().into_iter().filter(|e| e.card().site == site).collect();
    list.sort_by_key(|e| e.card().rank);
    list
}

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

fn joined(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().chain(b).copied().collect()
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
fn step(value: f64, plausible: f64) -> f64 {
    2e-4 * value.abs().max(plausible.abs()).max(1e-9)
}

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
fn off_switches<const G: usize>(steps: Steps<G>) -> Steps<G> {
    let moved = |i: usize, s: usize| match (G, i) {
        (9, 4) => 1.02 + 1e-3 * (s % 3) as f64,
        (9, _) => 1.0,
        _ => 1.0 + 1e-3 * (s % 3) as f64,
    };
    // A closed tear is a switch too: it starts a little open.
    let shift = |i: usize| if G == 3 && i == 0 { 0.003 } else { 0.0 };
    steps
        .into_iter()
        .enumerate()
        .map(|(s, (c, g))| (c, std::array::from_fn(|i| g[i] * moved(i, s) + shift(i))))
        .collect()
}

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

fn symmetry_error<const G: usize>(a: &[[f64; G]; G]) -> f64 {
    let scale = a.as_flattened().iter().fold(1e-300f64, |m, x| m.max(x.abs()));
    let worst = (0..G * G).fold(0.0f64, |m, k| m.max((a[k / G][k % G] - a[k % G][k / G]).abs()));
    worst / scale
}

/// Every bulk effect in its plain form, and in the other ones that a search may try, around both forms of the base law.
fn bulk_forms() -> Vec<(String, Bulk, Vec<f64>)> {
    let full = hgo::Hgo { fibre_invariants: hgo::FibreInvariants::Full, ..hgo::Hgo::default() };
    let mut forms = Vec::new();
    for (base, of) in [(base_bulk(), ""), (Arc::new(full) as Bulk, " full")] {
        for e in all(Site::Bulk) {
            let (name, own) = (e.card().name, active(&*e));
            let plain = wrap_bulk(&*e, base.clone()).unwrap();
            forms.push((format!("{name}{of}"), plain, joined(&TISSUE, &own)));
            for (options, values) in e.richer(&model::Options::new(), &own) {
                let law = wrap_bulk_with(&*e, &options, base.clone()).unwrap();
                forms.push((format!("{name}{of} {options:?}"), law, joined(&TISSUE, &values)));
            }
        }
    }
    forms
}

#[test]
fn bulk_tangents_are_exact_symmetric_and_objective() {
    let q = testing::rotation(0.4, 0.7, -1.1);
    for (name, law, params) in bulk_forms() {
        let steps = off_switches(stretching(2));
        let trace = drive(&*law, &params, &steps);
        for s in 1..steps.len() {
            let (ctx, f) = &steps[s];
            let old = &trace.history[s - 1];
            let error = testing::tangent_error_9(&*law, ctx, f, &params, old, 1e-6);
            assert!(error < 1e-6, "{name}: tangent of step {s}: {error:e}");
            let by_jets = tangent_by_jets_9(&*law, ctx, f, &params, old, &mut old.clone());
            assert!(symmetry_error(&by_jets.1) < 1e-11, "{name}: symmetry: {:e}", symmetry_error(&by_jets.1));
            if let Some(error) = testing::hand_tangent_error(&*law, ctx, f, &params, old, by_jets) {
                assert!(error < 1e-11, "{name}: hand tangent: {error:e}");
                let mut by_hand = vec![f64::NAN; old.len()];
                law.hand_tangent(ctx, f, &params, old, &mut by_hand);
                for (a, b) in by_hand.iter().zip(&trace.history[s]) {
                    assert!((a - b).abs() <= 1e-13 * (1.0 + b.abs()), "{name}: history by hand {a} {b}");
                }
            }
            let error = testing::objectivity_error(&*law, ctx, f, &q, &params, old);
            assert!(error < 1e-10, "{name}: frame indifference: {error:e}");
        }
    }
}

#[test]
fn interface_tangents_are_exact_and_symmetric() {
    for e in all(Site::Interface) {
        let (law, params) = (wrap_interface(&*e, base_interface()).unwrap(), joined(&TEAR, &active(&*e)));
        let steps = off_switches(opening(2));
        let trace = drive(&*law, &params, &steps);
        for s in 1..steps.len() {
            let (ctx, d) = &steps[s];
            let old = &trace.history[s - 1];
            let name = e.card().name;
            let error = testing::tangent_error_3(&*law, ctx, d, &params, old, 1e-6);
            assert!(error < 1e-5, "{name}: tangent of step {s}: {error:e}");
            let by_jets = tangent_by_jets_3(&*law, ctx, d, &params, old, &mut old.clone());
            assert!(symmetry_error(&by_jets.1) < 1e-10, "{name}: symmetry of step {s}: {:?}", by_jets.1);
            if let Some(error) = testing::hand_tangent_error(&*law, ctx, d, &params, old, by_jets) {
                assert!(error < 1e-11, "{name}: hand tangent: {error:e}");
            }
        }
    }
}

/// Work of closed cycles and of the whole history is not negative, and the ledger closes.
fn assert_energy<const G: usize>(
    name: &str,
    law: &dyn PointLaw<G>,
    params: &[f64],
    steps: &Steps<G>,
    closure: f64,
    exact: bool,
) {
    let rows = ledger(law, params, steps);
    let scale = rows.iter().fold(0.0f64, |m, r| m.max(r[1].abs()).max(r[0].abs()));
    for (s, r) in rows.iter().enumerate() {
        let gap = (r[0] - r[1] - r[2]).abs();
        assert!(gap < closure * scale, "{name}: ledger of step {s}: gap {gap:e} of {scale:e} {r:?}");
        assert!(r[2] > -closure * scale, "{name}: dissipated {:e} of {scale:e}", r[2]);
        if exact && s > 0 {
            assert!(r[2] - rows[s - 1][2] > -closure * scale, "{name}: dissipation falls at step {s}");
        }
    }
}

#[test]
fn energy_is_kept_and_nothing_is_gained_in_cycles() {
    for (name, law, params) in bulk_forms() {
        let name = name.as_str();
        if name.starts_with("stiffness_drift") {
            continue; // its own test below
        }
        let mut steps = stretching(4);
        steps.truncate(10);
        // Back to the reference state: a closed cycle.
        let last = steps.last().unwrap().0;
        steps.push((Context { dt: 1.0, time: last.time + 1.0, ..last }, constitutive::tensor::identity()));
        let exact = !name.starts_with("viscoelastic");
        assert_energy(name, &*law, &params, &refine(&steps, 400), 2e-3, exact);
        let rows = ledger(&*law, &params, &refine(&steps, 400));
        let (most, work) = (rows.iter().fold(0.0f64, |m, r| m.max(r[0])), rows.last().unwrap()[0]);
        assert!(work > -1e-5 * most, "{name}: a closed cycle gave energy: {work:e} of {most:e}");
    }
    for e in all(Site::Interface) {
        let name = e.card().name;
        let law = wrap_interface(&*e, base_interface()).unwrap();
        let mut steps = opening(4);
        steps.truncate(12);
        let last = steps.last().unwrap().0;
        steps.push((Context { dt: 5.0, time: last.time + 5.0, ..last }, [0.0; 3]));
        let params = joined(&TEAR, &active(&*e));
        // A rate law switches its rise off where the opening turns: the traction jumps there.
        let closure = if name == "rate_dependent_strength" || name == "crack_friction" { 5e-3 } else { 5e-4 };
        assert_energy(name, &*law, &params, &refine(&steps, 400), closure, name != "fatigue");
    }
}

#[test]
fn stiffness_drift_accounts_for_its_parametric_work() {
    let e = named("stiffness_drift");
    let law = wrap_bulk(&*e, base_bulk()).unwrap();
    let mut steps = stretching(4);
    steps.truncate(10);
    let steps = refine(&steps, 400);
    let params = joined(&TISSUE, &[2e-3]);
    let trace = drive(&*law, &params, &steps);
    for (row, history) in ledger(&*law, &params, &steps).iter().zip(&trace.history) {
        let parametric = history.last().unwrap();
        assert!((row[0] + parametric - row[1]).abs() < 1e-4 * (1e-3 + row[1]), "{row:?} {parametric}");
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

/// Composes effects by rank, whatever their order in the list.
fn compose(names: &[&str], neutral_first: bool) -> (Bulk, Vec<f64>) {
    let mut list: Vec<_> = names.iter().map(|n| named(n)).collect();
    list.sort_by_key(|e| e.card().rank);
    let (mut law, mut params) = (base_bulk(), TISSUE.to_vec());
    for (i, e) in list.iter().enumerate() {
        law = wrap_bulk(&**e, law).unwrap();
        params.extend(if neutral_first && i == 0 { e.shapes(&SCALES)[0].clone() } else { active(&**e) });
    }
    (law, params)
}

#[test]
fn the_order_of_effects_in_a_list_does_not_matter() {
    let (a, pa) = compose(&["viscoelastic", "mullins", "fiber_damage"], false);
    let (b, pb) = compose(&["fiber_damage", "viscoelastic", "mullins"], false);
    let (x, y) = (drive(&*a, &pa, &stretching(9)), drive(&*b, &pb, &stretching(9)));
    for s in 0..x.force.len() {
        assert_eq!(bits(&x.force[s]), bits(&y.force[s]));
        assert_eq!(bits(&x.history[s]), bits(&y.history[s]));
    }
}

#[test]
fn ranks_are_unique_on_a_site() {
    for e in effects() {
        for f in effects() {
            if e.card().name != f.card().name && e.card().site == f.card().site {
                assert_ne!(e.card().rank, f.card().rank, "{} {}", e.card().name, f.card().name);
            }
        }
    }
}

#[test]
fn histories_add_up_and_no_name_comes_twice() {
    let every: Vec<&str> = all(Site::Bulk).iter().map(|e| e.card().name).collect();
    let (law, params) = compose(&every, false);
    let alone: usize =
        every.iter().map(|n| wrap_bulk(&*named(n), base_bulk()).unwrap().history().len()).sum();
    assert_eq!(law.history().len(), alone);
    assert_eq!(law.parameters().len(), params.len());
    let names: std::collections::BTreeSet<_> = law
        .history()
        .into_iter()
        .map(|h| h.name)
        .chain(law.parameters().into_iter().map(|p| p.name))
        .collect();
    assert_eq!(names.len(), law.history().len() + law.parameters().len());
    // The whole stack at work: finite, and its tangent exact.
    let steps = off_switches(stretching(7));
    let trace = drive(&*law, &params, &steps);
    for s in 1..steps.len() {
        let error =
            testing::tangent_error_9(&*law, &steps[s].0, &steps[s].1, &params, &trace.history[s - 1], 1e-6);
        assert!(error < 1e-6, "all effects, step {s}: {error:e}");
    }
}

#[test]
fn all_interface_effects_together_are_one_exact_law() {
    let (mut law, mut params) = (base_interface(), TEAR.to_vec());
    for e in all(Site::Interface) {
        law = wrap_interface(&*e, law).unwrap();
        params.extend(active(&*e));
    }
    assert_eq!(law.parameters().len(), params.len());
    let steps = off_switches(opening(7));
    let trace = drive(&*law, &params, &steps);
    for s in 1..steps.len() {
        let error =
            testing::tangent_error_3(&*law, &steps[s].0, &steps[s].1, &params, &trace.history[s - 1], 1e-6);
        assert!(error < 1e-5, "step {s}: {error:e}");
    }
    for k in 0..params.len() {
        let h = step(params[k], 0.0).max(1e-7);
        let error = column_error(&*law, &params, &steps, k, &[0.0; 3], h);
        assert!(error < 1e-4, "parameter {k}: {error:e}");
    }
}
