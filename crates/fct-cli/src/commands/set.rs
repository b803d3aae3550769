//! `fct set`: a config with other values, held or free parameters, another mesh.

use super::edit::{Source, next, source, write};
use crate::outcome::{Failure, Outcome};
use crate::session::Session;
use ::report::answer::SCHEMA;
use input::{Case, Value};
use model::{Discretisation, Model};
use params::{Owner, ParamPath};
use serde_json::json;
use std::path::PathBuf;
use std::sync::Arc;

/// Arguments of `fct set`.
#[derive(Clone, Debug, clap::Args)]
pub struct Arguments {
    /// A run directory (its identified values are where the new config starts), or a config or specimen file
    #[arg(value_name = "RUN|FILE")]
    pub file: PathBuf,
    /// Values of parameters, paths and units as in answers (mm, N, s, MPa, rad): bulk.mu=0.0051
    #[arg(value_name = "PATH=VALUE", value_parser = pair)]
    pub values: Vec<(String, f64)>,
    /// Parameters to hold at their values
    #[arg(long, value_name = "PATHS", value_delimiter = ',')]
    pub hold: Vec<String>,
    /// Parameters to identify
    #[arg(long, value_name = "PATHS", value_delimiter = ',')]
    pub free: Vec<String>,
    /// Elements along x (tear), y (load) and z, in place of the mesh's sizes
    #[arg(long, value_name = "X,Y,Z", value_delimiter = ',', num_args = 1)]
    pub divisions: Vec<usize>,
    /// Areas along the tear path; all begin with the values of the first
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=200))]
    pub areas: Option<u16>,
}

fn pair(word: &str) -> Result<(String, f64), String> {
    let (path, value) = word.split_once('=').ok_or("expected PATH=VALUE, as bulk.mu=0.0051")?;
    let value: f64 = value.trim().parse().map_err(|_| format!("`{value}` is no number"))?;
    if value.is_finite() { Ok((path.trim().to_owned(), value)) } else { Err(format!("{value} is no value")) }
}

/// Writes the resolved config with the changes.
///
/// # Errors
/// A path that is none of the model's parameters, a value out of its bounds, an unreadable file.
pub fn run(arguments: &Arguments, session: &Session) -> Result<Outcome, Failure> {
    let from = source(&arguments.file)?;
    let mut case = (*session.case(&from.file)?).clone();
    if let Some(answer) = from.run.as_ref().and_then(|r| r.identify()) {
        let values: Vec<(&str, f64)> = answer.parameters.iter().map(|p| (p.path.as_str(), p.value)).collect();
        analysis::start_at(&mut case, values.into_iter());
    }
    remesh(&mut case, arguments)?;
    known(&case, arguments, session)?;
    analysis::start_at(&mut case, arguments.values.iter().map(|(p, v)| (p.as_str(), *v)));
    for (paths, fixed) in [(&arguments.hold, true), (&arguments.free, false)] {
        for path in paths {
            value(&mut case, path)?.fixed = Some(fixed);
        }
    }
    // The file that it comes from stays what it is; records are where they are.
    let whole = Source { text: input::resolved_toml(&case), ..from };
    let file = write(&whole, &whole.text, "-set", session)?;
    let changed: Vec<&str> = arguments.values.iter().map(|v| v.0.as_str()).collect();
    let json = json!({ "schema": SCHEMA, "file": file, "values": changed, "held": arguments.hold, "freed": arguments.free });
    Outcome::new(&json, format!("{}\nnext: {}\n", file.display(), next(&whole, &file)))
}

fn remesh(case: &mut Case, arguments: &Arguments) -> Result<(), Failure> {
    if let Some(areas) = arguments.areas {
        case.interface.areas = usize::from(areas);
        case.interface.gc.truncate(1);
        case.interface.sigma_c.truncate(1);
    }
    match *arguments.divisions.as_slice() {
        [] => Ok(()),
        [x, y, z] if [x, y, z].iter().all(|d| (1..=400).contains(d)) => {
            case.mesh.divisions = Some([x, y, z]);
            Ok(())
        }
        _ => Err(Failure::usage("fct: --divisions: expected three numbers from 1 to 400, as 8,20,2")),
    }
}

/// Whether every path that is named is a parameter of the model.
fn known(case: &Case, arguments: &Arguments, session: &Session) -> Result<(), Failure> {
    let named: Vec<&str> = arguments
        .values
        .iter()
        .map(|v| &v.0)
        .chain(&arguments.hold)
        .chain(&arguments.free)
        .map(String::as_str)
        .collect();
    if named.is_empty() {
        return Ok(());
    }
    // Of the model only its parameters are wanted; a coarse mesh is made quickly, and cannot always be.
    let case = Arc::new(case.clone());
    let coarse = Discretisation { coarsen: 4.0, ..Discretisation::default() };
    let model = Model::new(case.clone(), &session.catalogue, coarse)
        .or_else(|_| Model::new(case, &session.catalogue, Discretisation::default()))
        .map_err(|e| Failure::usage(format!("fct: {}: {e}", arguments.file.display())))?;
    let paths: Vec<&str> = model.parameters.iter().map(|p| p.path.as_str()).collect();
    match named.iter().find(|n| !paths.contains(n)) {
        None => Ok(()),
        Some(name) => Err(Failure::usage(format!(
            "fct: {}: no parameter of this model; it has {}",
            input::visible(name),
            paths.join(", ")
        ))),
    }
}

/// Where a parameter stands in the case.
fn value<'c>(case: &'c mut Case, path: &str) -> Result<&'c mut Value, Failure> {
    let unknown = || Failure::usage(format!("fct: {}: no parameter of this model", input::visible(path)));
    let parsed: ParamPath = path.parse().map_err(|_| unknown())?;
    let areas = case.interface.areas;
    Ok(match &parsed.owner {
        Owner::Bulk => case.bulk.parameters.entry(parsed.name).or_default(),
        Owner::Interface => case.interface.parameters.entry(parsed.name).or_default(),
        Owner::Area(at) => {
            let list = if parsed.name == "gc" { &mut case.interface.gc } else { &mut case.interface.sigma_c };
            let common = list.first().copied().unwrap_or_default();
            list.resize(areas.max(1), common);
            list.get_mut(at.wrapping_sub(1)).ok_or_else(unknown)?
        }
        Owner::Effect(name) => {
            let effect = case.effects.iter_mut().find(|e| e.name == *name).ok_or_else(unknown)?;
            effect.parameters.entry(parsed.name).or_default()
        }
    })
}
