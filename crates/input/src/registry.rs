//! What the reader must know about laws and effects, without knowing any.

use crate::config::{BulkConfig, EffectConfig, InterfaceConfig, OptionValue};
use crate::experiment::ExperimentRegistry;
use params::ParamSpec;
use serde::Serialize;
use std::collections::BTreeMap;

/// What a law describes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum LawSite {
    /// The tissue: `[bulk]`.
    Bulk,
    /// The tear path: `[interface]`.
    Interface,
}

impl LawSite {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Bulk, Self::Interface];

    /// The section of a file, and the first word of parameter paths.
    pub const fn section(self) -> &'static str {
        match self {
            Self::Bulk => "bulk",
            Self::Interface => "interface",
        }
    }
}

/// The laws as the reader sees them; implemented by crate `laws`.
///
/// An interface law's parameters begin with `gc` and `sigma_c`, which have a value per area.
pub trait LawRegistry {
    /// Names of the laws of a site, the default first.
    fn law_names(&self, site: LawSite) -> Vec<String>;

    /// Settings of a law that are not parameters.
    fn law_options(&self, site: LawSite, law: &str) -> Vec<OptionSpec>;

    /// Parameters of a law under its settings, in its order; `None` if there is no such law.
    fn law_parameters(
        &self,
        site: LawSite,
        law: &str,
        options: &BTreeMap<String, OptionValue>,
    ) -> Option<Vec<ParamSpec>>;
}

/// The catalogue of laws, experiments and effects as the reader sees it; implemented by crate `model` for a catalogue of effects.
pub trait EffectRegistry: LawRegistry + ExperimentRegistry {
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

    /// Why an effect cannot act on these laws, in words ("law `neo_hooke` has no fibre families"); `None` if it can.
    fn lacks(&self, effect: &EffectConfig, bulk: &BulkConfig, interface: &InterfaceConfig) -> Option<String> {
        let _ = (effect, bulk, interface);
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
    /// The name of an experiment.
    TestKind,
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
