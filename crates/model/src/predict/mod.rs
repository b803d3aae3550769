//! Runs the tests and predicts what the record holds, with derivatives.

mod channel;
mod series;

pub use channel::Channel;
pub use series::Series;

use crate::build::{BuildError, Model, TestModel};
use crate::camera::Camera;
use crate::plan::{Corner, Plan, Stepping, corners_of_protocol, corners_of_record, plan};
use fem::sensitivity::Group;
use fem::{History, Run, State, SteppingOptions, Target, Warm, run_steps};
use input::TestKind;
use rayon::prelude::*;
use std::sync::Arc;

/// Rest between two tests of a piece when the file gives none, s: viscous stresses are gone.
pub const LONG_REST: f64 = 1e9;

/// How tests are run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RunOptions {
    /// Finite-element options.
    pub stepping: SteppingOptions,
    /// Grid lines over the displacement range of a test that tears.
    pub tearing_steps: usize,
    /// Grid lines over the displacement range of a test in which nothing tears.
    pub uniaxial_steps: usize,
    /// Follow holds even if no law looks at time (the screen's effects may).
    pub follow_holds: bool,
    /// The same of the ways by a turn, if neither load train nor bulk remember them.
    pub follow_turns: bool,
}

impl Default for RunOptions {
    fn default() -> Self {
        Self {
            stepping: SteppingOptions::default(),
            tearing_steps: 48,
            uniaxial_steps: 20,
            follow_holds: false,
            follow_turns: false,
        }
    }
}

impl RunOptions {
    /// Grid lines over the displacement range of a test of this kind.
    pub fn steps(&self, kind: TestKind) -> usize {
        if kind.tears { self.tearing_steps } else { self.uniaxial_steps }
    }
}

/// The result of one test's run.
pub struct TestRun {
    /// Index of the test.
    pub test: usize,
    /// Steps asked for.
    pub plan: Plan,
    /// Steps made.
    pub run: Run,
    /// θ indices of the derivative columns.
    pub columns: Vec<usize>,
    /// History at the end, handed on to the next test of the piece.
    pub history: Vec<f64>,
}

/// Something to run a test with: the problem is taken at θ; columns follow `seeds`.
pub struct Request<'a> {
    /// All parameter values.
    pub theta: &'a [f64],
    /// θ indices to differentiate by.
    pub seeds: &'a [usize],
    /// Options.
    pub options: RunOptions,
    /// Which tests are wanted (earlier tests of a piece with memory are run all the same).
    pub wanted: &'a [bool],
    /// First guesses per test from an earlier run.
    pub warm: &'a [Option<Warm>],
    /// Asked between steps.
    pub cancelled: &'a (dyn Fn() -> bool + Sync),
}

impl Model {
    /// Corners of the actuator's motion in a test, from its record or protocol.
    pub fn corners(&self, test: usize) -> Vec<Corner> {
        let t = &self.tests[test].test;
        match (&t.record, &t.protocol) {
            (Some(r), _) => corners_of_record(r),
            (None, Some(legs)) => corners_of_protocol(legs),
            (None, None) => Vec::new(),
        }
    }

    /// The plan of an identification run.
    pub fn plan(&self, test: usize, options: &RunOptions) -> Plan {
        let t = &self.tests[test];
        let steps = options.steps(t.test.kind);
        let holds = options.follow_holds || t.rate_dependent();
        let turns = options.follow_turns || t.remembers_turns();
        plan(&self.corners(test), Stepping { steps, holds, turns })
    }

    /// Chains of tests that inherit each other's bulk history.
    pub fn chains(&self) -> Vec<Vec<usize>> {
        let mut chains: Vec<Vec<usize>> = Vec::new();
        for (i, t) in self.tests.iter().enumerate() {
            match chains.last_mut() {
                Some(last) if t.has_memory() && !t.test.fresh_piece => last.push(i),
                _ => chains.push(vec![i]),
            }
        }
        chains
    }

    /// Runs the wanted tests; independent chains in parallel. One entry per test, `None` where not
    /// wanted.
    ///
    /// # Errors
    /// [`BuildError`] from setting up a solver; a run that stops early is no error here.
    pub fn run(&self, request: &Request) -> Result<Vec<Option<TestRun>>, BuildError> {
        let chains = self.chains();
        let results: Vec<Result<Vec<TestRun>, BuildError>> = chains
            .par_iter()
            .map(|chain| {
                let last = chain.iter().rposition(|&t| request.wanted[t]);
                let Some(last) = last else { return Ok(Vec::new()) };
                self.run_chain(&chain[..=last], request)
            })
            .collect();
        let mut out: Vec<Option<TestRun>> = (0..self.tests.len()).map(|_| None).collect();
        for r in results {
            for t in r? {
                let at = t.test;
                out[at] = Some(t);
            }
        }
        Ok(out)
    }

    fn run_chain(&self, chain: &[usize], request: &Request) -> Result<Vec<TestRun>, BuildError> {
        let mut done = Vec::new();
        let mut before: Option<(State, Group)> = None;
        for &t in chain {
            let plan = self.plan(t, &request.options);
            let (run, state, group) = self.run_test(t, request, &plan, before.take())?;
            done.push(TestRun {
                test: t,
                run,
                plan,
                columns: request.seeds.to_vec(),
                history: state.history.bulk.clone(),
            });
            before = Some((state, group));
        }
        Ok(done)
    }

    /// The state a test starts from.
    pub fn initial_state(&self, problem: &fem::Problem, test: &TestModel, before: Option<&State>) -> State {
        let mut state = State::virgin(problem);
        if let Some(b) = before {
            state.history.bulk.clone_from(&b.history.bulk);
            state.time = b.time;
            if !test.test.remount {
                state.history.train.clone_from(&b.history.train);
            }
        }
        state
    }

    #[allow(clippy::type_complexity)]
    fn run_test(
        &self,
        t: usize,
        request: &Request,
        plan: &Plan,
        before: Option<(State, Group)>,
    ) -> Result<(Run, State, Group), BuildError> {
        let test = &self.tests[t];
        let problem = Arc::new(test.problem(request.theta));
        let mut system = test.take_system(&problem)?;
        let mut group = Group::new(&problem, request.theta, request.seeds);
        let initial = self.initial_state(&problem, test, before.as_ref().map(|b| &b.0));
        if let Some((_, old)) = &before {
            group.carry_bulk_from(old);
        }
        let mut targets = plan.targets.clone();
        if before.is_some()
            && let Some(first) = targets.first_mut()
        {
            *first = Target { dt: test.test.rest_s.unwrap_or(LONG_REST), rest: true, ..*first };
        }
        let camera = self.camera_at(t, request.theta);
        let mut columns = group.columns();
        let run = run_steps(
            &problem,
            request.theta,
            &mut system,
            Some(initial),
            &targets,
            &mut columns,
            &camera,
            request.options.stepping,
            request.warm.get(t).and_then(Option::as_ref),
            request.cancelled,
        );
        test.give_back(system);
        let state = run
            .last
            .clone()
            .unwrap_or_else(|| State { history: History::virgin(&problem), ..State::virgin(&problem) });
        Ok((run, state, group))
    }

    /// The camera with the thresholds of θ.
    pub fn camera_at(&self, t: usize, theta: &[f64]) -> Camera {
        let mut c = self.tests[t].camera(self.areas());
        c.critical = (0..c.critical.len()).map(|a| self.threshold(a, theta).0).collect();
        c.thresholds.clone_from(&c.critical);
        c.spent = self.softening_end(theta).unwrap_or(f64::INFINITY);
        if let Some(x) = self.tests[t].test.tear_front_opening {
            c.thresholds.fill(x);
        }
        c
    }

    /// δc of an area and its derivatives by (Gc, σc).
    fn threshold(&self, area: usize, theta: &[f64]) -> (f64, [f64; 2]) {
        self.critical_opening(area, theta).unwrap_or((f64::INFINITY, [0.0; 2]))
    }
}
