//! One strength along the tear path, with one effect or none, beside a model of many areas. A strength that rises along
//! the tear is how a missing effect looks: areas imitate it.

use crate::answer::{LadderRow, ladder_row};
use crate::identify::AnalysisError;
use crate::ladder::FeLadder;
use crate::problem::Cancelled;
use diagnose::{Hints, Ladder, Policy, Rung};
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
    /// Without further effect, then with one each.
    pub ladder: Vec<LadderRow>,
    /// Effects of those that explain the records as well as the many areas do, by BIC, best first.
    pub as_good: Vec<Vec<String>>,
    /// The same as a sentence.
    pub words: String,
}

/// Tries one strength, alone and with each of the effects that its screen calls for most, against the model `many`
/// that a search with the case's areas ended with. `None` for a case of few areas.
///
/// # Errors
/// [`AnalysisError`].
pub fn one_strength(
    case: &Case,
    catalogue: &Catalogue,
    many: &LadderRow,
    progress: &(dyn Fn(&str) + Sync),
    cancelled: Cancelled,
) -> Result<Option<OneStrength>, AnalysisError> {
    if case.interface.areas < MANY {
        return Ok(None);
    }
    let policy = Policy::default();
    let simple = Arc::new(simplified(case));
    let mut ladder = FeLadder::new(simple, catalogue, policy.clone(), progress, cancelled)?;
    let base = ladder.fit(&[], &Hints::new())?;
    let mut rungs = vec![base.clone()];
    if !base.explained(&policy) {
        let screen = ladder.screen(&base)?;
        let called: Vec<_> = screen.findings.iter().filter(|f| f.significant && !f.set_aside).collect();
        let hints: Hints = called.iter().map(|f| (f.effect.clone(), (*f).clone())).collect();
        let sets: Vec<Vec<String>> = called.iter().take(TRIED).map(|f| vec![f.effect.clone()]).collect();
        // One that cannot be computed is no rival.
        rungs.extend(ladder.fit_all(&sets, &hints).into_iter().flatten());
    }
    let mut order: Vec<&Rung> = rungs.iter().collect();
    order.sort_by(|a, b| a.bic.total_cmp(&b.bic));
    let closest = order[0];
    let good = |r: &&Rung| r.explained(&policy) && r.bic <= many.bic + policy.tie_bic;
    let as_good: Vec<&Rung> = order.into_iter().filter(good).collect();
    Ok(Some(OneStrength {
        words: sentence(&as_good, closest, many),
        as_good: as_good.iter().map(|r| r.effects.clone()).collect(),
        ladder: rungs.iter().map(|r| ladder_row(&ladder, r)).collect(),
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

fn sentence(as_good: &[&Rung], closest: &Rung, many: &LadderRow) -> String {
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

fn with(r: &Rung) -> String {
    if r.effects.is_empty() { "no effect".into() } else { format!("with {}", r.effects.join(" and ")) }
}
