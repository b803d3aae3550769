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

    /// The published value of a parameter, internal unit.
    pub fn value(&self, path: &str, spec: &ParamSpec) -> Option<f64> {
        let section = self.table.get(path.split('.').next()?)?.as_table()?;
        let number = |v: &Value| v.as_float().or_else(|| v.as_integer().map(|i| i as f64));
        let of = |given: &Value| match area(path) {
            Some(i) => number(given.as_array()?.get(i)?),
            None => number(given),
        };
        let suffixes = spec.quantity.suffixes();
        if suffixes.is_empty() {
            return of(section.get(&*spec.name)?);
        }
        // Any unit that a file may use.
        suffixes.iter().find_map(|s| Some(of(section.get(&format!("{}_{}", spec.name, s.name))?)? * s.factor))
    }
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
