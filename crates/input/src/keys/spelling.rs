//! From what the user wrote to the key that was meant.

use super::{FOREIGN, Key, list};
use crate::text::short;
use params::Quantity;

/// What a written key turns out to be.
pub(crate) enum Match {
    /// The key with this index, in a unit with this factor.
    Known(usize, f64),
    /// None.
    Unknown(Unknown),
}

/// Why a written key is none.
pub(crate) struct Unknown {
    /// What to say.
    pub message: String,
    /// What to advise.
    pub help: Option<String>,
    /// Name of the key that was probably meant.
    pub meant: Option<String>,
}

/// Finds keys among the keys of one section.
pub(crate) struct Speller<'a> {
    /// As in messages: `[bulk]`.
    pub title: &'a str,
    /// The section's keys.
    pub keys: &'a [Key],
    /// Every spelling, with the index of its key and its unit's factor.
    spellings: Vec<(String, usize, f64)>,
    /// Keys that stand elsewhere, beyond those of the table.
    others: &'a [Key],
}

impl<'a> Speller<'a> {
    /// For the keys of a section with this title.
    pub fn new(title: &'a str, keys: &'a [Key]) -> Self {
        let of = |(i, k): (usize, &Key)| k.spellings().into_iter().map(move |(s, factor)| (s, i, factor));
        Self { title, keys, spellings: keys.iter().enumerate().flat_map(of).collect(), others: &[] }
    }

    /// The same, which also knows keys that stand elsewhere.
    pub fn beside(self, others: &'a [Key]) -> Self {
        Self { others, ..self }
    }

    /// The section's own keys, without those of other laws.
    fn own(&self) -> impl Iterator<Item = &'a Key> {
        self.keys.iter().filter(|k| k.section != FOREIGN)
    }

    /// The key that `written` is, or why it is none.
    pub fn find(&self, written: &str) -> Match {
        match self.known(written) {
            Some((index, factor)) => Match::Known(index, factor),
            None => Match::Unknown(self.explain(written)),
        }
    }

    /// Index and factor of a key that is written as it should be.
    pub fn known(&self, written: &str) -> Option<(usize, f64)> {
        self.spellings.iter().find(|s| s.0 == written).map(|s| (s.1, s.2))
    }

    /// Why a key that is not known is none.
    pub fn explain(&self, written: &str) -> Unknown {
        let (shown, title) = (short(written), self.title);
        if let Some(key) = self.own().find(|k| k.name == written) {
            let message = format!("key `{shown}` in {title} needs its unit: {}", key.spelling_list());
            return Unknown { message, help: None, meant: Some(key.name.to_string()) };
        }
        if let Some(found) = self.wrong_unit(written) {
            return found;
        }
        if let Some((key, meant)) = self.similar(written) {
            let message = format!("unknown key `{shown}` in {title}; did you mean `{meant}`?");
            return Unknown { message, help: None, meant: Some(key.name.to_string()) };
        }
        if let Some(place) = elsewhere(written, self.others) {
            let message = format!("unknown key `{shown}` in {title}; it belongs in {place}");
            return Unknown { message, help: None, meant: None };
        }
        let preferred: Vec<String> = self.own().map(Key::spelling).collect();
        let help = match preferred.is_empty() {
            true => format!("{title} has no keys"),
            false => format!("{title} takes {}", list(preferred.iter().map(|p| format!("`{p}`")), "and")),
        };
        Unknown { message: format!("unknown key `{shown}` in {title}"), help: Some(help), meant: None }
    }

    /// The key and the spelling of it that is most like what was written.
    fn similar(&self, written: &str) -> Option<(&Key, String)> {
        let own = self.spellings.iter().filter(|s| self.keys[s.1].section != FOREIGN);
        if let Some(meant) = closest(written, own.map(|s| s.0.as_str())) {
            return self.known(meant).map(|(i, _)| (&self.keys[i], meant.to_owned()));
        }
        let name = closest(written, self.own().map(|k| k.name.as_ref()))?;
        self.own().find(|k| k.name == name).map(|k| (k, k.spelling()))
    }

    /// A key that exists, with a suffix that is not one of its units and no slip of the pen either.
    fn wrong_unit(&self, written: &str) -> Option<Unknown> {
        let suffix = |k: &Key| Some(written.strip_prefix(k.name.as_ref())?.strip_prefix('_')?.to_owned());
        let (key, unit) =
            self.own().filter_map(|k| Some((k, suffix(k)?))).max_by_key(|(k, _)| k.name.len())?;
        let (shown, title) = (short(written), self.title);
        let meant = Some(key.name.to_string());
        if key.spellings().len() == 1 {
            let message = format!("key `{shown}` in {title} takes no unit: write `{}`", key.name);
            return is_unit(&unit).then_some(Unknown { message, help: None, meant });
        }
        let slip = |s: &params::Suffix| {
            s.name.eq_ignore_ascii_case(&unit)
                || (unit.len() > 2 && strsim::damerau_levenshtein(s.name, &unit) == 1)
        };
        if !is_unit(&unit) && (key.quantity().suffixes().iter().any(slip) || unit.contains('_')) {
            return None;
        }
        let (unit, all) = (short(&unit), key.spelling_list());
        let message = format!("unit `{unit}` of `{shown}` in {title} is not accepted: write {all}");
        Some(Unknown { message, help: None, meant })
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
fn elsewhere(written: &str, others: &[Key]) -> Option<String> {
    let key = super::keys().iter().chain(others).find(|k| k.spellings().iter().any(|s| s.0 == written))?;
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
