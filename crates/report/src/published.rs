//! Published values of a specimen, kept as data beside its folder.
//!
//! `published.toml` next to a specimen's file or folder, keyed by the specimen's name:
//!
//! ```toml
//! source = "Leng et al., Tables 1 and 2"
//! [FCT1]
//! notes = ["…"]
//! [FCT1.bulk]
//! mu_kPa = 2.0
//! [FCT1.interface]
//! gc_N_per_mm = [0.237, 0.225]     # one per area
//! ```
//!
//! Areas divide the tear path into equal parts, whatever their number: the values of the areas belong to places along the path,
//! not to counts. Where as many areas were identified as were published, each is compared with its own. Else an area is
//! shown the mean of the published values over its part of the path, each weighted with the length that lies in it; that is
//! no value which anybody published, so it is shown for orientation and counted neither inside nor outside an interval.

use crate::ReportError;
use input::Case;
use params::ParamSpec;
use std::path::{Path, PathBuf};
use toml::{Table, Value};

/// Published values of one specimen.
#[derive(Clone, Debug)]
pub struct Published {
    /// Where they were published.
    pub source: String,
    /// Remarks.
    pub notes: Vec<String>,
    table: Table,
}

impl Published {
    /// The published values of a case's specimen; `None` where there are none.
    ///
    /// # Errors
    /// If there is a `published.toml` that cannot be read.
    pub fn of(case: &Case) -> Result<Option<Self>, ReportError> {
        let Some(path) = find(case) else { return Ok(None) };
        let read = input::read_text(&path, input::LARGEST_TOML, "published values (TOML)");
        let text = read.map_err(|e| {
            let reason = e.0.first().map_or_else(String::new, |d| d.message.clone());
            ReportError::NotARun { path: path.clone(), reason }
        })?;
        let not = |reason: String| ReportError::NotARun { path: path.clone(), reason };
        let all: Table = text.parse().map_err(|e: toml::de::Error| not(e.message().to_owned()))?;
        let Some(table) = all.get(&case.name).and_then(Value::as_table) else { return Ok(None) };
        let words = |t: &Table| -> Vec<String> {
            let list = t.get("notes").and_then(Value::as_array);
            list.into_iter().flatten().filter_map(Value::as_str).map(str::to_owned).collect()
        };
        Ok(Some(Self {
            source: all.get("source").and_then(Value::as_str).unwrap_or("published values").to_owned(),
            notes: words(&all).into_iter().chain(words(table)).collect(),
            table: table.clone(),
        }))
    }

    /// The published value of a parameter of a model with so many areas, internal unit.
    pub fn value(&self, path: &str, spec: &ParamSpec, areas: usize) -> Option<At> {
        let section = self.table.get(path.split('.').next()?)?.as_table()?;
        let of = |given: &Value| match area(path) {
            Some(i) => along(&numbers(given)?, i, areas),
            None => number(given).map(|value| At { value, averaged: false }),
        };
        let suffixes = spec.quantity.suffixes();
        if suffixes.is_empty() {
            return of(section.get(&*spec.name)?);
        }
        // Any unit that a file may use.
        suffixes.iter().find_map(|s| {
            let at = of(section.get(&format!("{}_{}", spec.name, s.name))?)?;
            Some(At { value: at.value * s.factor, ..at })
        })
    }
}

/// What was published for a parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct At {
    /// Value.
    pub value: f64,
    /// Whether it is a mean over a part of the path that others divided otherwise.
    pub averaged: bool,
}

fn number(v: &Value) -> Option<f64> {
    v.as_float().or_else(|| v.as_integer().map(|i| i as f64)).filter(|x| x.is_finite())
}

/// One value per area; a value that is no list holds along the whole path.
fn numbers(v: &Value) -> Option<Vec<f64>> {
    v.as_array().map_or_else(|| Some(vec![number(v)?]), |list| list.iter().map(number).collect())
}

/// Mean of the published values over area `i` (from 0) of `areas` equal ones.
fn along(published: &[f64], i: usize, areas: usize) -> Option<At> {
    if published.len() == areas {
        return published.get(i).map(|value| At { value: *value, averaged: false });
    }
    if published.is_empty() || i >= areas {
        return None;
    }
    let ends = |i: usize, n: usize| [i as f64 / n as f64, (i + 1) as f64 / n as f64];
    let [from, to] = ends(i, areas);
    let mut sum = 0.0;
    for (k, value) in published.iter().enumerate() {
        let [low, high] = ends(k, published.len());
        sum += value * (high.min(to) - low.max(from)).max(0.0);
    }
    Some(At { value: sum / (to - from), averaged: true })
}

/// Index from 0 of the area in `interface.area[3].gc`.
pub(crate) fn area(path: &str) -> Option<usize> {
    let rest = path.strip_prefix("interface.area[")?;
    rest.split_once(']')?.0.parse::<usize>().ok()?.checked_sub(1)
}

fn find(case: &Case) -> Option<PathBuf> {
    let file = case.specimen_file.as_ref().or(case.config_file.as_ref())?;
    let file = std::path::absolute(file).ok()?;
    let folder = file.parent()?;
    let places = [Some(folder), folder.parent()];
    places.into_iter().flatten().map(|p: &Path| p.join("published.toml")).find(|p| p.is_file())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_paired_by_their_place_along_the_path() {
        let ten: Vec<f64> = (1..=10).map(f64::from).collect();
        assert_eq!(along(&ten, 2, 10), Some(At { value: 3.0, averaged: false }));
        // A third of the path is three areas and a third of the next.
        let third = along(&ten, 0, 3).expect("a mean");
        assert!(third.averaged && (third.value - (1.0 + 2.0 + 3.0 + 4.0 / 3.0) / (10.0 / 3.0)).abs() < 1e-12);
        let one = along(&ten, 0, 1).expect("a mean");
        assert!(one.averaged && (one.value - 5.5).abs() < 1e-12);
        // More areas than were published, and one value for all.
        let fine = along(&[2.0, 4.0], 1, 4).expect("a value");
        assert!(fine.averaged && (fine.value - 2.0).abs() < 1e-12);
        assert_eq!(along(&[2.0], 0, 1), Some(At { value: 2.0, averaged: false }));
        assert_eq!(along(&[], 0, 3), None);
    }
}
