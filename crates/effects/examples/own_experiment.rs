//! An experiment of one's own, from outside the workspace's crates: written, checked, named by a file and run.
//! `cargo run -p effects --example own_experiment`; docs/adding-an-experiment.md walks through it.

use experiments::{Experiment, Held, Setting, SupportFault, Supports, flat_strip, intact_sheet};
use input::{Ends, ExperimentCard, Test};
use mesh::{Mesh, MeshError, Strip};
use model::{Discretisation, Model, Request, RunOptions};
use std::error::Error;
use std::sync::Arc;

// ---- The experiment: a strip between two walls, which is stretched but cannot become narrower ----

static CARD: ExperimentCard = ExperimentCard {
    ends: &[Ends::Sliding],
    clamped_faces: false,
    shaped: false,
    ..intact_sheet(
        "between_walls",
        "A strip is stretched between two smooth walls that keep its width.",
        |g| 0.3 * g.length,
    )
};

struct BetweenWalls;

impl Experiment for BetweenWalls {
    fn card(&self) -> &'static ExperimentCard {
        &CARD
    }

    fn strip(&self, setting: &Setting<'_>) -> Result<Strip, MeshError> {
        flat_strip(setting)
    }

    fn supports(&self, mesh: &Mesh, test: &Test) -> Result<Supports, SupportFault> {
        let mut held = Held::at_mirrors(mesh, test)?;
        let share = held.share;
        for &n in held.set("top")? {
            held.hold(n, 1, share);
        }
        if !mesh.half_height {
            for &n in held.set("bottom")? {
                held.hold(n, 1, 0.0);
            }
        }
        for wall in ["left", "right"] {
            for &n in held.set(wall)? {
                held.hold(n, 0, 0.0);
            }
        }
        Ok(held.done())
    }
}

// ---- Use: a registry with one more, named by a file, run by the finite elements ------------------

const STRIP: &str = r#"
name = "strip"
[geometry]
length_mm = 6.0
width_mm = 4.0
thickness_mm = 0.8
[[tests]]
kind = "between_walls"
protocol = [{ to_mm = 1.8, rate_mm_per_s = 0.05 }]
[bulk]
law = "neo_hooke"
mu_kPa = 20.0
bulk_modulus_MPa = 100.0
"#;

/// Largest displacement (mm) and the force there (N).
fn end() -> Result<(f64, f64), Box<dyn Error>> {
    let known = experiments::registry().with(Arc::new(BetweenWalls));
    let catalogue = effects::catalogue().with_experiments(known);
    let folder = std::env::temp_dir().join(format!("own-experiment-{}", std::process::id()));
    std::fs::create_dir_all(&folder)?;
    let file = folder.join("strip.toml");
    std::fs::write(&file, STRIP)?;
    let case = input::read_case(&file, &catalogue).map_err(|e| e.to_string());
    std::fs::remove_dir_all(&folder)?;
    let model = Model::new(Arc::new(case?), &catalogue, Discretisation::default())?;
    let runs = model.run(&Request {
        theta: &model.theta(),
        seeds: &[],
        options: RunOptions::default(),
        wanted: &[true],
        warm: &[],
        cancelled: &|| false,
    })?;
    let run = &runs[0].as_ref().ok_or("the test was not run")?.run;
    if let Some(failure) = &run.failure {
        return Err(failure.to_string().into());
    }
    let last = run.steps.last().ok_or("no step was made")?;
    Ok((last.actuator, last.force))
}

fn main() -> Result<(), Box<dyn Error>> {
    let (u, force) = end()?;
    // The width stays, so the thickness becomes 1/λ: P = μ (λ − λ⁻³), homogeneous.
    let stretch = 1.0 + u / 6.0;
    let expected = 0.02 * (stretch - stretch.powi(-3)) * 4.0 * 0.8;
    println!("force at λ = {stretch:.2}: {force:.6} N, in closed form {expected:.6} N");
    assert!((force / expected - 1.0).abs() < 1e-3, "{force} {expected}");
    Ok(())
}
