//! One strength along the tear path, with one effect or none, beside a model of many areas. A strength that rises along
//! the tear is how a missing effect looks: areas imitate it.

use crate::answer::{DiscoverAnswer, LadderRow, ladder_row, word};
use crate::cost::{Phase, Within};
use crate::identify::AnalysisError;
use crate::journal::{Journal, Recent};
use crate::ladder::{FeLadder, LadderSettings};
use crate::problem::Cancelled;
use diagnose::{FittedModel, Policy, Verdict};
use input::{Case, Value};
use model::Catalogue;
use serde::Serialize;
use std::sync::Arc;

/// From here on areas are many.
const MANY: usize = 3;
/// Effects that are tried.
const TRIED: usize = 3;

/// Models with one strength and toughness for the whole path.
#[derive(Clone, Debug, Serialize)]
pub struct OneStrength {
    /// What was tried.
    pub ladder: Vec<LadderRow>,
    /// Effects of those that explain the records as well as the many areas do, by BIC, best first.
    pub as_good: Vec<Vec<String>>,
    /// The same as a sentence.
    pub words: String,
}

/// Tries one strength against what a search with the case's areas ended with: where these explain the records without
/// further effect, alone and with each of the most probable effects; where they need effects, with
/// these. `None` for a case of few areas, and where even these areas explain nothing: one strength is a special case of
/// them.
///
/// # Errors
/// [`AnalysisError`].
pub fn one_strength(
    case: &Case,
    catalogue: &Catalogue,
    search: &DiscoverAnswer,
    progress: &(dyn Fn(&str) + Sync),
    cancelled: Cancelled,
    journal: &dyn Journal,
) -> Result<Option<OneStrength>, AnalysisError> {
    let Some(many) = search.ladder.last().filter(|_| case.interface.areas >= MANY) else { return Ok(None) };
    if search.verdict == word(Verdict::Unexplained) {
        return Ok(None);
    }
    progress("one strength along the path, for comparison");
    cancelled.phase(Phase::OneStrength);
    let (policy, within) = (Policy::default(), Within(cancelled));
    let cancelled: Cancelled = &within;
    let said = |line: &str| progress(&format!("one strength: {line}"));
    let recent = Recent::new(journal);
    let how =
        LadderSettings { catalogue, policy: policy.clone(), progress: &said, cancelled, journal: &recent };
    let mut found = case.clone();
    found.effects.clone_from(&many.forms);
    crate::start_at(&mut found, many.values.iter().map(|(p, v)| (p.as_str(), *v)));
    // From the values of the many areas: a start of its own may end in another valley.
    let mut ladder = FeLadder::from_values(Arc::new(simplified(&found)), how)?;
    let mut fitted_models = ladder.likely(if many.effects.is_empty() { TRIED } else { 0 }, &policy)?;
    let mut rows: Vec<LadderRow> = fitted_models.iter().map(|r| ladder_row(&ladder, r)).collect();
    // To the ladder they belong to its base model, to the reader they are what was found.
    for (fitted_model, row) in fitted_models.iter_mut().zip(&mut rows) {
        for effects in [&mut fitted_model.effects, &mut row.effects] {
            *effects = many.effects.iter().chain(effects.iter()).cloned().collect();
        }
    }
    let mut order: Vec<&FittedModel> = fitted_models.iter().collect();
    order.sort_by(|a, b| a.bic.total_cmp(&b.bic));
    let closest = order[0];
    let good = |r: &&FittedModel| r.explained(&policy) && r.bic <= many.bic + policy.tie_bic;
    let as_good: Vec<&FittedModel> = order.into_iter().filter(good).collect();
    Ok(Some(OneStrength {
        words: sentence(&as_good, closest, many),
        as_good: as_good.iter().map(|r| r.effects.clone()).collect(),
        ladder: rows,
    }))
}

/// The case with one area, which begins at the mean of the areas.
fn simplified(case: &Case) -> Case {
    let mut simple = case.clone();
    simple.interface.areas = 1;
    for list in [&mut simple.interface.gc, &mut simple.interface.sigma_c] {
        let given: Vec<f64> = list.iter().filter_map(|v| v.value).collect();
        let mean = (!given.is_empty()).then(|| given.iter().sum::<f64>() / given.len() as f64);
        list.truncate(1);
        list.iter_mut().for_each(|v| *v = Value { value: mean, ..*v });
    }
    simple
}

fn sentence(as_good: &[&FittedModel], closest: &FittedModel, many: &LadderRow) -> String {
    let Some(best) = as_good.first() else {
        return format!(
            "One strength along the path is no match for the many areas (at best {}: reduced χ² {:.2}, BIC {:.1} against {:.1}).",
            with(closest),
            closest.reduced_chi2_total(),
            closest.bic,
            many.bic
        );
    };
    let all: Vec<String> = as_good.iter().map(|r| with(r)).collect();
    format!(
        "One strength along the path ({}) explains the records as well as the many areas do: at best reduced χ² {:.2}, BIC \
         {:.1} against {:.1}, {} parameters fewer. Strengths that differ from area to area need not be the tissue's.",
        all.join(", or "),
        best.reduced_chi2_total(),
        best.bic,
        many.bic,
        many.parameters.saturating_sub(best.parameters)
    )
}

fn with(r: &FittedModel) -> String {
    if r.effects.is_empty() { "no effect".into() } else { format!("with {}", r.effects.join(" and ")) }
}
