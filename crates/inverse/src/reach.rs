//! How far a step goes.
//!
//! What a linear model misses grows with the square of a step's length l, its sum of squares with the
//! fourth power: a step is worth its promise less q l⁴, and every trial measures q. Damping itself says
//! little about length: in a sloppy valley the same damping stands for steps that differ tenfold, and
//! what the valley's bend limits is the length. (Trust regions, Moré 1978, Numerical Analysis, Springer
//! LNM 630, control the length by a ratio alone; on a tear of this workspace q hardly changed while promises
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
/// Share of a promise from which on a step was as good as the linear model said.
const KEPT: f64 = 0.8;
/// q falls at most by this in such a step.
const EASING: f64 = 30.0;

/// What the trials so far say about the length of the next step.
pub(crate) struct Reach {
    /// The damping of the last step.
    pub lambda: f64,
    /// q; none before the first trial.
    quartic: Option<f64>,
    /// Longest step.
    cap: f64,
}

impl Reach {
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
            let worth = if far <= self.cap { step.fall - FEAR * quartic * far.powi(4) } else { -far };
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
    pub fn learn(&mut self, promise: f64, actual: Option<f64>, length: f64) {
        let Some(actual) = actual.filter(|a| a.is_finite()) else {
            self.cap = AFTER_NO_ANSWER * length;
            self.quartic.get_or_insert(0.0);
            return;
        };
        let measured = (promise - actual).max(1e-4 * promise) / length.powi(4);
        let failed = actual <= 0.0;
        self.quartic = Some(match self.quartic {
            None => measured,
            Some(q) if failed => measured.max((q * measured).sqrt()),
            Some(q) if actual > KEPT * promise => measured.max(q / EASING),
            Some(q) => (q * measured).sqrt(),
        });
        self.cap = length * if failed { AFTER_FAILURE } else { GROWTH };
    }
}
