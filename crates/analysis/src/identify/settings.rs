//! Settings of a stage's fit.

use super::{Stage, Work};
use inverse::{FitOptions, Free, MappedOptions, Objective, Poll};

/// The coarse mesh only brings the search near: a fall of half a percent is not worth a run, nor is a
/// fifth trial of a step.
const COARSE_TOLERANCE: f64 = 5e-3;
const COARSE_TRIALS: usize = 4;

/// Three steps in a row that lower χ² by less than this end the search: a quarter of what one
/// parameter is worth by chance, each step half a standard deviation at most in any direction.
const INSIGNIFICANT: f64 = 0.25;

/// How near rounds on the given mesh come to its optimum.
struct Near {
    /// Tolerance, least fall of three steps, and most steps of the searches on the cheap mesh between two runs on the given
    /// one.
    tolerance: f64,
    insignificant: f64,
    steps: usize,
    /// A predicted fall of χ² that is not worth a run on the given mesh.
    settled: f64,
    /// The trust region to begin with.
    radius: f64,
}

/// They need not end closer than the next run moves them.
const BEFORE: Near =
    Near { tolerance: 1e-4, insignificant: 0.05, steps: 16, settled: INSIGNIFICANT, radius: f64::INFINITY };

/// The last rounds, by runs with all load steps, along a valley: what ends χ² three above its least is off by nearly two
/// standard deviations in some direction. Begun with an unlimited region, the first of them is rejected; how many, and how
/// near, was chosen on FCT3, FCT4 and a strip that lacks nothing (docs/decisions/mapped-search.md).
const LAST: Near = Near { tolerance: 1e-5, insignificant: 0.01, steps: 30, settled: 0.1, radius: 0.1 };
pub(super) const LAST_ROUNDS: usize = 5;

/// Rounds of a stage that stalled: a model that misses the tear by far is not told apart from others by the rest.
pub(super) const STALLED_ROUNDS: usize = 5;

impl Work<'_> {
    pub(super) fn fit_options(&self, stage: Stage, coarse: bool, list: &[Free]) -> FitOptions {
        let whitened = stage == Stage::Joint || self.coarse_noise > 0.0;
        // Of several starts the best counts: none is worth a look around. Nor is the coarse mesh's, where another way ended:
        // that is known on the given one.
        let one_of_several = self.by_record || (coarse && self.again.below.is_finite());
        FitOptions {
            objective: if whitened { Objective::Record } else { Objective::PaperSum },
            // The coarse mesh only brings the search near: its own error is larger than the rest.
            insignificant: INSIGNIFICANT,
            tolerance: if coarse { COARSE_TOLERANCE } else { self.case.identify.tolerance },
            max_trials: if coarse { COARSE_TRIALS } else { FitOptions::default().max_trials },
            max_iterations: match (coarse, stage) {
                (false, _) => self.case.identify.max_iterations.min(self.rounds),
                (true, Stage::Joint) => 30,
                (true, _) => 10,
            },
            // Strengths of neighbouring areas trade against each other: a bold first step makes the
            // tear jump, and a jump tells the search nothing.
            initial_damping: if stage == Stage::Bulk { 1e-3 } else { 3e-2 },
            max_step: if stage == Stage::Bulk { 1.5 } else { 0.5 },
            poll: (!one_of_several).then(|| Poll {
                expected: self.expected,
                below: self.again.below,
                ..super::poll(list)
            }),
            ..FitOptions::default()
        }
    }

    /// A search on a cheap model, `ratio` runs of which take as long as one of the given.
    pub(super) fn mapped_options(&self, outer: &FitOptions, ratio: f64) -> MappedOptions {
        let near = if self.all_steps { LAST } else { BEFORE };
        let inner = FitOptions {
            tolerance: near.tolerance,
            insignificant: near.insignificant,
            max_iterations: near.steps,
            max_trials: COARSE_TRIALS,
            poll: None,
            ..outer.clone()
        };
        MappedOptions { outer: outer.clone(), inner, settled: near.settled, ratio, radius: near.radius }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identify::Again;
    use crate::ladder::tests::unloaded;
    use crate::{Control, NoJournal};

    /// Where another way ended, a search looks around below that alone, and on the given mesh alone.
    #[test]
    fn a_search_beside_a_better_one_does_not_look_around() {
        let catalogue = effects::catalogue();
        let case = unloaded(&catalogue);
        let control = Control { progress: &|_| (), cancelled: &|| false, journal: &NoJournal };
        let below = |coarse: bool, below: f64| {
            let mut work = Work::new(&case, Vec::new(), crate::run_options(&case), &control);
            work.again = Again { starts: &[], below };
            work.fit_options(Stage::Joint, coarse, &[]).poll.map(|p| p.below)
        };
        let none = f64::INFINITY;
        assert_eq!([below(true, none), below(false, none)], [Some(none); 2]);
        assert_eq!([below(true, 7.0), below(false, 7.0)], [None, Some(7.0)]);
    }
}
