//! What is told of a run that did not come to its end.

use crate::outcome::Failure;
use ::report::{Kept, ReportError};
use serde_json::Value;

/// The failure of a command whose unfinished run was stored: why it ended, where it is, how to go on.
pub fn kept(stored: Result<Kept, ReportError>, why: &str, answer: Option<Value>, what: &str) -> Failure {
    let why = why.strip_prefix("fct: ").unwrap_or(why);
    let message = match stored {
        Ok(Kept::At(place)) => {
            format!("fct: {why}; {what} in {}; --resume goes on from there", place.display())
        }
        Ok(Kept::Aside(place)) => format!(
            "fct: {why}; the finished run in {} stays as it was; --resume goes on with the new one",
            place.display()
        ),
        Err(e) => format!("fct: {why}; and what was found could not be kept: {e}"),
    };
    let failure = Failure::compute(message);
    Failure { json: answer.unwrap_or_else(|| failure.json.clone()), ..failure }
}
