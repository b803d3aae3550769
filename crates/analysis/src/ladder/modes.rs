//! Fitted models computed at the modes of their posteriors, on the mesh of their fit.

use super::{FeLadder, Fitted, named};
use crate::columns::transfer;
use crate::cost::Phase;
use crate::identify::{AnalysisError, TRIAL_BUDGET};
use crate::probable::measured;
use crate::problem::{FeProblem, Patience};
use crate::weigh::{Beliefs, Mode, NEAR, Scale};
use evidence::EvidenceError;
use inverse::{PredictError, Problem as _};
use rayon::prelude::*;
use std::sync::PoisonError;
use std::sync::atomic::Ordering;

/// A mode, for whatever fit of the same set has the same free parameters: its least squares may lead elsewhere.
pub(super) struct Seed {
    paths: Vec<String>,
    theta: Vec<f64>,
}

impl Seed {
    fn of(f: &Fitted, mode: &Mode) -> Self {
        let paths = f.free_parameters.iter().map(|p| p.path.clone()).collect();
        Self { paths, theta: mode.theta.clone() }
    }

    /// The values, within the bounds of that fit.
    fn for_fit(&self, f: &Fitted) -> Option<Vec<f64>> {
        let same = f.free_parameters.iter().map(|p| &p.path).eq(&self.paths);
        let within = |(p, v): (&inverse::Free, &f64)| v.clamp(p.lower, p.upper);
        same.then(|| f.free_parameters.iter().zip(&self.theta).map(within).collect())
    }
}

impl FeLadder<'_> {
    /// Takes the models whose mode is far from their fit, and that are not hopeless, there, once each; whether there were any.
    pub(super) fn approach_modes(&mut self) -> Result<bool, AnalysisError> {
        let open = self.far_from_modes();
        if open.is_empty() || self.interrupted() {
            return Ok(false);
        }
        self.cancelled.phase(Phase::Candidates);
        let done = {
            let this = &*self;
            let beliefs = Beliefs::of(this.case(), this.catalogue());
            let scale = Scale::new(
                &measured(this)?,
                this.fitted_models.values().map(Into::into),
                this.catalogue(),
                &beliefs,
            )?;
            let one = |key: &Vec<String>| this.mode_of(key, &scale);
            open.par_iter().map(one).collect::<Result<Vec<Mode>, AnalysisError>>()?
        };
        for (key, mode) in open.iter().zip(done) {
            let (name, ln_z) = (named(key), mode.ln_z);
            (self.progress)(&format!("{name}: ln Z {ln_z:.1} near the mode of its posterior"));
            if let Some(f) = self.fitted_models.get_mut(key) {
                self.modes.insert(key.clone(), Seed::of(f, &mode));
                f.mode = Some(mode);
            }
        }
        Ok(true)
    }

    fn far_from_modes(&self) -> Vec<Vec<String>> {
        let known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        let far = |key: &[String], f: &Fitted| {
            let elsewhere = || self.modes.get(key).is_some_and(|s| s.for_fit(f).is_some());
            known.weighed(key).is_some_and(|m| m.judged.is_some() && (m.moved > NEAR || elsewhere()))
        };
        let open = self.fitted_models.iter().filter(|(key, f)| f.mode.is_none() && far(key, f));
        open.map(|(key, _)| key.clone()).collect()
    }

    fn mode_of(&self, key: &[String], scale: &Scale) -> Result<Mode, AnalysisError> {
        let f = &self.fitted_models[key];
        let seed = self.modes.get(key).and_then(|s| s.for_fit(f));
        let slots = &self.measured.slots;
        if !f.settled {
            let (theta, free) = (f.theta.clone(), f.free.clone());
            let mut problem = FeProblem::new(&f.model, theta, free, slots, self.options, self.cancelled);
            problem.options.stepping.budget = TRIAL_BUDGET;
            problem.patience = Some(Patience::FIT);
            problem.correction = f.correction.clone();
            problem.start_from(f.warm.clone());
            return self.mode_by(&problem, f, seed, scale);
        }
        let fine = self.on_file_mesh(&f.model)?;
        let theta = transfer(&f.model, &f.theta, &fine);
        let options = self.file_options();
        let problem = FeProblem::new(&fine, theta, fine.free(), slots, options, self.cancelled);
        if let Some(s) = &self.fine_states {
            problem.start_from(s.guesses(&fine, &options));
        }
        self.mode_by(&problem, f, seed, scale)
    }

    fn mode_by(
        &self,
        problem: &FeProblem,
        f: &Fitted,
        seed: Option<Vec<f64>>,
        scale: &Scale,
    ) -> Result<Mode, AnalysisError> {
        scale.mode(f.into(), seed.as_deref(), |theta: &[f64]| {
            self.runs.fetch_add(1, Ordering::Relaxed);
            match problem.predict(theta, true) {
                Ok(prediction) => Ok(Some(prediction)),
                Err(PredictError::NotComputable(_)) => Ok(None),
                Err(e) => Err(e.into()),
            }
        })
    }
}

impl From<EvidenceError> for AnalysisError {
    fn from(why: EvidenceError) -> Self {
        Self::Case(format!("no probabilities: {why}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ladder::tests::unexplained;
    use evidence::{Linear, density};

    /// What no base model explains is weighed where its posterior is denser than at least squares; its rung stays the fit.
    #[test]
    fn a_model_far_from_its_mode_is_weighed_there() {
        let catalogue = effects::catalogue();
        let mut ladder = unexplained(&catalogue);
        ladder.columns_at(&[]).expect("columns");
        let sets = [vec![], vec!["mullins".to_owned()]];
        ladder.fit_sets(&sets[1..]).expect("a fit");
        let ln_z = |ladder: &FeLadder| {
            let (_, _, models) = ladder.posterior().expect("probabilities");
            sets.clone().map(|s| models.iter().find(|m| m.effects == s).expect("weighed").ln_z())
        };
        let before = ln_z(&ladder);
        let far = ladder.far_from_modes();
        assert!(!far.is_empty());
        let fits =
            |ladder: &FeLadder| far.iter().map(|s| ladder.fitted_models[s].theta.clone()).collect::<Vec<_>>();
        let fitted = fits(&ladder);
        assert!(ladder.approach_modes().expect("modes"));
        assert_eq!(fits(&ladder), fitted);
        let beliefs = Beliefs::of(ladder.case(), &catalogue);
        let record = measured(&ladder).expect("a record");
        let all = ladder.fitted_models.values().map(Into::into);
        let scale = Scale::new(&record, all, &catalogue, &beliefs).expect("a record");
        let dense = |linear: &Linear| density(&scale.record, linear, &beliefs.rest).expect("a density");
        let mut moved = 0;
        for set in &far {
            let f = &ladder.fitted_models[set];
            let (fit, mode) = (scale.linear(f.into()).expect("a fit"), scale.best(f.into()).expect("a mode"));
            moved += usize::from(fit != mode);
            assert!(fit == mode || dense(&mode) > dense(&fit), "{set:?}");
        }
        assert!(moved > 0);
        // Another fit of the set begins where the mode was found, if that is denser than the fit; else at the fit.
        let set = far.iter().find(|s| ladder.fitted_models[*s].mode.is_some()).expect("a mode");
        let f = &ladder.fitted_models[set];
        let found = f.mode.as_ref().expect("a mode");
        let begins = |seed: &[f64], there: &inverse::Prediction| {
            let predict = |theta: &[f64]| Ok::<_, EvidenceError>((theta == seed).then(|| there.clone()));
            scale.mode(f.into(), Some(seed), predict).expect("a mode").theta
        };
        let (astray, nowhere) = (vec![0.0; f.fit.theta.len()], &f.fit.prediction);
        assert_eq!(begins(&found.theta, &found.prediction), found.theta);
        let poor = inverse::Prediction { values: 2.0 * &nowhere.values, ..nowhere.clone() };
        assert_eq!(begins(&astray, &poor), f.fit.theta);
        assert_eq!(ladder.modes[set].for_fit(f).as_ref(), Some(&found.theta));
        let other = ladder.fitted_models.iter().find(|(s, _)| *s != set).expect("another set").1;
        assert!(ladder.modes[set].for_fit(other).is_none());
        assert_ne!(ln_z(&ladder), before);
        // Once each, and each fit once.
        assert!(!ladder.approach_modes().expect("nothing to do"));
        ladder.fitted_models.get_mut(&far[0]).expect("a fit").mode = None;
        ln_z(&ladder);
        assert_eq!(ladder.far_from_modes(), far[..1]);
    }
}
