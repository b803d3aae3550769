//! `fct export`: the identified law for other programs.

use crate::outcome::{Failure, Outcome};
use crate::session::{Session, file_name};
use ::report::StoredRun;
use ::report::answer::SCHEMA;
use ::report::export::{Exported, Program, deck};
use ::report::write_named;
use analysis::{SimulateControl, simulate};
use input::{Case, Ends, ExperimentRegistry, Leg, Test};
use model::cost::Purpose;
use model::{Discretisation, Model};
use serde_json::json;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Arguments of `fct export`.
#[derive(Clone, Debug, clap::Args)]
pub struct Arguments {
    /// The program
    #[arg(value_name = "FORMAT", value_enum)]
    pub format: Format,
    /// A run directory of `fct identify` or `fct discover`
    #[arg(value_name = "RUN")]
    pub run: PathBuf,
}

/// A program on the command line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Format {
    /// A Python script for FElupe; compares its forces with those of fct
    Felupe,
    /// An input file for Abaqus/Standard; not run there
    Abaqus,
    /// An input file for FEBio 4; not run there
    Febio,
}

impl Format {
    fn program(self) -> Program {
        match self {
            Self::Felupe => Program::Felupe,
            Self::Abaqus => Program::Abaqus,
            Self::Febio => Program::Febio,
        }
    }
}

/// Writes the law and a deck of one element beside the run.
///
/// # Errors
/// No finished run, a law that these programs do not have, a file that would be overwritten.
pub fn run(arguments: &Arguments, session: &Session) -> Result<Outcome, Failure> {
    let place = super::compare::last_fitted_model(&arguments.run);
    let run = session.stored(&place)?;
    let found = run.identify().ok_or_else(|| unfinished(&place))?;
    let mut case = (*session.case(&place)?).clone();
    analysis::start_at(&mut case, found.parameters.iter().map(|p| (p.path.as_str(), p.value)));
    let law = exported(case, &run, session)?;
    let (ending, text) = deck(arguments.format.program(), &law);
    let own = || PathBuf::from(format!("{}-{}.{ending}", file_name(&law.specimen), word(arguments.format)));
    let file = session.common.out.clone().unwrap_or_else(own);
    write_named(&file, text.as_bytes(), session.common.force, |there| there == text.as_bytes())?;
    let mut words = format!("{}\n", file.display());
    if !law.effects.is_empty() {
        words.push_str(&format!("not in it: the effects of the model: {}\n", law.effects.join(", ")));
    }
    if arguments.format != Format::Felupe {
        words.push_str("it has not been run in that program\n");
    }
    let forces = json!(law.forces);
    Outcome::new(
        &json!({ "schema": SCHEMA, "file": file, "specimen": law.specimen, "left_out": law.effects,
            "stretch_and_force_N": forces }),
        words,
    )
}

fn word(format: Format) -> &'static str {
    match format {
        Format::Felupe => "felupe",
        Format::Abaqus => "abaqus",
        Format::Febio => "febio",
    }
}

fn unfinished(place: &Path) -> Failure {
    Failure::usage(format!(
        "fct: {}: expected a finished run of `fct identify` or `fct discover`",
        place.display()
    ))
}

/// The law with its values, and what it answers on a cube.
fn exported(case: Case, run: &StoredRun, session: &Session) -> Result<Exported, Failure> {
    let option =
        |name: &str, wanted: &str| case.bulk.options.get(name).is_none_or(|v| v.to_string() == wanted);
    if case.bulk.law != "hgo" || !option("tension_only", "true") || !option("fibre_invariants", "isochoric") {
        return Err(Failure::usage(format!(
            "fct: {}: only the bulk law hgo with tension_only = true and fibre_invariants = \"isochoric\" can be exported: \
             the others are not the law of these programs",
            run.path.display()
        )));
    }
    let model = Model::checked(
        Arc::new(case.clone()),
        &session.catalogue,
        Discretisation::default(),
        Purpose::Simulation,
    )
    .map_err(analysis::AnalysisError::Build)?;
    let theta = model.theta();
    let value = |path: &str| model.find(path).and_then(|i| theta.get(i).copied());
    let bulk = |name: &str| {
        value(&format!("bulk.{name}"))
            .ok_or_else(|| Failure::compute(format!("fct: the model has no parameter bulk.{name}")))
    };
    let area = |i: usize| {
        Some([value(&format!("interface.area[{i}].gc"))?, value(&format!("interface.area[{i}].sigma_c"))?])
    };
    Ok(Exported {
        specimen: case.name.clone(),
        run: run.path.display().to_string(),
        effects: model.effects(),
        mu: bulk("mu")?,
        k1: bulk("k1")?,
        k2: bulk("k2")?,
        gamma: bulk("gamma")?,
        kappa: bulk("kappa")?,
        d: bulk("d")?,
        areas: (1..=case.interface.areas).map_while(area).collect(),
        forces: forces(case, session)?,
    })
}

/// Force at stretches up to 1.2 on a cube of 1 mm that may contract freely.
fn forces(mut case: Case, session: &Session) -> Result<Vec<[f64; 2]>, Failure> {
    let Some(first) = case.tests.first().cloned() else { return Ok(Vec::new()) };
    let Some(kind) = session.catalogue.kind("uniaxial") else { return Ok(Vec::new()) };
    case.geometry = input::Geometry { length: 1.0, width: 1.0, thickness: 1.0, ..Default::default() };
    let pull = Leg::Ramp { to_mm: 0.2, rate_mm_per_s: 0.01 };
    case.tests = vec![Test {
        name: "cube".into(),
        kind,
        ends: Ends::Sliding,
        grips: input::Grips::Ends,
        record: None,
        protocol: Some(vec![pull]),
        ..first
    }];
    case.effects.clear();
    case.mesh.divisions = Some([1, 2, 1]);
    case.mesh.symmetry = input::Symmetry::None;
    (case.interface.areas, case.solver.step_mm) = (1, Some(0.02));
    (case.interface.gc, case.interface.sigma_c) = (
        case.interface.gc.into_iter().take(1).collect(),
        case.interface.sigma_c.into_iter().take(1).collect(),
    );
    case.solver.control = input::Control::Actuator;
    case.solver.tolerance = 1e-10;
    let control = SimulateControl { progress: &|_, _| {}, cancelled: &|| session.cancelled() };
    let done = simulate(Arc::new(case), &session.catalogue, &control)?;
    if let Some(why) = done.failure() {
        return Err(Failure::compute(format!("fct: the cube could not be stretched to 1.2: {why}")));
    }
    let test = done.tests.first().map(|t| (&t.displacement, &t.force));
    let pairs = test.into_iter().flat_map(|(u, f)| u.iter().zip(f));
    Ok(pairs.filter(|(u, _)| **u > 0.0).map(|(u, f)| [1.0 + u, *f]).collect())
}
