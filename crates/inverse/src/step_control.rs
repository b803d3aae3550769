//! How far a step goes.
//!
//! What a linear model misses grows with the square of a step's length l, its sum of squares with the
//! fourth power: a step is worth its predicted reduction less q l⁴, and every trial measures q. Damping itself says
//! little about length: in a sloppy valley the same damping stands for steps that differ tenfold, and
//! what the valley's curvature limits is the length. (Trust regions, Moré 1978, Numerical Analysis, Springer
//! LNM 630, control the length by a ratio alone; on a tear of this workspace q hardly changed while predicted reductions
//! fell by four orders, docs/performance.md.)

use crate::linalg::Reduced;
use crate::step::{Step, StepBox, bounded_step, length};
use nalgebra::DVector;

/// Dampings that are tried, as powers of ten: first, last, spacing.
const POWERS: (f64, f64, f64) = (-12.0, 6.0, 0.5);
/// How finely the best of them is found.
const FINEST: f64 = 0.1;
/// Share of the expected loss that is feared: a step that fails costs one run, steps that are too short
/// cost one each.
const FEAR: f64 = 0.3;
/// Longest next step after one that was taken, and after one that failed.
const GROWTH: f64 = 4.0;
const AFTER_FAILURE: f64 = 0.5;
/// The same where the model cannot be computed.
const AFTER_NO_ANSWER: f64 = 0.25;
/// Share of a predicted reduction from which on a step was as good as the linear model said.
const KEPT: f64 = 0.8;
/// q falls at most by this in such a step.
const EASING: f64 = 30.0;

/// What the trials so far say about the length of the next step.
pub(crate) struct StepControl {
    /// The damping of the last step.
    pub lambda: f64,
    /// q; none before the first trial.
    quartic: Option<f64>,
    /// Longest step.
    cap: f64,
}

impl StepControl {
    /// The first step is damped by `lambda`.
    pub fn new(lambda: f64) -> Self {
        Self { lambda, quartic: None, cap: f64::INFINITY }
    }

    /// The step that is worth most.
    pub fn step(&mut self, system: &Reduced, d: &DVector<f64>, space: &StepBox) -> Step {
        let Some(quartic) = self.quartic else {
            return bounded_step(system, d, self.lambda, space);
        };
        let worth = |power: f64| {
            let step = bounded_step(system, d, 10f64.powf(power), space);
            let far = length(&step.dz, d);
            let worth = if far <= self.cap { step.predicted - FEAR * quartic * far.powi(4) } else { -far };
            (worth, power, step)
        };
        let better = |a: (f64, f64, Step), b: (f64, f64, Step)| if b.0 > a.0 { b } else { a };
        let (first, last, mut spacing) = POWERS;
        let mut best = worth(first);
        for n in 1..=((last - first) / spacing) as usize {
            best = better(best, worth(first + spacing * n as f64));
        }
        while spacing > FINEST {
            spacing *= 0.5;
            let at = best.1;
            best = better(better(best, worth(at - spacing)), worth(at + spacing));
        }
        self.lambda = 10f64.powf(best.1);
        best.2
    }

    /// What a step of this length came to, `None` where the model cannot be computed at its end; a misfit whose square
    /// overflows is none either.
    pub fn learn(&mut self, predicted: f64, actual: Option<f64>, length: f64) {
        let Some(actual) = actual.filter(|a| a.is_finite()) else {
            self.cap = AFTER_NO_ANSWER * length;
            self.quartic.get_or_insert(0.0);
            return;
        };
        let measured = (predicted - actual).max(1e-4 * predicted) / length.powi(4);
        let failed = actual <= 0.0;
        self.quartic = Some(match self.quartic {
            None => measured,
            Some(q) if failed => measured.max((q * measured).sqrt()),
            Some(q) if actual > KEPT * predicted => measured.max(q / EASING),
            Some(q) => (q * measured).sqrt(),
        });
        self.cap = length * if failed { AFTER_FAILURE } else { GROWTH };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::DMatrix;

    /// One parameter whose undamped step is 2, with a predicted reduction of 4.
    fn one() -> (Reduced, DVector<f64>, StepBox) {
        let system = Reduced::new(&DMatrix::from_element(1, 1, 1.0), &DVector::from_element(1, 2.0));
        let space = StepBox { lower: DVector::from_element(1, -9.0), upper: DVector::from_element(1, 9.0) };
        (system, DVector::from_element(1, 1.0), space)
    }

    fn next(control: &mut StepControl) -> f64 {
        let (system, d, space) = one();
        control.step(&system, &d, &space).dz[0]
    }

    fn close(a: f64, b: f64, relative: f64) {
        assert!((a / b - 1.0).abs() <= relative, "{a} {b}");
    }

    #[test]
    fn the_first_step_is_damped_as_told() {
        close(next(&mut StepControl::new(3.0)), 2.0 / 4.0, 1e-12);
    }

    #[test]
    fn a_step_is_worth_its_prediction_less_what_the_fourth_power_takes() {
        let mut control = StepControl::new(1.0);
        // A step of length 1 predicted 2 and gave 1: q = 1, and x of 4 x − x² − 0.3 x⁴ is largest where 4 − 2 x = 1.2 x³.
        control.learn(2.0, Some(1.0), 1.0);
        let x = next(&mut control);
        close(4.0 - 2.0 * x, 1.2 * x.powi(3), 0.1);
        close(control.lambda, 2.0 / x - 1.0, 1e-9);
        // The search between dampings is finer than a tenth of a power of ten.
        let worth = |x: f64| 4.0 * x - x * x - 0.3 * x.powi(4);
        for factor in [0.85, 1.15] {
            assert!(worth(2.0 / (1.0 + control.lambda * factor)) < worth(x) + 2e-3);
        }
    }

    #[test]
    fn a_length_is_capped_by_what_the_last_trial_came_to() {
        let after = |predicted: f64, actual: Option<f64>, length: f64| {
            let mut control = StepControl::new(1.0);
            control.learn(predicted, actual, length);
            (control.cap, next(&mut control))
        };
        assert_eq!(after(1.0, Some(1.0), 0.1).0, 0.4);
        assert_eq!(after(1.0, Some(-1.0), 0.1).0, 0.05);
        assert_eq!(after(1.0, Some(0.0), 0.1).0, 0.05);
        for (told, cap) in [(None, 0.025), (Some(f64::NAN), 0.025), (Some(f64::NEG_INFINITY), 0.025)] {
            let (found, step) = after(1.0, told, 0.1);
            assert_eq!(found, cap);
            // Nothing is known but the cap: as long as it allows.
            assert!(step <= cap && step > 0.7 * cap, "{step}");
        }
    }

    #[test]
    fn what_a_trial_lost_moves_q_as_far_as_it_is_trusted() {
        let q = |trials: &[(f64, f64, f64)]| {
            let mut control = StepControl::new(1.0);
            trials
                .iter()
                .for_each(|&(predicted, actual, length)| control.learn(predicted, Some(actual), length));
            control.quartic.unwrap_or(f64::NAN)
        };
        let half = (1.0, 0.5, 0.5);
        assert_eq!(q(&[half]), 8.0);
        // Nothing is lost: next to nothing is believed of that at once.
        assert_eq!(q(&[(1.0, 1.5, 1.0)]), 1e-4);
        assert_eq!(q(&[half, (1.0, 1.0, 0.5)]), 8.0 / 30.0);
        // As good as predicted, but short: what it lost counts whole.
        close(q(&[half, (1.0, 0.85, 0.1)]), 1500.0, 1e-12);
        close(q(&[half, (1.0, 0.5, 1.0)]), 2.0, 1e-12);
        // A failure raises q at once, by the mean of powers at least.
        close(q(&[half, (1.0, -1.0, 0.5)]), 32.0, 1e-12);
        close(q(&[half, (1.0, -1.0, 1.0)]), 4.0, 1e-12);
    }

    #[test]
    fn what_cannot_be_computed_forgets_nothing() {
        let mut control = StepControl::new(1.0);
        control.learn(1.0, Some(0.5), 0.5);
        control.learn(1.0, None, 0.4);
        assert_eq!((control.quartic, control.cap), (Some(8.0), 0.1));
    }
}
