use super::*;
use crate::ladder::tests::unexplained;
use evidence::{Judged, SetPrior};

/// Probabilities of sets by their ln Z alone; sets that nothing is known of have none.
fn posterior(of: &[(&[&str], f64)]) -> Posterior {
    let set = |names: &[&str]| names.iter().map(ToString::to_string).collect::<Vec<String>>();
    let models: Vec<Judged> =
        of.iter().map(|(names, ln_z)| Judged::from_numbers(&set(names), *ln_z, -999.0)).collect();
    Posterior::of(&models, &SetPrior::of_catalogue(20))
}

/// A search whose fitted models have met every point, as if noise were all that is left.
fn explained(catalogue: &model::Catalogue) -> FeLadder<'_> {
    let mut ladder = unexplained(catalogue);
    ladder.columns_at(&[]).expect("columns");
    meet(&mut ladder, &Vec::new());
    ladder
}

fn meet(ladder: &mut FeLadder, set: &Vec<String>) -> usize {
    let measured = ladder.measured.data.measured();
    let fitted = ladder.fitted_models.get_mut(set).expect("a fit");
    fitted.fit.prediction.values = measured;
    fitted.free_parameters.iter().position(|f| f.path == "interface.area[1].sigma_c").expect("a strength")
}

/// ln Z at which an effect is as probable as none: each has 0.7 / 20 of the prior.
fn even() -> f64 {
    (20.0f64 / 0.7 - 1.0).ln()
}

fn strength(ladder: &FeLadder, of: &[(&[&str], f64)]) -> (f64, [f64; 2]) {
    let a = averaged(ladder, &posterior(of)).expect("an average");
    assert!(a.share > 0.999 && a.parameters.contains_key("bulk.mu"), "{a:?}");
    assert!(a.parameters.keys().all(|path| !path.starts_with("effects.")));
    let mean = &a.path_means["sigma_c"];
    // Of one area the mean is its value.
    let own = &a.parameters["interface.area[1].sigma_c"];
    assert!((mean.value / own.value - 1.0).abs() < 1e-6 && mean.unit == "MPa");
    (mean.value, mean.interval_95)
}

#[test]
fn sets_say_the_tissues_values_with_their_shares() {
    let catalogue = effects::catalogue();
    let mut ladder = explained(&catalogue);
    let set = vec!["compliance".to_owned()];
    ladder.fit_sets(std::slice::from_ref(&set)).expect("a fit");
    let at = meet(&mut ladder, &Vec::new());
    let base = ladder.fitted_models[&Vec::new()].fit.theta[at];
    let at = meet(&mut ladder, &set);
    // As if the tear were twice as strong where the rig gives way.
    ladder.fitted_models.get_mut(&set).expect("a fit").fit.theta[at] = 2.0 * base;
    let (alone, [low, high]) = strength(&ladder, &[(&[], 0.0), (&["compliance"], -40.0)]);
    assert!(
        (alone / base).ln().abs() < 0.1 && low < base && base < high && high < 1.5 * base,
        "{low} {high}"
    );
    let (other, [other_low, other_high]) = strength(&ladder, &[(&[], -40.0), (&["compliance"], 0.0)]);
    assert!((other / (2.0 * base)).ln().abs() < 0.1 && other_low > 1.5 * base, "{other} {base}");
    let (_, both) = strength(&ladder, &[(&[], 0.0), (&["compliance"], even())]);
    assert!(both[0] < alone && both[1] > other && both[0] > low && both[1] < other_high, "{both:?}");
    // One in a hundred is no part of 95 %.
    let (_, rare) = strength(&ladder, &[(&[], 0.0), (&["compliance"], even() - 99f64.ln())]);
    assert!(rare[1] < 1.1 * high && rare[1] > high, "{rare:?} {high}");
}

/// What was not fitted counts by its columns; what has neither is said to be missing.
#[test]
fn sets_that_were_not_fitted_count_by_their_columns() {
    let catalogue = effects::catalogue();
    let mut ladder = explained(&catalogue);
    let of: [(&[&str], f64); 2] = [(&[], 0.0), (&["cut_length"], even())];
    let width = |[low, high]: [f64; 2]| (high / low).ln();
    let (_, alone) = strength(&ladder, &of[..1]);
    let (_, with) = strength(&ladder, &of);
    assert!(width(with) > 1.02 * width(alone), "{with:?} {alone:?}");
    ladder.screened.clear();
    let without = averaged(&ladder, &posterior(&of)).expect("an average");
    assert!((without.share - 0.5).abs() < 1e-6, "{}", without.share);
    assert!((width(without.path_means["sigma_c"].interval_95) / width(alone) - 1.0).abs() < 0.05);
}

/// A mean along the path is told where the records fix it, of areas that stand at no bound; a parameter is told as it is.
#[test]
fn what_is_not_fixed_has_no_mean() {
    let catalogue = effects::catalogue();
    let alone = posterior(&[(&[], 0.0)]);
    let told = |ladder: &FeLadder| averaged(ladder, &alone).expect("an average");
    // What this tear leaves is no noise, and its toughness may be anything.
    let open = told(&unexplained(&catalogue));
    assert!(!open.path_means.contains_key("gc") && open.parameters.contains_key("interface.area[1].gc"));
    let mut ladder = explained(&catalogue);
    let at = meet(&mut ladder, &Vec::new());
    assert!(told(&ladder).path_means.contains_key("sigma_c"));
    ladder.fitted_models.get_mut(&Vec::new()).expect("a fit").fit.at_bound[at] = true;
    let bound = told(&ladder);
    assert!(!bound.path_means.contains_key("sigma_c"));
    assert!(bound.parameters.contains_key("interface.area[1].sigma_c"));
}

/// Shapes of one effect share its probability; the parameters of effects are no values of the tissue.
#[test]
fn a_set_says_each_value_once() {
    let catalogue = effects::catalogue();
    let mut ladder = explained(&catalogue);
    let posterior = posterior(&[(&[], 0.0), (&["mullins"], even())]);
    let beliefs = Beliefs::of(ladder.case(), ladder.catalogue());
    let set = vec!["mullins".to_owned()];
    let weight = |ladder: &FeLadder| {
        let measured = measured(ladder).expect("records");
        let all = ladder.fitted_models.values().map(AtFit::from);
        let scale = Scale::new(&measured, all, ladder.catalogue(), &beliefs).expect("a scale");
        let asked = asked_of(&ladder.fitted_models[&Vec::new()]);
        let said = said_by(ladder, &scale, &posterior, (&set, 0.5), &asked).expect("numbers").expect("a set");
        assert_eq!(said.len(), asked.len());
        said.iter().map(|parts| parts.iter().map(|n| n.weight).sum()).collect::<Vec<f64>>()
    };
    let shapes = |c: &&Candidate| c.effect == "mullins" && c.shapes.len() > 1;
    assert!(ladder.screened[&Vec::new()].iter().any(|c| shapes(&c)));
    assert!(weight(&ladder).iter().all(|w| (w - 1.0).abs() < 1e-9));
    ladder.fit_sets(std::slice::from_ref(&set)).expect("a fit");
    assert!(weight(&ladder).iter().all(|w| (w - 1.0).abs() < 1e-9));
    let with = &ladder.fitted_models[&set];
    assert!(with.free_parameters.iter().any(|f| f.path.starts_with("effects.")));
    assert!(asked_of(with).iter().all(|a| !a.name.starts_with("effects.")));
}

#[test]
fn a_mean_along_the_path_is_asked_in_its_logarithm() {
    let free: Vec<Free> = [1.0, 3.0, 0.5]
        .iter()
        .enumerate()
        .map(|(k, v)| Free::new(format!("p{k}"), (1e-3, 1e3), params::Transform::Log, *v))
        .collect();
    let z = DVector::from_iterator(3, free.iter().map(|f| f.forward(f.start)));
    let (value, gradient) = logarithm_of_mean(&free, &[0, 1], &z);
    assert!((value - 2.0f64.ln()).abs() < 1e-12);
    let h = 1e-6;
    for k in 0..3 {
        let mut moved = z.clone();
        moved[k] += h;
        let slope = (logarithm_of_mean(&free, &[0, 1], &moved).0 - value) / h;
        assert!((slope - gradient[k]).abs() < 1e-5, "{k}: {slope} {}", gradient[k]);
    }
}

#[test]
fn the_spread_of_two_parts_counts_how_far_they_are_apart() {
    let part = |weight, mean| Normal { weight, mean, sd: 0.3 };
    assert!((spread(&[part(2.0, 0.0), part(2.0, 0.8)]) - 0.5).abs() < 1e-12);
    assert!((spread(&[part(0.2, 1.0)]) - 0.3).abs() < 1e-9);
}
