//! What a law says of itself so that a file can name it.

use constitutive::{Offers, PointLaw};
use input::{OptionSpec, OptionValue};
use params::ParamSpec;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Settings of a law that are not parameters, by name.
pub type Settings = BTreeMap<String, OptionValue>;

/// What a law says of itself. Everything here is printed.
#[derive(Clone, Copy, Debug)]
pub struct LawCard {
    /// Name in files and answers.
    pub name: &'static str,
    /// One sentence for the newcomer.
    pub summary: &'static str,
    /// The law, in symbols of the parameters.
    pub equation: &'static str,
    /// Where it comes from, with DOI.
    pub reference: &'static str,
}

/// A law as the registry holds it: `G` is 9 for a bulk law (F → P), 3 for an interface law (opening → traction).
///
/// A bulk law's parameters are its own affair. Those of an interface law begin with
/// [`cohesive::common_parameters`], its history with δmax, and it offers a [`constitutive::Cohesion`].
pub trait LawEntry<const G: usize>: Send + Sync {
    /// What it says of itself.
    fn card(&self) -> &LawCard;

    /// Settings that are not parameters.
    fn options(&self) -> Vec<OptionSpec> {
        Vec::new()
    }

    /// The law under settings; what they do not say is at its default.
    fn law(&self, settings: &Settings) -> Arc<dyn PointLaw<G>>;

    /// The law's parameters under settings.
    fn parameters(&self, settings: &Settings) -> Vec<ParamSpec> {
        self.law(settings).parameters()
    }

    /// What the law offers to effects under settings.
    fn offers(&self, settings: &Settings) -> Offers {
        self.law(settings).offers()
    }
}

/// A bulk law of the registry.
pub type BulkLaw = Arc<dyn LawEntry<9>>;
/// An interface law of the registry.
pub type InterfaceLaw = Arc<dyn LawEntry<3>>;

/// The word that a setting has, or its default.
pub(crate) fn word<'a>(settings: &'a Settings, name: &str, default: &'a str) -> &'a str {
    match settings.get(name) {
        Some(OptionValue::Text(t)) => t,
        _ => default,
    }
}

/// A setting with two or more words, the first being the default.
pub(crate) fn choice(name: &str, words: &[&str], description: &str) -> OptionSpec {
    OptionSpec {
        name: name.to_owned(),
        kind: input::OptionKind::Choice(words.iter().map(|w| (*w).to_owned()).collect()),
        default: words.first().map(|w| OptionValue::Text((*w).to_owned())),
        description: description.to_owned(),
    }
}
