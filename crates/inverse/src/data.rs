//! What is fitted to: measured numbers in blocks, each with its own noise.

use nalgebra::DVector;
use std::ops::Range;
use thiserror::Error;

/// Noise of one block: covariance D R(ar1) D + Σ e eᵀ, R the correlation of a stationary AR(1) process, D the sd of each
/// point: `sd`, times its share of it where points are averages of unequal numbers of readings.
#[derive(Clone, Debug, PartialEq)]
pub struct NoiseModel {
    /// Standard deviation of one point, unit of the block.
    pub sd: f64,
    /// Correlation of neighbouring points, −1 < ar1 < 1; 0 is white noise.
    pub ar1: f64,
    /// Sd of each point in units of `sd`; empty where all are 1.
    pub spread: Vec<f64>,
    /// Where each point stands, in units of neighbours' distance, growing: the correlation of two is ar1 to the power of
    /// their distance. Empty: 0, 1, 2, ….
    pub position: Vec<f64>,
    /// Readings behind each point, in units of the usual number: its weight in a plain sum of squares, which is that over
    /// all readings then. Empty where all are 1.
    pub readings: Vec<f64>,
    /// The model's own numerical error: columns e, each with an unknown factor of prior N(0, 1).
    pub nuisance: Vec<DVector<f64>>,
    /// Degrees of freedom that the level was estimated with; infinite where it is given.
    pub freedom: f64,
}

impl NoiseModel {
    /// White noise without numerical error.
    pub fn white(sd: f64) -> Self {
        Self::ar1(sd, 0.0)
    }

    /// Autocorrelated noise without numerical error.
    pub fn ar1(sd: f64, ar1: f64) -> Self {
        Self {
            sd,
            ar1,
            spread: Vec::new(),
            position: Vec::new(),
            readings: Vec::new(),
            nuisance: Vec::new(),
            freedom: f64::INFINITY,
        }
    }

    /// Sd of point `i` of the block.
    pub fn sd_of(&self, i: usize) -> f64 {
        self.spread.get(i).map_or(self.sd, |s| s * self.sd)
    }

    /// Square root of the weight of point `i` of the block in a plain sum of squares.
    pub fn root_weight(&self, i: usize) -> f64 {
        self.readings.get(i).map_or(1.0, |n| n.sqrt())
    }

    /// Correlation of the points `i` < `j` of the block.
    pub fn correlation(&self, i: usize, j: usize) -> f64 {
        match (self.position.get(i), self.position.get(j)) {
            (Some(a), Some(b)) => correlation_at(self.ar1, b - a),
            _ => self.ar1.powi(i32::try_from(j - i).unwrap_or(i32::MAX)),
        }
    }

    /// The same with one more column of numerical error.
    pub fn with_nuisance(mut self, column: DVector<f64>) -> Self {
        self.nuisance.push(column);
        self
    }
}

/// One channel of one test: a stretch of the prediction vector, what was measured there, its noise.
#[derive(Clone, Debug, PartialEq)]
pub struct Block {
    /// Name in answers: `tearing`, `tearing.grip_displacement`.
    pub name: String,
    /// Where the block stands in the prediction vector.
    pub range: Range<usize>,
    /// Measured numbers, one per point of `range`.
    pub measured: Vec<f64>,
    /// Noise of these numbers.
    pub noise: NoiseModel,
}

/// All measured numbers of a fit. The blocks tile the prediction vector in order, without gaps.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Data {
    /// The blocks in the order of the prediction vector.
    pub blocks: Vec<Block>,
    /// Numerical-error columns that span several blocks, each of the full length, prior N(0, 1).
    pub nuisance: Vec<DVector<f64>>,
    /// Points that are kept back (`true`): they take no part in the fit. Empty: none.
    pub held_out: Vec<bool>,
}

/// A fault in the description of the data.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum DataError {
    /// A block's numbers do not fill its range, or the blocks do not tile the prediction vector.
    #[error("block {block}: {fault}")]
    Shape {
        /// Name of the block.
        block: String,
        /// What does not fit.
        fault: String,
    },
    /// A number that cannot be used: not finite, a noise that is not positive, |ar1| ≥ 1.
    #[error("block {block}: {fault}")]
    Value {
        /// Name of the block.
        block: String,
        /// What was found and expected.
        fault: String,
    },
    /// A global column or mask of the wrong length.
    #[error("{what} has length {found}, expected {expected}")]
    Length {
        /// Which one.
        what: String,
        /// Its length.
        found: usize,
        /// Number of points.
        expected: usize,
    },
}

impl Data {
    /// Blocks placed one after the other.
    ///
    /// # Errors
    /// See [`Data::check`].
    pub fn from_parts(
        parts: impl IntoIterator<Item = (String, Vec<f64>, NoiseModel)>,
    ) -> Result<Self, DataError> {
        let mut blocks = Vec::new();
        let mut at = 0;
        for (name, measured, noise) in parts {
            let range = at..at + measured.len();
            at = range.end;
            blocks.push(Block { name, range, measured, noise });
        }
        let data = Self { blocks, ..Self::default() };
        data.check()?;
        Ok(data)
    }

    /// Number of points, held out or not.
    pub fn points(&self) -> usize {
        self.blocks.last().map_or(0, |b| b.range.end)
    }

    /// Number of points that take part in the fit.
    pub fn used_points(&self) -> usize {
        self.points() - self.held_out.iter().filter(|&&h| h).count()
    }

    /// Whether point `i` takes part in the fit.
    pub fn is_used(&self, i: usize) -> bool {
        !self.held_out.get(i).copied().unwrap_or(false)
    }

    /// All measured numbers, in the order of the prediction vector.
    pub fn measured(&self) -> DVector<f64> {
        DVector::from_iterator(self.points(), self.blocks.iter().flat_map(|b| b.measured.iter().copied()))
    }

    /// The misfit r = measurement − model, all points.
    pub fn misfit(&self, values: &DVector<f64>) -> DVector<f64> {
        self.measured() - values
    }

    /// Every numerical-error column at full length: the global ones and those of single blocks.
    pub fn nuisance_columns(&self) -> Vec<DVector<f64>> {
        let mut all = self.nuisance.clone();
        for block in &self.blocks {
            for e in &block.noise.nuisance {
                let mut column = DVector::zeros(self.points());
                column.rows_mut(block.range.start, block.range.len()).copy_from(e);
                all.push(column);
            }
        }
        all
    }

    /// Checks shapes and numbers.
    ///
    /// # Errors
    /// The first fault found, naming the block.
    pub fn check(&self) -> Result<(), DataError> {
        let mut at = 0;
        for block in &self.blocks {
            check_block(block, at)?;
            at = block.range.end;
        }
        for e in &self.nuisance {
            if e.len() != at {
                return Err(DataError::Length {
                    what: "a nuisance column".into(),
                    found: e.len(),
                    expected: at,
                });
            }
            if e.iter().any(|v| !v.is_finite()) {
                return Err(DataError::Value {
                    block: "(all)".into(),
                    fault: "a nuisance column holds a number that is not finite".into(),
                });
            }
        }
        if !self.held_out.is_empty() && self.held_out.len() != at {
            return Err(DataError::Length {
                what: "the held-out mask".into(),
                found: self.held_out.len(),
                expected: at,
            });
        }
        Ok(())
    }
}

/// AR(1) correlation across a distance. A negative one changes its sign from neighbour to neighbour; between them it has
/// no meaning but that it fades.
pub fn correlation_at(ar1: f64, distance: f64) -> f64 {
    if ar1 >= 0.0 { ar1.powf(distance) } else { ar1.powi(distance.round().clamp(1.0, 1e6) as i32) }
}

fn check_block(block: &Block, at: usize) -> Result<(), DataError> {
    let shape = |fault: String| Err(DataError::Shape { block: block.name.clone(), fault });
    let value = |fault: String| Err(DataError::Value { block: block.name.clone(), fault });
    if block.range.start != at {
        return shape(format!("starts at point {}, expected {at}", block.range.start));
    }
    if block.range.len() != block.measured.len() {
        return shape(format!("{} numbers for {} points", block.measured.len(), block.range.len()));
    }
    let noise = &block.noise;
    if !(noise.sd.is_finite() && noise.sd > 0.0) {
        return value(format!("noise sd is {}, expected a positive number", noise.sd));
    }
    if noise.ar1.is_nan() || noise.ar1.abs() >= 1.0 {
        return value(format!("ar1 is {}, expected a number between -1 and 1", noise.ar1));
    }
    if let Some(i) = block.measured.iter().position(|v| !v.is_finite()) {
        return value(format!("measured value {i} is not finite"));
    }
    let lists = [("spread", &noise.spread), ("position", &noise.position), ("readings", &noise.readings)];
    for (what, list) in lists {
        if !list.is_empty() && list.len() != block.range.len() {
            return shape(format!("a {what} of {} for {} points", list.len(), block.range.len()));
        }
    }
    if noise.spread.iter().chain(&noise.readings).any(|s| !(s.is_finite() && *s > 0.0)) {
        return value("a spread or a number of readings is not positive".into());
    }
    if noise.position.windows(2).any(|p| p[1].is_nan() || p[1] <= p[0]) {
        return value("positions do not grow".into());
    }
    for e in &noise.nuisance {
        if e.len() != block.range.len() {
            return shape(format!("a nuisance column of {} for {} points", e.len(), block.range.len()));
        }
        if e.iter().any(|v| !v.is_finite()) {
            return value("a nuisance column holds a number that is not finite".into());
        }
    }
    Ok(())
}
