//! The numbers behind the charts, as compact JSON: six significant digits, one array per column.

use super::view::{FittedModel, View};
use crate::Curve;
use crate::answer::{IdentifyAnswer, ParameterAnswer};
use crate::figures::shown_parameters;
use crate::published::area;
use serde_json::{Map, Value, json};

/// All charts of a page.
pub fn of(v: &View) -> Value {
    let tests: Vec<Value> = v.current().map_or_else(Vec::new, |r| r.curves.iter().map(test).collect());
    let fitted_models: Vec<Value> = v.fitted_models.iter().map(fitted_model).collect();
    json!({
        "tests": tests, "rungs": fitted_models, "shown": v.shown,
        "convergence": v.current().map_or(Value::Null, |r| convergence(&r.answer)),
    })
}

/// Charts of computed curves alone.
pub fn of_curves(curves: &[Curve]) -> Value {
    let models: Map<String, Value> = curves.iter().map(|c| (c.test.clone(), numbers(&c.model))).collect();
    json!({
        "tests": curves.iter().map(test).collect::<Vec<_>>(), "shown": 0, "convergence": null,
        "rungs": [{ "name": "model", "force": models, "channels": {}, "path": [] }],
    })
}

/// Six significant digits: more than any instrument has, and half the bytes.
fn round(x: f64) -> Value {
    if x == 0.0 || !x.is_finite() {
        return if x == 0.0 { json!(0) } else { Value::Null };
    }
    let short: f64 = format!("{x:.5e}").parse().unwrap_or(x);
    // Whole numbers without `.0`.
    if short.fract() == 0.0 && short.abs() < 1e9 { json!(short as i64) } else { json!(short) }
}

fn numbers(x: &[f64]) -> Value {
    Value::Array(x.iter().map(|v| round(*v)).collect())
}

fn sparse(x: &[Option<f64>]) -> Value {
    Value::Array(x.iter().map(|v| v.map_or(Value::Null, round)).collect())
}

/// What was measured in one test.
fn test(c: &Curve) -> Value {
    let pieces: Vec<Value> =
        c.segments().iter().map(|s| json!([s.name, s.range.start, s.range.end])).collect();
    let channels: Map<String, Value> = c
        .columns
        .iter()
        .filter_map(|(name, values)| Some((name.strip_suffix("_measured_mm")?.to_owned(), sparse(values))))
        .collect();
    json!({
        "name": c.test, "noise": round(c.noise), "t": numbers(&c.time), "u": numbers(&c.displacement),
        "f": numbers(&c.measured), "segments": pieces, "channels": channels,
    })
}

/// What one rung's model says.
fn fitted_model(r: &FittedModel) -> Value {
    let (a, curves) = (&r.answer, &r.curves);
    let force: Map<String, Value> = curves.iter().map(|c| (c.test.clone(), numbers(&c.model))).collect();
    let channels: Map<String, Value> = curves
        .iter()
        .flat_map(|c| {
            c.columns.iter().filter_map(move |(name, values)| {
                Some((format!("{}.{}", c.test, name.strip_suffix("_model_mm")?), sparse(values)))
            })
        })
        .collect();
    let path: Vec<Value> = a.parameters.iter().filter_map(place).collect();
    let jacobian = r.response.json(round);
    json!({ "name": r.name(), "run": r.run, "force": force, "channels": channels, "path": path, "jacobian": jacobian })
}

/// `[gc or sigma_c, area, value, low, high, published, identifiable]`.
fn place(p: &ParameterAnswer) -> Option<Value> {
    let at = area(&p.path)? + 1;
    let what = p.path.rsplit('.').next()?;
    let [low, high] = p.interval_95.map(|x| x.map_or(Value::Null, round));
    let published = p.published.map_or(Value::Null, round);
    Some(json!([what, at, round(p.value), low, high, published, p.identifiable]))
}

/// Accepted steps: stage, objective over its start in the stage, parameters over their final values.
fn convergence(a: &IdentifyAnswer) -> Value {
    let wanted = shown_parameters(a);
    let (mut stages, mut objective) = (Vec::new(), Vec::new());
    let mut values: Vec<Vec<Value>> = vec![Vec::new(); wanted.len()];
    for h in &a.history {
        let mesh = if h.coarse { ", coarse mesh" } else { "" };
        let mut first = None;
        for run in h.runs.iter().filter(|r| r.accepted) {
            let Some(f) = run.f else { continue };
            let first = *first.get_or_insert(f.max(f64::MIN_POSITIVE));
            stages.push(json!(format!("{}{mesh}", h.stage)));
            objective.push(round((f / first).max(1e-12)));
            for ((path, end), column) in wanted.iter().zip(&mut values) {
                let at = h.paths.iter().position(|p| p == path);
                let ratio = at.and_then(|i| run.theta.get(i)).map(|x| x / end).filter(|x| *x > 0.0);
                column.push(ratio.map_or(Value::Null, round));
            }
        }
    }
    if objective.len() < 2 {
        return Value::Null;
    }
    let names: Vec<&String> = wanted.iter().map(|w| &w.0).collect();
    json!({ "stages": stages, "objective": objective, "names": names, "values": values })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_a_page_have_six_digits() {
        let shown = |x: f64| round(x).to_string();
        assert_eq!(shown(1234567.0), "1234570");
        assert_eq!(shown(-0.123456789), "-0.123457");
        assert_eq!(shown(2.0), "2");
        assert_eq!([shown(0.0), shown(-0.0)], ["0", "0"]);
        assert_eq!([f64::NAN, f64::INFINITY, f64::NEG_INFINITY].map(shown), ["null"; 3]);
        assert_eq!(numbers(&[1.5, f64::NAN]).to_string(), "[1.5,null]");
        assert_eq!(sparse(&[None, Some(1.5)]).to_string(), "[null,1.5]");
    }
}
