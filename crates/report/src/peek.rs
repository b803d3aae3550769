//! Looking into answers that are only known as JSON: what is not there is empty.

use analysis::LawNames;
use serde::Deserialize;
use serde_json::Value;

/// A string.
pub fn text<'a>(v: &'a Value, key: &str) -> &'a str {
    v.get(key).and_then(Value::as_str).unwrap_or("")
}

/// A number.
pub fn number(v: &Value, key: &str) -> Option<f64> {
    v.get(key).and_then(Value::as_f64)
}

/// Whether something is said to be so.
pub fn yes(v: &Value, key: &str) -> bool {
    v.get(key).and_then(Value::as_bool) == Some(true)
}

/// A list of strings.
pub fn list(v: &Value, key: &str) -> Vec<String> {
    rows(v, key).iter().filter_map(|x| x.as_str().map(str::to_owned)).collect()
}

/// A list of anything.
pub fn rows<'a>(v: &'a Value, key: &str) -> &'a [Value] {
    v.get(key).and_then(Value::as_array).map_or(&[], Vec::as_slice)
}

/// The laws of a model, where they are known.
pub fn laws(v: &Value) -> Option<LawNames> {
    LawNames::deserialize(v.get("laws")?).ok()
}

/// Every name of a diagnosis with its rivals: `lag or viscoelastic`.
pub fn groups(diagnosis: &Value) -> Vec<String> {
    let names = |g: &Value| {
        let all: Vec<&str> = g.as_array().into_iter().flatten().filter_map(Value::as_str).collect();
        all.join(" or ")
    };
    rows(diagnosis, "groups").iter().map(names).collect()
}

/// Probabilities of five percent or more, most probable effect first; "nothing is missing" and "something else" come last and
/// always. Empty where an answer has none.
pub fn probabilities(answer: &Value) -> Vec<(String, f64)> {
    let Some(posterior) = answer.get("posterior").filter(|p| p.is_object()) else { return Vec::new() };
    let effects = posterior.get("effects").and_then(Value::as_object).into_iter().flatten();
    let mut all: Vec<(String, f64)> = effects
        .filter_map(|(name, p)| p.as_f64().map(|p| (name.clone(), p)))
        .filter(|(_, p)| *p >= LISTED)
        .collect();
    all.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    let last = [("nothing is missing", "nothing"), ("something else", "something_else")];
    all.extend(last.map(|(name, key)| (name.to_owned(), number(posterior, key).unwrap_or(0.0))));
    all
}

/// Least probability that is listed: an effect that the records say nothing of keeps some 3 %.
const LISTED: f64 = 0.05;
