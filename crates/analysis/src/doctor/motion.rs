//! What the actuator did, in numbers and words.

use model::Corner;
use serde::Serialize;

/// Rates in this proportion are one rate.
const ONE_RATE: f64 = 1.3;
/// A hold at less than this share of the largest displacement is a rest.
const REST: f64 = 0.05;

/// Legs of a record.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Motion {
    /// Largest displacement, mm.
    pub to_mm: f64,
    /// Times the displacement turned from growing to falling.
    pub unloadings: usize,
    /// Holds, s each.
    pub holds_s: Vec<f64>,
    /// Holds near displacement 0, s each.
    pub rests_s: Vec<f64>,
    /// Slowest and fastest leg, mm/s.
    pub rates_mm_per_s: Option<[f64; 2]>,
}

impl Motion {
    /// From the corners of the motion and the rows they stand at.
    pub fn of(corners: &[(usize, Corner)]) -> Self {
        let mut motion =
            Self { to_mm: corners.iter().fold(0.0f64, |m, c| m.max(c.1.displacement)), ..Self::default() };
        let mut rising = false;
        for w in corners.windows(2) {
            let (a, b) = (w[0].1, w[1].1);
            let (travel, time) = (b.displacement - a.displacement, b.time - a.time);
            if travel == 0.0 {
                let rests = a.displacement.abs() < REST * motion.to_mm;
                if rests { &mut motion.rests_s } else { &mut motion.holds_s }.push(time);
                continue;
            }
            motion.unloadings += usize::from(rising && travel < 0.0);
            rising = travel > 0.0;
            let rate = travel.abs() / time;
            let [low, high] = motion.rates_mm_per_s.unwrap_or([rate; 2]);
            motion.rates_mm_per_s = Some([low.min(rate), high.max(rate)]);
        }
        motion
    }

    /// Whether it went at more than one rate.
    pub fn two_rates(&self) -> bool {
        self.rates_mm_per_s.is_some_and(|[low, high]| high > ONE_RATE * low)
    }

    /// `to 2.1 mm at 0.05 mm/s; 2 unloadings, 1 hold (60 s), no rest`.
    pub fn words(&self) -> String {
        let rates = match self.rates_mm_per_s {
            Some([low, high]) if self.two_rates() => format!("at {low:.3} to {high:.3} mm/s"),
            Some([_, high]) => format!("at {high:.3} mm/s"),
            None => "without motion".to_owned(),
        };
        let count = |n: usize, word: &str| match n {
            0 => format!("no {word}"),
            1 => format!("1 {word}"),
            n => format!("{n} {word}s"),
        };
        let times = |list: &[f64], word: &str| {
            let longest = list.iter().fold(0.0f64, |m, s| m.max(*s));
            let tail = if list.is_empty() { String::new() } else { format!(" (to {longest:.0} s)") };
            format!("{}{tail}", count(list.len(), word))
        };
        format!(
            "to {:.3} mm {rates}; {}, {}, {}",
            self.to_mm,
            count(self.unloadings, "unloading"),
            times(&self.holds_s, "hold"),
            times(&self.rests_s, "rest")
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_motion_is_told_in_words() {
        let legs = [
            (0.0, 0.0),
            (20.0, 1.0),
            (80.0, 1.0),
            (90.0, 0.5),
            (100.0, 1.0),
            (102.0, 1.5),
            (110.0, 0.0),
            (400.0, 0.0),
        ];
        let corners: Vec<(usize, Corner)> = legs
            .iter()
            .enumerate()
            .map(|(i, &(time, displacement))| (i, Corner { time, displacement }))
            .collect();
        let motion = Motion::of(&corners);
        assert_eq!(
            motion.words(),
            "to 1.500 mm at 0.050 to 0.250 mm/s; 2 unloadings, 1 hold (to 60 s), 1 rest (to 290 s)"
        );
        assert_eq!(
            Motion::of(&corners[..2]).words(),
            "to 1.000 mm at 0.050 mm/s; no unloading, no hold, no rest"
        );
    }
}
