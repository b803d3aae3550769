//! Tangents and energies of every bulk and interface decorator, around both forms of the base law.
// Steps, their traces and their predecessors go by one index.
#![allow(clippy::needless_range_loop)]

use crate::battery;

use battery::*;
use constitutive::{
    Context, Jet, PointLaw, history_tangent_9, tangent_by_jets_3, tangent_by_jets_9, testing,
};
use model::{Bulk, Site};
use std::sync::Arc;

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
            if let Some(error) = testing::analytic_tangent_error(&*law, ctx, f, &params, old, by_jets) {
                assert!(error < 1e-11, "{name}: analytic tangent: {error:e}");
                let mut analytic = vec![f64::NAN; old.len()];
                law.analytic_tangent(ctx, f, &params, old, &mut analytic);
                for (a, b) in analytic.iter().zip(&trace.history[s]) {
                    assert!(
                        (a - b).abs() <= 1e-13 * (1.0 + b.abs()),
                        "{name}: history with the analytic tangent {a} {b}"
                    );
                }
            }
            let error = testing::objectivity_error(&*law, ctx, f, &q, &params, old);
            assert!(error < 1e-10, "{name}: frame indifference: {error:e}");
        }
    }
}

/// Jets along the gradient: the new history and its derivative.
fn history_by_jets(
    law: &dyn PointLaw<9>,
    ctx: &Context,
    f: &[f64; 9],
    params: &[f64],
    old: &[f64],
) -> Vec<Jet<9>> {
    let lift = |v: &[f64]| v.iter().map(|&x| Jet::constant(x)).collect::<Vec<Jet<9>>>();
    let along: [Jet<9>; 9] = std::array::from_fn(|i| Jet::variable(f[i], i));
    let mut new = lift(old);
    law.respond(ctx, &along, &lift(params), &lift(old), &mut new);
    new
}

/// Every bulk effect around every other.
fn bulk_pairs() -> Vec<(String, Bulk, Vec<f64>)> {
    let mut pairs = Vec::new();
    for inner in all(Site::Bulk) {
        let law = wrap_bulk(&*inner, base_bulk()).unwrap();
        let params = joined(&TISSUE, &active(&*inner));
        for outer in all(Site::Bulk).iter().filter(|o| o.card().name != inner.card().name) {
            let name = format!("{} around {}", outer.card().name, inner.card().name);
            let both = wrap_bulk(&**outer, law.clone()).unwrap();
            pairs.push((name, both, joined(&params, &active(&**outer))));
        }
    }
    pairs
}

#[test]
fn histories_follow_the_gradient_as_jets_say() {
    let mut analytic = Vec::new();
    for (name, law, params) in bulk_forms().into_iter().chain(bulk_pairs()) {
        let steps = off_switches(stretching(2));
        let trace = drive(&*law, &params, &steps);
        for s in 1..steps.len() {
            let (ctx, f) = &steps[s];
            let old = &trace.history[s - 1];
            let (mut new, mut rows) = (vec![f64::NAN; old.len()], vec![[f64::NAN; 9]; old.len()]);
            if law.history_tangent(ctx, f, &params, old, &mut new, &mut rows) {
                analytic.push(name.clone());
            }
            history_tangent_9(&*law, ctx, f, &params, old, &mut new, &mut rows);
            let jets = history_by_jets(&*law, ctx, f, &params, old);
            let scale = jets.iter().flat_map(|j| j.eps).fold(1e-12f64, |m, x| m.max(x.abs()));
            for ((new, plain), j) in new.iter().zip(&trace.history[s]).zip(&jets) {
                // Over jets a law may leave what only the ledger asks for.
                let left = name.contains(" around ") && *new == j.re;
                assert!(left || (new - plain).abs() <= 1e-13 * (1.0 + plain.abs()), "{name}: {new} {plain}");
            }
            for (row, j) in rows.iter().zip(&jets) {
                for (a, b) in row.iter().zip(&j.eps) {
                    assert!((a - b).abs() <= 1e-11 * scale, "{name}, step {s}: {a} {b}");
                }
            }
        }
    }
    let cheap = ["viscoelastic", "mullins", "fiber_damage"];
    let forms = bulk_forms().into_iter().filter(|f| cheap.iter().any(|c| f.0.starts_with(c)));
    for (name, ..) in forms {
        assert!(analytic.contains(&name), "{name} differentiates by jets");
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
            if let Some(error) = testing::analytic_tangent_error(&*law, ctx, d, &params, old, by_jets) {
                assert!(error < 1e-11, "{name}: analytic tangent: {error:e}");
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
