//! Another program's answers to the same records.

use crate::outcome::{Outcome, Stated};
use crate::run;
use std::collections::BTreeMap;
use std::path::Path;

/// Answers by names alone, each with probabilities put to it.
pub struct Beside {
    /// What the page calls it.
    pub name: String,
    /// Its answers, of cases that the program itself has answered too.
    pub outcomes: Vec<Outcome>,
}

impl Beside {
    /// Reads `dir/CASE/result.json` of every outcome's case; what is missing there is not counted.
    pub fn new(name: &str, outcomes: &[Outcome], dir: &Path) -> Self {
        let one = |own: &Outcome| {
            let mut other = run::stored(&dir.join(&own.truth.name), run::Drawn::All)?;
            other.imitated.clone_from(&own.imitated);
            other.stated = own.stated.as_ref().map(|s| by_names(&other, s.effects.keys()));
            Some(other)
        };
        Self { name: name.to_owned(), outcomes: outcomes.iter().filter_map(one).collect() }
    }
}

/// Each group that was named 95 % in even shares, an even share of 5 % for every effect else.
pub(super) fn by_names<'a>(o: &Outcome, effects: impl ExactSizeIterator<Item = &'a String>) -> Stated {
    let all = effects.len() as f64;
    let probability = |effect: &String| {
        let group = o.groups.iter().find(|g| g.contains(effect));
        group.map_or(0.05 / all, |g| 0.95 / g.len() as f64)
    };
    let effects: BTreeMap<String, f64> = effects.map(|e| (e.clone(), probability(e))).collect();
    Stated { effects, nothing: 0.0, something_else: 0.0, rest: 0.0, base_gc: None, averaged_gc: None }
}
