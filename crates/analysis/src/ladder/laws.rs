//! Other laws of bulk and tear as candidates beside the catalogue's effects: `[diagnose] laws = true`.
//!
//! A law stands in a set by its name, as an effect does, in place of the file's law of that site.

use super::FeLadder;
use crate::identify::AnalysisError;
use input::{Case, LawRegistry, LawSite, OptionValue};
use model::{Catalogue, Model};
use params::{Owner, ParamPath, ParamSpec};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Names of the laws that a case's could be replaced by; none where the file does not ask for them.
pub(crate) fn other_laws(case: &Case, catalogue: &Catalogue) -> Vec<String> {
    if !case.diagnose.laws {
        return Vec::new();
    }
    let tears = case.tests.iter().any(|t| t.kind.tears);
    let own = [&case.bulk.law, &case.interface.law];
    [LawSite::Bulk, LawSite::Interface]
        .into_iter()
        .filter(|site| *site == LawSite::Bulk || tears)
        .flat_map(|site| catalogue.law_names(site))
        .filter(|name| !own.contains(&name))
        .collect()
}

/// Whether what a file says of a parameter (by its name, or its reciprocal's) holds for another law of the site, whose
/// parameters are `specs`: it does for toughness, strength and all that two laws of a tear share, and for what resists
/// changes of volume. Other parameters of two tissues that share a name need not mean the same.
pub fn keeps_meaning(site: LawSite, specs: &[ParamSpec], name: &str) -> bool {
    let of = |s: &ParamSpec| s.name == name || s.reciprocal.is_some_and(|r| r.name == name);
    specs.iter().any(|s| of(s) && (site == LawSite::Interface || s.reciprocal.is_some()))
}

/// A case with another law of a site, at its settings' defaults; of the old law's parameters stays what [`keeps_meaning`].
pub(crate) fn with_law(case: &Case, catalogue: &Catalogue, site: LawSite, law: &str) -> Case {
    let defaults = catalogue.law_options(site, law).into_iter();
    let options: BTreeMap<String, OptionValue> =
        defaults.filter_map(|o| Some((o.name, o.default?))).collect();
    let specs = catalogue.law_parameters(site, law, &options).unwrap_or_default();
    let mut out = case.clone();
    match site {
        LawSite::Bulk => {
            out.bulk.parameters.retain(|name, _| keeps_meaning(site, &specs, name));
            out.identify.priors.given.retain(|path, _| !path.starts_with("bulk."));
            out.identify.priors.around.retain(|path, _| !path.starts_with("bulk."));
            (out.bulk.law, out.bulk.options, out.bulk.specs) = (law.to_owned(), options, specs);
        }
        LawSite::Interface => {
            out.interface.parameters.retain(|name, _| keeps_meaning(site, &specs, name));
            let interface = &mut out.interface;
            (interface.law, interface.options, interface.specs) = (law.to_owned(), options, specs);
        }
    }
    out
}

impl FeLadder<'_> {
    /// The case with the laws of a set in place of its own.
    pub(super) fn case_with_laws(&self, set: &[String]) -> Case {
        set.iter().fold((*self.case).clone(), |case, name| match self.catalogue.site_of_law(name) {
            Some(site) => with_law(&case, self.catalogue, site, name),
            None => case,
        })
    }

    /// Whether a set is made of laws alone.
    pub(super) fn laws_alone(&self, set: &[String]) -> bool {
        set.iter().all(|name| self.catalogue.site_of_law(name).is_some())
    }

    /// A model by its laws, where they are not the file's, and its effects.
    pub(super) fn parts_of(&self, model: &Model) -> Vec<String> {
        let laws = [
            (&model.case.bulk.law, &self.case.bulk.law),
            (&model.case.interface.law, &self.case.interface.law),
        ];
        let others = laws.into_iter().filter(|(now, file)| now != file).map(|(now, _)| now.clone());
        others.chain(model.effects()).collect()
    }

    /// Start values of a bulk law that is not the fitted model's: a parameter of the same name need not mean the same, so
    /// the record is asked.
    pub(super) fn start_other_bulk(
        &self,
        of: &Model,
        model: &Model,
        theta: &mut [f64],
    ) -> Result<(), AnalysisError> {
        if of.case.bulk.law == model.case.bulk.law {
            return Ok(());
        }
        let mut bare = (*model.case).clone();
        bare.effects.clone_from(&self.case.effects);
        let found = self.start_by_record(&Arc::new(bare), model)?;
        for (i, p) in model.parameters.iter().enumerate() {
            if p.path.parse::<ParamPath>().is_ok_and(|path| path.owner == Owner::Bulk) {
                theta[i] = found[i];
            }
        }
        Ok(())
    }

    /// Sets with one more law, of a site at which they have none yet.
    pub(super) fn with_other_laws(&self, sets: &[Vec<String>]) -> Vec<Vec<String>> {
        let laws = other_laws(&self.case, self.catalogue);
        let larger = sets.iter().filter(|s| !s.is_empty()).flat_map(|s| {
            laws.iter().map(|law| Self::key(&[s.as_slice(), std::slice::from_ref(law)].concat()))
        });
        larger.filter(|s| self.compatible(s)).collect()
    }
}
