//! The answer of a search.

use crate::{FittedModel, Screen};
use serde::Serialize;

/// How the search ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// The base model explains the record and no effect pays.
    NothingMissing,
    /// The effects found explain the record, and each can be told from every rival.
    Explained,
    /// Explained, but the record cannot tell some effect from its look-alikes, or whether one acts at all.
    Ambiguous,
    /// Something is missing that the catalogue does not hold (or could not be fitted).
    Unexplained,
}

/// The answer of a search.
#[derive(Clone, Debug, Serialize)]
pub struct Discovery {
    /// Accepted models, base first.
    pub ladder: Vec<FittedModel>,
    /// Every model that was fitted, in order.
    pub tried: Vec<FittedModel>,
    /// Sets that could not be fitted, with the reason.
    pub failed: Vec<(Vec<String>, String)>,
    /// Screen of the base model.
    pub screen: Screen,
    /// Screen of the last model.
    pub last_screen: Screen,
    /// Effects added in the end.
    pub found: Vec<String>,
    /// For each of `found`: itself and every effect that these records cannot tell from it.
    pub groups: Vec<Vec<String>>,
    /// Effects that lead without being probable enough to be named, where none is.
    pub undecided: Vec<String>,
    /// The answer.
    pub verdict: Verdict,
    /// Whether the user stopped the search.
    pub interrupted: bool,
}

impl Discovery {
    /// The last accepted model.
    pub fn last(&self) -> Option<&FittedModel> {
        self.ladder.last()
    }
}
