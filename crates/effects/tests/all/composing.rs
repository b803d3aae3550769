//! Several effects at once: order, names, histories, and the whole stack at work.
// Steps, their traces and their predecessors go by one index.
#![allow(clippy::needless_range_loop)]

use crate::battery;

use battery::*;
use constitutive::testing;
use model::{Bulk, Site};

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
