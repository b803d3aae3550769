//! The description of a parameter, and a parameter with its value.

use crate::{Quantity, Transform};
use serde::Serialize;
use std::borrow::Cow;

/// What a law or an effect says about one of its parameters. Values are in internal units.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ParamSpec {
    /// Name in parameter paths and, with a unit suffix, in files: `mu`.
    pub name: Cow<'static, str>,
    /// Symbol in equations: `μ`.
    pub symbol: Cow<'static, str>,
    /// Physical kind, hence unit.
    pub quantity: Quantity,
    /// Smallest admissible value.
    pub lower: f64,
    /// Largest admissible value.
    pub upper: f64,
    /// Value at which the parameter has no influence, where there is one.
    pub neutral: Option<f64>,
    /// Where an identification starts when the file does not say.
    pub start: f64,
    /// Held fixed unless a file frees it.
    pub fixed: bool,
    /// Coordinate for the optimiser.
    pub transform: Transform,
    /// One line of explanation.
    pub description: Cow<'static, str>,
    /// Least and greatest value that a file may give; `None`: the bounds of the search.
    #[serde(skip)]
    pub admissible: Option<(f64, f64)>,
    /// What the literature lets one expect, where it does.
    #[serde(skip)]
    pub expected: Option<Expected>,
    /// Another way to give the same parameter, where there is one.
    #[serde(skip)]
    pub reciprocal: Option<Reciprocal>,
    /// No key of a file: it is carried for an effect that moves it.
    #[serde(skip)]
    pub internal: bool,
}

/// A prior of the literature, in the parameter's own optimiser coordinate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Expected {
    /// Median, internal unit.
    pub median: f64,
    /// Standard deviation in the coordinate; in a logarithm, 1 is a factor 2.7 either way.
    pub spread: f64,
}

/// A parameter x that may also be given as `numerator`/x: the bulk modulus 2/D in place of D.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reciprocal {
    /// Name in files, without unit.
    pub name: &'static str,
    /// Physical kind of `numerator`/x.
    pub quantity: Quantity,
    /// What is divided.
    pub numerator: f64,
    /// One line of explanation.
    pub description: &'static str,
}

impl Reciprocal {
    /// `numerator`/x, either way; infinite for 0.
    pub fn of(&self, x: f64) -> f64 {
        self.numerator / x
    }
}

impl ParamSpec {
    /// A free parameter with an optimiser coordinate chosen from its bounds: logarithm for
    /// positive values, identity where zero or negative values are allowed.
    pub fn new(
        name: &'static str,
        symbol: &'static str,
        quantity: Quantity,
        (lower, upper): (f64, f64),
        start: f64,
        description: &'static str,
    ) -> Self {
        Self {
            name: name.into(),
            symbol: symbol.into(),
            quantity,
            lower,
            upper,
            neutral: None,
            start,
            fixed: false,
            transform: if lower > 0.0 { Transform::Log } else { Transform::Identity },
            description: description.into(),
            admissible: None,
            expected: None,
            reciprocal: None,
            internal: false,
        }
    }

    /// The same with wider (or narrower) limits for what a file may give than the search has.
    pub fn admissible(mut self, lower: f64, upper: f64) -> Self {
        self.admissible = Some((lower, upper));
        self
    }

    /// The same with a prior of the literature: median, and standard deviation in the optimiser's coordinate.
    pub fn expected(mut self, median: f64, spread: f64) -> Self {
        self.expected = Some(Expected { median, spread });
        self
    }

    /// The same with another way to give it.
    pub fn reciprocal(mut self, reciprocal: Reciprocal) -> Self {
        self.reciprocal = Some(reciprocal);
        self
    }

    /// The same, held fixed and without a key: an effect moves it.
    pub fn internal(mut self) -> Self {
        (self.internal, self.fixed) = (true, true);
        self
    }

    /// The same with a neutral value.
    pub fn neutral(mut self, value: f64) -> Self {
        self.neutral = Some(value);
        self
    }

    /// The same, held fixed unless a file frees it.
    pub fn fixed(mut self) -> Self {
        self.fixed = true;
        self
    }

    /// The same with another optimiser coordinate.
    pub fn transform(mut self, transform: Transform) -> Self {
        self.transform = transform;
        self
    }

    /// The key a file uses: name and preferred unit suffix.
    pub fn key(&self) -> String {
        self.quantity.key(&self.name)
    }

    /// A value in the unit of [`ParamSpec::key`].
    pub fn in_file_unit(&self, value: f64) -> f64 {
        self.quantity.suffixes().first().map_or(value, |s| value / s.factor)
    }
}

/// A parameter of a built model: where it is, what it is, its value, whether it is identified.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Parameter {
    /// Path in answers: `bulk.mu`, `interface.area[3].gc`, `effects.viscoelastic.g`.
    pub path: String,
    /// Description; its bounds are the ones in force (a file may narrow them).
    pub spec: ParamSpec,
    /// Present value, internal unit.
    pub value: f64,
    /// Whether an identification may change it.
    pub free: bool,
    /// Whether it is held only because its given value is a limit ([`Transform::is_limit`]) at which no search
    /// can start.
    pub held_at_limit: bool,
}
