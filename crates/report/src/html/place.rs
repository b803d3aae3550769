//! Where the model is off: segments of the force records, camera channels.

use super::answer::explained;
use super::escape;
use super::view::{FittedModel, View};
use crate::peek::{number, rows, text};
use crate::terminal::significant;
use serde_json::Value;

/// (test, segment, share of χ², whether the model lies too low or too high, if either).
pub type Place = (String, String, f64, char);

/// Where the misfit sits, largest share first, of the model that is described: from its own curves, as the atlas below
/// shows them. A diagnosis fits the base model in its own way, so what it tells is used only where no curves are.
pub fn places(v: &View) -> Vec<Place> {
    if let Some(fitted_model) = described(v).filter(|r| !r.curves.is_empty()) {
        let residuals: Vec<_> = fitted_model.curves.iter().map(crate::Curve::residuals).collect();
        let of = |(test, s): (String, diagnose::atlas::SegmentMisfit)| (test, s.segment, s.share, s.sign);
        return analysis::located(&residuals).into_iter().map(of).collect();
    }
    let told = v.diagnosis.as_ref().map_or(&[][..], |d| rows(d, "where"));
    let sign = |r: &Value| if number(r, "mean_N").unwrap_or(0.0) < 0.0 { '-' } else { '+' };
    let of = |r: &Value| {
        (text(r, "test").into(), text(r, "segment").into(), number(r, "share").unwrap_or(0.0), sign(r))
    };
    told.iter().map(of).collect()
}

/// The model whose misfit is described: of a ladder that explains the records the base, whose misfit was the question.
pub fn described(v: &View) -> Option<&FittedModel> {
    if v.fitted_models.len() > 1 && explained(v) { v.fitted_models.first() } else { v.current() }
}

/// Camera channels that the model misses, and the worst if it is missed more than every force.
pub fn cameras(v: &View) -> (String, Option<String>) {
    let Some(a) = v.current().map(|r| &r.answer) else { return (String::new(), None) };
    let force = a.tests.values().map(|t| t.reduced_chi2_total).fold(0.0, f64::max);
    let mut off: Vec<_> = a.channels.iter().filter(|(_, t)| t.reduced_chi2_total > 2.0).collect();
    off.sort_by(|a, b| b.1.reduced_chi2_total.total_cmp(&a.1.reduced_chi2_total));
    let line = |(n, t): &(&String, &crate::answer::TestFit)| {
        format!("<li>camera, {}: χ² <b>{}</b></li>", escape(n), significant(t.reduced_chi2_total, 3))
    };
    let worst = off.first().filter(|(_, t)| t.reduced_chi2_total > force).map(|(n, _)| escape(n));
    (off.iter().map(line).collect(), worst)
}
