//! `fct set`: a config with other values, held or free parameters, another mesh.

use super::edit::{Source, next, source, write};
use crate::outcome::{Failure, Outcome};
use crate::session::Session;
use ::report::answer::SCHEMA;
use input::{Case, Value, Weight};
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
    /// Stretches of a record that count less, more or not at all: test, from s, to s, factor in χ² (0: left out), as
    /// tearing,12.5,30,0
    #[arg(long, value_name = "TEST,FROM,TO,WEIGHT", value_parser = weight)]
    pub weigh: Vec<(String, Weight)>,
    /// Tests whose points count alike again; done before `--weigh`
    #[arg(long, value_name = "TESTS", value_delimiter = ',')]
    pub unweigh: Vec<String>,
    /// Areas along the tear path; all begin with the values of the first
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=200))]
    pub areas: Option<u16>,
}

fn pair(word: &str) -> Result<(String, f64), String> {
    let (path, value) = word.split_once('=').ok_or("expected PATH=VALUE, as bulk.mu=0.0051")?;
    let value: f64 = value.trim().parse().map_err(|_| format!("`{value}` is no number"))?;
    if value.is_finite() { Ok((path.trim().to_owned(), value)) } else { Err(format!("{value} is no value")) }
}

fn weight(word: &str) -> Result<(String, Weight), String> {
    const EXPECTED: &str = "expected TEST,FROM,TO,WEIGHT, as tearing,12.5,30,0";
    // A name may hold commas; numbers do not.
    let parts: Vec<&str> = word.rsplitn(4, ',').collect();
    let [weight, to, from, test] = parts.as_slice() else { return Err(EXPECTED.into()) };
    let number = |x: &str| match x.trim().parse::<f64>() {
        Ok(x) if x.is_finite() && x >= 0.0 => Ok(x),
        _ => Err(format!("`{x}` is no number of 0 or more; {EXPECTED}")),
    };
    let out = Weight { from_s: number(from)?, to_s: number(to)?, weight: number(weight)? };
    match (out.from_s <= out.to_s, out.weight <= 100.0) {
        (false, _) => Err(format!("{} s is before {} s; {EXPECTED}", out.to_s, out.from_s)),
        (_, false) => Err(format!("a weight of {} is too large; at most 100", out.weight)),
        _ => Ok(((*test).to_owned(), out)),
    }
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
    weigh(&mut case, arguments)?;
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

fn weigh(case: &mut Case, arguments: &Arguments) -> Result<(), Failure> {
    fn test<'c>(case: &'c mut Case, name: &str) -> Result<&'c mut input::Test, Failure> {
        let names = case.tests.iter().map(|t| t.name.as_str()).collect::<Vec<_>>().join(", ");
        let none = Failure::usage(format!(
            "fct: {}: no test of this specimen; it has {names}",
            input::visible(name)
        ));
        case.tests.iter_mut().find(|t| t.name == name).ok_or(none)
    }
    for name in &arguments.unweigh {
        test(case, name)?.weights.clear();
    }
    for (name, weight) in &arguments.weigh {
        test(case, name)?.weights.push(*weight);
    }
    Ok(())
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
