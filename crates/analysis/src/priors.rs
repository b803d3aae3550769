//! What the literature lets one expect of the base parameters: wide priors that keep a diagnosis
//! from paying for a missing effect with an absurd tissue.

use input::PriorsConfig;
use inverse::{Free, Prior};
use params::Transform;

/// Median and standard deviation (in the parameter's own coordinate) of base parameters.
///
/// Medians and spreads over arterial tissue as collected in the paper (Tables 1, 2 and its
/// section 6); a spread of 1 in a logarithm is a factor 2.7 either way.
const LITERATURE: [(&str, f64, f64); 7] = [
    ("bulk.mu", 0.005, 1.0),
    ("bulk.k1", 1.0, 1.2),
    ("bulk.k2", 30.0, 0.8),
    ("bulk.gamma", 0.87, 0.8),
    ("bulk.kappa", 0.23, 1.0),
    ("interface.gc", 0.4, 1.2),
    ("interface.sigma_c", 0.2, 1.2),
];

/// The path without its area: `interface.area[3].gc` → `interface.gc`.
fn common(path: &str) -> String {
    match path.strip_prefix("interface.area[").and_then(|r| r.split_once("].")) {
        Some((_, what)) => format!("interface.{what}"),
        None => path.to_owned(),
    }
}

/// Adds priors to free parameters: the file's own first, else the literature's where `literature`.
pub fn add(frees: &mut [Free], config: &PriorsConfig, literature: bool) {
    for f in frees {
        let path = common(&f.path);
        let given = config.given.get(&f.path).or_else(|| config.given.get(&path));
        if let Some(p) = given {
            let mean = f.transform.forward(p.mean);
            let sd = match f.transform {
                Transform::Log => (1.0 + p.relative_sd * p.relative_sd).ln().sqrt(),
                t => (p.relative_sd * p.mean / t.slope(p.mean).max(f64::MIN_POSITIVE)).abs(),
            };
            f.prior = Some(Prior { mean, sd });
        } else if literature {
            if let Some(&(_, median, sd)) = LITERATURE.iter().find(|l| l.0 == path) {
                f.prior = Some(Prior { mean: f.transform.forward(median), sd });
            }
        }
    }
}
