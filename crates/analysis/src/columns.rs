//! The catalogue's columns at a fitted model: what each effect would add to the record per unit of
//! its amplitude, from one run with every effect at its neutral value.

use crate::identify::AnalysisError;
use crate::problem::Cancelled;
use diagnose::{Amplitude, Candidate, Shape, Side};
use fem::sensitivity::{Chunk, Columns};
use fem::{Run, State, Target, march};
use input::{Case, EffectConfig, TestKind, Value};
use inverse::Prediction;
use model::{
    BuildError, Catalogue, Channel, Discretisation, Effect, LONG_REST, Model, RunOptions, Scales, Screening,
    Sided, TestRun,
};
use nalgebra::{DMatrix, DVector};
use std::sync::Arc;

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

/// Sizes from which starts and shape grids are taken.
pub fn scales(model: &Model, theta: &[f64]) -> Scales {
    let mut s = Scales {
        peak_force: 0.0,
        uniaxial_peak: 0.0,
        displacement: 0.0,
        uniaxial_displacement: 0.0,
        duration: 0.0,
        sampling: 1.0,
        energy: 0.0,
        delta_c: 0.5,
        sigma_c: 0.2,
        opening_rate: 0.05,
        fibre_strain: 0.1,
    };
    let mut speed = 0.05;
    for t in &model.tests {
        let Some(r) = &t.test.record else { continue };
        let peak = r.force.iter().fold(0.0f64, |m, f| m.max(f.abs()));
        let far = r.displacement.iter().fold(0.0f64, |m, u| m.max(u.abs()));
        s.peak_force = s.peak_force.max(peak);
        s.displacement = s.displacement.max(far);
        if t.test.kind == TestKind::Uniaxial {
            s.uniaxial_peak = s.uniaxial_peak.max(peak);
            s.uniaxial_displacement = s.uniaxial_displacement.max(far);
        }
        let duration = r.time[r.time.len() - 1] - r.time[0];
        s.duration = s.duration.max(duration);
        s.sampling = duration / r.time.len() as f64;
        let mut speeds: Vec<f64> = (1..r.time.len())
            .map(|i| ((r.displacement[i] - r.displacement[i - 1]) / (r.time[i] - r.time[i - 1])).abs())
            .collect();
        speeds.sort_by(f64::total_cmp);
        speed = speeds[speeds.len() / 2].max(1e-9);
    }
    if s.uniaxial_peak == 0.0 {
        (s.uniaxial_peak, s.uniaxial_displacement) = (s.peak_force, s.displacement);
    }
    let g = &model.case.geometry;
    // Energy of the uniaxial test per volume: half of peak force times displacement is an upper
    // bound for a stiffening curve; a third is typical.
    s.energy = s.uniaxial_peak * s.uniaxial_displacement / (3.0 * g.length * g.width * g.thickness);
    s.opening_rate = speed;
    let stretch = 1.0 + s.uniaxial_displacement / g.length;
    s.fibre_strain = (stretch * stretch - 1.0) * 0.5;
    let middle = model.areas().div_ceil(2);
    let at = |what: &str| model.find(&format!("interface.area[{middle}].{what}")).map(|i| theta[i]);
    if let (Some(gc), Some(sc)) = (at("gc"), at("sigma_c")) {
        s.sigma_c = sc;
        s.delta_c = gc / (std::f64::consts::E * sc);
    }
    s
}

/// A case with the parameter values of a model written into it, and more effects.
pub fn case_with(case: &Case, effects: &[EffectConfig]) -> Case {
    let mut c = case.clone();
    c.effects.extend(effects.iter().cloned());
    c
}

/// The configuration of an effect at given values (card order).
pub fn config_of(effect: &Arc<dyn Effect>, values: &[f64]) -> EffectConfig {
    config_with(effect, &model::Options::new(), values)
}

/// The same with settings of the effect.
pub fn config_with(effect: &Arc<dyn Effect>, settings: &model::Options, values: &[f64]) -> EffectConfig {
    let specs = effect.parameters(settings);
    let mut options: model::Options =
        effect.options().into_iter().filter_map(|o| o.default.map(|d| (o.name, d))).collect();
    options.extend(settings.clone());
    EffectConfig {
        name: effect.card().name.to_owned(),
        parameters: specs.iter().zip(values).map(|(s, &v)| (s.name.to_string(), Value::new(v))).collect(),
        specs,
        options,
        location: input::Location::default(),
    }
}

/// θ of `to`, taking values by path from `from`.
pub fn transfer(from: &Model, theta: &[f64], to: &Model) -> Vec<f64> {
    to.parameters.iter().map(|p| from.find(&p.path).map_or(p.value, |i| theta[i])).collect()
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
    pub slots: &'a [crate::Slot],
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
        let mut shapes: Vec<Vec<Shape>> = tried.iter().map(|_| Vec::new()).collect();
        for (offset, v) in (self.free.len()..).zip(&variants) {
            let t = &tried[v.effect];
            let column = self.gather_variant(&runs, t, v, offset)?;
            let parameters = t.names.iter().cloned().zip(v.values.iter().copied()).skip(1).collect();
            shapes[v.effect].push(Shape { parameters, columns: DMatrix::from_columns(&[column]) });
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
            let tear = self.model.tests.iter().any(|t| t.test.kind == TestKind::Tearing);
            if present.iter().any(|p| p == card.name || excluded(p))
                || (card.site == model::Site::Interface && !tear)
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
        Model::new(Arc::new(case), self.catalogue, Discretisation { neutral_halves: neutral, ..self.how })
    }

    /// One run per test, in order, with all columns; bulk history carried by every column.
    fn run(&self, tried: &[Tried], variants: &[Variant]) -> Result<Vec<Option<TestRun>>, AnalysisError> {
        let mut options = self.options;
        options.follow_holds = true;
        let mut out: Vec<Option<TestRun>> = (0..self.model.tests.len()).map(|_| None).collect();
        let mut before: Option<(State, Vec<Chunk<8>>, Vec<Chunk<1>>)> = None;
        let memoryless = self.model.tests.iter().all(|t| !t.has_memory());
        for (t, test) in self.model.tests.iter().enumerate() {
            let problem = Arc::new(test.problem(self.theta));
            let mut system = test.take_system(&problem)?;
            let mut base = fem::sensitivity::columns_for(&problem, self.theta, self.free);
            let mut extra: Vec<Chunk<1>> = variants
                .iter()
                .map(|v| {
                    let p = Arc::new(tried[v.effect].model.tests[t].problem(&v.theta));
                    let c = Chunk::new(p, &v.theta, &[v.amplitude]);
                    if memoryless { c.with_direct_history() } else { c }
                })
                .collect();
            let fresh = test.test.fresh_piece;
            let carried = before.take().filter(|_| !fresh);
            let initial = self.model.initial_state(&problem, test, carried.as_ref().map(|b| &b.0));
            if let Some((_, b, e)) = &carried {
                base.iter_mut().zip(b).for_each(|(c, o)| c.carry_bulk_from(o));
                extra.iter_mut().zip(e).for_each(|(c, o)| c.carry_bulk_from(o));
            }
            let plan = self.model.plan(t, &options);
            let mut targets = plan.targets.clone();
            if let (Some(first), true) = (targets.first_mut(), carried.is_some()) {
                *first = Target { dt: test.test.rest_s.unwrap_or(LONG_REST), rest: true, ..*first };
            }
            let kept = self.warm.get(t).and_then(Option::as_ref);
            let warm = kept.map(|w| plan.guesses(&self.model.plan(t, &self.options), w));
            let camera = self.model.camera_at(t, self.theta);
            let mut columns: Vec<&mut (dyn Columns + 'static)> = Vec::new();
            columns.extend(base.iter_mut().map(|c| c as &mut (dyn Columns + 'static)));
            columns.extend(extra.iter_mut().map(|c| c as &mut (dyn Columns + 'static)));
            let run = march(
                &problem,
                self.theta,
                &mut system,
                Some(initial),
                &targets,
                &mut columns,
                &camera,
                options.march,
                warm.as_ref(),
                self.cancelled,
            );
            test.give_back(system);
            let state = run.last.clone().unwrap_or_else(|| State::virgin(&problem));
            out[t] = Some(TestRun {
                test: t,
                plan,
                run,
                columns: self.free.to_vec(),
                history: state.history.bulk.clone(),
            });
            before = Some((state, base, extra));
        }
        Ok(out)
    }

    fn gather_base(&self, runs: &[Option<TestRun>]) -> Result<Prediction, AnalysisError> {
        let k = self.free.len();
        let own: Vec<Option<TestRun>> =
            runs.iter().map(|r| r.as_ref().map(|r| restricted(r, 0..k, self.free))).collect();
        let problem = crate::FeProblem::new(
            self.model,
            self.theta.to_vec(),
            self.free.to_vec(),
            self.slots,
            self.options,
            self.cancelled,
        );
        Ok(problem.gather(&own, self.theta, true)?)
    }

    fn gather_variant(
        &self,
        runs: &[Option<TestRun>],
        t: &Tried,
        v: &Variant,
        column: usize,
    ) -> Result<DVector<f64>, AnalysisError> {
        let own: Vec<Option<TestRun>> = runs
            .iter()
            .map(|r| r.as_ref().map(|r| restricted(r, column..column + 1, &[v.amplitude])))
            .collect();
        let mut all = Vec::new();
        for slot in self.slots {
            let Some(run) = &own[slot.test] else { continue };
            let series = t
                .model
                .series(run, &v.theta, slot.channel)
                .map_err(|e| AnalysisError::Case(e.to_string()))?;
            all.extend(series.derivatives);
        }
        let _ = Channel::Force;
        Ok(DVector::from_vec(all))
    }

    /// Finite change at a plausible amplitude, per unit: for effects whose derivative at neutral
    /// does not tell.
    fn secant(&self, t: &Tried, scales: &Scales, base: &Prediction) -> Result<Option<Shape>, AnalysisError> {
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
        Ok(Some(Shape { parameters, columns: DMatrix::from_columns(&[column]) }))
    }
}

/// A run seen with only some of its columns.
fn restricted(r: &TestRun, columns: std::ops::Range<usize>, ids: &[usize]) -> TestRun {
    let cut = |v: &[f64]| v.get(columns.clone()).map_or_else(Vec::new, <[f64]>::to_vec);
    let steps = r
        .run
        .steps
        .iter()
        .map(|s| {
            let d = &s.derivatives;
            fem::StepRecord {
                derivatives: fem::sensitivity::StepDerivatives {
                    force: cut(&d.force),
                    grip: cut(&d.grip),
                    actuator: cut(&d.actuator),
                    extra: d.extra.iter().map(|e| cut(e)).collect(),
                },
                ..s.clone()
            }
        })
        .collect();
    TestRun {
        test: r.test,
        plan: r.plan.clone(),
        run: Run { steps, failure: r.run.failure.clone(), ..Run::default() },
        columns: ids.to_vec(),
        history: Vec::new(),
    }
}
