//! `fct check`: validate, print what is resolved, say what the records are good for.

use crate::outcome::{Failure, Outcome};
use crate::session::Session;
use ::report::terminal::{doctor_lines, wrap};
use analysis::{AnalysisError, doctor};
use input::{Case, resolved_toml};
use model::cost::{self, Cost, Need, Purpose, RUNS_OF_A_FIT};
use model::{Discretisation, Model};
use params::ParamSpec;
use serde_json::{Value, json};
use std::path::PathBuf;

/// Arguments of `fct check`.
#[derive(Clone, Debug, clap::Args)]
pub struct Arguments {
    /// A specimen or a config
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    /// Without the model's part: which parameters and effects the records can show (a few seconds)
    #[arg(long)]
    pub quick: bool,
}

/// Reads the file, builds the model, prints the resolved configuration, examines the records.
///
/// # Errors
/// Everything that is wrong with the file.
pub fn run(arguments: &Arguments, session: &Session) -> Result<Outcome, Failure> {
    let case = session.case(&arguments.file)?;
    let how = Discretisation::default();
    let cost = Cost::of(&case, &session.catalogue, how).map_err(AnalysisError::Build)?;
    let model = Model::checked(case.clone(), &session.catalogue, how, Purpose::Simulation)
        .map_err(AnalysisError::Build)?;
    let resolved = resolved_toml(&case);
    let tests: Vec<_> = model
        .tests
        .iter()
        .map(|t| {
            json!({
                "name": t.test.name, "kind": t.test.kind.word(), "unknowns": t.unknowns(),
                "points": t.test.record.as_ref().map(input::Record::len),
            })
        })
        .collect();
    let free: Vec<&str> = model.free().into_iter().map(|i| model.parameters[i].path.as_str()).collect();
    let cancelled = || session.cancelled();
    let doctor = doctor(&case, &session.catalogue, !arguments.quick, &cancelled);
    let answer = json!({
        "schema": ::report::answer::SCHEMA, "specimen": case.name, "provenance": case.provenance,
        "laws": laws(&case, &model), "effects": model.effects(), "tests": tests, "free_parameters": free,
        "warnings": case.warnings, "resolved": resolved, "needs": needs(&cost), "doctor": doctor,
    });
    let told = doctor_lines(&doctor).iter().map(|l| format!("# {l}\n")).collect::<String>();
    let text = format!("{}{resolved}\n{told}", heading(&case, &model, &free, &cost));
    Outcome::new(&answer, text)
}

/// The laws with their parameters, as data; the tear's where something tears.
fn laws(case: &Case, model: &Model) -> Value {
    let of = |site: &str, name: &str, specs: &[ParamSpec]| {
        let list = specs.iter().filter(|s| !s.internal);
        let list: Vec<Value> =
            list.map(|s| json!({ "name": s.name, "unit": s.quantity.unit(), "is": s.description })).collect();
        json!({ "site": site, "law": name, "parameters": list })
    };
    let mut all = vec![of("bulk", &case.bulk.law, &case.bulk.specs)];
    if tears(model) {
        all.push(of("interface", &case.interface.law, &case.interface.specs));
    }
    json!(all)
}

fn tears(model: &Model) -> bool {
    model.find("interface.area[1].gc").is_some()
}

/// Each law on a line: its name, and its parameters as they stand in equations.
fn laws_in_words(case: &Case, model: &Model) -> String {
    let line = |site: &str, name: &str, specs: &[ParamSpec]| {
        let list = specs.iter().filter(|s| !s.internal).map(|s| format!("{} {}", s.name, unit(s)));
        let list: Vec<String> = list.map(|l| l.trim().to_owned()).collect();
        let text = format!("{site} law {name}: {}", list.join(", "));
        format!("\n# {}", wrap(&text, 94, 0).replace('\n', "\n#   "))
    };
    let mut out = line("bulk", &case.bulk.law, &case.bulk.specs);
    if tears(model) {
        out.push_str(&line("interface", &case.interface.law, &case.interface.specs));
    }
    out
}

/// The internal unit in brackets; nothing for a pure number.
fn unit(spec: &ParamSpec) -> String {
    match spec.quantity.unit() {
        "" => String::new(),
        unit => format!("({unit})"),
    }
}

/// Memory and time, as data.
fn needs(cost: &Cost) -> Value {
    let need = |n: Need| json!({ "memory_bytes": n.bytes.round(), "seconds_per_run": n.seconds });
    json!({
        "run": need(cost.simulation),
        "identify": { "memory_bytes": cost.fit.bytes.round(), "seconds_per_run": cost.fit.seconds, "runs": RUNS_OF_A_FIT, "seconds": cost.seconds_of_a_fit() },
        "elements": cost.elements, "elements_along_the_tear": cost.ahead, "available_bytes": cost::available_bytes(),
    })
}

/// Memory and time in words. A fit is spoken of where there is a record to fit.
fn needs_in_words(case: &Case, cost: &Cost) -> String {
    let (bytes, duration) = (cost::bytes, cost::duration);
    let run = cost.simulation;
    let mut out =
        format!("needs about {} and {} per run of the model", bytes(run.bytes), duration(run.seconds));
    if case.tests.iter().any(|t| t.record.is_some()) {
        let fit = cost.fit;
        out.push_str(&format!(
            "; identify takes some {RUNS_OF_A_FIT} runs, most on a coarser mesh: about {} and {} on one core",
            bytes(fit.bytes),
            duration(cost.seconds_of_a_fit())
        ));
        let available = cost::available_bytes().unwrap_or(cost::MOST_BYTES).min(cost::MOST_BYTES);
        if fit.bytes > available || fit.seconds > cost::MOST_SECONDS {
            out.push_str(&format!(": more than this machine has ({} to give)", bytes(available)));
        }
    }
    out
}

/// A comment above the resolved file, so that the output is a valid config.
fn heading(case: &Case, model: &Model, free: &[&str], cost: &Cost) -> String {
    let mut out = format!("# {}: valid.", case.name);
    out.push_str(&laws_in_words(case, model));
    for t in &model.tests {
        let points = t.test.record.as_ref().map_or("a protocol".into(), |r| format!("{} points", r.len()));
        out.push_str(&format!("\n# test {}: {points}, {} unknowns", t.test.name, t.unknowns()));
    }
    let list = wrap(&free.join(", "), 94, 0).replace('\n', "\n#   ");
    out.push_str(&format!("\n# {} free parameters: {list}\n", free.len()));
    if let Some(held) = ::report::answer::held_at_limits(&model.parameters) {
        out.push_str(&format!("# {}\n", wrap(&held, 94, 0).replace('\n', "\n#   ")));
    }
    out.push_str(&format!("# {}\n", wrap(&needs_in_words(case, cost), 94, 0).replace('\n', "\n#   ")));
    out.push('\n');
    out
}
