//! Fitted models computed at the modes of their posteriors.

use super::{FeLadder, Fitted, named};
use crate::cost::Phase;
use crate::identify::{AnalysisError, TRIAL_BUDGET};
use crate::probable::measured;
use crate::problem::{FeProblem, Patience};
use crate::weigh::{Beliefs, Mode, NEAR, Scale};
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

    /// A fitted model on the search's mesh, with what the file's says more around the fit, to first order.
    fn around<'f>(&'f self, f: &'f Fitted) -> FeProblem<'f> {
        let (theta, free, slots) = (f.theta.clone(), f.free.clone(), &self.measured.slots);
        let mut problem = FeProblem::new(&f.model, theta, free, slots, self.options, self.cancelled);
        problem.options.stepping.budget = TRIAL_BUDGET;
        problem.patience = Some(Patience::FIT);
        problem.correction = f.correction.clone();
        problem.start_from(f.warm.clone());
        problem
    }

    fn mode_of(&self, key: &[String], scale: &Scale) -> Result<Mode, AnalysisError> {
        let f = &self.fitted_models[key];
        let seed = self.modes.get(key).and_then(|s| s.for_fit(f));
        let problem = self.around(f);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ladder::tests::unexplained;
    use evidence::{EvidenceError, Linear, density};
    use model::Catalogue;

    /// A base that no base model explains and an effect beside it, weighed, and those of them that are far from their modes.
    fn weighed(catalogue: &Catalogue) -> (FeLadder<'_>, Vec<Vec<String>>) {
        let mut ladder = unexplained(catalogue);
        ladder.columns_at(&[]).expect("columns");
        ladder.fit_sets(&[vec!["mullins".to_owned()]]).expect("a fit");
        ladder.posterior().expect("probabilities");
        let far = ladder.far_from_modes();
        assert!(!far.is_empty());
        (ladder, far)
    }

    fn ln_z(ladder: &FeLadder, set: &[String]) -> f64 {
        let (_, _, models) = ladder.posterior().expect("probabilities");
        models.iter().find(|m| m.effects == set).expect("weighed").ln_z()
    }

    /// A model is weighed where its posterior is denser than at least squares, without what was not found there; its rung stays the fit.
    #[test]
    fn a_model_far_from_its_mode_is_weighed_there() {
        let catalogue = effects::catalogue();
        let (mut ladder, far) = weighed(&catalogue);
        let ends = |ladder: &FeLadder| {
            far.iter()
                .map(|s| (ladder.fitted_models[s].theta.clone(), ln_z(ladder, s)))
                .unzip::<_, _, Vec<_>, Vec<_>>()
        };
        let (fitted, before) = ends(&ladder);
        assert!(ladder.approach_modes().expect("modes"));
        let (still, after) = ends(&ladder);
        assert!(still == fitted && before != after, "{before:?} {after:?}");
        // Once each; what is not claimed is not weighed.
        assert!(!ladder.approach_modes().expect("nothing to do"));
        let set = &far[0];
        let mode = ladder.fitted_models.get_mut(set).and_then(|f| f.mode.as_mut()).expect("a mode");
        mode.unseen += 5.0;
        assert!((ln_z(&ladder, set) - after[0] + 5.0).abs() < 1e-9);
        // A fit that was not asked is, even where it stands near its own mode: one is known elsewhere.
        ladder.fitted_models.get_mut(set).expect("a fit").mode = None;
        ln_z(&ladder, set);
        assert_eq!(ladder.far_from_modes(), far[..1]);
    }

    /// At a fit, on whichever mesh it stands, the way to its mode begins with what the fit predicts.
    #[test]
    fn the_way_to_a_mode_begins_at_the_fit() {
        let catalogue = effects::catalogue();
        let (mut ladder, far) = weighed(&catalogue);
        let differs = |ladder: &FeLadder, set: &Vec<String>| {
            let f = &ladder.fitted_models[set];
            let (there, at) = (&f.fit.prediction.values, ladder.around(f).predict(&f.fit.theta, false));
            let peak = there.amax();
            let apart = (at.expect("an answer").values - there).amax() / peak;
            (apart, f.correction.shift.amax() / peak)
        };
        let check = |ladder: &FeLadder| {
            for set in &far {
                let (apart, meshes) = differs(ladder, set);
                assert!(apart < 1e-5 && meshes > 1e-3, "{set:?}: {apart} {meshes}");
            }
        };
        check(&ladder);
        ladder.settle_sets(&far).expect("fits on the file's mesh");
        assert!(far.iter().all(|set| ladder.fitted_models[set].settled));
        check(&ladder);
    }

    /// A fit of a set begins where its mode was found, if that is denser than the fit; else at the fit.
    #[test]
    fn a_mode_that_was_found_is_not_lost_with_its_fit() {
        let catalogue = effects::catalogue();
        let (mut ladder, far) = weighed(&catalogue);
        ladder.approach_modes().expect("modes");
        let beliefs = Beliefs::of(ladder.case(), &catalogue);
        let record = measured(&ladder).expect("a record");
        let all = ladder.fitted_models.values().map(Into::into);
        let scale = Scale::new(&record, all, &catalogue, &beliefs).expect("a record");
        let dense = |linear: &Linear| density(&scale.record, linear, &beliefs.rest).expect("a density");
        let moved = |set: &&Vec<String>| {
            let f = &ladder.fitted_models[*set];
            let (fit, mode) = (scale.linear(f.into()).expect("a fit"), scale.best(f.into()).expect("a mode"));
            assert!(fit == mode || dense(&mode) > dense(&fit), "{set:?}");
            fit != mode
        };
        let set = far.iter().find(moved).expect("one that moved");
        let f = &ladder.fitted_models[set];
        let found = f.mode.as_ref().expect("a mode");
        let begins = |seed: &[f64], there: &inverse::Prediction| {
            let predict = |theta: &[f64]| Ok::<_, EvidenceError>((theta == seed).then(|| there.clone()));
            scale.mode(f.into(), Some(seed), predict).expect("a mode").theta
        };
        // A little beside it, lest the fit's own step lead there.
        let beside: Vec<f64> =
            found.theta.iter().zip(&f.fit.theta).map(|(m, v)| 0.99 * m + 0.01 * v).collect();
        assert_eq!(begins(&beside, &found.prediction), beside);
        let poor = inverse::Prediction { values: 2.0 * &found.prediction.values, ..found.prediction.clone() };
        assert_eq!(begins(&beside, &poor), f.fit.theta);
        assert_eq!(ladder.modes[set].for_fit(f).as_ref(), Some(&found.theta));
        let other = ladder.fitted_models.iter().find(|(s, _)| *s != set).expect("another set").1;
        assert!(ladder.modes[set].for_fit(other).is_none());
    }
}
