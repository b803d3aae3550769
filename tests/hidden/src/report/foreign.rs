//! What is answered where a law of other people is hidden.

use super::share;
use super::tables::stated;
use crate::outcome::{Grade, Outcome};

/// Whether a name was given that is not of the hidden kind, in no group with one that is.
pub fn names_another(o: &Outcome) -> bool {
    matches!(o.grade(), Grade::Wrong | Grade::Extra)
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
    let count = |list: &[&&Outcome]| list.iter().filter(|o| o.grade() == Grade::Right).count();
    let another = all.iter().filter(|o| names_another(o)).count();
    format!(
        "## Laws of other people\n\nThe catalogue holds the kind of what is hidden, by another formula (`src/foreign`). Visible \
         laws whose kind was named, and nothing else: {}; load cells with their own noise that were given no name: {}; a name of another kind, \
         of all: {}.\n\n{}",
        share(count(&kinds), kinds.len()),
        share(count(&noise), noise.len()),
        share(another, all.len()),
        stated(all)
    )
}
