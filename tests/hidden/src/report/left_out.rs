//! What is answered where the catalogue lacks what is hidden.

use super::share;
use super::tables::stated;
use crate::outcome::Outcome;

/// Probability from which on a name is a statement.
const SURE: f64 = 0.95;

/// The section; nothing where nothing was left out.
pub fn section(left_out: &[Outcome]) -> String {
    if left_out.is_empty() {
        return String::new();
    }
    let wrong = left_out.iter().filter(|o| sure(o).is_some()).count();
    format!(
        "## One effect left out of the catalogue\n\nVisible single effects, each answered once more by a catalogue without \
         it (`-- leave-out`). Another effect was stated with {:.0} % or more in {} (wanted: at most 5 %).\n\n{}",
        100.0 * SURE,
        share(wrong, left_out.len()),
        stated(left_out)
    )
}

/// An effect that is stated for sure.
fn sure(o: &Outcome) -> Option<&String> {
    o.stated.as_ref()?.effects.iter().find(|(_, p)| **p >= SURE).map(|(e, _)| e)
}
