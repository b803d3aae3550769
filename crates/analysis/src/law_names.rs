//! Which laws a model is made of, by name.

use input::{Case, LawSite};
use serde::{Deserialize, Serialize};

/// The laws of a model.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct LawNames {
    /// The law of the tissue.
    pub bulk: String,
    /// The law of the tear; none where nothing tears.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub interface: Option<String>,
}

impl LawNames {
    /// Those of a case.
    pub fn of(case: &Case) -> Self {
        let tears = case.tests.iter().any(|t| t.kind.tears);
        Self { bulk: case.bulk.law.clone(), interface: tears.then(|| case.interface.law.clone()) }
    }

    /// The law of a site, where there is one.
    pub fn at(&self, site: LawSite) -> Option<&str> {
        match site {
            LawSite::Bulk => Some(&self.bulk),
            LawSite::Interface => self.interface.as_deref(),
        }
    }

    /// What a model has beside a base, in words: laws that are not the base's are said to be laws, then the effects.
    /// A search names a law among its effects; here it stands once.
    pub fn parts(&self, base: &Self, effects: &[String]) -> Vec<String> {
        let own = LawSite::ALL.map(|site| self.at(site));
        let other = LawSite::ALL.into_iter().filter(|site| self.at(*site) != base.at(*site));
        let laws = other.filter_map(|site| Some(format!("law {}", self.at(site)?)));
        laws.chain(effects.iter().filter(|e| !own.contains(&Some(e))).cloned()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn laws(bulk: &str, interface: Option<&str>) -> LawNames {
        LawNames { bulk: bulk.into(), interface: interface.map(str::to_owned) }
    }

    #[test]
    fn a_law_is_said_once_and_only_where_it_is_another() {
        let base = laws("hgo", Some("exponential"));
        let list = |names: &[&str]| names.iter().map(|n| (*n).to_owned()).collect::<Vec<String>>();
        assert_eq!(base.parts(&base, &list(&["drift"])), ["drift"]);
        let torn = laws("hgo", Some("bilinear"));
        assert_eq!(torn.parts(&base, &list(&["bilinear", "drift"])), ["law bilinear", "drift"]);
        assert_eq!(torn.parts(&base, &[]), ["law bilinear"]);
        assert_eq!(base.parts(&torn, &[]), ["law exponential"]);
        assert_eq!(laws("yeoh", Some("ppr")).parts(&base, &[]), ["law yeoh", "law ppr"]);
    }
}
