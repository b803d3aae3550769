//! Which laws a ladder has to tell, and how.

use analysis::LawNames;
use input::{LawRegistry, LawSite};
use model::Catalogue;

/// The laws of a file that does not choose.
pub(crate) fn default_laws() -> LawNames {
    let first = |site| Catalogue::default().law_names(site).into_iter().next();
    LawNames { bulk: first(LawSite::Bulk).unwrap_or_default(), interface: first(LawSite::Interface) }
}

/// What the laws are where a rung names none, as a sentence after `head`; `None` where there is nothing to tell apart.
pub(crate) fn said<'a>(
    models: impl Iterator<Item = Option<&'a LawNames>> + Clone,
    unsaid: &LawNames,
    head: &str,
) -> Option<String> {
    let of = |site: &LawSite| Some(format!("{} {}", site.section(), unsaid.at(*site)?));
    let laws: Vec<String> = told_sites(models).iter().filter_map(of).collect();
    (!laws.is_empty()).then(|| format!("{head}: {}.", laws.join(", ")))
}

/// Sites whose law is told: where two models differ, or one has another than a file gets that does not choose. Models of
/// which nothing is known tell nothing.
pub(crate) fn told_sites<'a>(models: impl Iterator<Item = Option<&'a LawNames>> + Clone) -> Vec<LawSite> {
    let default = default_laws();
    let told = |site: &LawSite| {
        let mut laws = models.clone().flatten().filter_map(|m| m.at(*site));
        laws.any(|law| Some(law) != default.at(*site))
    };
    LawSite::ALL.into_iter().filter(told).collect()
}

/// The head of their column; `None` where none is told.
pub(crate) fn head(sites: &[LawSite]) -> Option<String> {
    let names: Vec<&str> = sites.iter().map(|s| s.section()).collect();
    (!names.is_empty()).then(|| format!("{} law", names.join(", ")))
}

/// A model's cell of that column.
pub(crate) fn cell(laws: Option<&LawNames>, sites: &[LawSite]) -> String {
    let of = |site: &LawSite| laws.and_then(|l| l.at(*site)).unwrap_or("–");
    sites.iter().map(of).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn laws(bulk: &str, interface: Option<&str>) -> LawNames {
        LawNames { bulk: bulk.into(), interface: interface.map(str::to_owned) }
    }

    #[test]
    fn laws_are_told_where_they_are_not_the_default() {
        let sites = |models: &[LawNames]| told_sites(models.iter().map(Some));
        let base = laws("hgo", Some("exponential"));
        assert_eq!(sites(&[base.clone(), base.clone()]), []);
        // Where all have the same, but not the default, it is told too.
        assert_eq!(sites(&[laws("yeoh", None)]), [LawSite::Bulk]);
        let torn = laws("hgo", Some("bilinear"));
        let told = sites(&[base.clone(), torn.clone()]);
        assert_eq!(
            (head(&told).as_deref(), cell(Some(&torn), &told).as_str()),
            (Some("interface law"), "bilinear")
        );
        assert_eq!(cell(Some(&base), &told), "exponential");
        let models = [Some(&base), Some(&torn)];
        let sentence = said(models.into_iter(), &base, "Laws of the base");
        assert_eq!(sentence.as_deref(), Some("Laws of the base: interface exponential."));
        assert_eq!(said([Some(&base), None].into_iter(), &base, "Laws of the base"), None);
        let told = sites(&[base, laws("ogden", Some("ppr"))]);
        assert_eq!(head(&told).as_deref(), Some("bulk, interface law"));
        assert_eq!(cell(Some(&laws("ogden", None)), &told), "ogden, –");
        assert_eq!((head(&[]), cell(None, &told).as_str()), (None, "–, –"));
    }
}
