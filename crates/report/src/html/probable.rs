//! Probabilities as bars.

use super::{escape, share_class};
use crate::peek::probabilities;
use analysis::percent;
use serde_json::Value;

/// A bar for every effect with five percent or more, for "nothing" and for "something else"; empty where an answer has none.
pub fn bars(answer: &Value) -> String {
    let all = probabilities(answer);
    if all.is_empty() {
        return String::new();
    }
    let one = |(name, p): &(String, f64)| {
        format!(
            "<tr><th scope=\"row\">{}</th><td class=\"share\"><span class=\"{}\"></span></td><td>{}</td></tr>\n",
            escape(name),
            share_class(*p),
            escape(&percent(*p))
        )
    };
    let rows: String = all.iter().map(one).collect();
    format!(
        "<table class=\"probable\"><caption>How probable it is that this acts</caption>\n{rows}</table>\n"
    )
}
