//! Dimensions of the specimen: from a file of the user's, else from the record's header.

use crate::error::{ImportError, short, visible};
use crate::header::HeaderEntry;
use crate::units::{self, Measure};
use crate::words::Dimension;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Largest geometry file, bytes.
const LARGEST: u64 = 10_000_000;

/// What is known of the specimen, mm.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Geometry {
    /// Between the clamps along the load.
    pub length: Option<f64>,
    /// Along the tear.
    pub width: Option<f64>,
    /// Through the strip.
    pub thickness: Option<f64>,
    /// From the edge x = 0.
    pub cut: Option<f64>,
    /// Name of the specimen.
    pub name: Option<String>,
    /// The file of `--geometry`.
    pub file: Option<PathBuf>,
    /// Its `[geometry]` table, as TOML.
    #[serde(skip)]
    pub table: Option<toml::Table>,
}

impl Geometry {
    /// Reads the `[geometry]` of a specimen or config. What is no positive length (a cut: none below 0) counts as not given;
    /// `input::check_geometry` says what is wrong with it, and where.
    ///
    /// # Errors
    /// If there is none.
    pub fn read(path: &Path) -> Result<Self, ImportError> {
        let fault = |reason: String| ImportError::NotARecord { path: path.to_owned(), reason };
        let meta = std::fs::metadata(path).map_err(|e| fault(format!("--geometry: {e}")))?;
        if !meta.is_file() || meta.len() > LARGEST {
            return Err(fault("--geometry: expected a TOML file with a [geometry] table".into()));
        }
        let text = std::fs::read_to_string(path).map_err(|e| fault(format!("--geometry: {e}")))?;
        let all: toml::Table = toml::from_str(&text)
            .map_err(|e| fault(format!("--geometry: not valid TOML: {}", visible(e.message()))))?;
        let Some(table) = all.get("geometry").and_then(toml::Value::as_table) else {
            return Err(fault(
                "--geometry: the file has no [geometry] table; expected length_mm, width_mm, thickness_mm"
                    .into(),
            ));
        };
        let mut out = Self { file: Some(path.to_owned()), ..Self::default() };
        out.length = length(table, "length");
        out.width = length(table, "width");
        out.thickness = length(table, "thickness");
        out.cut = length(table, "cut");
        out.name = all.get("name").and_then(toml::Value::as_str).map(str::to_owned);
        // Profiles are named relative to their file, which the new specimen is not beside.
        let folder =
            std::path::absolute(path).ok().and_then(|p| p.parent().map(Path::to_owned)).unwrap_or_default();
        let mut table = table.clone();
        for value in table
            .iter_mut()
            .filter(|(k, _)| matches!(k.as_str(), "outline" | "thickness_profile"))
            .map(|e| e.1)
        {
            if let toml::Value::String(file) = value {
                *file = folder.join(&*file).display().to_string();
            }
        }
        out.table = Some(table);
        Ok(out)
    }

    /// Adds what the header of a record says; what is known already stays. Remarks where both differ.
    pub fn add(&mut self, said: &[HeaderEntry]) -> Vec<String> {
        let mut remarks = Vec::new();
        for s in said {
            let slot = match s.about {
                Dimension::Length => &mut self.length,
                Dimension::Width => &mut self.width,
                Dimension::Thickness => &mut self.thickness,
                Dimension::Cut => &mut self.cut,
                Dimension::Name => {
                    self.name.get_or_insert_with(|| s.text.clone());
                    continue;
                }
                Dimension::Rate | Dimension::Note => continue,
            };
            let word = format!("{:?}", s.about).to_lowercase();
            match (s.value, &slot) {
                (Some(v), Some(known)) if (v - *known).abs() > 1e-6 * known.abs() => remarks.push(format!(
                    "row {}: the header says {word} {} mm; {} mm was taken",
                    s.row,
                    short(v),
                    short(*known)
                )),
                (Some(v), None) if v > 0.0 => *slot = Some(v),
                (None, None) => remarks.push(format!(
                    "row {}: the header says {word} {} without a unit: not taken",
                    s.row,
                    visible(&s.text)
                )),
                _ => {}
            }
        }
        remarks
    }

    /// Whether a specimen file can be complete.
    pub fn is_complete(&self) -> bool {
        self.length.is_some() && self.width.is_some() && self.thickness.is_some()
    }
}

/// `name_mm = 10.0`, `name_um = 800`, …: a positive length, for a cut also 0.
pub(crate) fn length(table: &toml::Table, name: &str) -> Option<f64> {
    table.iter().find_map(|(key, value)| {
        let unit = units::parse(key.strip_prefix(name)?.strip_prefix('_')?)?;
        let number = value.as_float().or_else(|| value.as_integer().map(|i| i as f64))?;
        let mm = number * unit.scale();
        (unit.measure == Measure::Length && mm.is_finite() && (mm > 0.0 || mm == 0.0 && name == "cut"))
            .then_some(mm)
    })
}
