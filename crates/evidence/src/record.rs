//! The measured points of all tests with their noise, in shares of each block's peak.

use crate::process::Points;
use inverse::Data;
use nalgebra::DVector;
use thiserror::Error;

/// Where a block of [`Data`] stands on the path of its test.
#[derive(Clone, Debug, PartialEq)]
pub struct Place {
    /// Test that the block belongs to; blocks of one test are summed in what is left.
    pub test: String,
    /// Path coordinate ([`crate::path`]) of every point of the block.
    pub s: Vec<f64>,
    /// Which leg of the protocol every point belongs to; empty: all to one.
    pub leg: Vec<usize>,
    /// Largest measured size, unit of the block: what shares are of.
    pub peak: f64,
}

/// Why no evidence could be computed.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum EvidenceError {
    /// Lengths disagree.
    #[error("{what}: {found} entries, expected {expected}")]
    Length {
        /// What was given.
        what: String,
        /// Its length.
        found: usize,
        /// What it should be.
        expected: usize,
    },
    /// A number that cannot be used.
    #[error("{what} is {value}; expected {expected}")]
    Value {
        /// Which number.
        what: String,
        /// What was found.
        value: f64,
        /// What is needed.
        expected: &'static str,
    },
    /// No point is left.
    #[error("no point takes part")]
    Empty,
}

/// Checks a length.
pub(crate) fn length(what: impl Into<String>, found: usize, expected: usize) -> Result<(), EvidenceError> {
    if found == expected { Ok(()) } else { Err(EvidenceError::Length { what: what.into(), found, expected }) }
}

/// One block's points that take part.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct BlockPoints {
    pub test: String,
    /// Which of the record's tests that is.
    pub number: usize,
    pub rows: Vec<usize>,
    pub points: Points,
    pub peak: f64,
    /// What was measured, shares of the peak.
    pub measured: Vec<f64>,
}

/// Everything about the records that does not depend on a model. Models are compared on the same points only.
#[derive(Clone, Debug, PartialEq)]
pub struct Record {
    pub(crate) blocks: Vec<BlockPoints>,
    /// How many tests they belong to.
    pub(crate) tests: usize,
    pub(crate) full: usize,
    pub(crate) used: usize,
    /// Degrees of freedom that the least known noise level was estimated with.
    pub(crate) freedom: f64,
    /// Columns of the mesh's error, in shares of the peak, on the used points.
    pub(crate) mesh: Vec<Vec<f64>>,
    /// Σ n ln(peak): what turns a density of shares into one of the records.
    pub(crate) ln_units: f64,
}

impl Record {
    /// The points of `data` that are not held out. `places` has one entry per block. The numerical-error columns of `data`
    /// become the mesh's error; a column whose root mean square exceeds `most_mesh` (share of the peak) is scaled down to
    /// it: it is never larger than what the rest may be.
    ///
    /// # Errors
    /// [`EvidenceError`] when lengths disagree, a peak or noise level is not positive, or nothing is left.
    pub fn new(data: &Data, places: &[Place], most_mesh: f64) -> Result<Self, EvidenceError> {
        length("places", places.len(), data.blocks.len())?;
        let mut blocks: Vec<BlockPoints> = Vec::new();
        let mut tests = 0;
        for (block, place) in data.blocks.iter().zip(places) {
            length(format!("path of {}", block.name), place.s.len(), block.range.len())?;
            positive(format!("peak of {}", block.name), place.peak)?;
            positive(format!("noise of {}", block.name), block.noise.sd)?;
            let rows: Vec<usize> = block.range.clone().filter(|&i| data.is_used(i)).collect();
            let gap =
                (0..rows.len()).map(|k| if k > 0 { (rows[k] - rows[k - 1]) as u32 } else { 1 }).collect();
            let s = rows.iter().map(|&i| place.s[i - block.range.start]).collect();
            let leg = if place.leg.is_empty() {
                Vec::new()
            } else {
                length(format!("legs of {}", block.name), place.leg.len(), block.range.len())?;
                rows.iter().map(|&i| place.leg[i - block.range.start]).collect()
            };
            let points = Points { s, gap, sd: block.noise.sd / place.peak, ar1: block.noise.ar1, leg };
            let number = blocks.iter().find(|b| b.test == place.test).map_or(tests, |b| b.number);
            tests = tests.max(number + 1);
            let measured = rows.iter().map(|&i| block.measured[i - block.range.start] / place.peak).collect();
            let peak = place.peak;
            blocks.push(BlockPoints { test: place.test.clone(), number, rows, points, peak, measured });
        }
        let used = blocks.iter().map(|b| b.rows.len()).sum();
        if used == 0 {
            return Err(EvidenceError::Empty);
        }
        let freedom = data.blocks.iter().map(|b| b.noise.freedom).fold(f64::INFINITY, f64::min);
        let ln_units = blocks.iter().map(|b| b.rows.len() as f64 * b.peak.ln()).sum();
        let mut record =
            Self { blocks, tests, full: data.points(), used, freedom, mesh: Vec::new(), ln_units };
        record.mesh = data.nuisance_columns().iter().filter_map(|e| record.capped(e, most_mesh)).collect();
        Ok(record)
    }

    fn capped(&self, column: &DVector<f64>, most: f64) -> Option<Vec<f64>> {
        let mut e = self.shares(column);
        let here = e.iter().filter(|x| **x != 0.0).count().max(1) as f64;
        let rms = (e.iter().map(|x| x * x).sum::<f64>() / here).sqrt();
        if rms > most {
            e.iter_mut().for_each(|x| *x *= most / rms);
        }
        (rms > 0.0 && rms.is_finite()).then_some(e)
    }

    /// The used points of a vector of full length, in shares of the peak, block after block.
    pub(crate) fn shares(&self, v: &DVector<f64>) -> Vec<f64> {
        self.blocks.iter().flat_map(|b| b.rows.iter().map(|&i| v[i] / b.peak)).collect()
    }

    /// Number of points that take part.
    pub const fn points(&self) -> usize {
        self.used
    }
}

fn positive(what: String, value: f64) -> Result<(), EvidenceError> {
    if value.is_finite() && value > 0.0 {
        return Ok(());
    }
    Err(EvidenceError::Value { what, value, expected: "a positive number" })
}
