//! Fields at typical points of each curve, for ParaView.

mod bulk;
mod path;
mod picture;
mod points;
mod vtu;

pub use points::{TypicalPoint, typical_points};

use crate::{ReportError, RunDir};
use analysis::SimulatedTest;
use fem::State;
use model::Model;
use vtu::{Grid, collection};

/// Fields of one test at one step: positions, elements, numbers. Serves VTU files and pictures.
pub struct Snapshot {
    /// Which point of the curve.
    pub point: TypicalPoint,
    /// The strip.
    pub bulk: Grid,
    /// The tear path; `None` for an intact strip.
    pub path: Option<Grid>,
}

/// Fields of every test at `count` typical points each.
pub fn snapshots(
    model: &Model,
    theta: &[f64],
    tests: &[SimulatedTest],
    count: usize,
) -> Vec<(String, Vec<Snapshot>)> {
    let mut out: Vec<(String, Vec<Snapshot>)> = Vec::new();
    for chain in model.chains() {
        let mut before: Option<&State> = None;
        for &t in &chain {
            let Some(test) = tests.iter().find(|s| s.name == model.tests[t].test.name) else { continue };
            out.push((test.name.clone(), of_test(model, theta, t, test, before, count)));
            before = test.run.last.as_ref();
        }
    }
    out
}

fn of_test(
    model: &Model,
    theta: &[f64],
    t: usize,
    test: &SimulatedTest,
    before: Option<&State>,
    count: usize,
) -> Vec<Snapshot> {
    let steps = test.run.states.len().min(test.run.steps.len());
    let points = typical_points(&test.displacement[..steps], &test.force[..steps], count);
    let problem = model.tests[t].problem(theta);
    let initial = model.initial_state(&problem, &model.tests[t], before).history.bulk;
    let rest = before.map(|_| model.tests[t].test.rest_s.unwrap_or(model::LONG_REST));
    let mut strip = bulk::Strip::new(&problem, theta, initial, rest);
    let mesh = &model.tests[t].mesh;
    let mut out = Vec::new();
    let mut next = points.into_iter().peekable();
    for (i, step) in test.run.steps.iter().enumerate().take(steps) {
        let kept = &test.run.states[i];
        let u = &kept.guess.u;
        let wanted = next.peek().is_some_and(|p| p.step == i);
        let cells = strip.advance(step, u, wanted);
        if let (Some(cells), Some(point)) = (cells, next.next_if(|p| p.step == i)) {
            let path = path::grid(&problem, theta, u, &kept.path);
            out.push(Snapshot { point, bulk: bulk::grid(&problem, mesh, u, &cells), path });
        }
    }
    out
}

/// Writes `fields/<test>-<n>.vtu`, the tear path's `fields/<test>-path-<n>.vtu`, and one `.pvd`
/// per test that ParaView opens as a series over the displacement's step.
///
/// # Errors
/// If the disk refuses.
pub fn write_fields(dir: &RunDir, all: &[(String, Vec<Snapshot>)]) -> Result<(), ReportError> {
    for (test, snapshots) in all {
        let mut entries = Vec::new();
        for (n, s) in snapshots.iter().enumerate() {
            let name = format!("{test}-{}.vtu", n + 1);
            dir.write(format!("fields/{name}"), s.bulk.vtu().as_bytes())?;
            entries.push((n, 0, name));
            if let Some(path) = &s.path {
                let name = format!("{test}-path-{}.vtu", n + 1);
                dir.write(format!("fields/{name}"), path.vtu().as_bytes())?;
                entries.push((n, 1, name));
            }
        }
        dir.write(format!("fields/{test}.pvd"), collection(&entries).as_bytes())?;
    }
    Ok(())
}

/// `figures/<test>-S22.svg`: the deformed strip at the typical points, name and content.
pub fn pictures(all: &[(String, Vec<Snapshot>)]) -> Vec<(String, String)> {
    all.iter().filter_map(|(test, s)| Some((format!("{test}-S22"), picture::svg(test, s)?))).collect()
}
