//! The catalogue's columns at a fitted model: what each effect would add to the record per unit of
//! its amplitude, from one run with every effect at its neutral value.

mod run;
mod sizes;
mod with;

use crate::identify::AnalysisError;
use crate::problem::Cancelled;
use diagnose::{Amplitude, Candidate, ShapeColumns, Side};
use inverse::Prediction;
use model::{BuildError, Catalogue, Discretisation, Effect, Model, RunOptions, Scales, Screening, Sided};
use nalgebra::DMatrix;
use std::sync::Arc;

pub use sizes::scales;
pub(crate) use with::{case_with, config_of, config_with, transfer};

/// An effect that is tried at its neutral value, at one set of shape parameters.
struct Variant {
    effect: usize,
    /// Values of its parameters in its card's order.
    values: Vec<f64>,
    theta: Vec<f64>,
    /// θ index of its amplitude in its own model.
    amplitude: usize,
}

/// A candidate effect with the model that carries it.
struct Tried {
    effect: Arc<dyn Effect>,
    model: Model,
    names: Vec<String>,
    neutral: f64,
    plausible: f64,
    limits: (f64, f64),
    refit: bool,
    side: Side,
}

/// Base prediction, its jacobian, and the candidates' columns.
pub struct Screened {
    /// Prediction and jacobian by the base model's free parameters.
    pub prediction: Prediction,
    /// Candidates with raw columns.
    pub candidates: Vec<Candidate>,
    /// Forward runs of short refits (secants), counted apart.
    pub secant_runs: usize,
}

/// What the screen needs to know about the fitted base.
pub struct Base<'a> {
    /// Fitted model.
    pub model: &'a Model,
    /// Its values.
    pub theta: &'a [f64],
    /// Free parameters.
    pub free: &'a [usize],
    /// Catalogue.
    pub catalogue: &'a Catalogue,
    /// Discretisation of the fitted model.
    pub how: Discretisation,
    /// Options of its runs.
    pub options: RunOptions,
    /// Blocks of the prediction vector.
    pub slots: &'a [crate::DataBlock],
    /// First guesses per test from the fit; none where empty.
    pub warm: &'a [Option<fem::Warm>],
    /// Asked between steps.
    pub cancelled: Cancelled<'a>,
}

impl Base<'_> {
    /// Runs the base model once with all candidates' columns beside its own.
    ///
    /// # Errors
    /// [`AnalysisError`] when a model cannot be built or the base run does not reach the end.
    pub fn screen(&self) -> Result<Screened, AnalysisError> {
        let scales = scales(self.model, self.theta);
        let (tried, variants) = self.variants(&scales)?;
        let runs = self.run(&tried, &variants)?;
        let prediction = self.gather_base(&runs)?;
        let mut shapes: Vec<Vec<ShapeColumns>> = tried.iter().map(|_| Vec::new()).collect();
        for (offset, v) in (self.free.len()..).zip(&variants) {
            let t = &tried[v.effect];
            let column = self.gather_variant(&runs, t, v, offset)?;
            let parameters = t.names.iter().cloned().zip(v.values.iter().copied()).skip(1).collect();
            shapes[v.effect].push(ShapeColumns { parameters, columns: DMatrix::from_columns(&[column]) });
        }
        let mut secant_runs = 0;
        for (e, t) in tried.iter().enumerate().filter(|(_, t)| t.refit) {
            if let Some(shape) = self.secant(t, &scales, &prediction)? {
                shapes[e] = vec![shape];
            }
            secant_runs += 1;
        }
        let candidates = tried
            .iter()
            .zip(shapes)
            .map(|(t, shapes)| Candidate {
                effect: t.effect.card().name.to_owned(),
                amplitudes: vec![Amplitude {
                    name: t.names[0].clone(),
                    side: t.side,
                    plausible: t.plausible,
                    limits: t.limits,
                }],
                shapes,
                refit_only: t.refit,
            })
            .collect();
        Ok(Screened { prediction, candidates, secant_runs })
    }

    fn variants(&self, scales: &Scales) -> Result<(Vec<Tried>, Vec<Variant>), AnalysisError> {
        let present = self.model.effects();
        let (mut tried, mut variants): (Vec<Tried>, Vec<Variant>) = (Vec::new(), Vec::new());
        for effect in self.catalogue.iter() {
            let card = effect.card();
            let excluded = |a: &str| {
                card.excludes.contains(&a)
                    || self.catalogue.get(a).is_some_and(|e| e.card().excludes.contains(&card.name))
            };
            let tear = self.model.tests.iter().any(|t| t.test.kind.tears);
            if present.iter().any(|p| p == card.name || excluded(p))
                || (card.site == model::Site::Interface && !tear)
                || !self.catalogue.can_act(&**effect, &model::Options::new(), &self.model.case)
            {
                continue;
            }
            let specs = effect.parameters(&model::Options::new());
            let start = effect.start(scales);
            let neutral = specs[0].neutral.unwrap_or(0.0);
            let mut first = start.clone();
            first[0] = neutral;
            let model = self.with(effect, &first, true)?;
            let (refit, sided) = match card.screening {
                Screening::Score(s) => (false, s),
                Screening::Refit(s) => (true, s),
            };
            let names: Vec<String> = specs.iter().map(params::ParamSpec::key).collect();
            let offset = model.find(&format!("effects.{}.{}", card.name, specs[0].name));
            let Some(amplitude) = offset else { continue };
            if !refit {
                for values in effect.shapes(scales) {
                    let mut theta = transfer(self.model, self.theta, &model);
                    for (k, v) in values.iter().enumerate() {
                        theta[amplitude + k] = *v;
                    }
                    variants.push(Variant { effect: tried.len(), values, theta, amplitude });
                }
            }
            tried.push(Tried {
                effect: effect.clone(),
                model,
                names,
                neutral,
                plausible: start[0] - neutral,
                limits: (neutral - specs[0].lower, specs[0].upper - neutral),
                refit,
                side: if sided == Sided::Positive { Side::Positive } else { Side::Both },
            });
        }
        Ok((tried, variants))
    }

    fn with(&self, effect: &Arc<dyn Effect>, values: &[f64], neutral: bool) -> Result<Model, BuildError> {
        let case = case_with(&self.model.case, &[config_of(effect, values)]);
        // Columns live on the mesh of the model: its own effects may need the whole height.
        let breaks = |name: &String| self.catalogue.get(name).is_some_and(|e| e.card().breaks_half_height);
        let neutral_halves = neutral && !self.model.effects().iter().any(breaks);
        Model::new(Arc::new(case), self.catalogue, Discretisation { neutral_halves, ..self.how })
    }

    /// Finite change at a plausible amplitude, per unit: for effects whose derivative at neutral
    /// does not tell.
    fn secant(
        &self,
        t: &Tried,
        scales: &Scales,
        base: &Prediction,
    ) -> Result<Option<ShapeColumns>, AnalysisError> {
        let values = t.effect.start(scales);
        let model = self.with(&t.effect, &values, false)?;
        let theta = {
            let mut theta = transfer(self.model, self.theta, &model);
            let specs = t.effect.parameters(&model::Options::new());
            for (s, v) in specs.iter().zip(&values) {
                if let Some(i) = model.find(&format!("effects.{}.{}", t.effect.card().name, s.name)) {
                    theta[i] = *v;
                }
            }
            theta
        };
        let problem = crate::FeProblem::new(
            &model,
            theta.clone(),
            Vec::new(),
            self.slots,
            self.options,
            self.cancelled,
        );
        let runs = problem.run(&theta, &[])?;
        let Ok(p) = problem.gather(&runs, &theta, false) else { return Ok(None) };
        let column = (p.values - &base.values) / (values[0] - t.neutral);
        let parameters = t.names.iter().cloned().zip(values).skip(1).collect();
        Ok(Some(ShapeColumns { parameters, columns: DMatrix::from_columns(&[column]) }))
    }
}
