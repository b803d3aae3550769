//! Whether a fit may still come to what another start has come to.

use super::fit::STEPS;

/// The objectives of a fit's accepted steps, and what it must come below to be of use.
pub(super) struct Pace {
    below: f64,
    last: Option<f64>,
    falls: [f64; 2],
}

impl Pace {
    /// Of a fit that is of use below that objective.
    pub fn below(below: f64) -> Self {
        Self { below, last: None, falls: [f64::INFINITY; 2] }
    }

    /// Whether the fit would stay above even if each step that is left lowered the objective as much as the better of the last
    /// two did. `f`: the objective after that step.
    pub fn too_slow(&mut self, step: usize, f: f64) -> bool {
        if let Some(last) = self.last.replace(f) {
            self.falls = [self.falls[1], last - f];
        }
        let left = STEPS.saturating_sub(step) as f64;
        f - left * self.falls[0].max(self.falls[1]) > self.below
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The step after which a fit through these objectives is left.
    fn left_after(below: f64, course: &[f64]) -> Option<usize> {
        let mut pace = Pace::below(below);
        (course.iter().enumerate()).find_map(|(step, &f)| pace.too_slow(step, f).then_some(step))
    }

    #[test]
    fn a_fit_goes_on_while_its_pace_would_bring_it_there() {
        let there = 10.0;
        // Two short steps in a row, not one: a jump may lie between.
        assert_eq!(left_after(there, &[1000.0, 999.0, 998.0]), Some(2));
        assert_eq!(left_after(there, &[1000.0, 999.0, 500.0, 499.0, 498.0]), Some(4));
        // 22 steps left of 24: 44.5 a step do not do from 1000, 45.5 do.
        assert_eq!(left_after(there, &[1089.0, 1044.5, 1000.0]), Some(2));
        assert_eq!(left_after(there, &[1090.0, 1045.5, 1000.0]), None);
        // Below, however slow; and where there is nothing to come below of.
        assert_eq!(left_after(there, &[9.0, 9.0, 9.0, 9.0]), None);
        assert_eq!(left_after(f64::INFINITY, &[1000.0, 1000.0, 1000.0]), None);
    }
}
