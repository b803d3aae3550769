//! Laws of a tear by the roles that a fit gave them.

use super::*;
use crate::ladder::tests::unloaded;
use input::Case;
use inverse::Prior;
use model::Discretisation;

use std::sync::Arc;

/// The strip of the ladder's tests with bridging, and so many areas.
fn bridged(areas: usize) -> Model {
    let catalogue = effects::catalogue();
    let effect = crate::columns::config_of(catalogue.get("bridging").expect("an effect"), &[0.02, 2.0]);
    let mut case: Case = crate::columns::case_with(&unloaded(&catalogue), &[effect]);
    case.interface.areas = areas;
    Model::new(Arc::new(case), &catalogue, Discretisation::default()).expect("a model")
}

const OF_LAWS: [&str; 4] = [
    "interface.area[1].gc",
    "interface.area[1].sigma_c",
    "effects.bridging.sigma_b",
    "effects.bridging.delta_b",
];

/// A model at these values of its two laws, named anew; `None` where they stay. `change`: what is said of the free parameters.
fn named(model: &Model, values: [f64; 4], change: impl Fn(&mut Vec<Free>)) -> Option<[f64; 4]> {
    let places = OF_LAWS.map(|path| model.find(path).expect("a parameter"));
    let mut theta = model.theta();
    places.iter().zip(values).for_each(|(&i, v)| theta[i] = v);
    let before = theta.clone();
    let mut free = crate::identify::free_parameters(model, &theta, &model.free());
    change(&mut free);
    let any = as_the_cards_say(model, &effects::catalogue(), &free, &mut theta);
    assert_eq!(any, theta != before);
    let others = (0..theta.len()).filter(|i| !places.contains(i));
    assert!(others.clone().all(|i| theta[i] == before[i]));
    any.then(|| places.map(|i| theta[i]))
}

#[test]
fn the_law_of_the_longer_opening_is_called_bridging() {
    let model = bridged(1);
    let e = std::f64::consts::E;
    let swapped = [e * 0.1 * 2.0, 0.1, 0.8, 0.2];
    let as_is = |_: &mut Vec<Free>| ();
    let found = named(&model, swapped, as_is).expect("roles exchanged");
    for (found, right) in found.iter().zip([e * 0.8 * 0.2, 0.8, 0.1, 2.0]) {
        assert!((found / right - 1.0).abs() < 1e-12, "{found} {right}");
    }
    assert_eq!(named(&model, found, as_is), None);
    // What is believed of the one does not hold of the other; what is held stays.
    let at = |free: &[Free], path: &str| free.iter().position(|f| f.path == path).expect("free");
    for path in OF_LAWS {
        let believed = |free: &mut Vec<Free>| {
            let k = at(free, path);
            free[k].prior = Some(Prior { mean: 0.0, sd: 1.0 });
        };
        assert_eq!(named(&model, swapped, believed), None, "{path}");
        let held = |free: &mut Vec<Free>| {
            let k = at(free, path);
            free.remove(k);
        };
        assert_eq!(named(&model, swapped, held), None, "{path}");
    }
    // A toughness beyond its bounds.
    let far = [e * 0.1 * 900.0, 0.1, 90.0, 800.0];
    assert_eq!(named(&model, far, as_is), None);
    assert_eq!(named(&bridged(2), swapped, as_is), None);
}

/// A search gives the laws their names before its last stage; one that is to stay where it is leaves them.
#[test]
fn a_search_begins_with_laws_named_by_their_cards() {
    let catalogue = effects::catalogue();
    let effect = crate::columns::config_of(catalogue.get("bridging").expect("an effect"), &[0.8, 0.02]);
    let mut case: Case = crate::columns::case_with(&unloaded(&catalogue), &[effect]);
    (case.interface.gc[0].value, case.interface.sigma_c[0].value) = (Some(0.25), Some(0.1));
    case.interface.areas = 1;
    case.identify.coarse_first = false;
    let control = crate::Control { progress: &|_| (), cancelled: &|| false, journal: &crate::NoJournal };
    for (iterations, named) in [(1, true), (0, false)] {
        case.identify.max_iterations = iterations;
        let found = crate::identify(Arc::new(case.clone()), &catalogue, &control).expect("an answer");
        let [gc, sigma_c, _, delta_b] =
            OF_LAWS.map(|path| found.theta[found.model.find(path).expect("a parameter")]);
        assert_eq!(delta_b > gc / (std::f64::consts::E * sigma_c), named, "{delta_b} {gc} {sigma_c}");
    }
}
