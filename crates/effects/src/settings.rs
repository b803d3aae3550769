//! Reading an effect's options: what the file says, or the default of the option's description.

use input::{OptionKind, OptionSpec, OptionValue};
use model::Options;

/// A whole-number option.
pub fn integer(options: &Options, name: &str, default: i64) -> i64 {
    match options.get(name) {
        Some(OptionValue::Integer(i)) => *i,
        Some(OptionValue::Number(x)) => x.round() as i64,
        _ => default,
    }
}

/// A word option.
pub fn word<'a>(options: &'a Options, name: &str, default: &'a str) -> &'a str {
    match options.get(name) {
        Some(OptionValue::Text(t)) => t,
        _ => default,
    }
}

/// The description of a choice between words, the first being the default.
pub fn choice(name: &str, words: &[&str], description: &str) -> OptionSpec {
    OptionSpec {
        name: name.to_owned(),
        kind: OptionKind::Choice(words.iter().map(|w| (*w).to_owned()).collect()),
        default: words.first().map(|w| OptionValue::Text((*w).to_owned())),
        description: description.to_owned(),
    }
}

/// The description of an option that names an experiment.
pub fn kind(name: &str, default: &str, description: &str) -> OptionSpec {
    OptionSpec {
        name: name.to_owned(),
        kind: OptionKind::TestKind,
        default: Some(OptionValue::Text(default.to_owned())),
        description: description.to_owned(),
    }
}

/// Values spread evenly in the logarithm from `low` to `high`, both included.
pub fn spread(low: f64, high: f64, count: usize) -> Vec<f64> {
    let (low, high) = (low.max(1e-300), high.max(low).max(1e-300));
    let last = count.saturating_sub(1).max(1) as f64;
    (0..count).map(|i| low * (high / low).powf(i as f64 / last)).collect()
}
