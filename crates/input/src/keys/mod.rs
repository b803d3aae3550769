//! One table of every section and key: it drives the reader, the check for unknown keys, the documentation
//! and the JSON schema.

mod spelling;
mod table;
mod table_specimen;

pub(crate) use spelling::{Match, Speller, closest};

use crate::registry::{LawSite, OptionSpec};
use params::{ParamSpec, Quantity, Suffix};
use serde::Serialize;
use std::borrow::Cow;
use std::sync::LazyLock;

/// Limits of a number, internal unit.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Limits {
    /// Least value.
    pub lower: f64,
    /// Greatest value.
    pub upper: f64,
    /// Whether the least value itself is excluded.
    pub above: bool,
    /// Whether the greatest value itself is excluded.
    pub below: bool,
}

impl Limits {
    /// Both ends allowed.
    pub const fn within(lower: f64, upper: f64) -> Self {
        Self { lower, upper, above: false, below: false }
    }

    /// From 0, itself excluded, to `upper`.
    pub const fn positive(upper: f64) -> Self {
        Self { lower: 0.0, upper, above: true, below: false }
    }

    /// `x` if it is inside, pulled onto a limit if it is outside by no more than rounding.
    pub(crate) fn admit(&self, x: f64) -> Option<f64> {
        let slack = 1e-12 * self.lower.abs().max(self.upper.abs()).min(1.0);
        // A least value above 0 is not rounded to by 0 itself.
        let below = if self.lower > 0.0 { 1e-12 * self.lower } else { slack };
        let low = if self.above { x > self.lower } else { x >= self.lower - below };
        let high =
            if self.below { x < self.upper } else { x <= self.upper + slack.max(1e-12 * self.upper.abs()) };
        (low && high).then(|| x.max(self.lower).min(self.upper))
    }

    /// The limits in words, in a unit whose factor to the internal unit is `factor`.
    pub(crate) fn words(&self, factor: f64) -> String {
        let (lower, upper) = (plain(self.lower / factor), plain(self.upper / factor));
        match (self.above, self.below, self.lower.is_finite(), self.upper.is_finite()) {
            (_, _, false, false) => "any number".to_owned(),
            (true, _, _, false) => format!("a number above {lower}"),
            (false, _, _, false) => format!("a number of at least {lower}"),
            (_, _, false, true) => format!("a number of at most {upper}"),
            (true, true, ..) => format!("a number between {lower} and {upper}, neither included"),
            (true, false, ..) => format!("a number above {lower} and at most {upper}"),
            (false, true, ..) => format!("a number from {lower} to below {upper}"),
            (false, false, ..) => format!("a number from {lower} to {upper}"),
        }
    }
}

/// A number as a reader would write it, without the dust of unit conversion.
pub(crate) fn plain(x: f64) -> String {
    if (x - 1.0 / 3.0).abs() < 1e-12 {
        return "1/3".to_owned();
    }
    let rounded: f64 = format!("{x:.9e}").parse().unwrap_or(x);
    if rounded != 0.0 && !(1e-4..1e7).contains(&rounded.abs()) {
        format!("{rounded:e}")
    } else {
        format!("{rounded}")
    }
}

/// What a key takes.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case", tag = "type")]
pub enum Kind {
    /// `true` or `false`.
    Bool,
    /// Any text.
    Text,
    /// The path of a file, relative to the file it is written in.
    File,
    /// A CSV file, or a list of rows of so many numbers.
    Rows {
        /// Physical kind of the numbers.
        quantity: Quantity,
        /// Numbers in a row.
        columns: usize,
    },
    /// One of these words.
    Choice {
        /// The words.
        words: Vec<String>,
    },
    /// A list of some of these words.
    Words {
        /// The words.
        words: Vec<String>,
    },
    /// A whole number, both limits allowed.
    Integer {
        /// Least.
        min: i64,
        /// Greatest.
        max: i64,
    },
    /// A whole number or `true`/`false` for the default/0.
    Count {
        /// Greatest.
        max: i64,
    },
    /// Three whole numbers.
    Divisions,
    /// A number.
    Number {
        /// Physical kind, hence the unit suffixes of the key.
        quantity: Quantity,
        /// Limits, internal unit.
        limits: Limits,
    },
    /// A parameter: a number, or `{ start, min, max, fixed }`.
    Parameter {
        /// Physical kind, hence the unit suffixes of the key.
        quantity: Quantity,
        /// Limits, internal unit.
        limits: Limits,
        /// Held fixed unless freed; `None`: said elsewhere.
        fixed: Option<bool>,
        /// Whether a list, one entry per area, is accepted too.
        list: bool,
    },
    /// `true`, `false`, `"literature"`, or a table of priors.
    Priors,
    /// A list of legs.
    Legs,
    /// A list of stretches of a record with a weight each.
    Weights,
    /// A table with keys of its own.
    Table,
    /// A list of tables with keys of their own.
    Tables,
}

/// What holds when a key is not given.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Fallback {
    /// It must be given.
    Required,
    /// Nothing; in words what then happens.
    Absent(Cow<'static, str>),
    /// A number, internal unit.
    Number(f64),
    /// A whole number.
    Integer(i64),
    /// Yes or no.
    Bool(bool),
    /// A word.
    Word(Cow<'static, str>),
}

/// One key of a file.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Key {
    /// Section, `""` for the top level, without brackets.
    pub section: Cow<'static, str>,
    /// Name without unit.
    pub name: Cow<'static, str>,
    /// What it takes.
    #[serde(flatten)]
    pub kind: Kind,
    /// What holds when it is not given.
    pub default: Fallback,
    /// One line of explanation.
    pub description: Cow<'static, str>,
}

impl Key {
    /// Physical kind of the number, hence the unit suffixes of the key.
    pub fn quantity(&self) -> Quantity {
        match self.kind {
            Kind::Number { quantity, .. } | Kind::Parameter { quantity, .. } => quantity,
            _ => Quantity::Dimensionless,
        }
    }

    /// Every accepted spelling with the factor to the internal unit, the preferred one first.
    pub fn spellings(&self) -> Vec<(String, f64)> {
        let with_units = |q: Quantity| {
            units(q, &self.name).into_iter().map(|s| (format!("{}_{}", self.name, s.name), s.factor))
        };
        match self.kind {
            Kind::Rows { quantity, .. } => {
                let mut all = vec![(self.name.to_string(), 1.0)];
                all.extend(with_units(quantity));
                all
            }
            _ if self.quantity().suffixes().is_empty() => vec![(self.name.to_string(), 1.0)],
            _ => with_units(self.quantity()).collect(),
        }
    }

    /// The preferred spelling.
    pub fn spelling(&self) -> String {
        self.spellings().swap_remove(0).0
    }

    /// `a`, `b` or `c`.
    pub(crate) fn spelling_list(&self) -> String {
        either(self.spellings().iter().map(|s| s.0.as_str()))
    }
}

/// The units a key may carry, the one its users think in first: strengths and bulk moduli are in MPa, other
/// stresses in kPa.
pub(crate) fn units(quantity: Quantity, name: &str) -> Vec<Suffix> {
    let mut units = quantity.suffixes().to_vec();
    if matches!(name, "sigma_c" | "bulk_modulus") {
        units.sort_by_key(|s| s.name != "MPa");
    }
    units
}

/// `` `a`, `b` or `c` ``
pub(crate) fn either<'a>(words: impl Iterator<Item = &'a str>) -> String {
    list(words.map(|w| format!("`{w}`")), "or")
}

/// a, b and c
pub(crate) fn list(words: impl Iterator<Item = String>, last: &str) -> String {
    let words: Vec<String> = words.collect();
    match words.split_last() {
        Some((end, rest)) if !rest.is_empty() => format!("{} {last} {end}", rest.join(", ")),
        Some((end, _)) => end.clone(),
        None => "nothing".to_owned(),
    }
}

/// Every section and key, in the order of the documentation. Keys of laws and effects come from their registries.
pub fn keys() -> &'static [Key] {
    static KEYS: LazyLock<Vec<Key>> = LazyLock::new(table::build);
    &KEYS
}

/// Section of a key that another law of the same site has: known, so that it can be refused by name.
pub(crate) const FOREIGN: &str = "another law";

/// The keys of a law: its parameters (a reciprocal before the parameter itself), then its settings.
pub(crate) fn law_keys(site: LawSite, specs: &[ParamSpec], options: &[OptionSpec]) -> Vec<Key> {
    let mut all = Vec::new();
    for (index, spec) in specs.iter().enumerate().filter(|(_, s)| !s.internal) {
        let list = site == LawSite::Interface && index < crate::read::PER_AREA;
        let (lower, upper) = spec.admissible.unwrap_or((spec.lower, spec.upper));
        let key = |name: Cow<'static, str>, quantity, lower, upper, start, about: Cow<'static, str>| Key {
            section: site.section().into(),
            name,
            kind: Kind::Parameter {
                quantity,
                limits: Limits::within(lower, upper),
                fixed: spec.fixed.then_some(true),
                list,
            },
            default: match spec.fixed {
                true => Fallback::Number(start),
                false => Fallback::Absent("the parameter's own start".into()),
            },
            description: about,
        };
        if let Some(r) = spec.reciprocal {
            let name = r.name.into();
            all.push(key(name, r.quantity, r.of(upper), r.of(lower), r.of(spec.start), r.description.into()));
        }
        all.push(key(spec.name.clone(), spec.quantity, lower, upper, spec.start, spec.description.clone()));
    }
    all.extend(options.iter().map(|o| crate::read::option_key(site.section().into(), o)));
    all
}

/// The keys of one section.
pub(crate) fn of(section: &str) -> Vec<Key> {
    keys().iter().filter(|k| k.section == section).cloned().collect()
}
