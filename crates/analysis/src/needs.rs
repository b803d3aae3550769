//! What the effects of a config need their records to hold.

use input::{Case, Layout, Location};
use model::{Catalogue, Corner, Effect, corners_of_record};

/// Travel below this share of a record's range is no leg of its own.
const STILL: f64 = 0.01;

/// Rates that differ by this factor are two.
const TWO_RATES: f64 = 1.3;

/// Where an effect stands in its file, and what its records lack.
pub type Need = (Location, String);

/// What the records of a case hold.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Holds {
    tests: usize,
    tearing: bool,
    clamped: bool,
    flat: bool,
    one_axis: bool,
    unloading: bool,
    pause: bool,
    /// Slowest and fastest leg, mm/s.
    rates: Option<(f64, f64)>,
}

impl Holds {
    fn of(case: &Case) -> Self {
        let mut holds = Self::default();
        for (test, record) in case.tests.iter().filter_map(|t| t.record.as_ref().map(|r| (t, r))) {
            holds.tests += 1;
            holds.tearing |= test.kind.tears;
            holds.clamped |= test.kind.clamped_faces;
            holds.one_axis |= !test.kind.two_axes;
            holds.flat |= test.kind.layout == Layout::Sheet;
            holds.add(&corners_of_record(record));
        }
        holds
    }

    fn add(&mut self, corners: &[Corner]) {
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
                let rate = travel.abs() / time;
                let (slowest, fastest) = self.rates.unwrap_or((rate, rate));
                self.rates = Some((slowest.min(rate), fastest.max(rate)));
            }
        }
    }

    fn two_rates(&self) -> bool {
        self.rates.is_some_and(|(slowest, fastest)| fastest > TWO_RATES * slowest)
    }

    /// What of the records an effect lacks, and what to add; `None` where a need is met.
    fn lacks(&self, need: &str) -> Option<(&'static str, &'static str)> {
        match need {
            model::TEARING if !self.tearing => Some(("no tearing test", "a tearing test")),
            model::CLAMPED_ENDS if !self.clamped => {
                Some(("no test between clamped ends", "a test between clamps at both ends"))
            }
            model::FLAT_SHEET if !self.flat => {
                Some(("no test in the plane of the piece", "a test in its plane"))
            }
            model::ONE_AXIS if !self.one_axis => {
                Some(("no test with one load train and one load cell", "a test with one actuator"))
            }
            "unloading" if !self.unloading => Some(("no unloading", "a partial unloading and a reloading")),
            "two tests" if self.tests < 2 => Some(("one test", "a second test of another kind")),
            TIME if !self.pause && !self.two_rates() => {
                Some(("no pause and one rate", "a hold, or a leg at another rate"))
            }
            _ => None,
        }
    }
}

/// The sentence on one effect whose record lacks something.
fn sentence(effect: &dyn Effect, holds: &str, add: &str) -> String {
    let card = effect.card();
    let rivals: Vec<String> = card.look_alikes.iter().map(|r| format!("`{r}`")).collect();
    let rivals = if rivals.is_empty() { "the base parameters".to_owned() } else { rivals.join(" or ") };
    format!("these records hold {holds}: `{}` cannot be told from {rivals}; add {add}", card.name)
}

/// What tells effects of time from each other.
const TIME: &str = "pause or two rates";

/// Effects of a case that its records cannot show (faults) or hardly tell from others (remarks): where each stands in
/// the file, and a sentence.
pub fn needs(case: &Case, catalogue: &Catalogue) -> (Vec<Need>, Vec<Need>) {
    let holds = Holds::of(case);
    let (mut faults, mut remarks) = (Vec::new(), Vec::new());
    for (config, effect) in case.effects.iter().filter_map(|e| catalogue.get(&e.name).map(|f| (e, f))) {
        let axis = effect.card().site.is_of_one_axis().then_some(&model::ONE_AXIS);
        for need in effect.card().needs.iter().chain(axis) {
            if let Some((what, add)) = holds.lacks(need) {
                // One rate still makes loops of unloading; without a tear there is nothing at all.
                let list = if *need == TIME { &mut remarks } else { &mut faults };
                list.push((config.location.clone(), sentence(&**effect, what, add)));
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
        let mut holds = Holds { tests: 1, clamped: true, flat: true, one_axis: true, ..Holds::default() };
        holds.add(&corners);
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

    #[test]
    fn what_the_records_lack_is_said_with_what_would_do() {
        let catalogue = effects::catalogue();
        let lag = catalogue.get("lag").expect("there is one");
        assert_eq!(
            sentence(&**lag, "one rate", "a hold"),
            "these records hold one rate: `lag` cannot be told from `viscoelastic` or `backlash`; add a hold"
        );
    }
}
