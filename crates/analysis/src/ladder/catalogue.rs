//! The catalogue weighed: every effect really fitted, sets grown by their evidence, what matters fitted on the file's mesh.
//!
//! Fits of effects take the search's mesh, put right at the base to first order in its parameters ([`crate::Correction`]);
//! sets with a share of the posterior are then fitted on the file's mesh themselves, their steps taken on the search's
//! (`inverse::fit_mapped`).

use super::decided::Probabilities;
use super::fit::LITTLE;
use super::laws::other_laws;
use super::leading::leading;
use super::smaller::Pair;
use super::{FeLadder, Fitted, named};
use crate::cost::Phase;
use crate::identify::{AnalysisError, FAR};
use crate::probable::{Probable, probable_with_models};
use inverse::PredictError;
use rayon::prelude::*;
use std::collections::BTreeSet;
use std::sync::PoisonError;

/// Most effects of a set.
const LARGEST: usize = 4;
/// Sets that are fitted in one round.
const AT_ONCE: usize = 8;

impl FeLadder<'_> {
    /// Fits every effect, and every set that matters: what leads is taken to the file's mesh before anything is added to it,
    /// so that additions are judged at an optimum.
    ///
    /// # Errors
    /// [`AnalysisError`].
    pub(super) fn weigh_catalogue(&mut self) -> Result<Probabilities, AnalysisError> {
        if !self.screens.contains_key(&Vec::new()) {
            self.columns_at(&[])?;
        }
        let mut done = Done::default();
        loop {
            let (found, posterior, models) = self.posterior()?;
            // What else there is to try comes before what costs most.
            if self.interrupted() || (matches!(done.singles, Singles::Fitted) && self.gives_up()) {
                return Ok((found, posterior));
            }
            (self.progress)(found.sentence().trim_end_matches('.'));
            let noise = found.left.explained_to == evidence::ExplainedTo::Noise;
            let now = Now { noise, leads: leading(&posterior), found, posterior, models };
            let moved = self.settle_leading_base(&now)?
                || self.fit_likely(&mut done, &now)?
                || self.approach_modes()?
                || self.begin_rivals_again(&mut done, &now)
                || self.end_leaders_as_identified(&mut done, &now)
                || self.fit_others(&mut done, &now)?
                || self.settle_leaders(&mut done, &now)?
                || self.begin_smaller_again(&mut done, &now)
                || self.settle_rivals(&mut done, &now)?
                || self.screen_leaders(&now)?
                || self.grow(&now)?;
            if !moved {
                return Ok((now.found, now.posterior));
            }
        }
    }

    /// The base model at its end, where it leads, with the catalogue's columns there.
    pub(super) fn settle_leading_base(&mut self, now: &Now) -> Result<bool, AnalysisError> {
        let moved = now.leads.iter().any(Vec::is_empty) && self.settle_base()?;
        if moved {
            self.columns_at(&[])?;
        }
        Ok(moved)
    }

    /// The effects that lead by the base's columns.
    fn fit_likely(&mut self, done: &mut Done, now: &Now) -> Result<bool, AnalysisError> {
        if !matches!(done.singles, Singles::Likely) {
            return Ok(false);
        }
        let mut sets = self.singles(&now.found, &now.models);
        sets.extend(other_laws(&self.case, self.catalogue).into_iter().map(|law| vec![law]));
        let likely: Vec<Vec<String>> = sets.iter().filter(|s| now.leads.contains(s)).cloned().collect();
        done.singles = Singles::Others(sets);
        self.fit_sets(&likely)?;
        Ok(!likely.is_empty())
    }

    /// The leading sets once more from the record, where the base model does not lead: its optimum, from which they were fitted,
    /// is bent by what it lacks, and what explains the records there may do so by a tear that is not the strip's. Where more
    /// than noise is left, single effects whose evidence was worth its integral, too: a fit that ended early has next to no
    /// share of the posterior, and what leads instead takes it.
    pub(super) fn begin_rivals_again(&mut self, done: &mut Done, now: &Now) -> bool {
        let open = {
            let known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
            let near = |s: &[String]| s.len() == 1 && known.weighed(s).is_some_and(|m| m.judged.is_some());
            let bent = !now.leads.iter().any(Vec::is_empty);
            self.unsettled(&done.twice, |s| {
                let leads = now.leads.iter().any(|l| l == s);
                if now.noise { bent && leads } else { leads || near(s) }
            })
        };
        self.fit_again(&open, |ladder, _, f| ladder.restart_as_identified(f));
        done.twice.extend(open.iter().cloned());
        !open.is_empty()
    }

    /// The leading sets where `identify` of them ends, where more than noise is left. For all of the others that would take longer
    /// than the search.
    pub(super) fn end_leaders_as_identified(&mut self, done: &mut Done, now: &Now) -> bool {
        let open = self.unsettled(&done.ended, |s| !now.noise && now.leads.iter().any(|l| l == s));
        self.fit_again(&open, |ladder, _, f| ladder.end_as_identified(f));
        done.ended.extend(open.iter().cloned());
        !open.is_empty()
    }

    /// Those sets with effects that count, are not on the file's mesh, and not among these.
    fn unsettled(&self, but: &BTreeSet<Vec<String>>, counts: impl Fn(&[String]) -> bool) -> Vec<Vec<String>> {
        let open = self
            .fitted_models
            .iter()
            .filter(|(s, f)| !f.settled && !s.is_empty() && !but.contains(*s) && counts(s));
        open.map(|(s, _)| s.clone()).collect()
    }

    /// All other effects, held against a leader that leaves noise alone.
    fn fit_others(&mut self, done: &mut Done, now: &Now) -> Result<bool, AnalysisError> {
        let Singles::Others(sets) = std::mem::replace(&mut done.singles, Singles::Fitted) else {
            return Ok(false);
        };
        self.leader = now.noise.then(|| self.least());
        self.fit_sets(&sets)?;
        self.leader = None;
        if !self.gives_up() {
            self.begin_again(&sets, now)?;
        }
        Ok(true)
    }

    /// The leading sets in their best form, on the file's mesh.
    pub(super) fn settle_leaders(&mut self, done: &mut Done, now: &Now) -> Result<bool, AnalysisError> {
        let open: Vec<Vec<String>> = (self.fitted(now).into_iter())
            .filter(|s| !self.fitted_models[s].settled || !done.formed.contains(s))
            .collect();
        self.settle_sets(&open)?;
        done.formed.extend(open.iter().cloned());
        Ok(!open.is_empty())
    }

    fn screen_leaders(&mut self, now: &Now) -> Result<bool, AnalysisError> {
        let unscreened: Vec<Vec<String>> = (self.fitted(now).into_iter())
            .filter(|s| s.len() < LARGEST && !self.screened.contains_key(s))
            .collect();
        for set in &unscreened {
            match self.columns_at(set) {
                // Without columns nothing is added to this set; what was found stands.
                Err(AnalysisError::Predict(PredictError::NotComputable(why))) => {
                    (self.progress)(&format!("{}: no screen ({why})", named(set)));
                    self.screened.insert(set.clone(), Vec::new());
                }
                screened => screened?,
            }
        }
        Ok(!unscreened.is_empty())
    }

    /// The sets that the posterior asks for next.
    fn grow(&mut self, now: &Now) -> Result<bool, AnalysisError> {
        let beside = if now.noise { Vec::new() } else { self.with_other_laws(&self.fitted(now)) };
        let known = |s: &Vec<String>| self.fitted_models.contains_key(s) || self.failed.contains_key(s);
        let open: Vec<Vec<String>> = (evidence::to_fit(&now.posterior, &now.models).into_iter())
            .chain(beside)
            .filter(|s| s.len() <= LARGEST && !known(s))
            .take(AT_ONCE)
            .collect();
        self.fit_sets(&open)?;
        Ok(!open.is_empty())
    }

    /// The leading sets that are fitted.
    fn fitted(&self, now: &Now) -> Vec<Vec<String>> {
        now.leads.iter().filter(|s| self.fitted_models.contains_key(*s)).cloned().collect()
    }

    /// The least objective of what was fitted.
    fn least(&self) -> f64 {
        self.fitted_models.values().map(|f| f.fit.f).fold(f64::INFINITY, f64::min)
    }

    /// Once more from the record's own start: all sets, where no effect explains what the base leaves by far; those that ended clearly
    /// worse than the base, wherever the base leaves more than noise. At its neutral value an effect is as good as the base.
    pub(super) fn begin_again(&mut self, sets: &[Vec<String>], now: &Now) -> Result<(), AnalysisError> {
        let chi2 = |f: &Fitted| f.quality.reduced_chi2_total;
        let best = self.fitted_models.values().map(chi2).fold(f64::INFINITY, f64::min);
        let base = self.fitted_models.get(&Vec::new()).map_or(f64::INFINITY, |f| f.fit.f);
        let lost = |s: &&Vec<String>| self.fitted_models.get(*s).is_some_and(|f| LITTLE * f.fit.f > base);
        let open: Vec<Vec<String>> =
            sets.iter().filter(|s| best > FAR || (!now.noise && lost(s))).cloned().collect();
        if open.is_empty() || self.interrupted() {
            return Ok(());
        }
        self.first = self.unbent()?;
        self.fit_again(&open, |ladder, set, f| ladder.restart_from_the_record(set, f));
        Ok(())
    }

    /// Replaces fits by what a second one makes of them, side by side.
    fn fit_again(&mut self, sets: &[Vec<String>], again: impl Fn(&Self, &[String], Fitted) -> Fitted + Sync) {
        self.cancelled.phase(Phase::Candidates);
        let begun: Vec<(Vec<String>, Fitted)> =
            sets.iter().filter_map(|s| self.fitted_models.remove_entry(s)).collect();
        let this = &*self;
        let done: Vec<(Vec<String>, Fitted)> = (begun.into_par_iter())
            .map(|(set, f)| {
                let f = again(this, &set, f);
                (set, f)
            })
            .collect();
        self.fitted_models.extend(done);
    }

    /// The effects that are fitted first: all of them; where the base leaves noise alone, so that no effect can gain much, those
    /// whose columns gain something, or that have none.
    fn singles(&self, found: &Probable, models: &[evidence::Judged]) -> Vec<Vec<String>> {
        let noise = found.left.explained_to == evidence::ExplainedTo::Noise;
        let present: BTreeSet<&str> = self.case.effects.iter().map(|e| e.name.as_str()).collect();
        let refused = |set: &Vec<String>| {
            let mut judged = models.iter().filter(|m| &m.effects == set);
            noise && judged.next().is_some_and(|m| m.gain <= 0.0)
        };
        self.candidates
            .iter()
            .filter(|c| !present.contains(c.effect.as_str()))
            .filter(|c| self.catalogue.get(&c.effect).is_some_and(|e| !e.card().negative_control))
            .map(|c| vec![c.effect.clone()])
            .filter(|set| !refused(set))
            .collect()
    }

    pub(super) fn posterior(
        &self,
    ) -> Result<(Probable, evidence::Posterior, Vec<evidence::Judged>), AnalysisError> {
        Ok(probable_with_models(self)?)
    }

    /// The catalogue by its columns at the base model.
    pub(super) fn weigh_columns(&mut self) -> Result<Probabilities, AnalysisError> {
        self.settle_base()?;
        self.columns_at(&[])?;
        self.posterior().map(|(found, posterior, _)| (found, posterior))
    }

    /// The catalogue's columns at a fitted set.
    pub(crate) fn columns_at(&mut self, set: &[String]) -> Result<(), AnalysisError> {
        let Some(f) = self.fitted_models.get(set) else { return Ok(()) };
        let fitted_model = self.fitted_model(set, f);
        let screen = self.screen(&fitted_model)?;
        self.screens.insert(set.to_vec(), screen);
        Ok(())
    }

    /// Fits sets side by side. One that cannot be fitted is left out, and said to be.
    ///
    /// # Errors
    /// [`AnalysisError`] when the user stops it.
    pub fn fit_sets(&mut self, sets: &[Vec<String>]) -> Result<(), AnalysisError> {
        self.cancelled.phase(Phase::Candidates);
        let this = &*self;
        let known = |s: &Vec<String>| this.fitted_models.contains_key(s) || this.failed.contains_key(s);
        let open: Vec<&Vec<String>> = sets.iter().filter(|s| this.compatible(s) && !known(s)).collect();
        let one = |set: &&Vec<String>| this.fit_with_restarts(set, set, &this.proposed(set));
        let fitted: Vec<Result<Fitted, AnalysisError>> = open.par_iter().map(one).collect();
        let names: Vec<Vec<String>> = open.into_iter().cloned().collect();
        for (set, fitted) in names.into_iter().zip(fitted) {
            match fitted {
                Ok(f) => {
                    (self.progress)(&format!("{}: χ² {:.1}", named(&set), f.fit.f));
                    self.fitted_models.insert(set, f);
                }
                Err(e) if self.cancelled.stops() => return Err(e),
                Err(e) => {
                    (self.progress)(&format!("{}: no fit ({e})", named(&set)));
                    self.failed.insert(set, e.to_string());
                }
            }
        }
        Ok(())
    }
}

/// What a search has behind it.
#[derive(Default)]
pub(super) struct Done {
    pub singles: Singles,
    /// Sets that began a second time, from the record.
    pub twice: BTreeSet<Vec<String>>,
    /// Sets that were taken to where `identify` of them ends.
    pub ended: BTreeSet<Vec<String>>,
    /// Sets that were looked at on the file's mesh.
    pub seen: BTreeSet<Vec<String>>,
    /// Sets that led, and those without one effect that began once more from where they ended.
    pub smaller: BTreeSet<Pair>,
    /// Sets whose effects were tried in other forms.
    pub formed: BTreeSet<Vec<String>>,
}

/// Which sets of one effect are to be fitted next.
#[derive(Default)]
pub(super) enum Singles {
    /// Those that lead by the base's columns: where they leave noise alone, the others have something to be held against.
    #[default]
    Likely,
    /// The others of these.
    Others(Vec<Vec<String>>),
    /// None.
    Fitted,
}

/// Where a search stands.
pub(super) struct Now {
    pub found: Probable,
    pub posterior: evidence::Posterior,
    pub models: Vec<evidence::Judged>,
    /// Whether noise explains what is left.
    pub noise: bool,
    /// The sets that an answer may hang on.
    pub leads: Vec<Vec<String>>,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ladder::tests::unexplained;

    fn one(effect: &str) -> Vec<String> {
        vec![effect.to_owned()]
    }

    /// Where the search's mesh gives no answer, what the file's has found stands, and is not added to.
    #[test]
    fn what_the_search_mesh_cannot_follow_stands() {
        let catalogue = effects::catalogue();
        let mut ladder = unexplained(&catalogue);
        let (found, posterior, models) = {
            ladder.columns_at(&[]).expect("columns");
            ladder.posterior().expect("probabilities")
        };
        let mullins = one("mullins");
        ladder.fit_sets(std::slice::from_ref(&mullins)).expect("a fit");
        let mut begun = ladder.begun_of(&ladder.fitted_models[&mullins]).expect("a start");
        begun.warm.clear();
        ladder.options.stepping.budget = 0;
        let (stands, _) = ladder.settle(begun, None, 0).expect("a run").expect("an answer");
        assert!(stands.settled && stands.correction == crate::Correction::default());
        assert!((stands.fit.f / ladder.fitted_models[&mullins].fit.f - 1.0).abs() < 0.01);
        ladder.fitted_models.insert(mullins.clone(), stands);
        let now = Now { found, posterior, models, noise: true, leads: vec![mullins.clone()] };
        assert!(ladder.screen_leaders(&now).expect("no error"));
        assert!(ladder.screened[&mullins].is_empty() && !ladder.screen_leaders(&now).expect("nothing to do"));
    }
}
