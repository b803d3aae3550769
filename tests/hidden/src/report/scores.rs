//! The stated probabilities against the truth: scores, and how often what was said with a probability was so.

use super::beside::by_names;
use super::{Beside, share};
use crate::outcome::{Outcome, Stated};
use std::fmt::Write as _;

/// Probabilities are kept this far off 0 and 1 in the logarithmic score.
const FLOOR: f64 = 1e-6;

/// Draws behind a consistency band.
const DRAWS: usize = 1000;

/// Edges of the rows of the table of reliability.
const EDGES: [f64; 7] = [0.0, 0.05, 0.25, 0.5, 0.75, 0.9, 1.0];

/// Statements about effects, and whether each was so; cases of the catalogue or without effect alone.
struct Statements {
    stated: Vec<f64>,
    so: Vec<bool>,
}

impl Statements {
    /// Of every case the probability of every effect, as `by` has it.
    fn of(outcomes: &[Outcome], by: impl Fn(&Outcome, &Stated) -> Stated) -> Self {
        let mut all = Self { stated: Vec::new(), so: Vec::new() };
        for o in outcomes.iter().filter(|o| o.truth.is_known()) {
            let Some(s) = &o.stated else { continue };
            for (effect, probability) in by(o, s).effects {
                all.stated.push(probability);
                all.so.push(o.truth.effects.contains(&effect));
            }
        }
        all
    }

    fn log(&self) -> f64 {
        evidence::scores::log_score(&self.stated, &self.so, FLOOR)
    }

    fn brier(&self) -> f64 {
        evidence::scores::brier(&self.stated, &self.so)
    }
}

/// Effects that a case was told with 90 % or more.
pub fn said(o: &Outcome) -> impl Iterator<Item = &String> {
    o.stated.iter().flat_map(|s| s.effects.iter().filter(|(_, p)| **p >= 0.9).map(|(e, _)| e))
}

/// Whether an interval of Gc holds the truth.
pub fn inside(o: &Outcome, [_, low, high]: [f64; 3]) -> bool {
    (low..=high).contains(&o.truth.gc())
}

/// Half the width of an interval of Gc, over the truth.
pub fn half_width(o: &Outcome, [_, low, high]: [f64; 3]) -> f64 {
    0.5 * (high - low) / o.truth.gc()
}

/// The section.
pub fn section(outcomes: &[Outcome], beside: Option<&Beside>) -> String {
    let own = Statements::of(outcomes, |_, s| s.clone());
    if own.stated.is_empty() {
        return String::new();
    }
    let names = Statements::of(outcomes, |o, s| by_names(o, s.effects.keys()));
    let rate = own.so.iter().filter(|y| **y).count() as f64 / own.so.len() as f64;
    let flat = Statements { stated: vec![rate; own.so.len()], so: own.so.clone() };
    let mut text = format!(
        "## Stated probabilities\n\n{} statements: of every case with effects of the catalogue or none, the probability of \
         every effect, whether the record can see it or not. *Names alone*: the same answers without their \
         probabilities, each named group 95 % in even shares.\n\n\
         | | −ln p | Brier |\n|---|---|---|\n",
        own.stated.len()
    );
    let other = beside.map(|b| (b.name.as_str(), Statements::of(&b.outcomes, |_, s| s.clone())));
    let all = [("as stated", &own), ("names alone", &names), ("base rate", &flat)];
    for (what, s) in all.into_iter().chain(other.iter().map(|(name, s)| (*name, s))) {
        let _ = writeln!(text, "| {what} | {:.4} | {:.4} |", s.log(), s.brier());
    }
    text.push_str(&reliability(&own));
    text
}

fn reliability(s: &Statements) -> String {
    let curve = evidence::scores::reliability(&s.stated, &s.so, DRAWS);
    let mut text = format!(
        "\nReliability curve (isotonic regression, Dimitriadis, Gneiting & Jordan 2021): miscalibration {:.4}, \
         discrimination {:.4}, uncertainty {:.4}; {:.0} % of it lies within its 90 % consistency band.\n\n\
         | stated | statements | mean of them | so |\n|---|---|---|---|\n",
        curve.miscalibration,
        curve.discrimination,
        curve.uncertainty,
        100.0 * curve.within
    );
    for w in EDGES.windows(2) {
        let inside = |p: f64| p >= w[0] && (p < w[1] || w[1] >= 1.0);
        let (mut sum, mut so, mut n) = (0.0, 0, 0);
        for (p, y) in s.stated.iter().zip(&s.so).filter(|(p, _)| inside(**p)) {
            (sum, so, n) = (sum + p, so + usize::from(*y), n + 1);
        }
        let mean = if n > 0 { format!("{:.1} %", 100.0 * sum / f64::from(n)) } else { "–".into() };
        let _ = writeln!(
            text,
            "| {:.0} to {:.0} % | {n} | {mean} | {} |",
            100.0 * w[0],
            100.0 * w[1],
            share(so, usize::try_from(n).unwrap_or(0))
        );
    }
    text.push('\n');
    text
}
