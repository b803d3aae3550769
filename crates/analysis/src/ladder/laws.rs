//! Other laws of bulk and tear as candidates beside the catalogue's effects: `[diagnose] laws = true`.
//!
//! A law stands in a set by its name, as an effect does, in place of the file's law of that site.

use super::FeLadder;
use crate::identify::AnalysisError;
use input::{Case, LawRegistry, LawSite, OptionValue};
use model::{Catalogue, Model};
use params::{Owner, ParamPath};
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

/// A case with another law of a site. What the file says of the old law's parameters holds for those of the same meaning:
/// toughness and strength of any tear, and what resists changes of volume.
pub(crate) fn with_law(case: &Case, catalogue: &Catalogue, site: LawSite, law: &str) -> Case {
    let defaults = catalogue.law_options(site, law).into_iter();
    let options: BTreeMap<String, OptionValue> =
        defaults.filter_map(|o| Some((o.name, o.default?))).collect();
    let specs = catalogue.law_parameters(site, law, &options).unwrap_or_default();
    let mut out = case.clone();
    match site {
        LawSite::Bulk => {
            let same = |name: &str| specs.iter().any(|s| s.name == name && s.reciprocal.is_some());
            out.bulk.parameters.retain(|name, _| same(name));
            out.identify.priors.given.retain(|path, _| !path.starts_with("bulk."));
            out.identify.priors.around.retain(|path, _| !path.starts_with("bulk."));
            (out.bulk.law, out.bulk.options, out.bulk.specs) = (law.to_owned(), options, specs);
        }
        LawSite::Interface => {
            out.interface.parameters.retain(|name, _| specs.iter().any(|s| s.name == *name));
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

    /// Sets with one more law, for sets that have none yet.
    pub(super) fn with_other_laws(&self, sets: &[Vec<String>]) -> Vec<Vec<String>> {
        let laws = other_laws(&self.case, self.catalogue);
        let larger = sets.iter().filter(|s| !s.is_empty()).flat_map(|s| {
            laws.iter().map(|law| Self::key(&[s.as_slice(), std::slice::from_ref(law)].concat()))
        });
        larger.filter(|s| self.compatible(s)).collect()
    }
}
