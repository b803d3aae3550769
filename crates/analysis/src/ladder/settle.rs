//! Fits on the file's mesh, their steps taken on the search's (`inverse::fit_mapped`).

use super::begin::with_effects_at;
use super::{FeLadder, Fitted, named};
use crate::columns::transfer;
use crate::correction::Correction;
use crate::identify::{AnalysisError, run_options, runs_as_long};
use crate::journal::{Asked, remembered};
use crate::problem::FeProblem;
use inverse::{Fit, FitOptions, Iterate, MappedOptions, Objective, PredictError, Problem as _, quality};
use model::{Discretisation, Model, RunOptions};
use rayon::prelude::*;
use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::Ordering;

/// Runs on the file's mesh that a fit may move by.
pub(super) const ROUNDS: usize = 5;
/// A predicted fall of χ² that is not worth a run on the file's mesh: as in `identify`.
const SETTLED: f64 = 0.25;

/// States on the file's mesh, with the model they are of.
pub(super) struct FineStates {
    model: Model,
    warm: Vec<Option<fem::Warm>>,
}

impl FineStates {
    /// As first guesses for another model of the same tests.
    pub(super) fn guesses(&self, of: &Model, options: &RunOptions) -> Vec<Option<fem::Warm>> {
        let one = |(t, w): (usize, &Option<fem::Warm>)| {
            let (from, to) = (self.model.plan(t, options), of.plan(t, options));
            w.as_ref().map(|w| to.guesses(&from, w))
        };
        self.warm.iter().enumerate().map(one).collect()
    }
}

/// Where a fit on the file's mesh begins, by the search's mesh.
pub(super) struct Begun {
    pub model: Model,
    pub theta: Vec<f64>,
    pub free: Vec<usize>,
    pub free_parameters: Vec<inverse::Free>,
    pub warm: Vec<Option<fem::Warm>>,
}

impl FeLadder<'_> {
    /// The start of a fit on the file's mesh at one of the search's.
    pub(super) fn begun_of(&self, f: &Fitted) -> Result<Begun, AnalysisError> {
        let start = |(free, &start): (&inverse::Free, &f64)| inverse::Free { start, ..free.clone() };
        Ok(Begun {
            model: Model::new(f.model.case.clone(), self.catalogue, self.how)?,
            theta: f.theta.clone(),
            free: f.free.clone(),
            free_parameters: f.free_parameters.iter().zip(&f.fit.theta).map(start).collect(),
            warm: f.warm.clone(),
        })
    }

    /// Fits sets on the file's mesh, side by side, in the form that their effects do best in. Where that mesh gives no answer a
    /// fit stays as it is; so does one that stands there already, in no better form.
    pub(super) fn settle_sets(&mut self, sets: &[Vec<String>]) -> Result<(), AnalysisError> {
        let this = &*self;
        let one = |set: &Vec<String>| match this.fitted_models.get(set) {
            Some(f) => {
                let better = this.best_form(f)?;
                if better.is_none() && f.settled {
                    return Ok(None);
                }
                let f = better.as_ref().unwrap_or(f);
                match this.settle(this.begun_of(f)?, this.fine_states.as_ref(), ROUNDS)? {
                    None => this.settle_as_identified(f),
                    settled => Ok(settled),
                }
            }
            None => Ok(None),
        };
        let done: Vec<Result<Option<(Fitted, FineStates)>, AnalysisError>> =
            sets.par_iter().map(one).collect();
        for (set, settled) in sets.iter().zip(done) {
            match (settled?, self.fitted_models.get_mut(set)) {
                (Some((f, _)), _) => {
                    (self.progress)(&format!("{}: on the file's mesh χ² {:.1}", named(set), f.fit.f));
                    self.fitted_models.insert(set.clone(), f);
                }
                (None, Some(f)) => f.settled = true,
                (None, None) => {}
            }
        }
        Ok(())
    }

    /// One step on the file's mesh of each of these sets, side by side. Where
    /// that mesh gives no answer a fit stays as it is.
    pub(super) fn settle_once(&mut self, sets: &[Vec<String>]) -> Result<(), AnalysisError> {
        let this = &*self;
        let one = |set: &Vec<String>| match this.fitted_models.get(set) {
            Some(f) => this.settle(this.begun_of(f)?, this.fine_states.as_ref(), 1),
            None => Ok(None),
        };
        let done: Vec<Result<Option<(Fitted, FineStates)>, AnalysisError>> =
            sets.par_iter().map(one).collect();
        for (set, moved) in sets.iter().zip(done) {
            if let Some((f, _)) = moved? {
                (self.progress)(&format!(
                    "{}: χ² {:.1} after a step on the file's mesh",
                    named(set),
                    f.fit.f
                ));
                self.fitted_models.insert(set.clone(), Fitted { settled: false, ..f });
            }
        }
        Ok(())
    }

    /// A fit that gives no answer on the file's mesh, taken to where `fct identify` of its model ends there. `None`: nowhere.
    pub(super) fn settle_as_identified(
        &self,
        f: &Fitted,
    ) -> Result<Option<(Fitted, FineStates)>, AnalysisError> {
        let found = with_effects_at(f);
        let mut case = (*self.fine_case).clone();
        (case.effects, case.bulk, case.interface) = (found.effects, found.bulk, found.interface);
        let case = Arc::new(case);
        let name = named(&self.parts_of(&f.model));
        let theta = match self.identify(&case, &name, f.fit.f) {
            Ok(found) => found.theta,
            Err(e) if self.cancelled.stops() => return Err(e),
            Err(_) => return Ok(None),
        };
        let model = Model::new(f.model.case.clone(), self.catalogue, self.how)?;
        let begun =
            self.begun_from(&Model::new(case, self.catalogue, Discretisation::default())?, model, &theta);
        self.settle(begun, None, ROUNDS)
    }

    /// A fit taken to the optimum on the file's mesh; `None` where that mesh gives no answer.
    pub(super) fn settle(
        &self,
        begun: Begun,
        states: Option<&FineStates>,
        rounds: usize,
    ) -> Result<Option<(Fitted, FineStates)>, AnalysisError> {
        let begun = self.with_laws_named(begun);
        let fine = self.on_file_mesh(&begun.model)?;
        let theta = transfer(&begun.model, &begun.theta, &fine);
        let slots = &self.measured.slots;
        let options = self.file_options();
        let problem = FeProblem::new(&fine, theta, fine.free(), slots, options, self.cancelled);
        if let Some(s) = states {
            problem.start_from(s.guesses(&fine, &options));
        }
        let cheap = self.on_search_mesh(&begun);
        let how = mapped_options(rounds, runs_as_long(&fine, &options, &begun.model, &self.options));
        let name = named(&self.parts_of(&begun.model));
        let say = self.progress;
        let mut told = |i: &Iterate| {
            let chi2 = i.f.map_or("no answer".into(), |f| format!("χ² {f:.1}"));
            say(&format!("{name}, file's mesh: iteration {}, {chi2}", i.iteration));
            ControlFlow::Continue(())
        };
        let mut quiet = |_: &Iterate| ControlFlow::Continue(());
        let (data, free) = (&self.measured.data, begun.free_parameters.as_slice());
        let asked = Asked {
            problem: &problem,
            beside: Some(&cheap),
            data,
            free,
            options: &how.outer,
            how: &format!("{how:?}"),
            cancelled: self.cancelled,
        };
        let done = remembered(self.journal, &asked, &mut told, &mut |told| {
            Ok((inverse::fit_mapped(&problem, &cheap, data, free, &how, told, &mut quiet)?, None))
        });
        let done = match done {
            Ok(done) => done,
            Err(AnalysisError::Fit(inverse::FitError::Start(PredictError::NotComputable(_)))) => {
                return Ok(None);
            }
            Err(e) => return Err(e),
        };
        self.runs.fetch_add(done.runs, Ordering::Relaxed);
        drop((problem, cheap));
        let states = FineStates { model: fine, warm: done.warm };
        Ok(Some((self.settled_at(begun, done.fit)?, states)))
    }

    /// A start whose laws have the roles that their cards mean.
    fn with_laws_named(&self, mut begun: Begun) -> Begun {
        let Begun { model, theta, free, free_parameters, .. } = &mut begun;
        if crate::roles::as_the_cards_say(model, self.catalogue, free_parameters, theta) {
            free.iter().zip(free_parameters).for_each(|(&i, f)| f.start = theta[i]);
        }
        begun
    }

    /// A rung at the end of its fit on the file's mesh. Where the search's gives no answer there, nothing is put right by it: what
    /// the file's mesh says stands, but nothing can be added to it.
    fn settled_at(&self, begun: Begun, end: Fit) -> Result<Fitted, AnalysisError> {
        // From the same states whether the fit was done or remembered: the same bits.
        let cheap = self.on_search_mesh(&begun);
        let own = match cheap.predict(&end.theta, true) {
            Ok(own) => Some(own),
            Err(PredictError::NotComputable(_)) => None,
            Err(e) => return Err(e.into()),
        };
        let (theta, warm) = (cheap.full(&end.theta), cheap.warm());
        drop(cheap);
        let Begun { model, free, free_parameters, .. } = begun;
        let difference = |own| Correction::first_order(&free_parameters, &end.theta, &end.prediction, own);
        Ok(Fitted {
            theta,
            quality: quality(&self.measured.data, &free_parameters, &end),
            correction: own.as_ref().map_or_else(Correction::default, difference),
            free_parameters,
            fit: end,
            settled: true,
            mode: None,
            warm,
            free,
            model,
        })
    }

    /// The model of a fit's start on the search's mesh, with its states.
    fn on_search_mesh<'a>(&'a self, begun: &'a Begun) -> FeProblem<'a> {
        let (theta, free) = (begun.theta.clone(), begun.free.clone());
        let slots = &self.measured.slots;
        let cheap = FeProblem::new(&begun.model, theta, free, slots, self.options, self.cancelled);
        cheap.start_from(begun.warm.clone());
        cheap
    }

    /// A model of the search's, on the file's mesh.
    pub(super) fn on_file_mesh(&self, model: &Model) -> Result<Model, AnalysisError> {
        let mut case = (*self.fine_case).clone();
        case.effects.clone_from(&model.case.effects);
        case.bulk.clone_from(&model.case.bulk);
        case.interface.clone_from(&model.case.interface);
        Ok(Model::new(Arc::new(case), self.catalogue, Discretisation::default())?)
    }

    /// All load steps: where a strip tears through, the curve between half of them is not the model's.
    pub(super) fn file_options(&self) -> RunOptions {
        let mut options = run_options(&self.fine_case);
        options.stepping.budget = 2 * crate::identify::TRIAL_BUDGET;
        options.stepping.newton.tolerance = self.options.stepping.newton.tolerance;
        options
    }
}

fn mapped_options(rounds: usize, ratio: f64) -> MappedOptions {
    let outer = FitOptions { objective: Objective::Record, max_iterations: rounds, ..FitOptions::default() };
    let inner = FitOptions { max_iterations: 16, tolerance: 1e-4, ..outer.clone() };
    MappedOptions { outer, inner, settled: SETTLED, ratio, radius: f64::INFINITY }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ladder::tests::unexplained;

    /// Laws of a tear that have taken each other's roles have those of their cards on the file's mesh, and the model is the same.
    #[test]
    fn a_fit_on_the_files_mesh_begins_with_laws_named_by_their_cards() {
        let catalogue = effects::catalogue();
        let ladder = unexplained(&catalogue);
        let effect = crate::columns::config_of(catalogue.get("bridging").expect("an effect"), &[0.1, 2.0]);
        let mut case = crate::columns::case_with(&ladder.case, &[effect]);
        case.interface.areas = 1;
        // Of what a file gives as a start nothing is believed.
        (case.interface.gc[0].value, case.interface.sigma_c[0].value) = (Some(0.1), Some(0.1));
        let case = Arc::new(case);
        let of_laws = [
            "interface.area[1].gc",
            "interface.area[1].sigma_c",
            "effects.bridging.sigma_b",
            "effects.bridging.delta_b",
        ];
        let settled = |values: [f64; 4]| {
            let model = Model::new(case.clone(), &catalogue, ladder.how).expect("a model");
            let places = of_laws.map(|path| model.find(path).expect("a parameter"));
            let mut theta = transfer(
                &ladder.fitted_models[&Vec::new()].model,
                &ladder.fitted_models[&Vec::new()].theta,
                &model,
            );
            places.iter().zip(values).for_each(|(&i, v)| theta[i] = v);
            let free = model.free();
            let free_parameters = ladder.free_parameters(&model, &theta, &free);
            let begun = Begun { model, theta, free, free_parameters, warm: Vec::new() };
            let (f, _) = ladder.settle(begun, None, 0).expect("a run").expect("an answer");
            (places.map(|i| f.theta[i]), f.fit.f)
        };
        let e = std::f64::consts::E;
        let right = [e * 0.8 * 0.02, 0.8, 0.1, 0.5];
        let (kept, f) = settled(right);
        let (named, same) = settled([e * 0.1 * 0.5, 0.1, 0.8, 0.02]);
        for (k, v) in right.iter().enumerate() {
            assert!((kept[k] / v - 1.0).abs() < 1e-9 && (named[k] / v - 1.0).abs() < 1e-9, "{named:?}");
        }
        assert!((f / same - 1.0).abs() < 1e-6, "{f} {same}");
    }
}
