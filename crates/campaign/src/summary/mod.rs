//! What the specimens of a study say together: by model, by group, with everything that is left out and why.

mod specimen;
mod tables;

pub use specimen::{SpecimenRow, Strength};
pub use tables::csv_files;

use crate::files::Folder;
use crate::plan::Plan;
use crate::pool::{Difference, Observation, Pooled, difference, pooled};
use crate::status::{Status, status};
use serde::Serialize;
use specimen::rows_of;

/// A quantity that is pooled.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Quantity {
    /// `gc`, `sigma_c`, or the path of an effect's parameter.
    pub path: String,
    /// Its unit; empty for a pure number.
    pub unit: String,
}

/// One quantity in one group.
#[derive(Clone, Debug, Serialize)]
pub struct GroupSummary {
    /// The group; empty: all specimens.
    pub group: String,
    /// What is pooled.
    pub quantity: Quantity,
    /// The mean over the specimens that count.
    pub pooled: Pooled,
    /// Donors among them, where the table names them all.
    pub donors: Option<usize>,
    /// The mean with those that their model does not explain, where there are some: no result, but what leaving them out
    /// does.
    pub with_unexplained: Option<f64>,
}

/// How often an effect is in the model that was chosen.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct EffectCount {
    /// Effect.
    pub effect: String,
    /// Group; empty: all.
    pub group: String,
    /// Specimens whose model has it.
    pub specimens: usize,
    /// Specimens of the group with an answer that are not excluded.
    pub of: usize,
}

/// Two groups compared.
#[derive(Clone, Debug, Serialize)]
pub struct GroupDifference {
    /// Quantity.
    pub quantity: Quantity,
    /// First group.
    pub first: String,
    /// Second group.
    pub second: String,
    /// Second minus first.
    #[serde(flatten)]
    pub difference: Difference,
}

/// One model of the study.
#[derive(Clone, Debug, Serialize)]
pub struct ModelSummary {
    /// Its name.
    pub model: String,
    /// `identify` or `discover`.
    pub task: String,
    /// Every specimen, counted or not.
    pub specimens: Vec<SpecimenRow>,
    /// Means by quantity and group.
    pub groups: Vec<GroupSummary>,
    /// Differences of groups, each with the first one.
    pub differences: Vec<GroupDifference>,
    /// Effects.
    pub effects: Vec<EffectCount>,
}

/// The whole study.
#[derive(Clone, Debug, Serialize)]
pub struct StudySummary {
    /// Version of this answer's form.
    pub schema: u32,
    /// How its tasks stand.
    #[serde(flatten)]
    pub status: Status,
    /// Version of the program that planned it.
    pub version: String,
    /// Models.
    pub models: Vec<ModelSummary>,
}

/// Reads all results of a plan and pools them.
pub fn summary(plan: &Plan, folder: &Folder) -> StudySummary {
    let models = (0..plan.models.len()).map(|m| model(plan, folder, m)).collect();
    StudySummary {
        schema: report::answer::SCHEMA,
        status: status(plan, folder),
        version: plan.version.clone(),
        models,
    }
}

fn model(plan: &Plan, folder: &Folder, m: usize) -> ModelSummary {
    let rows = rows_of(plan, folder, m);
    let groups = groups(&rows);
    let mut all = Vec::new();
    let mut differences = Vec::new();
    for quantity in quantities(&rows) {
        let of: Vec<GroupSummary> = groups.iter().filter_map(|g| group(&rows, g, &quantity)).collect();
        let named: Vec<&GroupSummary> = of.iter().filter(|g| !g.group.is_empty()).collect();
        if let Some((first, others)) = named.split_first() {
            differences.extend(others.iter().filter_map(|second| {
                Some(GroupDifference {
                    quantity: quantity.clone(),
                    first: first.group.clone(),
                    second: second.group.clone(),
                    difference: difference(&first.pooled, &second.pooled)?,
                })
            }));
        }
        all.extend(of);
    }
    let effects = effects(&rows, &groups);
    let (model, task) = (plan.models[m].name.clone(), plan.models[m].task.clone());
    ModelSummary { model, task, specimens: rows, groups: all, differences, effects }
}

/// Groups in the order of the table; the last, empty, is all of them together.
fn groups(rows: &[SpecimenRow]) -> Vec<String> {
    let mut out: Vec<String> = Vec::new();
    for row in rows.iter().filter(|r| !r.group.is_empty()) {
        if !out.contains(&row.group) {
            out.push(row.group.clone());
        }
    }
    if out.len() != 1 || rows.iter().any(|r| r.group.is_empty()) {
        out.push(String::new());
    }
    out
}

fn quantities(rows: &[SpecimenRow]) -> Vec<Quantity> {
    let mut out: Vec<Quantity> = Vec::new();
    for (quantity, _) in rows.iter().flat_map(|r| &r.strengths) {
        if !out.contains(quantity) {
            out.push(quantity.clone());
        }
    }
    out
}

fn group(rows: &[SpecimenRow], name: &str, quantity: &Quantity) -> Option<GroupSummary> {
    let of: Vec<&SpecimenRow> = rows.iter().filter(|r| name.is_empty() || r.group == name).collect();
    let take = |counts: &dyn Fn(&SpecimenRow) -> bool| -> Vec<Observation> {
        let values = of.iter().filter(|r| counts(r)).filter_map(|r| r.strength(quantity));
        values.map(|s| Observation { value: s.value, std_error: s.std_error }).collect()
    };
    let counted = take(&|r| r.counted());
    let with = take(&|r| r.counted() || r.unexplained_alone());
    let donors: Vec<&str> = of
        .iter()
        .filter(|r| r.counted() && r.strength(quantity).is_some())
        .map(|r| r.donor.as_str())
        .collect();
    let named = donors.iter().all(|d| !d.is_empty());
    let distinct: std::collections::BTreeSet<&str> = donors.iter().copied().collect();
    Some(GroupSummary {
        group: name.to_owned(),
        quantity: quantity.clone(),
        pooled: pooled(&counted)?,
        donors: named.then_some(distinct.len()),
        with_unexplained: (with.len() > counted.len()).then(|| pooled(&with).map(|p| p.mean)).flatten(),
    })
}

fn effects(rows: &[SpecimenRow], groups: &[String]) -> Vec<EffectCount> {
    let answered = || rows.iter().filter(|r| r.answered && r.excluded.is_none());
    let names: std::collections::BTreeSet<&String> = answered().flat_map(|r| &r.effects).collect();
    let count = |effect: &String, group: &String| {
        let of: Vec<_> = answered().filter(|r| group.is_empty() || r.group == *group).collect();
        EffectCount {
            effect: effect.clone(),
            group: group.clone(),
            specimens: of.iter().filter(|r| r.effects.contains(effect)).count(),
            of: of.len(),
        }
    };
    names.into_iter().flat_map(|e| groups.iter().map(move |g| (e, g))).map(|(e, g)| count(e, g)).collect()
}
