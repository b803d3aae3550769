//! Tables of compare, diagnose and discover, from their JSON answers.

use super::Style;
use serde_json::Value;
use std::fmt::Write;

fn text<'a>(v: &'a Value, key: &str) -> &'a str {
    v.get(key).and_then(Value::as_str).unwrap_or("")
}

fn number(v: &Value, key: &str) -> Option<f64> {
    v.get(key).and_then(Value::as_f64)
}

fn list(v: &Value, key: &str) -> Vec<String> {
    let items = v.get(key).and_then(Value::as_array);
    items.into_iter().flatten().filter_map(|x| x.as_str().map(str::to_owned)).collect()
}

fn rows<'a>(v: &'a Value, key: &str) -> &'a [Value] {
    v.get(key).and_then(Value::as_array).map_or(&[], Vec::as_slice)
}

fn shown(x: Option<f64>, digits: usize) -> String {
    x.map_or_else(|| "-".into(), |x| format!("{x:.digits$}"))
}

/// Verdict, ladder and screen of `fct discover` and `fct diagnose`.
pub fn discover(answer: &Value, _style: Style) -> String {
    let mut out = String::new();
    let _ = writeln!(out, "{}: {}", text(answer, "specimen"), text(answer, "verdict").replace('_', " "));
    for sentence in list(answer, "words") {
        let _ = writeln!(out, "{sentence}");
    }
    let ladder = rows(answer, "ladder");
    if !ladder.is_empty() {
        let _ = writeln!(
            out,
            "\n{:<40} {:>6} {:>10} {:>9} {:>9} {:>10}",
            "effects", "param.", "rms N", "red. χ²", "+ mesh", "BIC"
        );
        for r in ladder {
            let names = list(r, "effects");
            let name = if names.is_empty() { "(base)".to_owned() } else { names.join(" + ") };
            let _ = writeln!(
                out,
                "{:<40} {:>6} {:>10} {:>9} {:>9} {:>10}",
                name,
                shown(number(r, "parameters"), 0),
                shown(number(r, "rms_N"), 5),
                shown(number(r, "reduced_chi2"), 2),
                shown(number(r, "reduced_chi2_total"), 2),
                shown(number(r, "bic"), 0)
            );
        }
    }
    let _ = writeln!(
        out,
        "\n{:<26} {:>6} {:>9} {:>8}  look-alikes",
        "screen of the catalogue", "fall", "p", "visible"
    );
    for r in rows(answer, "screen") {
        let p = number(r, "p_value").map_or_else(|| "-".into(), |p| format!("{p:.0e}"));
        let visible = if r.get("visible").and_then(Value::as_bool) == Some(true) { "yes" } else { "no" };
        let fall = number(r, "expected_fall").map_or_else(|| "-".into(), |f| format!("{:.0} %", 100.0 * f));
        let alike = list(r, "look_alikes").join(", ");
        let _ = writeln!(out, "{:<26} {fall:>6} {p:>9} {visible:>8}  {alike}", text(r, "effect"));
    }
    places(answer, &mut out);
    if let Some(next) = answer.get("next_test").filter(|n| !n.is_null()) {
        let _ =
            writeln!(out, "\nTo separate {}: {}", list(next, "separates").join(", "), text(next, "proposal"));
    }
    out
}

fn places(answer: &Value, out: &mut String) {
    let place = rows(answer, "where");
    if !place.is_empty() {
        let _ = writeln!(out, "\nwhere the base model is off");
        for r in place.iter().take(6) {
            let share = 100.0 * number(r, "share").unwrap_or(0.0);
            let _ =
                writeln!(out, "  {:<16} {:<14} {share:>5.0} % of χ²", text(r, "test"), text(r, "segment"));
        }
    }
}

/// Distance per test and where it sits.
pub fn compare(answer: &Value, _style: Style) -> String {
    let mut out = String::new();
    let explained = answer.get("explained").and_then(Value::as_bool) == Some(true);
    let verdict = if explained { "explained: the misfit is at the noise floor" } else { "not explained" };
    let _ = writeln!(out, "{}: {verdict}", text(answer, "specimen"));
    let _ = writeln!(
        out,
        "\n{:<28} {:>6} {:>12} {:>12} {:>9} {:>9}",
        "test", "points", "rms", "noise", "red. χ²", "+ mesh"
    );
    for r in rows(answer, "tests") {
        let _ = writeln!(
            out,
            "{:<28} {:>6} {:>12} {:>12} {:>9} {:>9}",
            text(r, "name"),
            shown(number(r, "points"), 0),
            shown(number(r, "rms"), 6),
            shown(number(r, "noise"), 6),
            shown(number(r, "reduced_chi2"), 2),
            shown(number(r, "reduced_chi2_total"), 2)
        );
    }
    places(answer, &mut out);
    for sentence in list(answer, "words") {
        let _ = writeln!(out, "{sentence}");
    }
    out
}
