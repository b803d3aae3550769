//! A linearised model on the points of a record, in shares of the peak.

use crate::linear::Linear;
use crate::process::Process;
use crate::record::{BlockPoints, Record};
use crate::rest::RestSize;
use nalgebra::DMatrix;

/// Columns and prediction of a linearised model on the points that take part.
pub(crate) struct Shares {
    /// Columns [H | mesh | r].
    pub x: DMatrix<f64>,
    /// The same with a column for each point.
    across: DMatrix<f64>,
    /// How many of them are parameters.
    pub parameters: usize,
    /// What the model predicts where it is linearised, block by block, over its root mean square there: a rest that goes with it is
    /// as large as one that does not. It has no noise: one that went with what was measured would explain the noise by itself.
    pub profile: Vec<Vec<f64>>,
    /// What is not known of it where it jumps, block by block; empty where it does not.
    pub jumps: Vec<Vec<f64>>,
}

/// Over its root mean square; as it is where that is nothing.
fn of_size_one(mut values: Vec<f64>) -> Vec<f64> {
    let mean = values.iter().map(|v| v * v).sum::<f64>() / values.len().max(1) as f64;
    if mean.is_normal() {
        values.iter_mut().for_each(|v| *v /= mean.sqrt());
    }
    values
}

impl Shares {
    /// Of a model that fits the record ([`Linear::check`]).
    pub fn of(record: &Record, linear: &Linear) -> Self {
        let parameters = linear.parameters.len();
        let mut x = DMatrix::zeros(record.used, parameters + record.mesh.len() + 1);
        for k in 0..parameters {
            let share = record.shares(&linear.jacobian.column(k).into_owned());
            x.column_mut(k).copy_from_slice(&share);
        }
        for (k, e) in record.mesh.iter().enumerate() {
            x.column_mut(parameters + k).copy_from_slice(e);
        }
        let misfit = record.shares(&linear.misfit);
        let last = x.ncols() - 1;
        x.column_mut(last).copy_from_slice(&misfit);
        let mut left = misfit.as_slice();
        let profile = record.blocks.iter().map(|block| {
            let (here, rest) = left.split_at(block.rows.len());
            left = rest;
            of_size_one(block.measured.iter().zip(here).map(|(y, r)| y - r).collect())
        });
        let profile = profile.collect();
        let jumps = |b: &BlockPoints| {
            let here = b.rows.iter().map_while(|&i| Some(linear.jumps.get(i)? / b.peak));
            here.collect()
        };
        let jumps = record.blocks.iter().map(jumps).collect();
        Self { across: x.transpose(), x, parameters, profile, jumps }
    }

    /// XᵀC⁻¹X, X all columns: what a covariance leaves of them.
    pub fn square(&self, processes: &[Process<'_>]) -> DMatrix<f64> {
        let mut white = self.across.clone();
        let columns = white.nrows();
        let mut left = white.as_mut_slice();
        for process in processes {
            let (here, rest) = left.split_at_mut(process.points() * columns);
            process.whiten_all(here, columns);
            left = rest;
        }
        &white * white.transpose()
    }

    /// Noise and rest of every block, for one size of the rest that is in `only` one test or in all.
    pub fn processes<'r>(&self, record: &'r Record, size: RestSize, only: Option<usize>) -> Vec<Process<'r>> {
        let blocks = record.blocks.iter().zip(&self.profile).zip(&self.jumps);
        blocks
            .map(|((b, y), jumps)| Process::beside(&b.points, size.in_test(b.number, only), y, jumps))
            .collect()
    }
}
