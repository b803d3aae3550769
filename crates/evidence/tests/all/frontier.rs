//! What must still be fitted, and the few sizes of the rest on which models are compared before.

use crate::toys::*;

use evidence::{Belief, Evidence, Kernel, RestPrior};
use inverse::{NoiseModel, Random};
use nalgebra::{DMatrix, DVector};

/// Where all models leave as much as a cause outside the catalogue does, the few sizes give a column that is nothing to it about
/// what the integral gives.
#[test]
fn a_few_sizes_follow_the_integral_where_much_is_left() {
    let n = 120;
    let (rest, prior) = (RestPrior::default(), evidence::SetPrior::of_catalogue(2));
    let points = evidence::Points { s: line(n), gap: vec![1; n], sd: 1.0, ar1: 0.0, leg: Vec::new() };
    let mut random = Random::new(14);
    let mut off = [0.0f64; 2];
    for _ in 0..10 {
        let size = evidence::RestSize { tau: 0.08, ..evidence::RestSize::NONE };
        let drawn = DVector::from_vec(evidence::Process::new(&points, size).draw(&mut random).0);
        let r = drawn * PEAK + random.normals(n) * 0.01;
        let record = record(&data(&r, NoiseModel::white(0.01)), PEAK);
        let both = |kinds: &[usize], parameters| {
            let model = linear(r.clone(), kinds, parameters, PEAK);
            let quick = Evidence::quick(&record, &model, (&rest, &prior), Kernel::Plain).expect("evidence");
            let e = Evidence::of(&record, &model, &rest, Kernel::Plain).expect("evidence");
            let [own, other] = [e.ln_z + (1.0 - prior.beyond).ln(), e.ln_z_else + prior.unlike().ln()];
            [quick, evidence::special::ln_sum_exp([own, other])]
        };
        let (without, with) = (both(&[0, 1], base()), both(&[0, 1, 3], with_effect()));
        let [quick, full] = [0, 1].map(|k| with[k] - without[k]);
        off = [off[0].min(quick - full), off[1].max(quick - full)];
    }
    // A third of what hangs on it (`HOPELESS`); by sizes up to one scale it is more than that off.
    assert!(off[0] > -4.0 && off[1] < 4.0, "{off:?}");
}

/// A superset judged from its parent's columns is what the same model gives when asked directly; shapes share their prior.
#[test]
fn supersets_are_judged_from_columns() {
    let n = 80;
    let r = column(3, n, 0.15) + misfit(n, 0.03, 3);
    let record = record(&data(&r, NoiseModel::white(0.03)), PEAK);
    let (rest, prior) = (RestPrior::default(), evidence::SetPrior::of_catalogue(2));
    let parent = linear(r.clone(), &[0, 1], base(), PEAK);
    let shape = |kind: usize| {
        let p = parameter("effects.bump.size", Belief::above(0.0, 0.1), true);
        (vec![p], DMatrix::from_columns(&[column(kind, n, PEAK)]))
    };
    let names = ["bump".to_owned()];
    let posterior = |shapes: Vec<_>| {
        let extension = evidence::Extension { effects: names.to_vec(), shapes };
        let asked = evidence::extend(&record, &parent, &extension, (&rest, &prior), Kernel::Plain);
        let e = Evidence::of(&record, &parent, &rest, Kernel::Plain).expect("evidence");
        let models =
            [evidence::Judged::new(&[], &e, &rest, 1.0, &prior), asked.expect("evidence").expect("a shape")];
        assert_eq!(evidence::to_fit(&evidence::Posterior::of(&models, &prior), &models), [names.to_vec()]);
        evidence::Posterior::of(&models, &prior)
    };
    let one = posterior(vec![shape(3)]);
    let direct = linear(r.clone(), &[0, 1, 3], with_effect(), PEAK);
    let direct = Evidence::of(&record, &direct, &rest, Kernel::Plain).expect("evidence");
    let e = Evidence::of(&record, &parent, &rest, Kernel::Plain).expect("evidence");
    let want = evidence::Posterior::of(
        &[
            evidence::Judged::new(&[], &e, &rest, 1.0, &prior),
            evidence::Judged::new(&names, &direct, &rest, 1.0, &prior),
        ],
        &prior,
    );
    assert!((one.effects["bump"] - want.effects["bump"]).abs() < 1e-12);
    // Three further shapes that do not help leave a quarter of the odds.
    let four = posterior(vec![shape(3), shape(5), shape(6), shape(7)]);
    let odds = |p: f64| p / (1.0 - p);
    let ratio = odds(four.effects["bump"]) / odds(one.effects["bump"]);
    assert!((ratio - 0.25).abs() < 0.05, "{ratio}");
    // An extension without shapes says nothing.
    let empty = evidence::Extension { effects: names.to_vec(), shapes: Vec::new() };
    let nothing = evidence::extend(&record, &parent, &empty, (&rest, &prior), Kernel::Plain);
    assert!(nothing.expect("no fault").is_none());
}
