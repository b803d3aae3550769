//! From what the user wrote to the key that was meant.

use super::{Key, either};
use crate::text::short;
use params::Quantity;

/// What a written key turns out to be.
pub(crate) enum Match {
    /// The key with this index, in a unit with this factor.
    Known(usize, f64),
    /// None: a message and advice.
    Unknown(String, Option<String>),
}

/// Finds keys among the keys of one section.
pub(crate) struct Speller<'a> {
    /// As in messages: `[bulk]`.
    pub title: &'a str,
    /// The section's keys.
    pub keys: &'a [Key],
}

impl Speller<'_> {
    /// The key that `written` is, or why it is none.
    pub fn find(&self, written: &str) -> Match {
        let spelled = |k: &Key| k.spellings().into_iter().find(|s| s.0 == written).map(|s| s.1);
        if let Some((i, factor)) = self.keys.iter().enumerate().find_map(|(i, k)| Some((i, spelled(k)?))) {
            return Match::Known(i, factor);
        }
        let (message, help) = self.explain(written);
        Match::Unknown(message, help)
    }

    fn explain(&self, written: &str) -> (String, Option<String>) {
        let (shown, title) = (short(written), self.title);
        if let Some(key) = self.keys.iter().find(|k| k.name == written) {
            return (format!("key `{shown}` in {title} needs its unit: {}", key.spelling_list()), None);
        }
        if let Some(message) = self.wrong_unit(written, true) {
            return (message, None);
        }
        let all: Vec<String> = self.keys.iter().flat_map(|k| k.spellings()).map(|s| s.0).collect();
        if let Some(meant) = closest(written, all.iter().map(String::as_str)) {
            return (format!("unknown key `{shown}` in {title}; did you mean `{meant}`?"), None);
        }
        if let Some(message) = self.wrong_unit(written, false) {
            return (message, None);
        }
        let bare = self.keys.iter().map(|k| k.name.as_ref());
        if let Some(name) = closest(written, bare) {
            let meant = self.keys.iter().find(|k| k.name == name).map_or_else(String::new, Key::spelling);
            return (format!("unknown key `{shown}` in {title}; did you mean `{meant}`?"), None);
        }
        if let Some(place) = elsewhere(written) {
            return (format!("unknown key `{shown}` in {title}; it belongs in {place}"), None);
        }
        let preferred: Vec<String> = self.keys.iter().map(Key::spelling).collect();
        let help = match preferred.is_empty() {
            true => format!("{title} has no keys"),
            false => format!("{title} takes {}", either(preferred.iter().map(String::as_str))),
        };
        (format!("unknown key `{shown}` in {title}"), Some(help))
    }

    /// A key that exists, with a suffix that is not one of its units; `strict`: the suffix is a unit of
    /// something else, so that there can be no doubt.
    fn wrong_unit(&self, written: &str, strict: bool) -> Option<String> {
        let suffix = |k: &Key| Some(written.strip_prefix(k.name.as_ref())?.strip_prefix('_')?.to_owned());
        let (key, unit) = self
            .keys
            .iter()
            .filter_map(|k| Some((k, suffix(k)?)))
            .filter(|(k, _)| !k.name.is_empty())
            .max_by_key(|(k, _)| k.name.len())?;
        if strict && !is_unit(&unit) {
            return None;
        }
        let (written, unit, title) = (short(written), short(&unit), self.title);
        if key.quantity() == Quantity::Dimensionless {
            return strict.then(|| format!("key `{written}` in {title} takes no unit: write `{}`", key.name));
        }
        Some(format!("unit `{unit}` of `{written}` in {title} is not accepted: write {}", key.spelling_list()))
    }
}

/// Every quantity that has units.
const QUANTITIES: [Quantity; 14] = [
    Quantity::Length,
    Quantity::Force,
    Quantity::Time,
    Quantity::Stress,
    Quantity::InverseStress,
    Quantity::Angle,
    Quantity::FractureEnergy,
    Quantity::EnergyDensity,
    Quantity::InterfaceStiffness,
    Quantity::Speed,
    Quantity::Rate,
    Quantity::ForceRate,
    Quantity::Compliance,
    Quantity::Density,
];

fn is_unit(text: &str) -> bool {
    QUANTITIES.iter().flat_map(|q| q.suffixes()).any(|s| s.name == text)
}

/// The section that has this key, in brackets.
fn elsewhere(written: &str) -> Option<String> {
    let key = super::keys().iter().find(|k| k.spellings().iter().any(|s| s.0 == written))?;
    Some(match key.section.as_ref() {
        "" => "the top level, before the first [section]".to_owned(),
        "tests" => "[[tests]]".to_owned(),
        section => format!("[{section}]"),
    })
}

/// The word most like `written`, if it is like it at all.
pub(crate) fn closest<'a>(written: &str, words: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    if written.len() > 80 {
        return None;
    }
    let lower = written.to_lowercase().replace('-', "_");
    let score = |word: &str| {
        let word = word.to_lowercase();
        if word == lower {
            return 2.0;
        }
        let spread = strsim::normalized_damerau_levenshtein(&lower, &word);
        let begins = strsim::jaro_winkler(&lower, &word);
        if spread >= 0.6 || begins >= 0.9 { spread + begins } else { 0.0 }
    };
    let mut best: Option<(&str, f64)> = None;
    for word in words {
        let s = score(word);
        if s > 0.0 && best.is_none_or(|b| s > b.1) {
            best = Some((word, s));
        }
    }
    best.map(|b| b.0)
}
