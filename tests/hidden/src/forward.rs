//! Forward runs of the generator: a probe that finds how far to pull, and the records themselves, on meshes,
//! steps and integration points that the identification does not use.

use crate::GenerateError;
use crate::draw::between;
use crate::foreign::ForeignLaw;
use crate::outside::SutureEffect;
use crate::protocol::Extent;
use analysis::{DataBlock, FeProblem, SimulateControl, simulate};
use input::{Case, EffectConfig, Integration, Leg, Location, Record, Value};
use inverse::Random;
use model::{Catalogue, Channel, Discretisation, Model, Options, RunOptions};
use nalgebra::DVector;
use std::sync::Arc;

/// The catalogue of the generator: the product's, and the laws that the product does not know.
pub fn catalogue() -> Catalogue {
    ForeignLaw::all().fold(effects::catalogue().with(Arc::new(SutureEffect)), |c, law| c.with(Arc::new(law)))
}

/// How the records' user will fit them: coarsely, so that a case takes seconds.
#[derive(Clone, Copy, Debug)]
pub struct Fit {
    /// Element size away from the path, mm.
    pub bulk: f64,
    /// Element size along the path, mm.
    pub path: f64,
    /// Areas of the tear path, of the truth too.
    pub areas: usize,
}

/// How finely records are computed, and how coarsely they are to be fitted.
#[derive(Clone, Copy, Debug)]
pub struct Fineness {
    /// What the strips are, in the title of the page.
    pub strips: &'static str,
    /// The fit.
    pub fit: Fit,
    /// Element size away from the path, mm.
    pub bulk: f64,
    /// Element size along the path, mm.
    pub path: f64,
    /// Elements through the thickness.
    pub layers: usize,
    /// Grid lines of displacement in the tearing test (the intact strip gets half).
    pub steps: usize,
}

impl Fineness {
    /// For the study.
    pub const STUDY: Self = Self {
        strips: "",
        fit: Fit { bulk: 0.9, path: 0.25, areas: 4 },
        bulk: 0.55,
        path: 0.14,
        layers: 2,
        steps: 74,
    };
    /// A study of many records: what a record shows is seen on small meshes, too, in a tenth of the time.
    pub const SMALL: Self = Self {
        strips: ": small strips",
        fit: Fit { bulk: 1.4, path: 0.5, areas: 2 },
        bulk: 0.9,
        path: 0.3,
        layers: 1,
        steps: 48,
    };
    /// For the tests: still another mesh than the fit's, but quick.
    pub const QUICK: Self = Self {
        strips: ": the quick ones",
        fit: Fit { bulk: 1.4, path: 0.5, areas: 1 },
        bulk: 1.0,
        path: 0.36,
        layers: 1,
        steps: 36,
    };
}

/// Runs on, whatever happens.
pub fn never() -> bool {
    false
}

/// Another discretisation than the fit's: every second record on a uniform grid, the others graded but finer;
/// nodal integration of the interface.
pub fn refine(case: &mut Case, fine: &Fineness, random: &mut Random) {
    let (g, jitter) = (&case.geometry, between(random, 0.9, 1.1));
    let mesh = &mut case.mesh;
    if random.uniform() < 0.5 {
        let along = |size: f64, cell: f64| (size / (cell * jitter)).ceil().max(4.0) as usize;
        let up = along(g.length, 0.9 * fine.bulk);
        mesh.divisions = Some([along(g.width, 1.3 * fine.path), up + up % 2, fine.layers]);
    } else {
        (mesh.bulk_size, mesh.path_size) = (fine.bulk * jitter, fine.path * jitter);
        mesh.layers = fine.layers;
    }
    case.solver.integration = Integration::Nodal;
}

/// Puts an effect at these values into a case.
pub fn add_effect(
    case: &mut Case,
    catalogue: &Catalogue,
    name: &str,
    values: &[(&str, f64)],
) -> Result<(), GenerateError> {
    let effect = catalogue
        .get(name)
        .ok_or_else(|| GenerateError::Model(format!("no effect {name} in the catalogue")))?;
    let specs = effect.parameters(&Options::new());
    if let Some((unknown, _)) = values.iter().find(|(n, _)| specs.iter().all(|s| s.name != *n)) {
        return Err(GenerateError::Model(format!("{name} has no parameter {unknown}")));
    }
    case.effects.push(EffectConfig {
        name: name.to_owned(),
        parameters: values.iter().map(|(n, v)| ((*n).to_owned(), Value::new(*v))).collect(),
        specs,
        options: effect.options().into_iter().filter_map(|o| o.default.map(|d| (o.name, d))).collect(),
        location: Location::default(),
    });
    Ok(())
}

/// One test of the case alone, pulled once to `to` without a record.
fn pull(case: &Case, tears: bool, to: f64) -> Case {
    let mut c = case.clone();
    c.tests.retain(|t| t.kind.tears == tears);
    for t in &mut c.tests {
        t.record = None;
        t.protocol = Some(vec![Leg::Ramp { to_mm: to, rate_mm_per_s: 0.05 }]);
    }
    c.solver.step_mm = Some(to / 50.0);
    c
}

/// Displacement, force, and whether the strip jumped or the run failed.
fn curve(case: Case, catalogue: &Catalogue) -> Result<(Vec<f64>, Vec<f64>, bool), GenerateError> {
    let control = SimulateControl { progress: &|_, _| (), cancelled: &never };
    let s = simulate(Arc::new(case), catalogue, &control)?;
    let t = s.tests.into_iter().next().ok_or_else(|| GenerateError::Model("the case has no test".into()))?;
    let uneven = t.failure.is_some() || !t.run.jumps.is_empty();
    Ok((t.displacement, t.force, uneven))
}

/// How far to pull: the tear is through where the force has fallen to a small rest; the intact strip is
/// stretched to `share` of the tear's largest force. `None`: the tear jumps.
pub fn probe(case: &Case, catalogue: &Catalogue, share: f64) -> Result<Option<Extent>, GenerateError> {
    let opening = case.interface.gc[0].value.unwrap_or(0.2) / case.interface.sigma_c[0].value.unwrap_or(0.2);
    let far = 0.35 * case.geometry.length + 3.5 * opening;
    let (u, f, uneven) = curve(pull(case, true, far), catalogue)?;
    if uneven {
        return Ok(None);
    }
    let peak = (0..f.len()).fold(0, |m, i| if f[i] > f[m] { i } else { m });
    let tearing = (peak..f.len()).find(|&i| f[i] < 0.04 * f[peak]).map_or(far, |i| u[i]);
    let (v, g, uneven) = curve(pull(case, false, u[peak]), catalogue)?;
    if uneven {
        return Ok(None);
    }
    let wanted = share * f[peak];
    let right = g.partition_point(|x| *x < wanted).clamp(1, g.len() - 1);
    let s = ((wanted - g[right - 1]) / (g[right] - g[right - 1])).clamp(0.0, 1.0);
    Ok(Some(Extent { uniaxial: v[right - 1] + s * (v[right] - v[right - 1]), tearing }))
}

/// Noise-free records of a case.
#[derive(Clone, Debug)]
pub struct Computed {
    /// Force of each test at its rows, N.
    pub force: Vec<Vec<f64>>,
    /// Camera: change of distance between the clamped edges, mm.
    pub grip: Vec<Vec<f64>>,
}

/// Blocks of one channel in every test.
pub fn slots(case: &Case, channel: Channel) -> Vec<DataBlock> {
    let rows = |r: &Option<Record>| (0..r.as_ref().map_or(0, Record::len)).collect();
    case.tests
        .iter()
        .enumerate()
        .map(|(test, t)| DataBlock { test, channel, rows: rows(&t.record) })
        .collect()
}

/// Computes the records of a case whose tests have their motion. `None`: a jump, or no solution.
///
/// # Errors
/// When no model can be made of the case.
pub fn compute(case: &Case, catalogue: &Catalogue, steps: usize) -> Result<Option<Computed>, GenerateError> {
    let mut case = case.clone();
    for r in case.tests.iter_mut().filter_map(|t| t.record.as_mut()) {
        r.grip_displacement = Some(vec![Some(0.0); r.len()]);
    }
    let model = Model::new(Arc::new(case.clone()), catalogue, Discretisation::default())?;
    let options = RunOptions {
        tearing_steps: steps,
        uniaxial_steps: steps / 2,
        follow_holds: true,
        ..analysis::run_options(&case)
    };
    let both: Vec<DataBlock> =
        [slots(&case, Channel::Force), slots(&case, Channel::GripDisplacement)].concat();
    let problem = FeProblem::new(&model, model.theta(), Vec::new(), &both, options, &never);
    let runs = problem.run(&problem.theta, &[])?;
    if runs.iter().flatten().any(|r| r.run.failure.is_some() || !r.run.jumps.is_empty()) {
        return Ok(None);
    }
    let Ok(all) = problem.gather(&runs, &problem.theta, false) else { return Ok(None) };
    let mut blocks = split(&all.values, &both);
    let grip = blocks.split_off(case.tests.len());
    Ok(Some(Computed { force: blocks, grip }))
}

/// A prediction vector cut into its blocks.
fn split(values: &DVector<f64>, slots: &[DataBlock]) -> Vec<Vec<f64>> {
    let mut at = 0;
    slots
        .iter()
        .map(|s| {
            let from = at;
            at += s.rows.len();
            values.as_slice()[from..at].to_vec()
        })
        .collect()
}
