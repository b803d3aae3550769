//! What the reader must know about effects, without knowing any.

use crate::config::OptionValue;
use params::ParamSpec;
use serde::Serialize;
use std::collections::BTreeMap;

/// The catalogue of effects as the reader sees it; implemented by crate `effects`.
pub trait EffectRegistry {
    /// Every effect's name.
    fn names(&self) -> Vec<&str>;

    /// Parameters of an effect, in the order of its card; `None` if there is no such effect.
    fn parameters(&self, effect: &str) -> Option<Vec<ParamSpec>>;

    /// The same under options that change the list (a number of branches).
    fn parameters_with(
        &self,
        effect: &str,
        options: &BTreeMap<String, OptionValue>,
    ) -> Option<Vec<ParamSpec>> {
        let _ = options;
        self.parameters(effect)
    }

    /// Names of effects that cannot be used together with this one.
    fn excludes(&self, effect: &str) -> Vec<String> {
        let _ = effect;
        Vec::new()
    }

    /// Settings of an effect that are not parameters.
    fn options(&self, effect: &str) -> Vec<OptionSpec> {
        let _ = effect;
        Vec::new()
    }
}

/// The empty catalogue: every `[effects.NAME]` is an error.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoEffects;

impl EffectRegistry for NoEffects {
    fn names(&self) -> Vec<&str> {
        Vec::new()
    }

    fn parameters(&self, _effect: &str) -> Option<Vec<ParamSpec>> {
        None
    }
}

/// What values an option takes.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum OptionKind {
    /// Yes or no.
    Bool,
    /// A whole number between two limits, both allowed.
    Integer {
        /// Least.
        min: i64,
        /// Greatest.
        max: i64,
    },
    /// A pure number between two limits, both allowed.
    Number {
        /// Least.
        min: f64,
        /// Greatest.
        max: f64,
    },
    /// One of these words.
    Choice(Vec<String>),
    /// The name of a test of the case.
    Test,
    /// Any text.
    Text,
}

/// A setting of an effect that is not a parameter, for instance a number of branches.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct OptionSpec {
    /// Key in the file.
    pub name: String,
    /// What values it takes.
    pub kind: OptionKind,
    /// Value when the file does not say; `None`: the option is then absent.
    pub default: Option<OptionValue>,
    /// One line of explanation.
    pub description: String,
}
