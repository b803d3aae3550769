//! What the effects of a config need their records to hold.

use input::{Case, TestKind};
use model::{Card, Catalogue, Corner, corners_of_record};

/// Travel below this share of a record's range is no leg of its own.
const STILL: f64 = 0.01;

/// Rates that differ by this factor are two.
const TWO_RATES: f64 = 1.3;

/// What the records of a case hold.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Holds {
    tests: usize,
    tearing: bool,
    unloading: bool,
    pause: bool,
    two_rates: bool,
}

impl Holds {
    fn of(case: &Case) -> Self {
        let mut holds = Self::default();
        let mut rates: Vec<f64> = Vec::new();
        for (test, record) in case.tests.iter().filter_map(|t| t.record.as_ref().map(|r| (t, r))) {
            holds.tests += 1;
            holds.tearing |= test.kind == TestKind::Tearing;
            holds.add(&corners_of_record(record), &mut rates);
        }
        let fastest = rates.iter().copied().fold(0.0, f64::max);
        let slowest = rates.iter().copied().fold(f64::INFINITY, f64::min);
        holds.two_rates = fastest > TWO_RATES * slowest;
        holds
    }

    fn add(&mut self, corners: &[Corner], rates: &mut Vec<f64>) {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for c in corners {
            (low, high) = (low.min(c.displacement), high.max(c.displacement));
        }
        for leg in corners.windows(2) {
            let (travel, time) = (leg[1].displacement - leg[0].displacement, leg[1].time - leg[0].time);
            if travel.abs() <= STILL * (high - low) {
                self.pause |= time > 0.0;
            } else if time > 0.0 {
                self.unloading |= travel < 0.0;
                rates.push(travel.abs() / time);
            }
        }
    }

    /// What of the records an effect lacks, and what to add; `None` where a need is met.
    fn lacks(&self, need: &str) -> Option<(&'static str, &'static str)> {
        match need {
            "tearing" if !self.tearing => Some(("no tearing test", "a tearing test")),
            "unloading" if !self.unloading => Some(("no unloading", "a partial unloading and a reloading")),
            "two tests" if self.tests < 2 => Some(("one test", "a second test of another kind")),
            "pause or two rates" if !self.pause && !self.two_rates => {
                Some(("no pause and one rate", "a hold, or a leg at another rate"))
            }
            _ => None,
        }
    }
}

/// The sentence on one effect whose record lacks something.
fn sentence(card: &Card, holds: &str, add: &str) -> String {
    let rivals = match card.look_alikes {
        [] => "the base parameters".to_owned(),
        some => some.iter().map(|r| format!("`{r}`")).collect::<Vec<_>>().join(" or "),
    };
    format!("these records hold {holds}: `{}` cannot be told from {rivals}; add {add}", card.name)
}

/// Effects of a case that its records cannot show (faults) or hardly tell from others (remarks), as sentences.
pub fn needs(case: &Case, catalogue: &Catalogue) -> (Vec<String>, Vec<String>) {
    let holds = Holds::of(case);
    let (mut faults, mut remarks) = (Vec::new(), Vec::new());
    for card in case.effects.iter().filter_map(|e| catalogue.get(&e.name)).map(|e| e.card()) {
        for need in card.needs {
            if let Some((what, add)) = holds.lacks(need) {
                // One rate still makes loops of unloading; without a tear there is nothing at all.
                let list = if *need == "pause or two rates" { &mut remarks } else { &mut faults };
                list.push(sentence(card, what, add));
            }
        }
    }
    (faults, remarks)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn holds(legs: &[(f64, f64)]) -> Holds {
        let corners: Vec<Corner> =
            legs.iter().map(|&(time, displacement)| Corner { time, displacement }).collect();
        let (mut holds, mut rates) = (Holds { tests: 1, ..Holds::default() }, Vec::new());
        holds.add(&corners, &mut rates);
        holds.two_rates = rates.iter().any(|a| rates.iter().any(|b| a > &(TWO_RATES * b)));
        holds
    }

    #[test]
    fn a_record_is_read_for_what_effects_need() {
        let ramp = holds(&[(0.0, 0.0), (10.0, 1.0)]);
        for need in ["tearing", "unloading", "two tests", "pause or two rates"] {
            assert!(ramp.lacks(need).is_some(), "{need}");
        }
        let loops = holds(&[(0.0, 0.0), (10.0, 1.0), (15.0, 0.5), (25.0, 1.5)]);
        assert!(loops.lacks("unloading").is_none() && loops.lacks("pause or two rates").is_some());
        let paused = holds(&[(0.0, 0.0), (10.0, 1.0), (60.0, 1.001), (70.0, 2.0)]);
        assert!(paused.lacks("pause or two rates").is_none() && paused.lacks("unloading").is_some());
        assert!(holds(&[(0.0, 0.0), (10.0, 1.0), (11.0, 2.0)]).lacks("pause or two rates").is_none());
    }
}
