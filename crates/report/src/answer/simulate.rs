//! The answer of `fct simulate`.

use super::SCHEMA;
use super::remarks::remarks;
use analysis::{Simulated, SimulatedTest};
use fem::Ledger;
use indexmap::IndexMap;
use serde::{Deserialize, Serialize};

/// Forward runs.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct SimulateAnswer {
    /// Layout version.
    pub schema: u32,
    /// Name of the specimen.
    pub specimen: String,
    /// Where the specimen's data come from.
    pub provenance: String,
    /// Effects in the model.
    pub effects: Vec<String>,
    /// Curves by test.
    pub tests: IndexMap<String, TestCurve>,
    /// What the solver did.
    pub solver: SolverAnswer,
    /// Meshes too coarse, steps too large.
    #[serde(default)]
    pub remarks: Vec<String>,
    /// Why the runs ended early, if they did.
    pub stopped_because: Option<String>,
}

/// One test's curves; one entry per step.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct TestCurve {
    /// Time since the start of the test, s.
    pub time_s: Vec<f64>,
    /// Actuator displacement, mm.
    pub displacement_mm: Vec<f64>,
    /// Load cell, N.
    pub force_N: Vec<f64>,
    /// Second actuator, mm; empty for a test with one axis.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub displacement_x_mm: Vec<f64>,
    /// Second load cell, N; empty for a test with one axis.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub force_x_N: Vec<f64>,
    /// Camera: change of distance between the clamped edges, mm.
    pub grip_displacement_mm: Vec<f64>,
    /// Camera: tear front, mm; empty for an intact strip.
    pub tear_front_mm: Vec<f64>,
    /// Camera: change of width, mm.
    pub width_change_mm: Vec<f64>,
    /// Jumps at a held actuator.
    pub jumps: Vec<JumpAnswer>,
    /// Energies at the end.
    pub energy: EnergyAnswer,
    /// Why the test ended early, if it did.
    pub stopped_because: Option<String>,
}

/// A jump at a held actuator.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct JumpAnswer {
    /// Actuator displacement, mm.
    pub displacement_mm: f64,
    /// Time since the start of the test, s.
    pub time_s: f64,
    /// Force before, N.
    pub force_before_N: f64,
    /// Force after, N.
    pub force_after_N: f64,
    /// Energy set free, N·mm.
    pub released_Nmm: f64,
}

/// The energy ledger at the end of a test, N·mm.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct EnergyAnswer {
    /// ∫F du at the actuator.
    pub external_work_Nmm: f64,
    /// Stored in the bulk.
    pub stored_Nmm: f64,
    /// Lost in the bulk.
    pub dissipated_bulk_Nmm: f64,
    /// Stored in the tear path.
    pub cohesive_recoverable_Nmm: f64,
    /// Lost in the tear path.
    pub cohesive_dissipated_Nmm: f64,
    /// Stored and lost in the load train.
    pub rig_Nmm: f64,
    /// Work of stiffness that changes in time.
    pub parametric_Nmm: f64,
    /// Set free in jumps.
    pub released_in_jumps_Nmm: f64,
    /// Largest gap of the ledger over the run, as a share of the external work.
    pub closure: f64,
}

/// What the solver did.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct SolverAnswer {
    /// Converged steps.
    pub steps: usize,
    /// Newton iterations.
    pub iterations: usize,
    /// Wall-clock time, s.
    pub seconds: f64,
}

impl SimulateAnswer {
    /// The answer of finished runs.
    pub fn new(simulated: &Simulated, seconds: f64) -> Self {
        let case = &simulated.model.case;
        Self {
            schema: SCHEMA,
            specimen: case.name.clone(),
            provenance: case.provenance.clone(),
            effects: simulated.model.effects(),
            tests: simulated.tests.iter().map(|t| (t.name.clone(), TestCurve::new(t))).collect(),
            solver: SolverAnswer { steps: simulated.steps(), iterations: simulated.iterations(), seconds },
            remarks: remarks(&simulated.tests),
            stopped_because: simulated.failure(),
        }
    }
}

impl TestCurve {
    fn new(t: &SimulatedTest) -> Self {
        let start =
            t.run.steps.first().map_or(0.0, |s| s.time) - t.plan.times.first().copied().unwrap_or(0.0);
        let jump = |j: &fem::Jump| JumpAnswer {
            displacement_mm: j.displacement,
            time_s: j.time - start,
            force_before_N: j.force_before,
            force_after_N: j.force_after,
            released_Nmm: j.released,
        };
        Self {
            time_s: t.time.clone(),
            displacement_mm: t.displacement.clone(),
            force_N: t.force.clone(),
            displacement_x_mm: t.across[0].clone(),
            force_x_N: t.across[1].clone(),
            grip_displacement_mm: t.grip_displacement.clone(),
            tear_front_mm: t.tear_front.clone(),
            width_change_mm: t.width_change.clone(),
            jumps: t.run.jumps.iter().map(jump).collect(),
            energy: EnergyAnswer::new(t),
            stopped_because: t.failure.clone(),
        }
    }
}

impl EnergyAnswer {
    /// The ledger at the last step of a run.
    pub fn new(t: &SimulatedTest) -> Self {
        let l = t.run.steps.last().map_or_else(Ledger::default, |s| s.ledger);
        Self {
            external_work_Nmm: l.external_work,
            stored_Nmm: l.stored,
            dissipated_bulk_Nmm: l.dissipated_bulk,
            cohesive_recoverable_Nmm: l.cohesive_recoverable,
            cohesive_dissipated_Nmm: l.cohesive_dissipated,
            rig_Nmm: l.rig,
            parametric_Nmm: l.parametric,
            released_in_jumps_Nmm: l.released_in_jumps,
            closure: t.closure,
        }
    }
}
