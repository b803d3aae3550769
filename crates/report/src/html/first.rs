//! The top of the page: one plain sentence, what was identified, the main curve.

use super::answer::{explained, mean_off, practice, something_else, verdict};
use super::place::places;
use super::view::{FittedModel, View};
use super::{chart, escape, per_model};
use crate::answer::{IdentifyAnswer, ParameterAnswer};
use crate::averaged::averaged;
use crate::peek::{groups, number, rows, text};
use crate::terminal::{interval, known, mean_sd, pair, readable_unit, significant};
use serde_json::Value;

/// The section.
pub fn section(v: &View) -> String {
    let (good, sentence) = cause(v);
    let class = if good { "good" } else { "bad" };
    let values = per_model(v, |r| values(&r.answer));
    let average = v.diagnosis.as_ref().and_then(averaged);
    let average =
        average.map_or_else(String::new, |said| format!("<p class=\"muted\">{}</p>\n", escape(&said)));
    let curve = v.current().and_then(main_curve).map_or_else(String::new, |test| {
        chart("main", test, &format!("{test}: record and model with ± 2 sd of the noise"))
    });
    format!(
        "<section id=\"first\"><p class=\"lead {class}\">{}</p>\n{}<div class=\"first\"><div>{values}</div>\n{curve}</div>\n{average}</section>\n",
        escape(&sentence),
        left_out(v)
    )
}

/// That the sentence is one of a part of the records.
fn left_out(v: &View) -> String {
    let ends = v.diagnosis.as_ref().map_or(&[][..], |d| rows(d, "left_out"));
    let one = |l: &Value| {
        let [points, of] = ["points", "of"].map(|key| number(l, key).unwrap_or(0.0));
        format!(
            "<p class=\"bad\">This leaves out the last {points} of {of} points of {}, where the force falls steeply: no \
             effect came near the whole records.</p>\n",
            escape(text(l, "test"))
        )
    };
    ends.iter().map(one).collect()
}

/// The test that is torn, else the first.
fn main_curve(r: &FittedModel) -> Option<&str> {
    let measured = || r.curves.iter().filter(|c| !c.measured.is_empty());
    let torn = measured().find(|c| !c.residuals().tear_front.is_empty());
    torn.or_else(|| measured().next()).map(|c| c.test.as_str())
}

/// Whether the records are explained, and what is the cause, in one sentence.
pub fn cause(v: &View) -> (bool, String) {
    let good = explained(v);
    let named = v.diagnosis.as_ref().map(groups).unwrap_or_default().join(", and ");
    let searched = v.run.info.command == "discover";
    let model = v.current().filter(|_| v.fitted_models.len() > 1 || searched).map(FittedModel::name);
    let added = model.filter(|m| m != "base model");
    let sentence = match (good, verdict(v)) {
        _ if v.current().is_none() => v.diagnosis.as_ref().map_or_else(
            || "The run has no answer.".to_owned(),
            |_| format!("The search named {}.", if named.is_empty() { "nothing" } else { named.as_str() }),
        ),
        (true, "ambiguous") if searched && named.is_empty() => {
            "The base model explains the records; whether an effect is missing, they cannot tell.".to_owned()
        }
        (true, "ambiguous") if searched => {
            format!(
                "{named} explains the records; which of the names that stand together it is, these records cannot tell."
            )
        }
        (true, _) if mean_off(v).is_some() => {
            let by = added.map_or_else(String::new, |m| format!(" with {m}"));
            format!("The model explains the records{by}, as far as the mesh's own error lets anyone see.")
        }
        (true, _) => {
            let by = added.map_or_else(String::new, |m| format!(" with {m}"));
            let left = practice(v).map_or_else(
                || "noise".to_owned(),
                |share| format!("{share:.1} % of the peak force, as in a complete model of such a test"),
            );
            format!("The model explains the records{by}: what is left is {left}.")
        }
        (false, "unexplained") if searched && named.is_empty() => {
            "No effect of the catalogue explains the records.".to_owned()
        }
        (false, "unexplained") if searched && something_else(v) => {
            format!("Missing: {named}, and something that the catalogue does not hold.")
        }
        (false, "unexplained") if searched => {
            format!("Missing: {named}; more is left than a complete model leaves.")
        }
        (false, _) => {
            let place = places(v).into_iter().next();
            let off = place.map_or_else(String::new, |(test, segment, share, _)| {
                format!(": it is off most in {test}, {segment} ({:.0} % of χ²)", 100.0 * share)
            });
            let by = added.map_or_else(String::new, |m| format!(", even with {m}"));
            let why = match (v.diagnosis.is_some(), named.is_empty()) {
                (true, false) if v.fitted_models.len() < 2 => {
                    format!(" The screen points to {named}; nothing was refitted yet.")
                }
                (true, true) => " The screen points to no effect of the catalogue.".to_owned(),
                _ => String::new(),
            };
            format!("The model does not explain the records{by}{off}.{why}")
        }
    };
    (good, sentence)
}

/// Gc and σc: one area's value with its interval; of several areas their mean along the path, or that of those the
/// records fix one by one.
fn values(a: &IdentifyAnswer) -> String {
    let of = |end: &str| -> Vec<&ParameterAnswer> {
        a.parameters
            .iter()
            .filter(|p| p.path.starts_with("interface.area[") && p.path.ends_with(end))
            .collect()
    };
    [("].gc", "fracture energy Gc"), ("].sigma_c", "strength σc")]
        .iter()
        .map(|(end, name)| match of(end).as_slice() {
            [] => String::new(),
            [one] => tile(name, readable_unit(&one.path, &one.unit).0, &alone(one)),
            all => tile(name, readable_unit(&all[0].path, &all[0].unit).0, &together(a, end, all)),
        })
        .collect()
}

/// A value, and what is known of it.
fn alone(p: &ParameterAnswer) -> [String; 2] {
    let (_, factor) = readable_unit(&p.path, &p.unit);
    let value = significant(p.value * factor, 4);
    let known = match (p.at_bound, p.identifiable) {
        (true, _) => format!("95 %: {}; it stands at a bound", interval(p, factor)),
        (_, false) => "not fixed by the records".to_owned(),
        _ => format!("95 %: {}", interval(p, factor)),
    };
    [value, known]
}

fn together(a: &IdentifyAnswer, end: &str, all: &[&ParameterAnswer]) -> [String; 2] {
    let fixed = known(a, end);
    if let Some(mean) = a.path_means.get(end.trim_start_matches("].")) {
        let of = if mean.counted < mean.areas {
            format!(", {} of {} areas", mean.counted, mean.areas)
        } else {
            String::new()
        };
        let [low, high] = mean.interval_95.map(|x| significant(x, 3));
        let error = significant(mean.std_error, 2);
        let by_itself = match fixed.len() {
            0 => "no area is known by itself".to_owned(),
            n => format!("{n} of {} areas are known by themselves", all.len()),
        };
        let note =
            format!("mean along the tear path{of} ± its standard error (95 %: {low} – {high}); {by_itself}");
        return [format!("{} ± {error}", significant(mean.value, 3)), note];
    }
    if fixed.is_empty() {
        return ["–".into(), format!("in none of the {} areas fixed by the records", all.len())];
    }
    let ends = |at: usize, worst: fn(f64, f64) -> f64| {
        all.iter().filter(|p| p.identifiable && !p.at_bound).filter_map(|p| p.interval_95[at]).reduce(worst)
    };
    let range = match (ends(0, f64::min), ends(1, f64::max)) {
        (Some(low), Some(high)) => {
            let theirs =
                if fixed.len() == 1 { "its 95 % interval is" } else { "their 95 % intervals lie within" };
            format!("; {theirs} {} – {}", significant(low, 3), significant(high, 3))
        }
        _ => String::new(),
    };
    let what = match fixed.len() {
        1 => format!("of the only one of {} areas that the records fix{range}", all.len()),
        n => format!("mean ± SD of the {n} of {} areas that the records fix{range}", all.len()),
    };
    [pair(mean_sd(&fixed)), what]
}

fn tile(name: &str, unit: &str, [value, note]: &[String; 2]) -> String {
    let [name, value, unit, note] = [name, value, unit, note].map(escape);
    format!(
        "<div class=\"value\"><span>{name}</span><b>{value} <small>{unit}</small></b><span>{note}</span></div>\n"
    )
}
