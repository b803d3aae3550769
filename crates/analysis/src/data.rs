//! From records to data: blocks, their noise, the model's numerical error.

use crate::condense;
use diagnose::NoiseError;
use inverse::{Data, DataError, NoiseModel};
use model::{Channel, Model, corners_of_record};
use nalgebra::DVector;
use thiserror::Error;

/// Why a record cannot be used.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum RecordError {
    /// No noise level was given, and none can be estimated.
    #[error(
        "test {test}, {channel}: the noise cannot be estimated from the record ({source}); give `force_sd_N` (or the channel's sd) in the specimen file"
    )]
    Noise {
        /// Test.
        test: String,
        /// Channel.
        channel: &'static str,
        /// What the estimator says.
        source: NoiseError,
    },
    /// The numbers do not fit together.
    #[error(transparent)]
    Data(#[from] DataError),
    /// Nothing was measured.
    #[error("no test has a record: give `data = \"….csv\"` in a [[tests]] block")]
    Empty,
}

/// A block's place in the case.
#[derive(Clone, Debug, PartialEq)]
pub struct DataBlock {
    /// Index of the test.
    pub test: usize,
    /// Channel.
    pub channel: Channel,
    /// Rows of the record, one per point.
    pub rows: Vec<usize>,
}

/// Measured data of some tests, with each block's place.
#[derive(Clone, Debug)]
pub struct Measured {
    /// Blocks in order.
    pub data: Data,
    /// Their places, in the same order.
    pub slots: Vec<DataBlock>,
}

impl Measured {
    /// The data of the wanted tests.
    ///
    /// # Errors
    /// [`RecordError`] naming the test.
    pub fn of(model: &Model, wanted: &[bool]) -> Result<Self, RecordError> {
        Self::with(model, wanted, false)
    }

    /// The same with conservative noise: correlated as much as the record allows. A
    /// screen that trusts white noise too easily finds effects in what is only slow noise.
    ///
    /// # Errors
    /// As [`Measured::of`].
    pub fn conservative(model: &Model, wanted: &[bool]) -> Result<Self, RecordError> {
        Self::with(model, wanted, true)
    }

    /// The same with the noise as estimated instead of the conservative one; numerical error stays.
    ///
    /// # Errors
    /// As [`Measured::of`].
    pub fn as_estimated(&self, model: &Model) -> Result<Self, RecordError> {
        let estimated = Self::of(model, &model.recorded())?.data;
        let mut out = self.clone();
        for (block, from) in out.data.blocks.iter_mut().zip(&estimated.blocks) {
            (block.noise.sd, block.noise.ar1) = (from.noise.sd, from.noise.ar1);
        }
        Ok(out)
    }

    fn with(model: &Model, wanted: &[bool], conservative: bool) -> Result<Self, RecordError> {
        let mut parts = Vec::new();
        let mut slots = Vec::new();
        let mut left_out: Vec<bool> = Vec::new();
        for (t, test) in model.tests.iter().enumerate() {
            let Some(record) = test.test.record.as_ref().filter(|_| wanted[t]) else { continue };
            for channel in Channel::ALL {
                let measured = channel.of(record);
                if measured.is_empty() {
                    continue;
                }
                let rows: Vec<usize> = measured.iter().map(|m| m.0).collect();
                let values: Vec<f64> = measured.iter().map(|m| m.1).collect();
                let noise = noise_of(model, t, channel, &rows, &values, conservative)?;
                let weights: Vec<f64> = rows.iter().map(|&r| test.test.weight_at(record.time[r])).collect();
                let noise = weighted(noise, &weights);
                left_out.extend(weights.iter().map(|w| *w == 0.0));
                let name = match channel {
                    Channel::Force => test.test.name.clone(),
                    _ => format!("{}.{}", test.test.name, channel.word()),
                };
                parts.push((name, values, noise));
                slots.push(DataBlock { test: t, channel, rows });
            }
        }
        if parts.is_empty() {
            return Err(RecordError::Empty);
        }
        let mut data = Data::from_parts(parts)?;
        if left_out.contains(&true) {
            data.held_out = left_out;
        }
        Ok(Self { data, slots })
    }

    /// The same with white noise of at least a share of each block's largest value.
    pub fn with_noise_of_at_least(mut self, share: f64) -> Self {
        for block in &mut self.data.blocks {
            let largest = block.measured.iter().fold(0.0f64, |m, v| m.max(v.abs()));
            block.noise.sd = block.noise.sd.max(share * largest);
            block.noise.ar1 = 0.0;
        }
        self
    }

    /// The same with the model's numerical error: one column per block, with an unknown factor.
    ///
    /// `difference`: what the given mesh says more than one twice as coarse. What the given mesh
    /// itself still lacks is less than that if it converges; but a record has its own roughness, and
    /// naming an effect that is no more than a mesh error is worse than missing one.
    pub fn with_numerical_error(mut self, difference: &DVector<f64>) -> Self {
        for block in &mut self.data.blocks {
            let column = difference.rows(block.range.start, block.range.len()).into_owned();
            if column.norm() > 0.0 {
                block.noise.nuisance = vec![column];
            }
        }
        self
    }
}

/// Noise where points have weights: a point of weight w counts as if its noise were w^-½ times what it is.
fn weighted(noise: NoiseModel, weights: &[f64]) -> NoiseModel {
    if weights.iter().all(|w| *w == 1.0) {
        return noise;
    }
    let n = weights.len();
    let or = |list: &[f64], default: &dyn Fn(usize) -> f64| -> Vec<f64> {
        if list.is_empty() { (0..n).map(default).collect() } else { list.to_vec() }
    };
    // What is left out has no part in any sum, whatever stands here.
    let counted = |i: usize| if weights[i] > 0.0 { weights[i] } else { 1.0 };
    let spread = or(&noise.spread, &|_| 1.0).iter().enumerate().map(|(i, s)| s / counted(i).sqrt()).collect();
    let readings = or(&noise.readings, &|_| 1.0).iter().enumerate().map(|(i, m)| m * counted(i)).collect();
    let position = or(&noise.position, &|i| i as f64);
    NoiseModel { spread, readings, position, ..noise }
}

/// Noise of one channel: as the file says, else estimated from the record itself.
fn noise_of(
    model: &Model,
    t: usize,
    channel: Channel,
    rows: &[usize],
    values: &[f64],
    conservative: bool,
) -> Result<NoiseModel, RecordError> {
    let test = &model.tests[t].test;
    let given = match channel {
        Channel::Force => test.force_sd,
        Channel::GripDisplacement => test.grip_displacement_sd,
        Channel::TearFront => test.tear_front_sd,
        Channel::WidthChange => test.width_change_sd,
        Channel::ForceX => test.force_x_sd,
    };
    let Some(record) = &test.record else { return Err(RecordError::Empty) };
    let averages = averages_of(record, channel, rows);
    if let Some(sd) = given {
        return Ok(match averages {
            Some(a) => {
                let white = NoiseModel::white(sd * a.surer);
                NoiseModel { spread: a.spread, position: a.position, readings: a.readings, ..white }
            }
            None => NoiseModel::white(sd),
        });
    }
    let (spread, position, readings) =
        averages.map_or_else(Default::default, |a| (a.spread, a.position, a.readings));
    // What is left out of the fit says nothing about the noise either; the stretches beside it are no neighbours.
    let used: Vec<usize> = (0..rows.len()).filter(|&k| test.weight_at(record.time[rows[k]]) > 0.0).collect();
    let pick = |v: &[f64]| -> Vec<f64> { used.iter().filter_map(|&k| v.get(k).copied()).collect() };
    let time: Vec<f64> = used.iter().map(|&k| record.time[rows[k]]).collect();
    let corners = corners_of_record(record);
    let mut breaks: Vec<usize> =
        corners.iter().filter_map(|c| time.iter().position(|t| (t - c.time).abs() < 1e-9)).collect();
    breaks.extend((1..used.len()).filter(|&i| used[i] > used[i - 1] + 1));
    breaks.sort_unstable();
    breaks.dedup();
    let (near, at) = (pick(&spread), pick(&position));
    let weights = diagnose::noise::Averages { spread: &near, position: &at };
    let estimate = diagnose::noise::estimate_averages(&time, &pick(values), weights, &breaks)
        .map_err(|source| RecordError::Noise { test: test.name.clone(), channel: channel.word(), source })?;
    // A record without any noise (computed, or rounded) still has the rounding of its digits.
    let peak = values.iter().fold(0.0f64, |m, v| m.max(v.abs()));
    let (sd, ar1) = if conservative {
        (estimate.conservative_sd, estimate.conservative_ar1)
    } else {
        (estimate.sd, estimate.ar1)
    };
    let freedom = estimate.freedom();
    Ok(NoiseModel {
        freedom,
        spread,
        position,
        readings,
        ..NoiseModel::ar1(sd.max(1e-6 * peak).max(1e-12), ar1)
    })
}

/// Weights of points that are averages.
struct Averaged {
    spread: Vec<f64>,
    position: Vec<f64>,
    readings: Vec<f64>,
    /// Sd of a point of the usual number of readings, in units of a single reading's.
    surer: f64,
}

fn averages_of(record: &input::Record, channel: Channel, rows: &[usize]) -> Option<Averaged> {
    let at = Channel::ALL.iter().position(|c| *c == channel)?;
    let averages = &record.averaged.as_ref()?.channels[at];
    let readings = rows.iter().map(|&r| averages.readings.get(r).copied()).collect::<Option<Vec<usize>>>()?;
    Some(Averaged {
        spread: condense::spread(&readings),
        position: condense::position(&readings),
        readings: condense::weights(&readings),
        surer: condense::typical(&readings).powf(-averages.decay),
    })
}
