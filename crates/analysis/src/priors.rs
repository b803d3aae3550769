//! What the literature lets one expect of the base parameters: wide priors that keep a diagnosis
//! from paying for a missing effect with an absurd tissue.

use input::Case;
use inverse::{Free, Prior};
use params::Transform;

/// Median and standard deviation (in the parameter's own coordinate) of base parameters.
///
/// Medians and spreads over arterial tissue as collected in the paper (Tables 1, 2 and its
/// section 6); a spread of 1 in a logarithm is a factor 2.7 either way.
const LITERATURE: [(&str, f64, f64); 7] = [
    ("bulk.mu", 0.005, 0.6),
    ("bulk.k1", 1.0, 1.0),
    ("bulk.k2", 30.0, 0.7),
    ("bulk.gamma", 0.87, 0.8),
    ("bulk.kappa", 0.23, 1.0),
    ("interface.gc", 0.4, 1.2),
    ("interface.sigma_c", 0.2, 1.2),
];

/// Spread of a bulk parameter whose value the file gives: 50 %.
const GIVEN_SD: f64 = 0.5;

/// A search does not look farther than this many standard deviations from the prior: beyond, a
/// tissue without matrix or without fibres would pay for any missing effect.
const REACH: f64 = 3.0;

/// The path without its area: `interface.area[3].gc` → `interface.gc`.
fn common(path: &str) -> String {
    match path.strip_prefix("interface.area[").and_then(|r| r.split_once("].")) {
        Some((_, what)) => format!("interface.{what}"),
        None => path.to_owned(),
    }
}

/// What the file gives for a base parameter.
fn given_value(case: &Case, path: &str) -> Option<f64> {
    let b = &case.bulk;
    match path {
        "bulk.mu" => b.mu.value,
        "bulk.k1" => b.k1.value,
        "bulk.k2" => b.k2.value,
        "bulk.gamma" => b.gamma.value,
        "bulk.kappa" => b.kappa.value,
        "interface.gc" => case.interface.gc_of(0).value,
        "interface.sigma_c" => case.interface.sigma_c_of(0).value,
        _ => None,
    }
}

/// Adds priors to free parameters: the file's own first; else, where `literature`, around the value
/// the file gives, or the literature's. With or without priors the search stays within reach of
/// them ([`REACH`]), narrower bounds of the file first.
pub fn add(frees: &mut [Free], case: &Case, literature: bool) {
    for f in frees {
        let path = common(&f.path);
        let config = &case.identify.priors;
        if let Some(p) = config.given.get(&f.path).or_else(|| config.given.get(&path)) {
            let mean = f.transform.forward(p.mean);
            let sd = match f.transform {
                Transform::Log => (1.0 + p.relative_sd * p.relative_sd).ln().sqrt(),
                t => (p.relative_sd * p.mean / t.slope(p.mean).max(f64::MIN_POSITIVE)).abs(),
            };
            f.prior = Some(Prior { mean, sd });
            continue;
        }
        let Some(&(_, median, spread)) = LITERATURE.iter().find(|l| l.0 == path) else { continue };
        let given = given_value(case, &path);
        let at = given.unwrap_or(median);
        // A value on a bound (k2 = 0, κ = 0) has no place in the coordinate: no prior.
        if f.at_bound(at) || at <= f.lower || at >= f.upper {
            continue;
        }
        let sd = if given.is_some() && path.starts_with("bulk.") { GIVEN_SD } else { spread };
        let mean = f.transform.forward(at);
        f.prior = literature.then_some(Prior { mean, sd });
        f.lower = f.lower.max(f.transform.backward(mean - REACH * sd));
        f.upper = f.upper.min(f.transform.backward(mean + REACH * sd));
        f.start = f.start.clamp(f.lower, f.upper);
    }
}
