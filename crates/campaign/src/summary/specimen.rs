//! One specimen with one model: what it says of its strength, whether it counts, and why not.

use super::Quantity;
use crate::files::{Folder, Outcome};
use crate::plan::{Plan, Task};
use report::answer::{IdentifyAnswer, ParameterAnswer};
use serde::Serialize;

/// A specimen's value of one quantity: of a strength the mean over the areas that its records fix.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Strength {
    /// The value.
    pub value: f64,
    /// Its standard error, correlations of the areas included.
    pub std_error: f64,
    /// 95 % interval.
    pub interval_95: [f64; 2],
    /// Areas that count, and all areas.
    pub areas: [usize; 2],
    /// Standard deviation along the path, of two areas or more.
    pub along_sd: Option<f64>,
    /// Standard deviation over the repeats, of two or more.
    pub bootstrap_sd: Option<f64>,
}

/// A specimen with one model.
#[derive(Clone, Debug, Serialize)]
pub struct SpecimenRow {
    /// Row of the study's table.
    pub row: usize,
    /// Name.
    pub specimen: String,
    /// Group.
    pub group: String,
    /// Donor.
    pub donor: String,
    /// Where its records come from.
    pub provenance: String,
    /// Whether there is an answer.
    pub answered: bool,
    /// Whether the model explains the records.
    pub explained: bool,
    /// Fit.
    pub reduced_chi2_total: Option<f64>,
    /// Effects of its model.
    pub effects: Vec<String>,
    /// Of a search: its verdict.
    pub verdict: Option<String>,
    /// Why the study's table excludes it.
    pub excluded: Option<String>,
    /// Why it is in no mean; none: it is.
    pub left_out: Option<String>,
    /// Repeats with an answer.
    pub repeats: usize,
    /// What it says.
    pub strengths: Vec<(Quantity, Strength)>,
}

impl SpecimenRow {
    /// Whether it is in the means.
    pub fn counted(&self) -> bool {
        self.left_out.is_none()
    }

    /// Whether that its model does not explain it is all that keeps it out.
    pub fn unexplained_alone(&self) -> bool {
        self.answered && !self.explained && self.excluded.is_none()
    }

    /// Its value of a quantity.
    pub fn strength(&self, quantity: &Quantity) -> Option<&Strength> {
        self.strengths.iter().find(|(q, _)| q == quantity).map(|(_, s)| s)
    }
}

/// All specimens with one model, in the order of the plan.
pub fn rows_of(plan: &Plan, folder: &Folder, model: usize) -> Vec<SpecimenRow> {
    let mut tasks: Vec<Vec<&Task>> = vec![Vec::new(); plan.specimens.len()];
    for task in plan.tasks.iter().filter(|t| t.model == model) {
        tasks[task.specimen].push(task);
    }
    tasks.iter().enumerate().map(|(s, tasks)| row(plan, folder, s, tasks)).collect()
}

fn row(plan: &Plan, folder: &Folder, s: usize, tasks: &[&Task]) -> SpecimenRow {
    let specimen = &plan.specimens[s];
    let mut out = SpecimenRow {
        row: specimen.row,
        specimen: specimen.name.clone(),
        group: specimen.group.clone(),
        donor: specimen.donor.clone(),
        provenance: String::new(),
        answered: false,
        explained: false,
        reduced_chi2_total: None,
        effects: Vec::new(),
        verdict: None,
        excluded: specimen.exclude.clone(),
        left_out: None,
        repeats: 0,
        strengths: Vec::new(),
    };
    let first = tasks.iter().find(|t| t.repeat == 0).and_then(|t| folder.read(&t.key));
    match first.map(|r| r.outcome) {
        Some(Outcome::Done { identify, discover }) => {
            let repeats = repeats(folder, tasks);
            out.repeats = repeats.len();
            out.verdict = discover.and_then(|d| Some(d.get("verdict")?.as_str()?.to_owned()));
            fill(&mut out, &identify, &repeats);
        }
        Some(Outcome::Failed { reason }) => out.left_out = Some(format!("could not be computed: {reason}")),
        None => out.left_out = Some("not done yet".into()),
    }
    if let Some(why) = &out.excluded {
        out.left_out = Some(format!("excluded by the study: {why}"));
    }
    out
}

fn repeats(folder: &Folder, tasks: &[&Task]) -> Vec<IdentifyAnswer> {
    let one = |t: &&&Task| match folder.read(&t.key)?.outcome {
        Outcome::Done { identify, .. } => Some(*identify),
        Outcome::Failed { .. } => None,
    };
    tasks.iter().filter(|t| t.repeat > 0).filter_map(|t| one(&t)).collect()
}

fn fill(out: &mut SpecimenRow, a: &IdentifyAnswer, repeats: &[IdentifyAnswer]) {
    out.answered = true;
    out.explained = a.explained;
    out.provenance.clone_from(&a.provenance);
    out.reduced_chi2_total = Some(a.reduced_chi2_total);
    out.effects.clone_from(&a.effects);
    for (path, end, unit) in [("gc", "].gc", "N/mm"), ("sigma_c", "].sigma_c", "MPa")] {
        let is = |p: &ParameterAnswer| p.path.starts_with("interface.area[") && p.path.ends_with(end);
        let quantity = Quantity { path: path.into(), unit: unit.into() };
        out.strengths.extend(strength(a, &is, repeats).map(|s| (quantity, s)));
    }
    for p in a.parameters.iter().filter(|p| p.path.starts_with("effects.")) {
        let is = |other: &ParameterAnswer| other.path == p.path;
        let quantity = Quantity { path: p.path.clone(), unit: p.unit.clone() };
        out.strengths.extend(strength(a, &is, repeats).map(|s| (quantity, s)));
    }
    if !a.explained {
        let chi2 = report::terminal::significant(a.reduced_chi2_total, 3);
        out.left_out = Some(format!("not explained by its model, reduced χ² {chi2}"));
    } else if out.strengths.is_empty() {
        out.left_out = Some("no value that its records fix".into());
    }
}

/// Mean over the parameters that `is` takes and the records fix.
fn strength(
    a: &IdentifyAnswer,
    is: &dyn Fn(&ParameterAnswer) -> bool,
    repeats: &[IdentifyAnswer],
) -> Option<Strength> {
    let all = a.parameters.iter().filter(|p| is(p)).count();
    let known: Vec<(usize, f64, f64)> = a
        .parameters
        .iter()
        .enumerate()
        .filter(|(_, p)| is(p) && p.identifiable && !p.at_bound)
        .filter_map(|(i, p)| Some((i, p.value, p.std_error.filter(|s| *s > 0.0)?)))
        .collect();
    if known.is_empty() {
        return None;
    }
    let n = known.len() as f64;
    let value = known.iter().map(|k| k.1).sum::<f64>() / n;
    let correlation = |i: usize, j: usize| {
        let given = a.correlations.get(i).and_then(|row| row.get(j).copied().flatten());
        if i == j { 1.0 } else { given.unwrap_or(0.0) }
    };
    let pairs = known.iter().flat_map(|x| known.iter().map(move |y| (x, y)));
    let variance: f64 = pairs.map(|(x, y)| correlation(x.0, y.0) * x.2 * y.2).sum::<f64>() / (n * n);
    // Areas that hold each other in balance may be known much better together than apart, not perfectly.
    let least = known.iter().map(|k| k.2 * k.2).fold(f64::MAX, f64::min) / (n * n * 100.0);
    let std_error = variance.max(least).sqrt();
    let interval_95 = match known.as_slice() {
        [(i, ..)] => match a.parameters[*i].interval_95 {
            [Some(low), Some(high)] => [low, high],
            _ => [value - 1.96 * std_error, value + 1.96 * std_error],
        },
        _ => [value - 1.96 * std_error, value + 1.96 * std_error],
    };
    let values: Vec<f64> = known.iter().map(|k| k.1).collect();
    let again: Vec<f64> = repeats.iter().filter_map(|r| mean_of(r, &known)).collect();
    Some(Strength {
        value,
        std_error,
        interval_95,
        areas: [known.len(), all],
        along_sd: sd(&values),
        bootstrap_sd: sd(&again),
    })
}

/// The same mean in a repeat.
fn mean_of(a: &IdentifyAnswer, known: &[(usize, f64, f64)]) -> Option<f64> {
    let values: Option<Vec<f64>> = known.iter().map(|k| a.parameters.get(k.0).map(|p| p.value)).collect();
    values.map(|v| v.iter().sum::<f64>() / v.len() as f64)
}

fn sd(x: &[f64]) -> Option<f64> {
    let n = x.len() as f64;
    let mean = x.iter().sum::<f64>() / n;
    (x.len() > 1).then(|| (x.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0)).sqrt())
}
