//! Fits on the search's mesh.

use super::pace::Pace;
use super::{FeLadder, Fitted};
use crate::correction::Correction;
use crate::cost::Phase;
use crate::identify::{AnalysisError, FAR, free_parameters};
use crate::journal::{Asked, remembered};
use crate::priors::{self, Belief};
use crate::problem::{FeProblem, Patience};
use crate::start;
use input::Case;
use inverse::{FitOptions, Iterate, Objective, Poll, quality};
use model::Model;
use std::ops::{ControlFlow, Range};
use std::sync::Arc;
use std::sync::atomic::Ordering;

/// Relative fall of χ² that is worth another step of the search. Steps are as long as they are safe: a little fall
/// is a short step more often than the end.
pub(super) const TOLERANCE: f64 = 3e-3;

/// A fit that comes to about the base's χ², no better than this share of it, and gains next to nothing of what is beyond the noise
/// in a step, is left: what it has not gained by then it will not. One that is clearly worse is on its way: at its neutral value an effect is as good
/// as the base.
pub(super) const LITTLE: f64 = 0.9;
const COARSE_TOLERANCE: f64 = 2e-2;

/// Steps of a fit at most.
pub(super) const STEPS: usize = 24;

/// Three steps in a row that lower χ² by less than this end the fit of what is weighed.
pub(super) const INSIGNIFICANT: f64 = 0.25;

/// Trials of one step before the search is content. From the sixth on they must promise what is worth another step:
/// the fits of a search begin where one trial in two is the bent one, so fewer hardly damp them.
const TRIALS: usize = 10;

impl FeLadder<'_> {
    /// Values that a search from the record alone would begin with: no fit has bent them.
    pub(super) fn unbent(&self) -> Result<Vec<f64>, AnalysisError> {
        let model = Model::new(self.case.clone(), self.catalogue, self.how)?;
        self.start_by_record(&self.case, &model)
    }

    /// Values of a model that a search from the record alone would begin with, by a case of the same laws.
    pub(super) fn start_by_record(&self, case: &Arc<Case>, model: &Model) -> Result<Vec<f64>, AnalysisError> {
        let mut theta = model.theta();
        if let Some(start) = self.known_starts(case).first() {
            start::spread(model, start, &mut theta);
            return Ok(theta);
        }
        let say = self.progress;
        let shown = |p: &crate::Progress| {
            let objective = p.iterate.f.map_or("no answer".into(), |f| format!("objective {f:.4e}"));
            say(&format!("start, {}: iteration {}, {objective}", p.stage.word(), p.iterate.iteration));
        };
        let quiet = crate::Control { progress: &shown, cancelled: self.cancelled, journal: self.journal };
        self.cancelled.phase(Phase::Start);
        if let Some(start) = start::for_case(case, self.catalogue, self.options, &quiet)? {
            start::spread(model, &start, &mut theta);
        }
        Ok(theta)
    }

    /// What the record of a tear told of bulk and path is the base's start, whatever else a model of the same laws has.
    pub(super) fn known_starts(&self, case: &Case) -> &[Arc<start::Start>] {
        let laws = |c: &Case| (c.bulk.law.clone(), c.interface.law.clone());
        if laws(case) == laws(&self.case) { &self.torn } else { &[] }
    }

    /// The states of a fitted rung as first guesses for another model of the same tests.
    pub(super) fn guesses(&self, of: &Fitted, model: &Model) -> Vec<Option<fem::Warm>> {
        let one = |(t, w): (usize, &Option<fem::Warm>)| {
            let (from, to) = (of.model.plan(t, &self.options), model.plan(t, &self.options));
            w.as_ref().map(|w| to.guesses(&from, w))
        };
        of.warm.iter().enumerate().map(one).collect()
    }

    /// Free parameters as a fit sees them.
    pub(super) fn free_parameters(&self, model: &Model, theta: &[f64], free: &[usize]) -> Vec<inverse::Free> {
        let mut list = free_parameters(model, theta, free);
        priors::add(&mut list, &model.case, Belief::of(&self.case, Belief::Bounds));
        list
    }

    /// Fits a model from θ on all data; one that is of use below an objective, only as long as it may come there.
    pub(super) fn fit_model(
        &self,
        model: Model,
        theta: Vec<f64>,
        correction: Correction,
        states: Vec<Option<fem::Warm>>,
        below: f64,
    ) -> Result<Fitted, AnalysisError> {
        let free = model.free();
        let list = self.free_parameters(&model, &theta, &free);
        let (fit, warm) = {
            let mut problem = FeProblem::new(
                &model,
                theta.clone(),
                free.clone(),
                &self.measured.slots,
                self.options,
                self.cancelled,
            );
            problem.options.stepping.budget = crate::identify::TRIAL_BUDGET;
            problem.patience = Some(Patience::FIT);
            problem.correction = correction.clone();
            problem.start_from(states);
            let beside = self.part_that_misses(&model);
            let little = self.little(beside);
            let known = beside.map_or(0.0..0.0, |_| little.clone());
            let options = search_options(&list, below, known);
            let mut watch = self.watch(&model, little.clone(), Pace::below(below));
            let asked = Asked {
                problem: &problem,
                beside: None,
                data: &self.measured.data,
                free: &list,
                options: &options,
                how: &format!("little {little:?}, leader {:?}, below {below}", self.leader),
                cancelled: self.cancelled,
            };
            let done = remembered(self.journal, &asked, &mut watch, &mut |observer| {
                Ok((inverse::fit(&problem, &self.measured.data, &list, &options, observer)?, None))
            })?;
            self.runs.fetch_add(done.runs, Ordering::Relaxed);
            (done.fit, done.warm)
        };
        let mut all = theta;
        for (&i, &v) in free.iter().zip(&fit.theta) {
            all[i] = v;
        }
        let quality = quality(&self.measured.data, &list, &fit);
        Ok(Fitted {
            model,
            theta: all,
            free,
            free_parameters: list,
            fit,
            quality,
            correction,
            settled: false,
            mode: None,
            warm,
        })
    }

    /// The fit of the most of a model's effects, if not of all or none, where it misses the records by far.
    fn part_that_misses(&self, model: &Model) -> Option<&Fitted> {
        let key = Self::key(&self.parts_of(model));
        let part = self.nearest_where(&key, |k| k.len() < key.len()).filter(|(k, _)| !k.is_empty());
        part.map(|(_, f)| f).filter(|f| f.quality.reduced_chi2_total > FAR)
    }

    /// The values of χ² that are about those of such a part, else of the base.
    fn little(&self, part: Option<&Fitted>) -> Range<f64> {
        let base = part.or_else(|| self.fitted_models.get(&Vec::new())).map_or(f64::INFINITY, |f| f.fit.f);
        LITTLE * base..base / LITTLE
    }

    /// Tells the steps of a model's fit, and ends one that gains little, that stays behind the leader or is too slow.
    fn watch(
        &self,
        model: &Model,
        little: Range<f64>,
        mut pace: Pace,
    ) -> impl FnMut(&Iterate) -> ControlFlow<()> {
        let names = super::named(&self.parts_of(model));
        let (progress, leader) = (self.progress, self.leader);
        let points = self.measured.data.points() as f64;
        let mut last = f64::INFINITY;
        move |i: &Iterate| {
            progress(&format!("{names}: iteration {}, {}", i.iteration, came_to(i)));
            // A trial that was rejected says nothing about the fit.
            let taken = i.f.filter(|_| i.accepted);
            let idle = taken.is_some_and(|f| little.contains(&f) && last - f < worth(f, points));
            // Beside a model that leaves noise alone, and only there, half a difference of χ² is one of evidence. Twice
            // the fall of the last step is what a fit may hope for.
            let behind = taken
                .zip(leader)
                .is_some_and(|(f, leader)| evidence::hopeless(-0.5 * f, last - f, -0.5 * leader));
            last = taken.unwrap_or(last);
            let too_slow = taken.is_some_and(|f| pace.too_slow(i.iteration, f));
            if idle || behind || too_slow { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        }
    }
}

/// Fall of χ² that is worth another step to a fit that gains little, on so many points: a share of what is beyond the noise. At
/// the noise a difference of χ² is one of evidence, however small a share of the whole.
fn worth(f: f64, points: f64) -> f64 {
    (COARSE_TOLERANCE * (f - points)).max(INSIGNIFICANT)
}

/// What a run of a fit came to. One without an answer may have taken longest.
fn came_to(i: &Iterate) -> String {
    match i.f {
        Some(f) if i.accepted => format!("χ² {f:.1}"),
        Some(f) => format!("χ² {f:.1} (rejected)"),
        None => "no answer".into(),
    }
}

/// Above what another start came to, or where a part of the model looked around, a fit that is stuck does not do so.
fn search_options(list: &[inverse::Free], below: f64, known: Range<f64>) -> FitOptions {
    FitOptions {
        objective: Objective::Record,
        tolerance: TOLERANCE,
        max_iterations: STEPS,
        insignificant: INSIGNIFICANT,
        max_trials: TRIALS,
        initial_damping: 1e-2,
        // A rejected trial needs none, and derivatives cost as much as a run.
        jacobian_with_trial: false,
        max_step: 0.7,
        poll: Some(Poll { below, known, ..crate::identify::poll(list) }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ladder::tests::unexplained;
    use inverse::{PredictError, Problem as _};

    /// A run that takes far longer than the one before it gives no answer; the first of a fit has all the time, and so has every run
    /// where nobody is in a hurry.
    #[test]
    fn a_run_that_takes_far_longer_than_the_last_is_given_up() {
        let catalogue = effects::catalogue();
        let ladder = unexplained(&catalogue);
        let base = &ladder.fitted_models[&Vec::new()];
        let (slots, options, free) = (&ladder.measured.slots, ladder.options, base.free.clone());
        let second = |patience: Option<Patience>| {
            let theta = base.theta.clone();
            let mut p = FeProblem::new(&base.model, theta, free.clone(), slots, options, &|| false);
            p.patience = patience;
            p.predict(&base.fit.theta, true).expect("the first run's answer");
            let elsewhere: Vec<f64> = base.fit.theta.iter().map(|v| 1.3 * v).collect();
            p.predict(&elsewhere, false)
        };
        let answer = second(None).expect("an answer");
        let waited = second(Some(Patience::FIT)).expect("an answer in time");
        assert_eq!(answer.values, waited.values);
        let hasty = second(Some(Patience { times: 1, jump: 0 }));
        assert!(matches!(&hasty, Err(PredictError::NotComputable(why)) if why.contains("Newton iterations")));
        assert_eq!(Patience::FIT.limit(50), 750);
        // A jump, of some hundred iterations, is no reason.
        assert!(second(Some(Patience { times: 1, ..Patience::FIT })).is_ok());
    }

    /// What will not come to what another start came to is left, and does not look around above that.
    #[test]
    fn a_fit_beside_a_better_start_is_left() {
        let catalogue = effects::catalogue();
        let ladder = unexplained(&catalogue);
        let model = &ladder.fitted_models[&Vec::new()].model;
        let left_at = |below: f64| {
            let mut watch = ladder.watch(model, 0.0..0.0, Pace::below(below));
            [900.0, 899.0, 898.0, 897.0].into_iter().enumerate().position(|(iteration, f)| {
                let taken =
                    Iterate { iteration, f: Some(f), theta: Vec::new(), accepted: true, damping: 0.0 };
                watch(&taken).is_break()
            })
        };
        assert_eq!((left_at(10.0), left_at(f64::INFINITY)), (Some(2), None));
        let poll = search_options(&[], 10.0, 3.0..4.0).poll.expect("a look around");
        assert_eq!((poll.below, poll.above, poll.known), (10.0, FAR, 3.0..4.0));
    }

    /// A set is held against the part of it that was fitted, where that misses the records by far; else against the base.
    #[test]
    fn a_set_is_held_against_a_part_that_misses() {
        let catalogue = effects::catalogue();
        let mut ladder = unexplained(&catalogue);
        let sets = [vec!["mullins".to_owned()], vec!["mullins".to_owned(), "drift".to_owned()]];
        ladder.columns_at(&[]).expect("columns");
        ladder.fit_sets(&sets[..1]).expect("a fit");
        ladder.fit_sets(&sets[1..]).expect("a fit");
        let held_against = |ladder: &FeLadder, set: &Vec<String>| {
            let part = ladder.part_that_misses(&ladder.fitted_models[set].model);
            (part.map(|f| f.fit.f), ladder.little(part))
        };
        let [base, one] = [&Vec::new(), &sets[0]].map(|s| ladder.fitted_models[s].fit.f);
        assert!(ladder.fitted_models[&sets[0]].quality.reduced_chi2_total > FAR && one < base);
        let about = |f: f64| LITTLE * f..f / LITTLE;
        assert_eq!(held_against(&ladder, &sets[0]), (None, about(base)));
        assert_eq!(held_against(&ladder, &sets[1]), (Some(one), about(one)));
        ladder.fitted_models.get_mut(&sets[0]).expect("a fit").quality.reduced_chi2_total = FAR;
        assert_eq!(held_against(&ladder, &sets[1]), (None, about(base)));
    }

    /// Where the base's search began, an effect's second fit begins; a model of another law asks the record itself.
    #[test]
    fn what_the_record_told_of_bulk_and_path_is_the_start_of_every_effect() {
        let catalogue = effects::catalogue();
        let ladder = unexplained(&catalogue);
        let with = |law: Option<&str>| {
            let effect = crate::columns::config_of(catalogue.get("mullins").expect("an effect"), &[1.5, 0.5]);
            let mut case = crate::columns::case_with(&ladder.case, &[effect]);
            if let Some(law) = law {
                case = crate::ladder::laws::with_law(&case, &catalogue, input::LawSite::Interface, law);
            }
            let model = Model::new(Arc::new(case.clone()), &catalogue, ladder.how).expect("a model");
            let begun = ladder.start_by_record(&Arc::new(case), &model).expect("a start");
            let mut base = model.theta();
            start::spread(&model, &ladder.torn[0], &mut base);
            (begun, base)
        };
        let (begun, base) = with(None);
        assert_eq!(begun, base);
        let (begun, base) = with(Some("bilinear"));
        assert_ne!(begun, base);
        let other =
            crate::ladder::laws::with_law(&ladder.case, &catalogue, input::LawSite::Bulk, "neo_hooke");
        assert!(ladder.known_starts(&other).is_empty() && !ladder.known_starts(&ladder.case).is_empty());
    }

    /// At the noise a step is worth what evidence is; far above it, a share of what is left.
    #[test]
    fn a_step_is_worth_a_share_of_what_is_beyond_the_noise() {
        assert_eq!([700.0, 690.0, 712.5].map(|f| worth(f, 700.0)), [INSIGNIFICANT; 3]);
        assert!((worth(10_700.0, 700.0) - 200.0).abs() < 1e-9);
        let catalogue = effects::catalogue();
        let ladder = unexplained(&catalogue);
        let model = &ladder.fitted_models[&Vec::new()].model;
        let points = ladder.measured.data.points() as f64;
        let left_at = |above: f64, fall: f64| {
            let mut watch = ladder.watch(model, 0.0..f64::INFINITY, Pace::below(f64::INFINITY));
            (0..3_u32).position(|k| {
                let f = Some(points + above - f64::from(k) * fall);
                let (theta, iteration) = (Vec::new(), k as usize);
                watch(&Iterate { iteration, f, theta, accepted: true, damping: 0.0 }).is_break()
            })
        };
        assert_eq!((left_at(10.0, 1.0), left_at(10.0, 0.2), left_at(1000.0, 1.0)), (None, Some(1), Some(1)));
    }

    #[test]
    fn every_run_of_a_fit_is_told() {
        let run = |f, accepted| Iterate { iteration: 1, f, theta: Vec::new(), accepted, damping: 0.0 };
        let told =
            [(Some(12.34), true), (Some(12.34), false), (None, false)].map(|(f, a)| came_to(&run(f, a)));
        assert_eq!(told, ["χ² 12.3", "χ² 12.3 (rejected)", "no answer"]);
    }
}
