//! The confusion matrix: what was hidden against what was answered.

use crate::outcome::Outcome;
use std::collections::BTreeMap;
use std::fmt::Write as _;

/// Where an answer without name stands.
const NOTHING: &str = "nothing";
/// Where an unexplained record without name stands.
const OPEN: &str = "unexplained";
/// Where a case without answer stands.
const FAILED: &str = "failed";

/// Columns of one answer: the hidden effect's own where its group holds it, the first name otherwise; each once.
fn columns(o: &Outcome) -> Vec<String> {
    if o.verdict.is_empty() {
        return vec![FAILED.into()];
    }
    if o.found.is_empty() {
        return vec![if o.verdict == "unexplained" { OPEN } else { NOTHING }.into()];
    }
    o.groups
        .iter()
        .filter_map(|g| g.iter().find(|e| o.truth.effects.contains(e)).or(g.first()).cloned())
        .collect()
}

/// The matrix over cases with at most one effect.
pub fn section(outcomes: &[Outcome]) -> String {
    let mut rows: BTreeMap<(bool, String), BTreeMap<String, usize>> = BTreeMap::new();
    let mut used: Vec<String> = Vec::new();
    for o in outcomes.iter().filter(|o| o.truth.effects.len() <= 1) {
        let hidden = o.truth.effects.first().cloned().unwrap_or_else(|| "(none)".into());
        let row = rows.entry((!(o.visible() || o.truth.effects.is_empty()), hidden)).or_default();
        for c in columns(o) {
            if !used.contains(&c) {
                used.push(c.clone());
            }
            *row.entry(c).or_default() += 1;
        }
    }
    used.sort_by_key(|c| ([NOTHING, OPEN, FAILED].contains(&c.as_str()), c.clone()));
    let mut text = String::from(
        "## Confusion matrix\n\nCases with at most one hidden effect. A group counts for the hidden effect if it \
         holds it, for its first name otherwise; an answer with two effects counts in two columns. Numbers stand for \
         the answers below the table.\n\n",
    );
    for (invisible, title) in
        [(false, "What the record can see"), (true, "What it cannot (below 8 times the noise)")]
    {
        let _ = write!(text, "**{title}**\n\n| hidden |");
        for i in 1..=used.len() {
            let _ = write!(text, " {i} |");
        }
        let _ = write!(text, "\n|---|{}\n", "---|".repeat(used.len()));
        for ((_, hidden), row) in rows.iter().filter(|((i, _), _)| *i == invisible) {
            let _ = write!(text, "| {hidden} |");
            for c in &used {
                let cell = match row.get(c) {
                    Some(n) if c == hidden => format!("**{n}**"),
                    Some(n) => n.to_string(),
                    None => "·".into(),
                };
                let _ = write!(text, " {cell} |");
            }
            text.push('\n');
        }
        text.push('\n');
    }
    let key: Vec<String> = used.iter().enumerate().map(|(i, c)| format!("{} {c}", i + 1)).collect();
    let _ = writeln!(text, "{}.\n", key.join(", "));
    text
}
