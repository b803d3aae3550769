//! Sliders that need no server: the linear response by the derivatives that the run left.

use super::view::{FittedModel, View};
use super::{escape, per_model};
use crate::answer::ParameterAnswer;
use crate::terminal::readable_unit;
use crate::{ReportError, StoredRun};
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;

/// Most derivatives that a page carries for one model: about a megabyte.
const MOST: usize = 150_000;

/// Derivatives of the force at the record's points, N per unit of the parameter as answers have it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Response {
    /// Paths of the parameters.
    pub paths: Vec<String>,
    /// Per test one list for each parameter.
    pub tests: BTreeMap<String, Vec<Vec<f64>>>,
}

impl Response {
    /// The derivatives that a run stored; empty where it has none, or more than a page should carry.
    ///
    /// # Errors
    /// If the file is damaged.
    pub fn of(run: &StoredRun) -> Result<Self, ReportError> {
        const NAME: &str = "jacobian.csv";
        if !run.holds(NAME) {
            return Ok(Self::default());
        }
        let out = Self::parse(&run.file(NAME)?).unwrap_or_default();
        let numbers: usize = out.tests.values().flatten().map(Vec::len).sum();
        Ok(if numbers <= MOST { out } else { Self::default() })
    }

    fn parse(content: &[u8]) -> Option<Self> {
        let mut reader = csv::Reader::from_reader(content);
        let paths: Vec<String> = reader.headers().ok()?.iter().skip(3).map(str::to_owned).collect();
        let mut tests: BTreeMap<String, Vec<Vec<f64>>> = BTreeMap::new();
        for row in reader.records() {
            let row = row.ok()?;
            // Camera channels are blocks `test.channel`; a test's name has no dot.
            let Some(block) = row.get(0).filter(|b| !b.contains('.')) else { continue };
            let columns = tests.entry(block.to_owned()).or_insert_with(|| vec![Vec::new(); paths.len()]);
            for (column, cell) in columns.iter_mut().zip(row.iter().skip(3)) {
                column.push(cell.parse().ok()?);
            }
        }
        Some(Self { paths, tests })
    }

    /// As the page's script takes it: `{ "paths": […], "tests": { tearing: [[…], …] } }`; `null` where there is none.
    pub fn json(&self, round: impl Fn(f64) -> Value) -> Value {
        if self.paths.is_empty() || self.tests.is_empty() {
            return Value::Null;
        }
        let list = |x: &Vec<f64>| Value::Array(x.iter().map(|v| round(*v)).collect());
        let tests: Map<String, Value> = self
            .tests
            .iter()
            .map(|(name, columns)| (name.clone(), Value::Array(columns.iter().map(list).collect())))
            .collect();
        json!({ "paths": self.paths, "tests": tests })
    }
}

/// One slider per parameter whose derivatives are in the page; the script fills in what moves.
pub fn section(v: &View) -> String {
    if v.fitted_models.iter().all(|r| movable(r).next().is_none()) {
        return String::new();
    }
    format!(
        "<section id=\"sliders\"><h2>Move a parameter</h2>\n<p class=\"muted\">The dashed line in the curves above follows by the \
         derivatives at the fit: a straight-line estimate, good for small moves. What it says exactly, the command beneath \
         computes.</p>\n{}<p class=\"readout\" id=\"moved\" role=\"status\"></p>\n<div class=\"tools\">\
         <button type=\"button\" id=\"back\">Back to the fit</button></div>\n<pre id=\"moved-command\" hidden></pre></section>\n",
        per_model(v, |r| movable(r).map(slider).collect())
    )
}

fn movable(r: &FittedModel) -> impl Iterator<Item = &ParameterAnswer> {
    r.answer.parameters.iter().filter(|p| r.response.paths.contains(&p.path) && p.value.is_finite())
}

/// From a third to three times a positive value, as far to both sides of another one; not beyond a bound at 0.
fn range(p: &ParameterAnswer) -> [f64; 2] {
    let half = p.interval_95.iter().flatten().map(|e| (e - p.value).abs()).fold(0.0, f64::max);
    let wide = (3.0 * p.value.abs()).max(half).max(1e-9);
    match p.value {
        v if v > 0.0 => [v / 3.0, v * 3.0],
        0.0 if p.at_bound => [0.0, wide],
        v => [v - wide, v + wide],
    }
}

fn slider(p: &ParameterAnswer) -> String {
    let (unit, factor) = readable_unit(&p.path, &p.unit);
    let [low, high] = range(p);
    let path = escape(&p.path);
    format!(
        "<label class=\"slider\"><span>{path}</span><input type=\"range\" min=\"0\" max=\"1000\" data-path=\"{path}\" data-value=\"{:e}\" \
         data-low=\"{low:e}\" data-high=\"{high:e}\" data-factor=\"{factor:e}\" data-unit=\"{}\" aria-label=\"{path}\"><output></output></label>\n",
        p.value,
        escape(unit)
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn forces_are_read_and_cameras_are_not() {
        let csv =
            b"block,row,prediction,bulk.mu,bulk.k1\ntear,0,0.1,1.0,2\ntear,1,0.2,3,4e-9\ntear.grip,0,1,7,8\n";
        let read = Response::parse(csv).unwrap_or_default();
        assert_eq!(read.paths, ["bulk.mu", "bulk.k1"]);
        assert_eq!(read.tests["tear"], [[1.0, 3.0], [2.0, 4e-9]]);
        assert!(read.tests.len() == 1 && Response::parse(b"block,row,prediction,a\nx,0,0,what\n").is_none());
        assert_eq!(read.json(|x| json!(x))["tests"]["tear"][0], json!([1.0, 3.0]));
        assert_eq!(Response::default().json(|x| json!(x)), Value::Null);
    }

    #[test]
    fn a_slider_goes_as_far_as_its_value_asks() {
        let at = |value: f64, at_bound: bool, interval: [Option<f64>; 2]| {
            let known = json!({
                "path": "bulk.mu", "value": value, "unit": "MPa", "std_error": null, "interval_95": interval,
                "at_bound": at_bound, "identifiable": true,
            });
            range(&serde_json::from_value(known).expect("a parameter"))
        };
        assert_eq!(at(3.0, false, [None, None]), [1.0, 9.0]);
        assert_eq!(at(-2.0, false, [None, None]), [-8.0, 4.0]);
        // An interval wider than that is shown whole.
        assert_eq!(at(-2.0, false, [Some(-12.0), Some(5.0)]), [-12.0, 8.0]);
        assert_eq!(at(0.0, false, [Some(-0.5), Some(0.25)]), [-0.5, 0.5]);
        assert_eq!(at(0.0, true, [Some(0.0), Some(0.25)]), [0.0, 0.25]);
    }
}
