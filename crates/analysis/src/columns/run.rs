//! The run that carries all columns, and what each of them gets of it.

use super::{Base, Tried, Variant};
use crate::identify::AnalysisError;
use fem::sensitivity::{Chunk, Group};
use fem::{Run, State, Target, run_steps};
use inverse::Prediction;
use model::{LONG_REST, TestRun};
use nalgebra::DVector;
use std::sync::Arc;

impl Base<'_> {
    /// One run per test, in order, with all columns; bulk history carried over by every column.
    pub(super) fn run(
        &self,
        tried: &[Tried],
        variants: &[Variant],
    ) -> Result<Vec<Option<TestRun>>, AnalysisError> {
        let mut options = self.options;
        options.follow_holds = true;
        options.follow_turns = true;
        let mut out: Vec<Option<TestRun>> = (0..self.model.tests.len()).map(|_| None).collect();
        let mut before: Option<(State, Group, Vec<Chunk<1>>)> = None;
        let memoryless = self.model.tests.iter().all(|t| !t.has_memory());
        for (t, test) in self.model.tests.iter().enumerate() {
            let problem = Arc::new(test.problem(self.theta));
            let mut system = test.take_system(&problem)?;
            let mut base = Group::new(&problem, self.theta, self.free);
            let mut extra: Vec<Chunk<1>> = variants
                .iter()
                .map(|v| {
                    let p = Arc::new(tried[v.effect].model.tests[t].problem(&v.theta));
                    let c = Chunk::new(p, &v.theta, &[v.amplitude]);
                    if memoryless { c.with_direct_history() } else { c }
                })
                .collect();
            let fresh = test.test.fresh_piece;
            let before_this = before.take().filter(|_| !fresh);
            let initial = self.model.initial_state(&problem, test, before_this.as_ref().map(|b| &b.0));
            if let Some((_, b, e)) = &before_this {
                base.carry_bulk_from(b);
                extra.iter_mut().zip(e).for_each(|(c, o)| c.carry_bulk_from(o));
            }
            let plan = self.model.plan(t, &options);
            let mut targets = plan.targets.clone();
            if let (Some(first), true) = (targets.first_mut(), before_this.is_some()) {
                *first = Target { dt: test.test.rest_s.unwrap_or(LONG_REST), rest: true, ..*first };
            }
            let kept = self.warm.get(t).and_then(Option::as_ref);
            let warm = kept.map(|w| plan.guesses(&self.model.plan(t, &self.options), w));
            let camera = self.model.camera_at(t, self.theta);
            let mut columns = base.columns();
            columns.extend(extra.iter_mut().map(|c| c.columns()));
            let run = run_steps(
                &problem,
                self.theta,
                &mut system,
                Some(initial),
                &targets,
                &mut columns,
                &camera,
                options.stepping,
                warm.as_ref(),
                &|| self.cancelled.stops(),
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
        self.cancelled.ran(&out);
        Ok(out)
    }

    pub(super) fn gather_base(&self, runs: &[Option<TestRun>]) -> Result<Prediction, AnalysisError> {
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

    pub(super) fn gather_variant(
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
        Ok(DVector::from_vec(all))
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
                    reactions: d.reactions.iter().map(|r| cut(r)).collect(),
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
