//! The stages of a search, and their order on the coarse and the given mesh.

use super::mirrored::mirrored;
use super::settings::{LAST_ROUNDS, STALLED_ROUNDS};
use super::work::{Work, free_parameters};
use super::{AnalysisError, Stage};
use crate::cost::Phase;
use input::{Case, Mode};
use inverse::{FitError, PredictError, StopReason};
use model::{Catalogue, Model, Site};
use std::sync::Arc;

/// Everything at once helps where it leaves this share of what the stages left beyond noise, at most.
const HELPED: f64 = 0.5;

/// A stage, its parameters, its tests.
pub(crate) type StagePlan = (Stage, Vec<usize>, Vec<bool>);

/// The stages of a case: which parameters on which tests.
pub(crate) fn stages(model: &Model, mode: Mode) -> Vec<StagePlan> {
    let all = model.recorded();
    let only = |tears: bool| -> Vec<bool> {
        model.tests.iter().map(|t| t.test.kind.tears == tears && t.test.record.is_some()).collect()
    };
    let (intact, torn) = (only(false), only(true));
    let free = model.free();
    if !(intact.contains(&true) && torn.contains(&true)) {
        return vec![(Stage::Joint, free, all)];
    }
    let (bulk, rest) = (model.free_on(Site::Bulk), model.free_on(Site::Interface));
    // Effects that are not of the tear act on every test, those of the bulk too: the tear strains and unloads it otherwise
    // than the intact strip does. They have no stage of their own.
    let everywhere = |&i: &usize| model.is_of_effect(i) && model.site_of(i) != Site::Interface;
    let joint = mode == Mode::Joint || free.iter().any(everywhere);
    let mut out = vec![(Stage::Bulk, bulk, intact), (Stage::Interface, rest, torn)];
    if joint {
        out.push((Stage::Joint, free, all));
    }
    out.retain(|s| !s.1.is_empty());
    out
}

/// Whether bulk and interface have a stage each and never move together.
pub(super) fn staged(list: &[StagePlan]) -> bool {
    let has = |stage: Stage| list.iter().any(|s| s.0 == stage);
    has(Stage::Bulk) && has(Stage::Interface) && !has(Stage::Joint)
}

/// Where stages end on a mesh, one after the other, with the objective of the last.
type End = (f64, Vec<f64>);

fn ended<'l>(
    model: &Model,
    work: &mut Work,
    mut stages: impl Iterator<Item = &'l StagePlan>,
    theta: Vec<f64>,
) -> Result<End, AnalysisError> {
    work.theta = theta;
    let last = stages
        .try_fold(f64::INFINITY, |_, (stage, free, tests)| work.stage(model, *stage, free, tests, true));
    Ok((last?, work.theta.clone()))
}

fn lower(best: Option<End>, end: End) -> Option<End> {
    best.into_iter().chain([end]).min_by(|a, b| a.0.total_cmp(&b.0))
}

/// What a search works on.
pub(super) struct StagedSearch<'s> {
    pub case: &'s Arc<Case>,
    pub catalogue: &'s Catalogue,
    pub fine: &'s Model,
    pub coarse: Option<&'s Model>,
    /// The mesh that the search on the given one takes its steps on.
    pub cheap: Option<&'s Model>,
}

impl StagedSearch<'_> {
    /// A start, the stages on a coarse mesh, the stages on the given one.
    pub fn run(&self, work: &mut Work, list: &[StagePlan]) -> Result<(), AnalysisError> {
        // What is said of the end of a search is said of its last stages.
        let before = work.stopped.len();
        let coarse = self.coarse.filter(|_| self.case.identify.coarse_first);
        work.coarse_level = coarse.is_some();
        let mut starts = vec![work.theta.clone()];
        work.control.cancelled.phase(Phase::Start);
        if self.case.identify.coarse_first
            && let Some(found) = crate::start::find(self.case, self.catalogue, work, list)?
        {
            starts = found.iter().map(|s| s.spread_from(self.fine, &work.theta)).collect();
        }
        work.control.cancelled.phase(Phase::Fit);
        let mut came_to = None;
        if let Some(coarse) = coarse {
            came_to = self.coarsely(coarse, work, list, starts)?;
        } else if let Some(theta) = starts.into_iter().next() {
            work.theta = theta;
        }
        self.name_laws(work);
        work.stopped.truncate(before);
        work.bulk_held = false;
        // A joint search that was brought near on the coarse mesh needs no stages on the fine one, nor does one that is to
        // stay where it is.
        let near = coarse.is_some() || self.case.identify.max_iterations == 0;
        let straight = near && list.iter().any(|s| s.0 == Stage::Joint);
        for (stage, free, tests) in list.iter().filter(|s| !straight || s.0 == Stage::Joint) {
            let cheap = self.cheap.filter(|_| coarse.is_some());
            // A search on the cheap mesh is put right by the given one; what the stages before the last came to is not
            // what all parameters together did.
            let comparable = cheap.is_none() && straight;
            work.expected = came_to.filter(|_| comparable).unwrap_or(f64::INFINITY);
            let end = work.stage_beside(self.fine, cheap, *stage, free, tests, false);
            work.expected = f64::INFINITY;
            end?;
        }
        Ok(())
    }

    /// Gives laws that can take each other's roles those of their cards.
    fn name_laws(&self, work: &mut Work) {
        if self.case.identify.max_iterations > 0 {
            let mut free = free_parameters(self.fine, &work.theta, &self.fine.free());
            crate::priors::add(&mut free, self.case, work.belief);
            crate::roles::as_the_cards_say(self.fine, self.catalogue, &free, &mut work.theta);
        }
    }

    /// The stages on the coarse mesh, from each start, then from the best end's mirror image along the tear path; the end with the
    /// least objective goes on. A start from which the model cannot be computed does not count, as long as there is another.
    fn coarsely(
        &self,
        coarse: &Model,
        work: &mut Work,
        list: &[StagePlan],
        starts: Vec<Vec<f64>>,
    ) -> Result<Option<f64>, AnalysisError> {
        let (mut best, mut failed) = (None, None);
        for theta in starts {
            match ended(coarse, work, list.iter(), theta) {
                Err(e @ AnalysisError::Fit(FitError::Start(PredictError::NotComputable(_)))) => {
                    failed = Some(e)
                }
                end => best = lower(best, end?),
            }
        }
        let image =
            best.as_ref().and_then(|b| mirrored(coarse, &b.1)).filter(|_| !work.control.cancelled.stops());
        if let Some(theta) = image {
            // The bulk stands where it ended.
            let stages = list.iter().filter(|s| s.0 != Stage::Bulk);
            match ended(coarse, work, stages, theta) {
                Err(AnalysisError::Fit(FitError::Start(PredictError::NotComputable(_)))) => {}
                end => best = lower(best, end?),
            }
        }
        match (best, failed) {
            (Some((f, theta)), _) => {
                work.theta = theta;
                Ok(Some(f))
            }
            (None, Some(e)) => Err(e),
            (None, None) => Ok(None),
        }
    }

    /// A bulk that the intact strip alone leaves open, along the valley of its sloppy combinations, may end where the
    /// tear cannot be explained: all parameters are then fitted to all records, from the beginning, since strengths that
    /// made up for a wrong bulk are a bad start. The stages stand where that does not help. Either pauses where it stalls,
    /// and is taken to its end only if it is the one that stands.
    pub fn release(&self, work: &mut Work, own: &[StagePlan]) -> Result<Option<StagePlan>, AnalysisError> {
        let before = work.tear_left;
        let (theta, bulk_held, starts, paused) =
            (work.theta.clone(), work.bulk_held, work.starts.clone(), work.paused);
        let stopped = work.stopped.len();
        work.theta = self.fine.theta();
        let list = stages(self.fine, Mode::Joint);
        // A search that cannot begin helps as little; one that the user stops ends at the closing run.
        let ended = self.run(work, &list).is_ok();
        if !ended || work.tear_left.excess() > HELPED * before.excess() {
            let there = std::mem::replace(&mut work.theta, theta);
            work.beside = ended.then_some(there);
            (work.bulk_held, work.starts, work.tear_left) = (bulk_held, starts, before);
            work.stopped.truncate(stopped);
            self.go_on(work, paused, own)?;
            return Ok(None);
        }
        self.go_on(work, work.paused, &list)?;
        if let Some(last) = work.stopped.last_mut() {
            last.1 = format!(
                "The intact strip's bulk left the tear at χ² {:.2} per point: everything was fitted to all records. {}",
                before.per_point(),
                last.1
            );
        }
        Ok(list.into_iter().find(|s| s.0 == Stage::Joint))
    }

    /// Takes the last stage to its end on the given mesh, if it paused.
    fn go_on(&self, work: &mut Work, paused: bool, list: &[StagePlan]) -> Result<(), AnalysisError> {
        let Some((stage, free, tests)) = list.last().filter(|_| paused) else { return Ok(()) };
        if work.control.cancelled.stops() {
            work.stopped.push((*stage, StopReason::Stopped.sentence().to_owned(), false));
            return Ok(());
        }
        (work.pausing, work.rounds) = (false, STALLED_ROUNDS);
        work.stage_beside(self.fine, self.cheap, *stage, free, tests, false)?;
        Ok(())
    }

    /// The last stages once more by runs with the answer's load steps, where the search took fewer: its optimum is a
    /// little beside. What a model leaves that misses the tear hides that.
    pub fn with_all_steps(&self, work: &mut Work, list: &[StagePlan]) -> Result<(), AnalysisError> {
        let fewer = self.cheap.is_some() && self.case.identify.coarse_first;
        let stays = self.case.identify.max_iterations == 0 || work.control.cancelled.stops();
        if !fewer || stays || work.tear_left.unexplained() {
            return Ok(());
        }
        (work.pausing, work.all_steps, work.rounds) = (false, true, LAST_ROUNDS);
        let joint = list.iter().any(|s| s.0 == Stage::Joint);
        for (stage, free, tests) in list.iter().filter(|s| !joint || s.0 == Stage::Joint) {
            let told = work.stopped.len();
            work.stage_beside(self.fine, self.cheap, *stage, free, tests, false)?;
            // How the search itself ended is what counts, unless the user ended this.
            if !work.control.cancelled.stops() {
                work.stopped.truncate(told);
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of two ends that which misses less, of two that miss alike the earlier.
    #[test]
    fn the_lower_end_goes_on() {
        let end = |f: f64, at: f64| (f, vec![at]);
        assert_eq!(lower(None, end(3.0, 0.0)), Some(end(3.0, 0.0)));
        assert_eq!(lower(Some(end(3.0, 0.0)), end(2.0, 1.0)), Some(end(2.0, 1.0)));
        assert_eq!(lower(Some(end(2.0, 0.0)), end(3.0, 1.0)), Some(end(2.0, 0.0)));
        assert_eq!(lower(Some(end(2.0, 0.0)), end(2.0, 1.0)), Some(end(2.0, 0.0)));
    }
}
