//! What is answered where a law of other people is hidden.

use super::share;
use super::tables::stated;
use crate::outcome::Outcome;

/// Whether a name was given that is not of the hidden kind, in no group with one that is.
pub fn names_another(o: &Outcome) -> bool {
    let accepted = o.truth.foreign().map_or(&[][..], |f| f.accepted());
    o.groups.iter().any(|g| !g.iter().any(|e| accepted.contains(&e.as_str())))
}

/// Whether the first group of the answer holds the kind; nothing was named where there is none to name.
fn right(o: &Outcome) -> bool {
    let accepted = o.truth.foreign().map_or(&[][..], |f| f.accepted());
    match o.groups.first() {
        Some(first) => first.iter().any(|e| accepted.contains(&e.as_str())),
        None => accepted.is_empty() && !o.verdict.is_empty(),
    }
}

/// The section; nothing where no such case was answered.
pub fn section(outcomes: &[Outcome]) -> String {
    let all: Vec<&Outcome> = outcomes.iter().filter(|o| o.truth.foreign().is_some()).collect();
    if all.is_empty() {
        return String::new();
    }
    let kinds: Vec<&&Outcome> = all.iter().filter(|o| o.visible()).collect();
    let noise: Vec<&&Outcome> =
        all.iter().filter(|o| o.truth.foreign().is_some_and(|f| f.accepted().is_empty())).collect();
    let count = |list: &[&&Outcome]| list.iter().filter(|o| right(o)).count();
    let another = all.iter().filter(|o| names_another(o)).count();
    format!(
        "## Laws of other people\n\nThe catalogue holds the kind of what is hidden, by another formula (`src/foreign`). Visible \
         laws whose kind was named first: {}; load cells with their own noise that were given no name: {}; a name of another kind, \
         of all: {}.\n\n{}",
        share(count(&kinds), kinds.len()),
        share(count(&noise), noise.len()),
        share(another, all.len()),
        stated(all)
    )
}
