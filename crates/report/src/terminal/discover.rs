//! Tables of diagnose and discover, from their JSON answers.

use super::{Style, significant, table, wrap};
use crate::averaged::averaged;
use crate::law_columns::said;
use crate::peek::{groups, laws, list, number, probabilities, rows, text, yes};
use analysis::{LawNames, percent};
use input::visible;
use serde_json::Value;
use std::fmt::Write;

/// Segments that are named.
const PLACES: usize = 6;
/// Columns of a bar.
const BAR: f64 = 12.0;

fn shown(x: Option<f64>, digits: i32) -> String {
    x.map_or_else(|| "–".into(), |x| significant(x, digits))
}

/// Sentences, each broken at the width of a terminal.
fn sentences(out: &mut String, all: &[String], style: Style) {
    for sentence in all {
        // Writing to a String cannot fail.
        let _ = writeln!(out, "{}", wrap(sentence, style.width, 0));
    }
}

/// A verdict in its colour; a screen alone only calls for effects.
fn verdict(answer: &Value, style: Style) -> String {
    let word = text(answer, "verdict").replace('_', " ");
    let called = groups(answer);
    if rows(answer, "ladder").is_empty() && !called.is_empty() {
        return style
            .notice(&format!("the screen calls for {} (nothing was refitted)", called.join(" and ")));
    }
    match word.as_str() {
        "nothing missing" | "explained" => style.good(&word),
        "ambiguous" => style.notice(&word),
        _ => style.bad(&word),
    }
}

/// Verdict, ladder and screen of `fct discover` and `fct diagnose`.
pub fn discover(answer: &Value, style: Style) -> String {
    let mut out = String::new();
    let _ = writeln!(out, "{}: {}", style.bold(text(answer, "specimen")), verdict(answer, style));
    if text(answer, "provenance").to_lowercase().starts_with("synthetic") {
        let _ = writeln!(out, "{}", style.notice("The records are synthetic, not measured."));
    }
    let words: Vec<String> = list(answer, "words").into_iter().chain(averaged(answer)).collect();
    sentences(&mut out, &words, style);
    if !probabilities(answer).is_empty() {
        let _ = writeln!(
            out,
            "\n{}\n{}",
            style.bold("How probable it is that this acts"),
            probable(answer, style)
        );
    }
    if !rows(answer, "ladder").is_empty() {
        let _ = writeln!(out, "\n{}\n{}", style.bold("Ladder"), ladder(rows(answer, "ladder"), style));
    }
    let _ = writeln!(out, "\n{}\n{}", style.bold("Screen of the catalogue"), screen(answer, style));
    let _ = writeln!(out, "{}", wrap(MARKS, style.width, 0));
    places(answer, style, &mut out);
    if let Some(next) = answer.get("next_test").filter(|n| !n.is_null()) {
        let rivals = list(next, "separates").join(" from ");
        let power = number(next, "expected_power")
            .map_or_else(String::new, |p| format!(" (simulated: told apart with a chance of {})", chance(p)));
        let line = format!("To separate {rivals}: {}{power}", text(next, "proposal"));
        let _ = writeln!(out, "\n{}", wrap(&line, style.width, 0));
    }
    out
}

/// What the columns of a screen mean.
const MARKS: &str = "p: the chance of so much without the effect, with the noise as estimated. Called for: decided with noise as \
                     correlated as these records allow; if large: only in more than a plausible amount.";

fn ladder(fitted_models: &[Value], style: Style) -> String {
    let most = fitted_models.iter().filter_map(|r| number(r, "rms_N")).fold(f64::MIN_POSITIVE, f64::max);
    let all: Vec<Option<LawNames>> = fitted_models.iter().map(laws).collect();
    let base = all.first().and_then(Option::as_ref);
    let lines = fitted_models.iter().zip(&all).map(|(r, own)| {
        let effects = list(r, "effects");
        let names = own.as_ref().zip(base).map_or(effects.clone(), |(own, base)| own.parts(base, &effects));
        let share = number(r, "rms_N").unwrap_or(0.0) / most;
        vec![
            if names.is_empty() { "base".to_owned() } else { names.join(" + ") },
            number(r, "parameters").map_or_else(String::new, |n| format!("{n:.0}")),
            shown(number(r, "rms_N"), 3),
            "█".repeat((share * BAR).round().max(1.0) as usize),
            shown(number(r, "held_out_rms_N"), 3),
            shown(number(r, "reduced_chi2"), 3),
            shown(number(r, "reduced_chi2_total"), 3),
            shown(number(r, "bic"), 5),
        ]
    });
    let header = ["effects", "param.", "rms (N)", "", "held out (N)", "χ²/ν", "with num. error", "BIC"];
    let mut out = table(style, &header, &[0, 3], lines.collect());
    if let Some(said) = base.and_then(|b| said(all.iter().map(Option::as_ref), b, "Laws of the base")) {
        let _ = write!(out, "\n\n{}", wrap(&said, style.width, 0));
    }
    out
}

fn probable(answer: &Value, style: Style) -> String {
    let bar = |p: f64| "█".repeat((p.clamp(0.0, 1.0) * BAR).round() as usize);
    let lines = probabilities(answer).into_iter().map(|(name, p)| vec![name, percent(p), bar(p)]);
    table(style, &["", "probability", ""], &[0, 2], lines.collect())
}

fn screen(answer: &Value, style: Style) -> String {
    let lines = rows(answer, "screen").iter().map(|r| {
        let fall = number(r, "expected_fall").unwrap_or(0.0);
        let alike = list(r, "look_alikes");
        let more = if alike.len() > 3 { format!(", {} more", alike.len() - 3) } else { String::new() };
        vec![
            text(r, "effect").to_owned(),
            format!("{:.0} %", 100.0 * fall),
            "█".repeat((fall.clamp(0.0, 1.0) * BAR).round() as usize),
            number(r, "p_value").map_or_else(|| "–".into(), p_value),
            called(r).to_owned(),
            format!("{}{more}", alike.iter().take(3).cloned().collect::<Vec<_>>().join(", ")),
        ]
    });
    let header = ["effect", "χ² falls by", "", "p", "", "look-alikes"];
    table(style, &header, &[0, 2, 4, 5], lines.collect())
}

fn places(answer: &Value, style: Style, out: &mut String) {
    let place = rows(answer, "where");
    if place.is_empty() {
        return;
    }
    let _ = writeln!(out, "\n{}", style.bold("Where the base model is off"));
    for r in place.iter().take(PLACES) {
        let share = number(r, "share").unwrap_or(0.0);
        let bar = "█".repeat((share * 2.0 * BAR).round() as usize);
        let (test, segment) = (visible(text(r, "test")), visible(text(r, "segment")));
        let _ = writeln!(out, "  {test:<16} {segment:<14} {:>4.0} % of χ²  {bar}", 100.0 * share);
    }
}

/// What a row of the screen says of its effect, in one place: a plausible amount of what is not called for may show
/// or not; what is called for shows, though it may take more than a plausible amount.
pub(crate) fn called(row: &Value) -> &'static str {
    match (yes(row, "significant"), yes(row, "visible")) {
        (true, true) => "called for",
        (true, false) => "called for, if large",
        (false, true) => "",
        (false, false) => "would not show here",
    }
}

/// A p-value; a tail beyond what a double holds well is said to be below it.
pub(crate) fn p_value(p: f64) -> String {
    if p < 1e-99 {
        "< 1e-99".into()
    } else if p < 0.01 {
        format!("{p:.0e}")
    } else {
        format!("{p:.2}")
    }
}

/// A chance in percent; one that is rounded to all is not certain.
pub(crate) fn chance(p: f64) -> String {
    if p > 0.99 { "over 99 %".into() } else { format!("{:.0} %", 100.0 * p) }
}
