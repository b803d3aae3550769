//! A toy model with memory of nothing but a protocol, and toy effects, fitted with `inverse`.
#![allow(missing_docs)]

use diagnose::atlas::structure_p;
use diagnose::{
    Amplitude, Candidate, Hints, Ladder, Rung, Screen, ShapeColumns, Side, holdout, screen, segments,
};
use inverse::*;
use nalgebra::{DMatrix, DVector};
use params::Transform;
use std::ops::ControlFlow;

const SD: f64 = 0.01;
const EFFECTS: [(&str, Side, f64); 7] = [
    ("memory", Side::Positive, 0.2),
    ("drift", Side::Both, 0.01),
    ("softening", Side::Positive, 0.1),
    ("rate", Side::Both, 0.05),
    ("kink", Side::Both, 0.2),
    ("twin_kink", Side::Both, 0.2),
    ("stiffer", Side::Positive, 0.3),
];
const TAUS: [f64; 5] = [0.5, 1.5, 4.0, 10.0, 25.0];

pub struct Protocol {
    t: Vec<f64>,
    u: Vec<f64>,
    reached: Vec<f64>,
    rate: Vec<f64>,
}

pub fn protocol() -> Protocol {
    let steps = [
        (0.1, 40),
        (0.0, 40),
        (-0.1, 30),
        (0.1, 40),
        (0.5, 12),
        (0.0, 40),
        (-0.1, 40),
        (0.1, 60),
        (-0.3, 30),
    ];
    let (mut t, mut u, mut rate) = (vec![0.0], vec![0.0], vec![0.1]);
    for (v, n) in steps {
        for _ in 0..n {
            t.push(t[t.len() - 1] + 0.25);
            u.push(u[u.len() - 1] + 0.25 * v);
            rate.push(v);
        }
    }
    let mut top = 0.0f64;
    let reached = u
        .iter()
        .map(|&x| {
            top = top.max(x);
            top
        })
        .collect();
    Protocol { t, u, reached, rate }
}

impl Protocol {
    /// d(force)/d(amplitude) of an effect; `tau` is memory's shape.
    fn column(&self, effect: &str, tau: f64) -> DVector<f64> {
        let n = self.t.len();
        match effect {
            "memory" => {
                let mut slow = 0.0;
                DVector::from_fn(n, |i, _| {
                    if i > 0 {
                        let dt = self.t[i] - self.t[i - 1];
                        slow += (1.0 - (-dt / tau).exp()) * (self.u[i] - slow);
                    }
                    self.u[i] - slow
                })
            }
            "drift" => DVector::from_fn(n, |i, _| self.t[i]),
            "softening" => DVector::from_fn(n, |i, _| -(self.reached[i] - self.u[i]) * self.u[i]),
            "rate" => DVector::from_fn(n, |i, _| (1.0 + self.rate[i].abs() / 0.1).ln() * self.u[i]),
            "kink" => DVector::from_fn(n, |i, _| (self.u[i] - 1.0).max(0.0)),
            "twin_kink" => DVector::from_fn(n, |i, _| (self.u[i] - 1.01).max(0.0)),
            "stiffer" => DVector::from_fn(n, |i, _| self.u[i] + 0.5 * self.u[i].powi(3)),
            _ => DVector::from_fn(n, |i, _| (9.0 * self.u[i]).sin()),
        }
    }

    fn base(&self, p: &[f64]) -> DVector<f64> {
        DVector::from_fn(self.t.len(), |i, _| p[0] * self.u[i] + p[1] * self.u[i].powi(3))
    }
}

/// A noisy record with the given effects and amplitudes.
pub fn record(truth: &[(&str, f64)], seed: u64) -> DVector<f64> {
    let p = protocol();
    let mut y = p.base(&[1.0, 0.4]);
    for (effect, a) in truth {
        y += p.column(effect, 3.0) * *a;
    }
    y + Random::new(seed + 100).normals(p.t.len()) * SD
}

/// Base model and chosen effects as a problem; parameters a, b, then each effect's amplitude (and memory's tau).
struct Model<'a>(&'a Protocol, &'a [String]);

impl Problem for Model<'_> {
    fn predict(&self, theta: &[f64], _: bool) -> Result<Prediction, PredictError> {
        let n = self.0.t.len();
        let mut values = self.0.base(theta);
        let mut columns =
            vec![DVector::from_fn(n, |i, _| self.0.u[i]), DVector::from_fn(n, |i, _| self.0.u[i].powi(3))];
        let mut at = 2;
        for e in self.1 {
            let memory = e == "memory";
            let tau = if memory { theta[at + 1] } else { 1.0 };
            let s = self.0.column(e, tau);
            values.axpy(theta[at], &s, 1.0);
            columns.push(s);
            if memory {
                let h = 1e-5 * tau;
                let slope = (self.0.column(e, tau + h) - self.0.column(e, tau - h)) / (2.0 * h);
                columns.push(slope * theta[at]);
            }
            at += if memory { 2 } else { 1 };
        }
        Ok(Prediction::new(values, Some(DMatrix::from_columns(&columns))))
    }
}

pub struct ToyLadder {
    protocol: Protocol,
    y: DVector<f64>,
    pub unfittable: Option<String>,
    pub fits_allowed: usize,
    fits: usize,
}

impl ToyLadder {
    pub fn new(y: DVector<f64>) -> Self {
        Self { protocol: protocol(), y, unfittable: None, fits_allowed: usize::MAX, fits: 0 }
    }

    fn data(&self) -> Data {
        let y = self.y.iter().copied().collect();
        Data::from_parts([("toy".to_owned(), y, NoiseModel::white(SD))]).expect("data")
    }

    fn free(effects: &[String], hints: &Hints) -> Vec<Free> {
        let mut free = vec![
            Free::new("a", (1e-3, 1e2), Transform::Log, 0.7),
            Free::new("b", (1e-3, 1e2), Transform::Log, 0.7),
        ];
        for e in effects {
            let (_, side, plausible) = EFFECTS.iter().find(|x| x.0 == e).expect("known");
            let lower = if *side == Side::Positive { 0.0 } else { -10.0 };
            let hint = hints.get(e);
            let start = hint.map_or(*plausible, |h| h.amplitudes[0].1);
            free.push(Free::new(e.clone(), (lower, 10.0), Transform::Identity, start));
            if e == "memory" {
                let tau = hint.and_then(|h| h.shape.first()).map_or(2.0, |s| s.1);
                free.push(Free::new("tau", (0.1, 100.0), Transform::Log, tau));
            }
        }
        free
    }

    fn fit_on(&self, data: &Data, effects: &[String], hints: &Hints) -> Result<(Vec<Free>, Fit), FitError> {
        let free = Self::free(effects, hints);
        let model = Model(&self.protocol, effects);
        let end = fit(&model, data, &free, &FitOptions::default(), &mut |_| ControlFlow::Continue(()))?;
        Ok((free, end))
    }
}

impl Ladder for ToyLadder {
    type Error = String;

    fn fit(&mut self, effects: &[String], hints: &Hints) -> Result<Rung, String> {
        self.fits += 1;
        if let Some(bad) = self.unfittable.as_ref().filter(|b| effects.contains(b)) {
            return Err(format!("{bad} diverges"));
        }
        let mut data = self.data();
        let (free, end) = self.fit_on(&data, effects, hints).map_err(|e| e.to_string())?;
        let q = quality(&data, &free, &end);
        let white = Whitened::new(&data, &free, &end.theta, &end.prediction, Noise::Total);
        let p = &self.protocol;
        let cut = segments::cut(&p.t, &p.u, self.y.as_slice(), diagnose::RecordKind::Intact);
        let held = holdout::split(&cut, p.t.len(), 0.25);
        data.held_out = held.mask.clone();
        let (_, trained) = self.fit_on(&data, effects, hints).map_err(|e| e.to_string())?;
        let misfit = self.data().misfit(&trained.prediction.values);
        let outside: Vec<f64> = (0..misfit.len()).filter(|&i| held.mask[i]).map(|i| misfit[i]).collect();
        let rms_out = rms(outside.iter().copied());
        Ok(Rung::new(effects, &q, q.blocks[0].rms, structure_p(white.r.as_slice())).held_out(
            (rms_out / SD).powi(2),
            outside.len(),
            rms_out,
        ))
    }

    fn screen(&mut self, rung: &Rung) -> Result<Screen, String> {
        let data = self.data();
        let (free, end) = self.fit_on(&data, &rung.effects, &Hints::new()).map_err(|e| e.to_string())?;
        let white = Whitened::new(&data, &free, &end.theta, &end.prediction, Noise::Total);
        let candidates: Vec<Candidate> = EFFECTS
            .iter()
            .filter(|(e, _, _)| !rung.effects.contains(&(*e).to_owned()))
            .map(|&(effect, side, plausible)| {
                let shapes: &[f64] = if effect == "memory" { &TAUS } else { &[1.0] };
                Candidate {
                    effect: effect.into(),
                    amplitudes: vec![Amplitude {
                        name: "amount".into(),
                        side,
                        plausible,
                        limits: (f64::INFINITY, f64::INFINITY),
                    }],
                    shapes: shapes
                        .iter()
                        .map(|&tau| ShapeColumns {
                            parameters: if effect == "memory" { vec![("tau".into(), tau)] } else { vec![] },
                            columns: DMatrix::from_columns(&[self.protocol.column(effect, tau)]),
                        })
                        .collect(),
                    refit_only: false,
                }
            })
            .collect();
        let policy = diagnose::Policy { draws: 2000, ..Default::default() };
        screen(&white, &end.at_bound, &candidates, self.y.len(), &policy).map_err(|e| e.to_string())
    }

    fn interrupted(&self) -> bool {
        self.fits >= self.fits_allowed
    }
}
