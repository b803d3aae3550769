//! Effects, laws and experiments by name, and which effect can act on which law.

use crate::effect::{Effect, Options, Site};
use constitutive::Offers;
use experiments::Experiments;
use input::{
    BulkConfig, Case, EffectConfig, ExperimentRegistry, InterfaceConfig, LawRegistry, LawSite, Layout,
    OptionSpec, TestKind,
};
use laws::Laws;
use params::ParamSpec;
use std::sync::Arc;

/// Need of an effect that acts on the tear path alone.
pub const TEARING: &str = "tearing";
/// Need of an effect of the clamps: whole end faces are held.
pub const CLAMPED_ENDS: &str = "clamped ends";
/// Need of an effect that changes the shape of a sheet in its plane.
pub const FLAT_SHEET: &str = "a flat sheet";

/// Need of an effect of the load train or of the load cell, whatever its card says: a test has one of each.
pub const ONE_AXIS: &str = "one axis";

/// Effects, laws and experiments that can be asked by name. Without more being said, laws and experiments are those of
/// [`laws::registry`] and [`experiments::registry`].
#[derive(Clone)]
pub struct Catalogue {
    effects: Vec<Arc<dyn Effect>>,
    laws: Laws,
    experiments: Experiments,
}

impl Default for Catalogue {
    fn default() -> Self {
        Self::new(Vec::new())
    }
}

impl Catalogue {
    /// A catalogue of these effects, in this order.
    pub fn new(effects: Vec<Arc<dyn Effect>>) -> Self {
        Self { effects, laws: laws::registry(), experiments: experiments::registry() }
    }

    /// The same with one more.
    pub fn with(mut self, effect: Arc<dyn Effect>) -> Self {
        self.effects.push(effect);
        self
    }

    /// The same without the effect of this name.
    pub fn without(mut self, name: &str) -> Self {
        self.effects.retain(|e| e.card().name != name);
        self
    }

    /// The same with other laws.
    pub fn with_laws(mut self, laws: Laws) -> Self {
        self.laws = laws;
        self
    }

    /// The same with other experiments.
    pub fn with_experiments(mut self, experiments: Experiments) -> Self {
        self.experiments = experiments;
        self
    }

    /// The experiments.
    pub fn experiments(&self) -> &Experiments {
        &self.experiments
    }

    /// The laws.
    pub fn laws(&self) -> &Laws {
        &self.laws
    }

    /// What the laws of a case offer to effects; nothing for a law that is not in the registry.
    pub fn offers(&self, bulk: &BulkConfig, interface: &InterfaceConfig) -> Offers {
        Offers {
            bulk: self.laws.bulk(&bulk.law).and_then(|l| l.offers(&bulk.options).bulk),
            cohesion: self.laws.interface(&interface.law).and_then(|l| l.offers(&interface.options).cohesion),
        }
    }

    /// What the laws of a case lack for an effect under its options, in words; `None` if they lack nothing.
    pub fn lacking(
        &self,
        effect: &dyn Effect,
        options: &Options,
        bulk: &BulkConfig,
        interface: &InterfaceConfig,
    ) -> Option<String> {
        let asks = effect.asks(options);
        if asks.is_empty() {
            return None;
        }
        let offers = self.offers(bulk, interface);
        let missing = asks.into_iter().find(|a| !offers.has(*a))?;
        let law = if missing.is_of_bulk() { &bulk.law } else { &interface.law };
        Some(format!("law `{law}` has no {}", missing.words()))
    }

    /// Whether the laws of a case offer what an effect asks of them under its options.
    pub fn can_act(&self, effect: &dyn Effect, options: &Options, case: &Case) -> bool {
        self.lacking(effect, options, &case.bulk, &case.interface).is_none()
    }

    /// Names of the experiments in which an effect can show: those that offer what its card needs of a test.
    pub fn shown_in(&self, effect: &dyn Effect) -> Vec<&'static str> {
        let card = effect.card();
        let offered = |kind: &TestKind| {
            let has = |need: &&str| match *need {
                TEARING => kind.tears,
                CLAMPED_ENDS => kind.clamped_faces,
                FLAT_SHEET => kind.layout == Layout::Sheet,
                _ => true,
            };
            let axes = !(kind.two_axes && card.site.is_of_one_axis());
            axes && card.needs.iter().all(has) && (card.site != Site::Interface || kind.tears)
        };
        self.kinds().iter().filter(|k| offered(k)).map(|k| k.word()).collect()
    }

    /// All effects.
    pub fn iter(&self) -> impl Iterator<Item = &Arc<dyn Effect>> {
        self.effects.iter()
    }

    /// The effect of this name.
    pub fn get(&self, name: &str) -> Option<&Arc<dyn Effect>> {
        self.effects.iter().find(|e| e.card().name == name)
    }

    /// The site of a law of this name; nothing for an effect.
    pub fn site_of_law(&self, name: &str) -> Option<LawSite> {
        let has = |site: &LawSite| self.law_names(*site).iter().any(|n| n == name);
        [LawSite::Bulk, LawSite::Interface].into_iter().find(has).filter(|_| self.get(name).is_none())
    }
}

impl LawRegistry for Catalogue {
    fn law_names(&self, site: LawSite) -> Vec<String> {
        self.laws.law_names(site)
    }

    fn law_options(&self, site: LawSite, law: &str) -> Vec<OptionSpec> {
        self.laws.law_options(site, law)
    }

    fn law_parameters(&self, site: LawSite, law: &str, options: &Options) -> Option<Vec<ParamSpec>> {
        self.laws.law_parameters(site, law, options)
    }
}

impl ExperimentRegistry for Catalogue {
    fn kinds(&self) -> Vec<TestKind> {
        self.experiments.kinds()
    }
}

impl input::EffectRegistry for Catalogue {
    fn names(&self) -> Vec<&str> {
        self.effects.iter().map(|e| e.card().name).collect()
    }

    fn parameters(&self, effect: &str) -> Option<Vec<ParamSpec>> {
        self.get(effect).map(|e| e.parameters(&Options::new()))
    }

    fn parameters_with(&self, effect: &str, options: &Options) -> Option<Vec<ParamSpec>> {
        self.get(effect).map(|e| e.parameters(options))
    }

    fn excludes(&self, effect: &str) -> Vec<String> {
        self.get(effect).map_or_else(Vec::new, |e| e.card().excludes.iter().map(|&s| s.to_owned()).collect())
    }

    fn options(&self, effect: &str) -> Vec<OptionSpec> {
        self.get(effect).map_or_else(Vec::new, |e| e.options())
    }

    fn lacks(&self, effect: &EffectConfig, bulk: &BulkConfig, interface: &InterfaceConfig) -> Option<String> {
        let found = self.get(&effect.name)?;
        // A law that does not exist was reported as such.
        self.laws.bulk(&bulk.law)?;
        self.laws.interface(&interface.law)?;
        self.lacking(&**found, &effect.options, bulk, interface)
    }
}
