//! What the page shows: the present step as one JSON document.

use crate::BenchError;
use crate::bench::Bench;
use crate::numbers::{adds, jacobian, list, short};
use crate::steps::Steps;
use input::{Case, ExperimentRegistry};
use model::{Discretisation, Model};
use report::answer::IdentifyAnswer;
use report::{Curve, StoredRun};
use serde_json::{Map, Value, json};
use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

/// Lines of a file that are shown as it is.
const HEAD: usize = 8;
/// Bytes of a line that are shown.
const WIDE: usize = 160;

/// The state of the workbench.
pub fn state(bench: &Bench) -> Value {
    let steps = bench.steps().clone();
    let present = steps.present().cloned().unwrap_or_default();
    let run = present.run.as_ref().map(|r| StoredRun::read(&bench.path(r)));
    let mut faults: Vec<String> = Vec::new();
    let run = match run {
        Some(Ok(run)) => Some(run),
        Some(Err(e)) => {
            faults.push(e.to_string());
            None
        }
        None => None,
    };
    let case = present.config.as_ref().map(|c| input::read_case(&bench.path(c), &bench.catalogue));
    let case = match case {
        Some(Ok(case)) => Some(analysis::condensed(&Arc::new(case))),
        Some(Err(e)) => {
            faults.push(e.to_string());
            None
        }
        None => None,
    };
    let answer = run.as_ref().and_then(StoredRun::identify);
    let (parameters, fault) =
        case.as_ref().map_or((Vec::new(), None), |c| parameters(bench, c, answer.as_ref()));
    faults.extend(fault);
    json!({
        "folder": bench.opened.root, "home": bench.opened.home, "version": env!("CARGO_PKG_VERSION"),
        "steps": shown(&steps), "cursor": steps.cursor, "commands": steps.commands(),
        "busy": bench.queue.is_busy(), "faults": faults,
        "import": import(bench, &steps), "raw": raw(bench), "doctor": steps.doctor_of(present.config.as_deref()),
        "specimen": case.as_deref().map(specimen), "parameters": parameters,
        "answer": answer.as_ref().map(told), "curves": curves(case.as_deref(), run.as_ref()),
        "jacobian": run.as_ref().map_or(Value::Null, jacobian), "adds": run.as_ref().map_or(Value::Null, adds),
        "fields": run.as_ref().map_or(Vec::new(), fields),
        "effects": catalogue(bench),
        "experiments": bench.catalogue.kinds().iter().map(|k| k.word()).collect::<Vec<_>>(),
        "diagnosis": run.as_ref().and_then(diagnosis),
        "config": present.config, "run": present.run,
    })
}

/// What `fct diagnose` left in a run; of a rung of a search, what the search says.
fn diagnosis(run: &StoredRun) -> Option<Value> {
    if let Some(own) = run.diagnosis().ok().flatten() {
        return Some(own);
    }
    let fitted_models = run.path.parent().filter(|p| p.ends_with("rungs"))?;
    let search = StoredRun::read(fitted_models.parent()?).ok()?;
    (search.info.command == "discover").then_some(search.answer)
}

fn catalogue(bench: &Bench) -> Vec<Value> {
    bench
        .catalogue
        .iter()
        .map(|e| e.card())
        .map(|c| {
            json!({ "name": c.name, "summary": c.summary, "site": c.site.word(), "law": c.law,
                "shows_in": c.shows_in, "look_alikes": c.look_alikes, "separated_by": c.separated_by, "ordinary": c.ordinary,
                "needs": c.needs, "reference": c.reference })
        })
        .collect()
}

/// Pictures of the strip that a run keeps: files of its folder, by name.
fn fields(run: &StoredRun) -> Vec<String> {
    let entries = std::fs::read_dir(run.path.join("fields")).into_iter().flatten().flatten();
    let mut out: Vec<String> = entries.filter_map(|e| e.file_name().to_str().map(str::to_owned)).collect();
    out.retain(|name| name.ends_with(".vtu"));
    out.sort();
    out
}

/// The model's curves at another step, to be laid over the present ones.
///
/// # Errors
/// If there is no such step, or its run is gone.
pub fn overlay(bench: &Bench, step: usize) -> Result<Value, BenchError> {
    let none = || BenchError::Asked(format!("step {step} has no model to show"));
    let (run, title) = {
        let steps = bench.steps();
        let step = steps.steps.get(step).ok_or_else(none)?;
        (step.run.clone().ok_or_else(none)?, step.title.clone())
    };
    let run = StoredRun::read(&bench.path(&run)).map_err(|e| BenchError::Asked(e.to_string()))?;
    Ok(json!({ "step": step, "title": title, "curves": curves(None, Some(&run)) }))
}

fn shown(steps: &Steps) -> Value {
    serde_json::to_value(&steps.steps).unwrap_or_default()
}

/// Files that were dropped, relative to the opened folder.
fn raw(bench: &Bench) -> Vec<String> {
    let folder = bench.opened.own().join("raw");
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let files = entries.filter(|e| e.file_type().is_ok_and(|t| t.is_file()));
    let mut out: Vec<String> = files
        .filter_map(|e| Some(format!("{}/raw/{}", bench.opened.home.display(), e.file_name().to_str()?)))
        .filter(|f| !f.contains("/."))
        .collect();
    out.sort();
    out
}

/// The last import with the first lines of its files.
fn import(bench: &Bench, steps: &Steps) -> Value {
    let Some(mut import) = steps.import.clone() else { return Value::Null };
    let files: Vec<String> = serde_json::from_value(import["request"]["files"].clone()).unwrap_or_default();
    let heads: Map<String, Value> = files
        .into_iter()
        .filter_map(|f| bench.opened.inside(&f).ok().map(|path| (f, json!(head(&path)))))
        .collect();
    import["heads"] = Value::Object(heads);
    import
}

/// The first lines of a text; none of a workbook.
fn head(path: &Path) -> Vec<String> {
    use std::io::Read;
    let mut bytes = Vec::new();
    let read = std::fs::File::open(path).map(|f| f.take(8192).read_to_end(&mut bytes));
    if read.is_err() || bytes.starts_with(b"PK") || bytes.starts_with(&[0xd0, 0xcf]) {
        return Vec::new();
    }
    bytes.retain(|b| *b != 0);
    let text = String::from_utf8_lossy(&bytes);
    text.lines().take(HEAD).map(|l| input::visible(&l.chars().take(WIDE).collect::<String>())).collect()
}

fn specimen(case: &Case) -> Value {
    let g = &case.geometry;
    let tests: Vec<Value> = case
        .tests
        .iter()
        .map(|t| json!({ "name": t.name, "points": t.record.as_ref().map(input::Record::len), "weights": t.weights }))
        .collect();
    json!({
        "name": case.name, "provenance": case.provenance,
        "geometry": { "length": g.length, "width": g.width, "thickness": g.thickness, "cut": g.cut },
        "tests": tests, "effects": case.effects.iter().map(|e| e.name.clone()).collect::<Vec<_>>(),
        "bulk_law": case.bulk.law, "interface_law": case.interface.law, "areas": case.interface.areas,
        "mesh": { "divisions": case.mesh.divisions, "bulk_size": case.mesh.bulk_size, "path_size": case.mesh.path_size },
    })
}

/// Parameters of the model with what the run found: values and bounds in internal units, `factor` to the unit shown.
fn parameters(
    bench: &Bench,
    case: &Arc<Case>,
    answer: Option<&IdentifyAnswer>,
) -> (Vec<Value>, Option<String>) {
    // Of the model only its parameters are wanted; a coarse mesh is made quickly, and cannot always be.
    let coarse = Discretisation { coarsen: 4.0, ..Discretisation::default() };
    let model = Model::new(case.clone(), &bench.catalogue, coarse)
        .or_else(|_| Model::new(case.clone(), &bench.catalogue, Discretisation::default()));
    let model = match model {
        Ok(model) => model,
        Err(e) => return (Vec::new(), Some(e.to_string())),
    };
    let found: HashMap<&str, _> =
        answer.iter().flat_map(|a| &a.parameters).map(|p| (p.path.as_str(), p)).collect();
    let shown = model.parameters.iter().enumerate().filter(|(i, p)| !model.is_hidden(*i) && !p.spec.internal);
    let rows = shown.map(|(_, p)| {
        let f = found.get(p.path.as_str());
        let key = p.spec.key();
        let unit = key.strip_prefix(&*p.spec.name).unwrap_or_default().trim_start_matches('_');
        json!({
            "path": p.path, "symbol": p.spec.symbol, "about": p.spec.description,
            "unit": unit.replace("_per_", "/"), "factor": p.spec.in_file_unit(1.0),
            "value": f.map_or(p.value, |f| f.value), "low": p.spec.lower, "high": p.spec.upper,
            "log": p.spec.lower > 0.0, "free": p.free,
            "interval": f.map(|f| f.interval_95), "identifiable": f.map(|f| f.identifiable),
            "at_bound": f.map(|f| f.at_bound),
        })
    });
    (rows.collect(), None)
}

/// What the page says of a fit; the history stays in the run directory.
fn told(a: &IdentifyAnswer) -> Value {
    let mut out = serde_json::to_value(a).unwrap_or_default();
    if let Some(fields) = out.as_object_mut() {
        for large in ["history", "correlations", "cost"] {
            fields.shift_remove(large);
        }
    }
    out
}

/// Curves of the run, or the records alone.
fn curves(case: Option<&Case>, run: Option<&StoredRun>) -> Vec<Value> {
    if let Some(Ok(curves)) = run.map(StoredRun::curves) {
        return curves.iter().map(curve).collect();
    }
    let records = case.into_iter().flat_map(|c| &c.tests).filter_map(|t| Some((t, t.record.as_ref()?)));
    records
        .map(|(t, r)| {
            json!({ "test": t.name, "t": list(&r.time), "u": list(&r.displacement), "f": list(&r.force),
                "m": null, "front": null, "noise": 0 })
        })
        .collect()
}

fn curve(c: &Curve) -> Value {
    let front = c.columns.iter().find(|c| c.0 == "tear_front_model_mm");
    let front = front.map(|c| c.1.iter().map(|x| x.map_or(Value::Null, short)).collect::<Vec<_>>());
    json!({
        "test": c.test, "t": list(&c.time), "u": list(&c.displacement), "f": list(&c.measured),
        "m": list(&c.model), "front": front, "noise": short(c.noise),
    })
}
