//! One specimen with one model: what it says of its strength, whether it counts, and why not.

use super::Quantity;
use crate::files::{Folder, Outcome};
use crate::plan::{Plan, Task};
use report::answer::{IdentifyAnswer, ParameterAnswer};
use serde::Serialize;

/// A specimen's value of one quantity: of a strength the mean along the tear path.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Strength {
    /// The value.
    pub value: f64,
    /// Its standard error, correlations of the areas included.
    pub std_error: f64,
    /// 95 % interval.
    pub interval_95: [f64; 2],
    /// Areas in the mean, and all areas.
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
    for path in ["gc", "sigma_c"] {
        out.strengths.extend(along_path(a, path, repeats));
    }
    for p in a.parameters.iter().filter(|p| p.path.starts_with("effects.")) {
        let quantity = Quantity { path: p.path.clone(), unit: p.unit.clone() };
        out.strengths.extend(of_effect(p, repeats).map(|s| (quantity, s)));
    }
    if !a.explained {
        let chi2 = report::terminal::significant(a.reduced_chi2_total, 3);
        out.left_out = Some(format!("not explained by its model, reduced χ² {chi2}"));
    } else if out.strengths.is_empty() {
        out.left_out = Some("no value that its records fix".into());
    }
}

/// The mean of a strength along the tear path, if the records fix it.
fn along_path(a: &IdentifyAnswer, name: &str, repeats: &[IdentifyAnswer]) -> Option<(Quantity, Strength)> {
    let mean = a.mean_along_path(name)?;
    let inside = a.in_path_mean(name);
    // The scatter along the path is that of areas which are known one by one.
    let known = inside.iter().map(|&i| &a.parameters[i]).filter(|p| p.identifiable);
    let values: Vec<f64> = known.map(|p| p.value).collect();
    let again: Vec<f64> = repeats.iter().filter_map(|r| mean_of(r, &inside)).collect();
    let strength = Strength {
        value: mean.value,
        std_error: mean.std_error,
        interval_95: mean.interval_95,
        areas: [mean.counted, mean.areas],
        along_sd: sd(&values),
        bootstrap_sd: sd(&again),
    };
    Some((Quantity { path: name.into(), unit: mean.unit.clone() }, strength))
}

/// A parameter of an effect, if the records fix it.
fn of_effect(p: &ParameterAnswer, repeats: &[IdentifyAnswer]) -> Option<Strength> {
    let std_error = p.std_error.filter(|s| *s > 0.0 && p.identifiable && !p.at_bound)?;
    let interval_95 = match p.interval_95 {
        [Some(low), Some(high)] => [low, high],
        _ => [p.value - 1.96 * std_error, p.value + 1.96 * std_error],
    };
    let again = repeats.iter().filter_map(|r| r.parameters.iter().find(|q| q.path == p.path));
    let again: Vec<f64> = again.map(|q| q.value).collect();
    Some(Strength {
        value: p.value,
        std_error,
        interval_95,
        areas: [1, 1],
        along_sd: None,
        bootstrap_sd: sd(&again),
    })
}

/// The same mean in a repeat.
fn mean_of(a: &IdentifyAnswer, inside: &[usize]) -> Option<f64> {
    let values: Option<Vec<f64>> = inside.iter().map(|&i| a.parameters.get(i).map(|p| p.value)).collect();
    values.filter(|v| !v.is_empty()).map(|v| v.iter().sum::<f64>() / v.len() as f64)
}

fn sd(x: &[f64]) -> Option<f64> {
    let n = x.len() as f64;
    let mean = x.iter().sum::<f64>() / n;
    (x.len() > 1).then(|| (x.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0)).sqrt())
}
