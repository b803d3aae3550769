//! When a round of a mapped fit has gained enough.

use crate::Iterate;

/// What a round has gained and taken so far, its steps being taken on the map.
///
/// A round ends where its next step gains less for a run than the round has gained for each of its own, that of the
/// expensive model at its end among them (Charnov's marginal value theorem, 1976, doi:10.1016/0040-5809(76)90040-X): further
/// steps along a valley gain little, and lead where the map does not hold.
pub struct Gain {
    begun: f64,
    last: f64,
    /// Runs of the cheap model: of the round, the expensive model's counted in; since the last step.
    runs: f64,
    since: f64,
}

impl Gain {
    /// Of a round that begins at this objective; the expensive run at its end takes as long as so many cheap ones.
    pub const fn from(f: f64, expensive: f64) -> Self {
        Self { begun: f, last: f, runs: expensive, since: 0.0 }
    }

    /// Whether the round is to end at this iterate; not before it gained `least`.
    pub fn is_enough(&mut self, i: &Iterate, least: f64) -> bool {
        if i.iteration == 0 {
            return false;
        }
        self.runs += 1.0;
        self.since += 1.0;
        let Some(f) = i.f.filter(|_| i.accepted) else { return false };
        let (whole, step) = (self.begun - f, self.last - f);
        let little = step / self.since < whole / self.runs;
        (self.last, self.since) = (f, 0.0);
        whole >= least && little
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whether a round ends at each of these iterates: accepted or not, and the objective.
    fn ends(ratio: f64, least: f64, begun: f64, runs: &[(bool, f64)]) -> Vec<bool> {
        let mut gain = Gain::from(begun, ratio);
        let one = |(k, &(accepted, f)): (usize, &(bool, f64))| {
            let iterate = Iterate { iteration: k + 1, f: Some(f), theta: Vec::new(), accepted, damping: 0.0 };
            gain.is_enough(&iterate, least)
        };
        runs.iter().enumerate().map(one).collect()
    }

    #[test]
    fn a_round_ends_where_a_run_gains_less_than_the_rounds_have_on_average() {
        // Three runs and the expensive one, which takes as long as five, gained 46: 5.8 a run.
        let runs = [(false, 130.0), (true, 60.0), (true, 54.0), (true, 53.0)];
        assert_eq!(ends(5.0, 0.25, 100.0, &runs), [false, false, false, true]);
    }

    #[test]
    fn a_rejected_trial_counts_with_the_step_after_it() {
        // 8.5 in one run is more than 48.5 in seven; in two it is less than 48.5 in eight.
        let at_once = [(true, 60.0), (true, 51.5)];
        let late = [(true, 60.0), (false, 70.0), (true, 51.5)];
        assert_eq!(ends(5.0, 0.25, 100.0, &at_once), [false, false]);
        assert_eq!(ends(5.0, 0.25, 100.0, &late), [false, false, true]);
    }

    #[test]
    fn steps_that_gain_alike_and_rounds_that_gained_nothing_yet_go_on() {
        let alike: Vec<(bool, f64)> = (1..=16).map(|k| (true, 100.0 - 0.3 * f64::from(k))).collect();
        assert!(ends(8.0, 0.25, 100.0, &alike).iter().all(|e| !e));
        let little = [(true, 99.9), (true, 99.899), (true, 99.8989)];
        assert!(ends(8.0, 0.25, 100.0, &little).iter().all(|e| !e));
    }
}
