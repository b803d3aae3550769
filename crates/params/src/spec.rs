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
        }
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
