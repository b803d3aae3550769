//! Posterior probabilities of an answer, as lines to show.

use crate::peek::number;
use serde_json::Value;

/// Effects that are shown hold at least this much, under some of the priors that were asked.
const LEAST: f64 = 0.01;
/// Effects at most.
const MOST: usize = 8;

/// One line: a name, its probability, the least and the most of it under other priors.
pub struct Probability {
    /// An effect, `nothing` or `something else`.
    pub name: String,
    /// Posterior probability.
    pub value: f64,
    /// Range where amplitudes and the rest are expected half or twice as large.
    pub range: [f64; 2],
}

/// The effects by probability, then nothing and something else; empty for an answer without.
pub fn probabilities(answer: &Value) -> Vec<Probability> {
    let Some(posterior) = answer.get("posterior").filter(|p| p.is_object()) else { return Vec::new() };
    let others: Vec<&Value> = posterior
        .get("sensitivity")
        .and_then(Value::as_object)
        .into_iter()
        .flat_map(|m| m.values())
        .collect();
    let line = |name: &str, of: &dyn Fn(&Value) -> f64| {
        let value = of(posterior);
        let all = others.iter().map(|v| of(v));
        let range = all.fold([value; 2], |[low, high], x| [low.min(x), high.max(x)]);
        Probability { name: name.to_owned(), value, range }
    };
    let names = posterior.get("effects").and_then(Value::as_object);
    let effect = |name: &str| {
        let of = |v: &Value| v.get("effects").and_then(|e| number(e, name)).unwrap_or(0.0);
        line(name, &of)
    };
    let mut out: Vec<Probability> = names.into_iter().flatten().map(|(n, _)| effect(n)).collect();
    out.retain(|p| p.range[1] >= LEAST);
    out.sort_by(|a, b| b.value.total_cmp(&a.value).then(a.name.cmp(&b.name)));
    out.truncate(MOST);
    out.push(line("nothing", &|v| number(v, "nothing").unwrap_or(0.0)));
    out.push(line("something else", &|v| number(v, "something_else").unwrap_or(0.0)));
    out
}

/// A probability in percent; what is rounded to none or all is not certain.
pub fn percent(p: f64) -> String {
    match p {
        p if p < 0.005 => "< 1 %".into(),
        p if p > 0.995 => "> 99 %".into(),
        p => format!("{:.0} %", 100.0 * p),
    }
}

/// The range under other priors, where it differs to the reader.
pub fn range(p: &Probability) -> String {
    let [low, high] = p.range.map(percent);
    if low == high { String::new() } else { format!("{low} to {high}") }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn effects_stand_by_probability_with_their_range() {
        let answer = json!({ "posterior": {
            "effects": { "lag": 0.02, "viscoelastic": 0.97, "gain": 1e-6 }, "nothing": 0.0, "something_else": 0.01,
            "sensitivity": { "rest_x2": { "effects": { "lag": 0.2, "viscoelastic": 0.7 }, "nothing": 0.1, "something_else": 0.0 } }
        } });
        let all = probabilities(&answer);
        let shown: Vec<(&str, String)> = all.iter().map(|p| (p.name.as_str(), range(p))).collect();
        assert_eq!(
            shown,
            [
                ("viscoelastic", "70 % to 97 %".into()),
                ("lag", "2 % to 20 %".into()),
                ("nothing", "< 1 % to 10 %".into()),
                ("something else", "< 1 % to 1 %".into())
            ]
        );
        assert!(probabilities(&json!({})).is_empty());
    }
}
