//! A channel at the rows of a record: steps interpolated, sensors and camera read, all of it with
//! derivatives.

use super::{Channel, TestRun};
use crate::build::{Model, TestModel};
use crate::camera;
use crate::effect::Sample;
use crate::plan::{Place, RunIndex};
use fem::{FemError, Run};
use input::Record;

/// The second of the measured forces of a test with two axes.
const ACROSS: usize = 1;

/// Predicted channel values at the rows of a record.
#[derive(Clone, Debug, Default)]
pub struct Series {
    /// Values.
    pub values: Vec<f64>,
    /// Derivatives: `derivatives[row * columns + c]`.
    pub derivatives: Vec<f64>,
    /// False where the value is not differentiable (next to a jump).
    pub smooth: Vec<bool>,
}

impl Model {
    /// A channel at the rows of the test's record.
    ///
    /// # Errors
    /// Why the run stopped before it reached a row.
    pub fn series(&self, run: &TestRun, theta: &[f64], channel: Channel) -> Result<Series, FemError> {
        let test = &self.tests[run.test];
        let Some(record) = &test.test.record else { return Ok(Series::default()) };
        let rows = channel.of(record);
        let index = RunIndex::new(&run.plan, &run.run);
        let k = run.columns.len();
        let mut out = Series {
            values: Vec::with_capacity(rows.len()),
            derivatives: Vec::with_capacity(rows.len() * k),
            smooth: Vec::with_capacity(rows.len()),
        };
        let start = record.time.first().copied().unwrap_or(0.0);
        for (row, _) in rows {
            let place = run.plan.place(record.time[row], record.displacement[row]);
            let (value, by, smooth) = match channel {
                Channel::Force => self.force_row(run, &index, theta, record, row, place, start)?,
                _ => self.camera_row(run, &index, theta, channel, place)?,
            };
            out.values.push(value);
            out.derivatives.extend(by);
            out.smooth.push(smooth);
        }
        Ok(out)
    }

    #[allow(clippy::too_many_arguments)]
    fn force_row(
        &self,
        run: &TestRun,
        index: &RunIndex,
        theta: &[f64],
        record: &Record,
        row: usize,
        place: Place,
        start: f64,
    ) -> Result<(f64, Vec<f64>, bool), FemError> {
        let test = &self.tests[run.test];
        let k = run.columns.len();
        let pick = |ids: &[usize]| ids.iter().map(|&i| theta[i]).collect::<Vec<f64>>();
        let mut late = 0.0;
        let mut late_by = vec![0.0; k];
        for (sensor, ids) in &test.sensors {
            let (delay, by) = sensor.delay(&pick(ids));
            late += delay;
            for (id, d) in ids.iter().zip(by) {
                if let Some(c) = run.columns.iter().position(|x| x == id) {
                    late_by[c] += d;
                }
            }
        }
        let delayed = |shift: f64| {
            let time = (place.time - shift).max(start);
            if shift == 0.0 { place } else { run.plan.place(time, displacement_at(record, time)) }
        };
        let at = |p: Place| -> Result<(f64, Vec<f64>, bool), FemError> {
            let s = run.plan.stencil(index, &run.run, &p).ok_or_else(|| missing(&run.run))?;
            let mut value = 0.0;
            let mut by = vec![0.0; k];
            for &(step, w) in &s.terms {
                let record = &run.run.steps[step];
                value += w * record.along();
                for (b, d) in by.iter_mut().zip(record.derivatives.along()) {
                    *b += w * d;
                }
            }
            Ok((value, by, s.smooth))
        };
        let (mut value, mut by, smooth) = at(delayed(late))?;
        if late_by.iter().any(|d| *d != 0.0) {
            let h = 1e-4 * (record.time[record.time.len() - 1] - start) / record.time.len() as f64;
            // From the past: a cell can only be late.
            let slope = (value - at(delayed(late + h))?.0) / h;
            for (b, d) in by.iter_mut().zip(&late_by) {
                *b -= slope * d;
            }
        }
        let sample = sample(record, row, test);
        for (sensor, ids) in &test.sensors {
            let reading = sensor.reading(&sample, value, &pick(ids));
            value = reading.value;
            for b in &mut by {
                *b *= reading.slope;
            }
            for (id, d) in ids.iter().zip(reading.by_param) {
                if let Some(c) = run.columns.iter().position(|x| x == id) {
                    by[c] += d;
                }
            }
        }
        Ok((value, by, smooth))
    }

    fn camera_row(
        &self,
        run: &TestRun,
        index: &RunIndex,
        theta: &[f64],
        channel: Channel,
        place: Place,
    ) -> Result<(f64, Vec<f64>, bool), FemError> {
        let k = run.columns.len();
        let s = run.plan.stencil(index, &run.run, &place).ok_or_else(|| missing(&run.run))?;
        // The camera counts from the start of the test.
        let first = run.run.steps.first();
        let mut value = 0.0;
        let mut by = vec![0.0; k];
        for &(step, w) in &s.terms {
            let r = &run.run.steps[step];
            let (v, d): (f64, Vec<f64>) = match channel {
                Channel::GripDisplacement => {
                    let zero = first.map_or(0.0, |f| f.grip);
                    let by_zero = first.map(|f| &f.derivatives.grip);
                    let d = (0..k)
                        .map(|c| {
                            r.derivatives.grip.get(c).unwrap_or(&0.0)
                                - by_zero.and_then(|z| z.get(c)).unwrap_or(&0.0)
                        })
                        .collect();
                    (r.grip - zero, d)
                }
                Channel::TearFront => self.front(run, theta, r),
                Channel::ForceX => {
                    let d = r.derivatives.reactions.get(ACROSS).cloned().unwrap_or_else(|| vec![0.0; k]);
                    (r.reactions.get(ACROSS).copied().unwrap_or_default(), d)
                }
                _ => {
                    let at = camera::output::WIDTH_CHANGE;
                    let zero = first.map_or(0.0, |f| f.extra[at]);
                    (r.extra[at] - zero, r.derivatives.extra.get(at).cloned().unwrap_or_else(|| vec![0.0; k]))
                }
            };
            value += w * v;
            for (b, d) in by.iter_mut().zip(&d) {
                *b += w * d;
            }
        }
        Ok((value, by, s.smooth))
    }

    /// Tear front with the part of its derivative that comes from the threshold δc.
    fn front(&self, run: &TestRun, theta: &[f64], r: &fem::StepRecord) -> (f64, Vec<f64>) {
        use camera::output::{FRONT_AREA, FRONT_BY_THRESHOLD, TEAR_FRONT};
        let mut by =
            r.derivatives.extra.get(TEAR_FRONT).cloned().unwrap_or_else(|| vec![0.0; run.columns.len()]);
        if self.tests[run.test].test.tear_front_opening.is_none() {
            let area = r.extra[FRONT_AREA] as usize;
            let (_, slopes) = self.threshold(area, theta);
            for (what, slope) in ["gc", "sigma_c"].iter().zip(slopes) {
                let path = format!("interface.area[{}].{what}", area + 1);
                let column = self.find(&path).and_then(|i| run.columns.iter().position(|&c| c == i));
                if let Some(c) = column {
                    by[c] += r.extra[FRONT_BY_THRESHOLD] * slope;
                }
            }
        }
        (r.extra[TEAR_FRONT], by)
    }
}

impl Model {
    /// How late the force of a test is recorded, s: all sensors together.
    pub fn sensor_delay(&self, test: usize, theta: &[f64]) -> f64 {
        self.tests[test].sensors.iter().map(|(sensor, ids)| sensor.delay(&pick(theta, ids)).0).sum()
    }

    /// What is recorded for a true force: through all sensors in order.
    pub fn sensor_reading(&self, test: usize, theta: &[f64], at: &Sample, force: f64) -> f64 {
        let sensors = &self.tests[test].sensors;
        sensors.iter().fold(force, |force, (sensor, ids)| sensor.reading(at, force, &pick(theta, ids)).value)
    }
}

fn pick(theta: &[f64], ids: &[usize]) -> Vec<f64> {
    ids.iter().map(|&i| theta[i]).collect()
}

fn missing(run: &Run) -> FemError {
    run.failure
        .clone()
        .unwrap_or_else(|| FemError::Setup("the run does not reach every point of the record".into()))
}

/// The measured displacement at a time between two rows. (The plan's pieces are straight; what was measured need not be.)
fn displacement_at(record: &Record, time: f64) -> f64 {
    let (t, u) = (&record.time, &record.displacement);
    let after = t.partition_point(|x| *x <= time).clamp(1, t.len() - 1);
    let (a, b) = (after - 1, after);
    u[a] + ((time - t[a]) / (t[b] - t[a])).clamp(0.0, 1.0) * (u[b] - u[a])
}

/// Motion of the actuator at a row, by differences.
fn sample(record: &Record, row: usize, test: &TestModel) -> Sample {
    let (t, u) = (&record.time, &record.displacement);
    let n = t.len();
    let speed = |i: usize, j: usize| if j > i { (u[j] - u[i]) / (t[j] - t[i]) } else { 0.0 };
    let (a, b) = (row.saturating_sub(1), (row + 1).min(n - 1));
    let (before, after) = (speed(a, row), speed(row, b));
    let mut acceleration = if a < row && b > row { (after - before) / (0.5 * (t[b] - t[a])) } else { 0.0 };
    if acceleration.abs() * (t[b] - t[a]) < 1e-3 * (before.abs() + after.abs()) {
        acceleration = 0.0;
    }
    Sample {
        time: t[row] - t[0],
        displacement: u[row],
        speed: speed(a, b),
        acceleration,
        kind: test.test.kind,
        test: test.index,
    }
}
