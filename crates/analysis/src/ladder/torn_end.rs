//! Records that no effect meets as a whole, and that end where the strip tears through.
//!
//! As a strip tears through, its force falls by many times the noise from one point to the next. These few points hang on
//! where exactly the tear arrives: every model that is not there yet misses them by far, in a way that no derivative sees,
//! and the fits of all effects end where these points are met, not where the record is. The same search of the record up
//! to there may be through in a moment. What was left out is part of the answer.

use super::{FeLadder, LadderSettings, Weighed};
use crate::identify::{AnalysisError, FAR};
use input::{Case, Test, Weight};
use inverse::Block;
use model::Channel;
use serde::Serialize;
use std::sync::Arc;
use std::sync::atomic::Ordering;

/// How far a force falls from one point to the next, in standard deviations of their difference, to be called steep.
const STEEP: f64 = 3.0;

/// Largest share of a record's points that are its end: a fall that takes longer is how the strip tears.
const END: f64 = 0.05;

/// The end of a record that a search left out.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LeftOut {
    /// Test.
    pub test: String,
    /// Where it begins, s.
    pub from_s: f64,
    /// The end of the record, s.
    pub to_s: f64,
    /// Points in it.
    pub points: usize,
    /// Points of the record.
    pub of: usize,
    /// Rows of the record before it.
    #[serde(skip)]
    rows: usize,
}

/// A finished search.
pub struct SearchOutcome<'a> {
    /// What it found.
    pub weighed: Weighed,
    /// Every model that was fitted.
    pub ladder: FeLadder<'a>,
    /// The case to look at what was found with: as given, or with weights of zero on what was left out.
    pub case: Arc<Case>,
    /// What was left out, the file's own weights aside.
    pub left_out: Vec<LeftOut>,
}

impl<'a> FeLadder<'a> {
    /// Weighs the catalogue by real fits ([`FeLadder::weighed`]); where no effect comes near the whole records, first
    /// without their ends where the strip tears through. That counts if a model comes near the rest.
    ///
    /// # Errors
    /// [`AnalysisError`].
    pub fn search(case: Arc<Case>, how: LadderSettings<'a>) -> Result<SearchOutcome<'a>, AnalysisError> {
        let mut ladder = Self::weighing(case.clone(), how.clone())?;
        let left_out = ladder.torn_ends();
        ladder.brief = !left_out.is_empty();
        let mut weighed = ladder.weighed()?;
        if ladder.gives_up() && !ladder.interrupted() {
            // What the whole records say stands, whatever becomes of the rest.
            if let Some(again) = ladder.search_without(&case, left_out, how) {
                return Ok(again);
            }
            ladder.brief = false;
            weighed = ladder.weighed()?;
        }
        Ok(SearchOutcome { weighed, ladder, case, left_out: Vec::new() })
    }

    /// The search without the ends of the records; `None` where no model comes near the rest either.
    fn search_without(
        &self,
        case: &Case,
        left_out: Vec<LeftOut>,
        how: LadderSettings<'a>,
    ) -> Option<SearchOutcome<'a>> {
        let points: usize = left_out.iter().map(|l| l.points).sum();
        (how.progress)(&format!(
            "no effect comes near; now without the last {points} points, where it tears through"
        ));
        let mut ladder = Self::weighing(Arc::new(before(&self.fine_case, &left_out)), how).ok()?;
        let weighed = ladder.weighed().ok()?;
        ladder.runs.fetch_add(self.runs(), Ordering::Relaxed);
        let case = Arc::new(with_weights(case, &left_out));
        let near = ladder.comes_near() && !ladder.interrupted();
        near.then_some(SearchOutcome { weighed, ladder, case, left_out })
    }

    /// Whether a search that is to be brief has nothing that comes near.
    pub(super) fn gives_up(&self) -> bool {
        self.brief && !self.comes_near()
    }

    /// Whether a model that was fitted leaves little beside the noise.
    fn comes_near(&self) -> bool {
        self.fitted_models.values().any(|f| f.quality.reduced_chi2_total <= FAR)
    }

    /// The ends of the records, from where a force falls steeply as the displacement grows.
    fn torn_ends(&self) -> Vec<LeftOut> {
        let (data, slots) = (&self.measured.data, &self.measured.slots);
        let end = |(block, slot): (&Block, &crate::data::DataBlock)| {
            let test = &self.fine_case.tests[slot.test];
            let record = test.record.as_ref().filter(|_| slot.channel == Channel::Force)?;
            let opens = |i: usize| record.displacement[slot.rows[i]] > record.displacement[slot.rows[i - 1]];
            let used = |i: usize| data.is_used(block.range.start + i);
            let first = torn_from(block, &|i| opens(i) && used(i))?;
            let rows = slot.rows[first];
            let to_s = *record.time.last()?;
            // Half way between two points, so that a rounded number means the same ones.
            let from_s = 0.5 * (record.time[rows - 1] + record.time[rows]);
            Some(LeftOut {
                test: test.name.clone(),
                from_s,
                to_s,
                points: block.measured.len() - first,
                of: block.measured.len(),
                rows,
            })
        };
        data.blocks.iter().zip(slots).filter_map(end).collect()
    }
}

/// The first point of a record's end that stands at the lower end of a steep fall.
fn torn_from(block: &Block, counts: &dyn Fn(usize) -> bool) -> Option<usize> {
    let (values, noise) = (&block.measured, &block.noise);
    let fall = |i: usize| (values[i - 1] - values[i]) / noise.sd_of(i).hypot(noise.sd_of(i - 1));
    let begin = values.len() - (END * values.len() as f64) as usize;
    (begin.max(1)..values.len()).find(|&i| counts(i) && fall(i) > STEEP)
}

/// The case with records that end before what is left out.
fn before(case: &Case, left_out: &[LeftOut]) -> Case {
    changed(case, left_out, |test, l| test.record.iter_mut().for_each(|r| r.truncate(l.rows)))
}

/// The case with weights of zero on what is left out.
fn with_weights(case: &Case, left_out: &[LeftOut]) -> Case {
    changed(case, left_out, |test, l| {
        test.weights.push(Weight { from_s: l.from_s, to_s: l.to_s, weight: 0.0 });
    })
}

fn changed(case: &Case, left_out: &[LeftOut], change: impl Fn(&mut Test, &LeftOut)) -> Case {
    let mut case = case.clone();
    for l in left_out {
        case.tests.iter_mut().filter(|t| t.name == l.test).for_each(|t| change(t, l));
    }
    case
}

#[cfg(test)]
mod tests {
    use super::*;
    use inverse::NoiseModel;

    const SD: f64 = 0.01;

    /// The first point of the end of a record that rises by 0.1 a point and falls to `ends` at last.
    fn from(ends: &[f64], counts: &dyn Fn(usize) -> bool) -> Option<usize> {
        let rising = (0..60 - ends.len()).map(|i| 0.1 * i as f64);
        let measured: Vec<f64> = rising.chain(ends.iter().copied()).collect();
        assert_eq!(measured.len(), 60);
        torn_from(
            &Block { name: String::new(), range: 0..60, measured, noise: NoiseModel::white(SD) },
            counts,
        )
    }

    #[test]
    fn an_end_begins_at_the_first_steep_fall_of_the_last_twentieth() {
        let all = |_: usize| true;
        assert_eq!(from(&[4.0, 3.0], &all), Some(58));
        // Three times the sd of a difference is 0.042.
        assert_eq!(from(&[5.7, 5.66, 4.0], &all), Some(59));
        assert_eq!(from(&[5.7, 5.65, 4.0], &all), Some(58));
        assert_eq!(from(&[5.7, 5.66, 5.62], &all), None);
        // A fall before the last three of sixty is how it tears.
        assert_eq!(from(&[5.0, 4.0, 3.0], &all), Some(57));
        assert_eq!(from(&[3.0, 3.1, 3.2, 3.3], &all), None);
        assert_eq!(from(&[5.0, 4.0, 3.0, 2.0], &all), Some(57));
        // Unloading, or what the file leaves out, is no fall.
        assert_eq!(from(&[4.0, 3.0], &|i| i != 58), Some(59));
        assert_eq!(from(&[4.0, 3.0], &|_| false), None);
    }
}
