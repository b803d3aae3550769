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
    /// How many of them are parameters.
    pub parameters: usize,
    /// What the model predicts where it is linearised, block by block. It has no noise: a rest that is a share of what was measured
    /// would explain the noise by itself.
    pub predicted: Vec<Vec<f64>>,
    /// What is not known of it where it jumps, block by block; empty where it does not.
    pub jumps: Vec<Vec<f64>>,
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
        let predicted = record.blocks.iter().map(|block| {
            let (here, rest) = left.split_at(block.rows.len());
            left = rest;
            block.measured.iter().zip(here).map(|(y, r)| y - r).collect()
        });
        let predicted = predicted.collect();
        let jumps = |b: &BlockPoints| {
            let here = b.rows.iter().map_while(|&i| Some(linear.jumps.get(i)? / b.peak));
            here.collect()
        };
        let jumps = record.blocks.iter().map(jumps).collect();
        Self { x, parameters, predicted, jumps }
    }

    /// Noise and rest of every block, for one size of the rest that is in `only` one test or in all.
    pub fn processes<'r>(&self, record: &'r Record, size: RestSize, only: Option<usize>) -> Vec<Process<'r>> {
        let blocks = record.blocks.iter().zip(&self.predicted).zip(&self.jumps);
        blocks
            .map(|((b, y), jumps)| Process::beside(&b.points, size.in_test(b.number, only), y, jumps))
            .collect()
    }
}
