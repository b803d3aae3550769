//! The tear's values averaged over what may be missing, as a sentence.

use crate::peek::{number, rows, text};
use crate::terminal::{readable_unit, significant};
use serde_json::Value;

/// Gc and σc along the tear, where a search told them; other values of a tear by their names.
pub fn averaged(answer: &Value) -> Option<String> {
    let means = answer.get("averaged")?.get("path_means")?.as_object()?;
    let called = |name: &str| match name {
        "gc" => "fracture energy Gc".to_owned(),
        "sigma_c" => "strength σc".to_owned(),
        other => other.to_owned(),
    };
    let one = |(name, value): (&String, &Value)| {
        let (unit, factor) = readable_unit(&format!("interface.{name}"), text(value, "unit"));
        let shown = |x: f64| significant(x * factor, 3);
        let ends: Vec<String> =
            rows(value, "interval_95").iter().filter_map(|x| x.as_f64().map(shown)).collect();
        let mean = shown(number(value, "value")?);
        let [low, high] = ends.as_slice() else { return None };
        Some(format!("{} {mean} {unit} (95 %: {low} to {high})", called(name)))
    };
    let all: Vec<String> = means.iter().filter_map(one).collect();
    (!all.is_empty())
        .then(|| format!("Averaged over what may be missing, along the tear: {}.", all.join(", ")))
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn the_tear_is_told_in_one_sentence() {
        let value = |value: f64, unit: &str| json!({ "unit": unit, "value": value, "interval_95": [0.9 * value, 1.2 * value] });
        let answer = json!({ "averaged": {
            "path_means": { "gc": value(0.2, "N/mm"), "sigma_c": value(0.15, "MPa") }, "parameters": {}, "share": 0.99
        }});
        assert_eq!(
            averaged(&answer).as_deref(),
            Some(
                "Averaged over what may be missing, along the tear: fracture energy Gc 0.200 N/mm (95 %: 0.180 to 0.240), \
                 strength σc 0.150 MPa (95 %: 0.135 to 0.180)."
            )
        );
        for nothing in [json!({}), json!({ "averaged": { "path_means": {} } }), json!({ "averaged": 1 })] {
            assert_eq!(averaged(&nothing), None);
        }
    }
}
