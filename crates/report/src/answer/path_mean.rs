//! Means along the tear path: areas that trade off against their neighbours are known better together than apart.

use super::{IdentifyAnswer, ParameterAnswer};
use indexmap::IndexMap;
use inverse::Identifiability;
use serde::{Deserialize, Serialize};

/// The mean of one strength over the areas of the tear path.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PathMean {
    /// Unit.
    pub unit: String,
    /// The mean.
    pub value: f64,
    /// Its standard error √(Σᵢⱼ ρᵢⱼ sᵢ sⱼ)/n, with the correlations ρ of the areas' own standard errors s.
    pub std_error: f64,
    /// 95 % interval.
    pub interval_95: [f64; 2],
    /// Areas in it: those that the records inform on at all and that do not stand at a bound.
    pub counted: usize,
    /// All areas.
    pub areas: usize,
}

/// What a parameter of an area is called: `gc` of `interface.area[3].gc`.
fn of_area(p: &ParameterAnswer) -> Option<&str> {
    p.path.strip_prefix("interface.area[")?.split_once("].").map(|(_, name)| name)
}

impl IdentifyAnswer {
    /// Means of all that varies along the path, by name (`gc`, `sigma_c`); without those that the records do not fix.
    pub(crate) fn means_along_path(&self) -> IndexMap<String, PathMean> {
        let mut names: Vec<&str> = self.parameters.iter().filter_map(of_area).collect();
        names.sort_unstable();
        names.dedup();
        names.into_iter().filter_map(|name| Some((name.to_owned(), self.mean_along_path(name)?))).collect()
    }

    /// Indices of the parameters in that mean.
    pub fn in_path_mean(&self, name: &str) -> Vec<usize> {
        let informed = |p: &ParameterAnswer| {
            of_area(p) == Some(name) && !p.at_bound && p.std_error.is_some_and(|s| s > 0.0)
        };
        self.parameters.iter().enumerate().filter(|(_, p)| informed(p)).map(|(i, _)| i).collect()
    }

    /// The mean of a name, if the records fix it.
    pub fn mean_along_path(&self, name: &str) -> Option<PathMean> {
        let all: Vec<&ParameterAnswer> =
            self.parameters.iter().filter(|p| of_area(p) == Some(name)).collect();
        let inside = self.in_path_mean(name);
        if inside.is_empty() {
            return None;
        }
        let n = inside.len() as f64;
        let value = inside.iter().map(|&i| self.parameters[i].value).sum::<f64>() / n;
        let std_error = self.error_of_mean(&inside);
        // As of a parameter that is called identifiable.
        if std_error > Identifiability::default().max_sd * value.abs() {
            return None;
        }
        let interval_95 = match inside.as_slice() {
            [one] => match self.parameters[*one].interval_95 {
                [Some(low), Some(high)] => [low, high],
                _ => return None,
            },
            // As of the areas themselves: even in the logarithm.
            _ => [-1.96, 1.96].map(|z| value * (z * std_error / value).exp()),
        };
        let (counted, areas) = (inside.len(), all.len());
        Some(PathMean { unit: all[0].unit.clone(), value, std_error, interval_95, counted, areas })
    }

    fn error_of_mean(&self, inside: &[usize]) -> f64 {
        let n = inside.len() as f64;
        let sd = |i: usize| self.parameters[i].std_error.unwrap_or(0.0);
        let correlation = |i: usize, j: usize| {
            let given = self.correlations.get(i).and_then(|row| row.get(j).copied().flatten());
            if i == j { 1.0 } else { given.unwrap_or(0.0) }
        };
        let pairs = inside.iter().flat_map(|i| inside.iter().map(move |j| (*i, *j)));
        let variance: f64 = pairs.map(|(i, j)| correlation(i, j) * sd(i) * sd(j)).sum::<f64>() / (n * n);
        // Areas that hold each other in balance may be known much better together than apart, not perfectly.
        let least = inside.iter().map(|&i| sd(i).powi(2)).fold(f64::MAX, f64::min) / (n * n * 100.0);
        variance.max(least).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two areas that hold each other in balance: each is known to 60 %, their sum to 6 %.
    #[test]
    fn areas_in_balance_are_known_together() -> Result<(), serde_json::Error> {
        let area = |k: usize, value: f64, at_bound: bool| {
            serde_json::json!({ "path": format!("interface.area[{k}].gc"), "value": value, "unit": "N/mm",
                "std_error": 0.6, "interval_95": [0.3, 3.2], "interval_95_if_right": [0.3, 3.2],
                "at_bound": at_bound, "identifiable": false })
        };
        let answer = |parameters: Vec<serde_json::Value>, rho: f64| {
            let n = parameters.len();
            let row = |i: usize| (0..n).map(|j| if i == j { 1.0 } else { rho }).collect::<Vec<_>>();
            serde_json::from_value::<IdentifyAnswer>(serde_json::json!({
                "schema": 1, "specimen": "s", "provenance": "", "effects": [], "parameters": parameters, "tests": {},
                "rms_N": 0.0, "reduced_chi2": 1.0, "reduced_chi2_total": 1.0, "explained": true, "bic": null,
                "iterations": 0, "forward_runs": 0, "seconds": 0.0, "stopped_because": "", "stages": [],
                "sloppy": [], "correlations": (0..n).map(row).collect::<Vec<_>>(), "history": []
            }))
        };
        let balanced = answer(vec![area(1, 1.0, false), area(2, 1.2, false), area(3, 9.0, true)], -0.98)?;
        let mean = &balanced.means_along_path()["gc"];
        // √(2·0.36·(1 − 0.98))/2 = 0.06.
        assert!((mean.value - 1.1).abs() < 1e-12 && (mean.std_error - 0.06).abs() < 1e-12, "{mean:?}");
        assert_eq!((mean.counted, mean.areas), (2, 3), "an area at a bound is in no mean");
        let [low, high] = mean.interval_95;
        assert!((low * high - 1.1 * 1.1).abs() < 1e-12 && (high / 1.1).ln() > 0.1, "{mean:?}");
        // Without the balance the mean is not known either.
        assert!(answer(vec![area(1, 1.0, false)], 0.0)?.means_along_path().is_empty());
        Ok(())
    }
}
