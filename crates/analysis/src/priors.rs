//! What the literature lets one expect of the base parameters: wide priors that keep a diagnosis
//! from paying for a missing effect with an absurd tissue.

use input::Case;
use inverse::{Free, Prior};
use params::{Expected, Owner, ParamPath, ParamSpec, Transform};

/// Spread of a bulk parameter whose value the file gives: 50 %.
const GIVEN_SD: f64 = 0.5;

/// A search does not look farther than this many standard deviations from the prior: beyond, a
/// tissue without matrix or without fibres would pay for any missing effect.
const PRIOR_WIDTH: f64 = 3.0;

/// What is believed of base parameters besides what a file calls a prior.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Belief {
    /// Nothing; where the file gives no value, a search stays within reach of the literature's.
    Bounds,
    /// What the literature lets one expect, whatever the file gives.
    Literature,
    /// The same, but no bound for what the file gives a value for: that is a start, the tissue may be none that the literature knows.
    Start,
    /// The literature's, and the file's values where it gives them.
    Given,
}

impl Belief {
    /// By what a file says of `priors`; what is the case where it says nothing.
    pub fn of(case: &Case, unsaid: Self) -> Self {
        match case.identify.priors.literature {
            Some(true) => Self::Given,
            Some(false) => Self::Bounds,
            None => unsaid,
        }
    }

    /// While a start is sought: the literature keeps it from absurd tissues, whatever the file says. A fit may end at others.
    pub fn at_start(self) -> Self {
        if self == Self::Given { self } else { Self::Start }
    }
}

/// The path without its area: `interface.area[3].gc` → `interface.gc`.
fn common(path: &str) -> Option<ParamPath> {
    path.parse::<ParamPath>().ok().map(ParamPath::common)
}

/// Parameters of which the literature lets one expect something, with what it does, as the laws say.
fn expectations(case: &Case) -> Vec<(ParamPath, Expected)> {
    let of = |owner: Owner, specs: &[ParamSpec]| -> Vec<_> {
        let with = |s: &ParamSpec| {
            Some((ParamPath { owner: owner.clone(), name: s.name.clone().into_owned() }, s.expected?))
        };
        specs.iter().filter_map(with).collect()
    };
    let bulk = of(Owner::Bulk, &case.bulk.specs);
    bulk.into_iter().chain(of(Owner::Interface, &case.interface.specs)).collect()
}

/// Has the priors of a case stand where they are while its start values move.
pub(crate) fn hold(case: &mut Case) {
    for (path, _) in expectations(case) {
        let given = given_value(case, &path);
        case.identify.priors.around.insert(path.to_string(), given);
    }
}

/// What the file gives for a base parameter.
fn given_value(case: &Case, path: &ParamPath) -> Option<f64> {
    if let Some(&given) = case.identify.priors.around.get(&path.to_string()) {
        return given;
    }
    match (&path.owner, path.name.as_str()) {
        (Owner::Bulk, name) => case.bulk.value(name).value,
        (Owner::Interface, "gc") => case.interface.gc_of(0).value,
        (Owner::Interface, "sigma_c") => case.interface.sigma_c_of(0).value,
        (Owner::Interface, name) => case.interface.value(name).value,
        _ => None,
    }
}

/// Adds priors to free parameters: the file's own first; else the literature's, or with [`Belief::Given`] around the value that
/// the file gives. The search stays within reach of them ([`PRIOR_WIDTH`]), narrower bounds of the file first.
pub fn add(free_parameters: &mut [Free], case: &Case, belief: Belief) {
    let expected = expectations(case);
    for f in free_parameters {
        let Some(path) = common(&f.path) else { continue };
        let config = &case.identify.priors;
        if let Some(p) = config.given.get(&f.path).or_else(|| config.given.get(&path.to_string())) {
            let mean = f.transform.forward(p.mean);
            let sd = match f.transform {
                Transform::Log => (1.0 + p.relative_sd * p.relative_sd).ln().sqrt(),
                t => (p.relative_sd * p.mean / t.slope(p.mean).max(f64::MIN_POSITIVE)).abs(),
            };
            f.prior = (belief != Belief::Bounds).then_some(Prior { mean, sd });
            continue;
        }
        let Some(&(_, Expected { median, spread })) = expected.iter().find(|l| l.0 == path) else { continue };
        let given = given_value(case, &path);
        if belief == Belief::Bounds && given.is_some() {
            // A start is no belief: the parameter's own bounds, or the file's, are the only ones.
            continue;
        }
        let believed = given.filter(|_| belief == Belief::Given);
        let at = believed.unwrap_or(median);
        // A value on a bound (k2 = 0, κ = 0) has no place in the coordinate: no prior.
        if f.at_bound(at) || at <= f.lower || at >= f.upper {
            continue;
        }
        let sd = if believed.is_some() && path.owner == Owner::Bulk { GIVEN_SD } else { spread };
        let mean = f.transform.forward(at);
        f.prior = Some(Prior { mean, sd });
        if given.is_some() && belief == Belief::Start {
            continue;
        }
        f.lower = f.lower.max(f.transform.backward(mean - PRIOR_WIDTH * sd));
        f.upper = f.upper.min(f.transform.backward(mean + PRIOR_WIDTH * sd));
        f.start = f.start.clamp(f.lower, f.upper);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use model::{Discretisation, Model};
    use std::sync::Arc;

    /// A case that gives the tissue but nothing of the tear.
    fn case(root: &std::path::Path) -> Case {
        let text = "name = \"x\"\n[geometry]\nlength_mm = 6.0\nwidth_mm = 4.0\nthickness_mm = 0.8\ncut_mm = 1.0\n\
                    [[tests]]\nkind = \"tearing\"\nprotocol = [{ to_mm = 1.0, rate_mm_per_s = 0.05 }]\n[mesh]\ndivisions = [4, 4, 1]\n\
                    [bulk]\nmu_kPa = 6.0\nk1_kPa = 500.0\nk2 = 12.0\ngamma_deg = 40.0\nkappa = 0.2\n\
                    [interface]\nareas = 2\n";
        std::fs::write(root.join("c.toml"), text).expect("written");
        input::read_case(&root.join("c.toml"), &effects::catalogue()).unwrap_or_else(|e| panic!("{e}"))
    }

    /// The free parameters of a case with the literature's priors.
    fn priors_of(case: &Case) -> Vec<Free> {
        let model = Model::new(Arc::new(case.clone()), &effects::catalogue(), Discretisation::default())
            .expect("a model");
        let mut list = crate::identify::free_parameters(&model, &model.theta(), &model.free());
        add(&mut list, case, Belief::Given);
        list
    }

    #[test]
    fn priors_stand_around_what_the_file_gives_else_around_the_literature() {
        let folder = tempfile::tempdir().expect("a folder");
        let list = priors_of(&case(folder.path()));
        let of = |path: &str| list.iter().find(|f| f.path == path).and_then(|f| f.prior).expect("a prior");
        assert_relative_eq!(of("bulk.k1").mean, 0.5f64.ln());
        assert_relative_eq!(of("bulk.k1").sd, 0.5);
        assert_relative_eq!(of("interface.area[2].gc").mean, 0.4f64.ln());
        assert_relative_eq!(of("interface.area[2].gc").sd, 1.2);
    }

    /// While a start is sought, a value that the file gives is no belief, and no bound: it may be wrong by any factor.
    #[test]
    fn a_start_is_sought_beyond_what_the_file_gives() {
        let folder = tempfile::tempdir().expect("a folder");
        let case = case(folder.path());
        let model = Model::new(Arc::new(case.clone()), &effects::catalogue(), Discretisation::default())
            .expect("a model");
        let own = crate::identify::free_parameters(&model, &model.theta(), &model.free());
        let k1 = own.iter().position(|f| f.path == "bulk.k1").expect("a parameter");
        let by = |belief: Belief| {
            let mut list = own.clone();
            add(&mut list, &case, belief);
            let f = &list[k1];
            (f.prior.map(|p| p.mean), f.lower, f.upper)
        };
        let (bounds, literature) = ((own[k1].lower, own[k1].upper), by(Belief::Literature));
        assert_eq!(by(Belief::Bounds), (None, bounds.0, bounds.1));
        assert_eq!(by(Belief::Start), (literature.0, bounds.0, bounds.1));
        assert!(literature.1 > bounds.0 && literature.2 < bounds.1 && literature.0 != by(Belief::Given).0);
        assert_eq!(
            [Belief::Bounds, Belief::Start, Belief::Given].map(Belief::at_start)[..2],
            [Belief::Start; 2]
        );
        assert_eq!(Belief::Given.at_start(), Belief::Given);
    }

    /// A diagnosis of a finished run starts at its values. Were its priors to follow them, no tissue would be absurd.
    #[test]
    fn priors_stay_where_a_search_starts_elsewhere() {
        let folder = tempfile::tempdir().expect("a folder");
        let mut case = case(folder.path());
        let before = priors_of(&case);
        let found = [("bulk.k1", 1.5), ("bulk.k2", 30.0), ("interface.area[1].gc", 0.05)];
        for _ in 0..2 {
            crate::start_at(&mut case, found.into_iter());
            let after = priors_of(&case);
            for (a, b) in after.iter().zip(&before) {
                assert_eq!((&a.path, a.prior, a.lower, a.upper), (&b.path, b.prior, b.lower, b.upper));
                let start = found.iter().find(|f| f.0 == a.path).map_or(b.start, |f| f.1);
                assert_relative_eq!(a.start, start);
            }
        }
    }
}
