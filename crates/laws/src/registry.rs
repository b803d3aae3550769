//! The list of all laws: one line each. The first of each site is what a file gets that names none.

use crate::entry::{BulkLaw, InterfaceLaw, LawCard, Settings};
use crate::{bulk, interface};
use input::{LawRegistry, LawSite, OptionSpec};
use params::ParamSpec;
use std::sync::Arc;

/// Every law this project knows, in the order of the handbook.
pub fn registry() -> Laws {
    Laws::default()
        .with_bulk(Arc::new(bulk::HolzapfelGasserOgden))
        .with_bulk(Arc::new(bulk::NeoHooke))
        .with_bulk(Arc::new(bulk::Yeoh))
        .with_bulk(Arc::new(bulk::Ogden))
        .with_bulk(Arc::new(bulk::FourFiber))
        .with_bulk(Arc::new(bulk::HolzapfelOgden))
        .with_interface(Arc::new(interface::Exponential))
        .with_interface(Arc::new(interface::Bilinear))
        .with_interface(Arc::new(interface::Trapezoidal))
        .with_interface(Arc::new(interface::Ppr))
}

/// Laws of both sites that can be asked by name.
#[derive(Clone, Default)]
pub struct Laws {
    bulk: Vec<BulkLaw>,
    interface: Vec<InterfaceLaw>,
}

impl Laws {
    /// The same with one more bulk law.
    pub fn with_bulk(mut self, law: BulkLaw) -> Self {
        self.bulk.push(law);
        self
    }

    /// The same with one more interface law.
    pub fn with_interface(mut self, law: InterfaceLaw) -> Self {
        self.interface.push(law);
        self
    }

    /// The bulk law of this name.
    pub fn bulk(&self, name: &str) -> Option<&BulkLaw> {
        self.bulk.iter().find(|l| l.card().name == name)
    }

    /// The interface law of this name.
    pub fn interface(&self, name: &str) -> Option<&InterfaceLaw> {
        self.interface.iter().find(|l| l.card().name == name)
    }

    /// Every bulk law.
    pub fn all_bulk(&self) -> impl Iterator<Item = &BulkLaw> {
        self.bulk.iter()
    }

    /// Every interface law.
    pub fn all_interface(&self) -> impl Iterator<Item = &InterfaceLaw> {
        self.interface.iter()
    }

    /// The cards of a site, the default law's first.
    pub fn cards(&self, site: LawSite) -> Vec<LawCard> {
        match site {
            LawSite::Bulk => self.bulk.iter().map(|l| *l.card()).collect(),
            LawSite::Interface => self.interface.iter().map(|l| *l.card()).collect(),
        }
    }
}

impl LawRegistry for Laws {
    fn law_names(&self, site: LawSite) -> Vec<String> {
        self.cards(site).iter().map(|c| c.name.to_owned()).collect()
    }

    fn law_options(&self, site: LawSite, law: &str) -> Vec<OptionSpec> {
        let found = match site {
            LawSite::Bulk => self.bulk(law).map(|l| l.options()),
            LawSite::Interface => self.interface(law).map(|l| l.options()),
        };
        found.unwrap_or_default()
    }

    fn law_parameters(&self, site: LawSite, law: &str, options: &Settings) -> Option<Vec<ParamSpec>> {
        match site {
            LawSite::Bulk => self.bulk(law).map(|l| l.parameters(options)),
            LawSite::Interface => self.interface(law).map(|l| l.parameters(options)),
        }
    }
}
