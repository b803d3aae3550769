//! Curves of model and measurement, and their CSV files.

use crate::ReportError;
use crate::answer::TestCurve;
use analysis::{Identified, Residuals, SimulatedTest};
use diagnose::segments::cut;
use diagnose::{RecordKind, Segment, SegmentKind};
use input::{Record, Test};
use model::Channel;

/// Columns of a curve's file that are no camera channel.
const OWN: [&str; 6] =
    ["time_s", "displacement_mm", "force_measured_N", "force_model_N", "residual_N", "segment"];

/// Measured and computed force of one test, one entry per record row.
#[derive(Clone, Debug, Default)]
pub struct Curve {
    /// Name of the test.
    pub test: String,
    /// Time, s.
    pub time: Vec<f64>,
    /// Actuator displacement, mm.
    pub displacement: Vec<f64>,
    /// Measured force, N; empty for a simulation.
    pub measured: Vec<f64>,
    /// Computed force, N.
    pub model: Vec<f64>,
    /// Segment of each row; empty for a simulation.
    pub segment: Vec<String>,
    /// Noise sd of the force, N.
    pub noise: f64,
    /// Length of the cut, mm; 0 where it is not known.
    pub cut: f64,
    /// Further columns: name, numbers (none where not measured).
    pub columns: Vec<(String, Vec<Option<f64>>)>,
}

/// Segment of rows that the file leaves out of the fit.
pub const LEFT_OUT: &str = "left out";
/// The model's tear front, a column.
const TEAR_FRONT: &str = "tear_front_model_mm";

/// The curves of an identification, one per test with a record. `replayed`: its last run, which knows where the
/// tear stood at every point, camera or none.
pub fn identified_curves(done: &Identified, replayed: &[SimulatedTest]) -> Vec<Curve> {
    let mut out = measured_curves(done);
    for curve in &mut out {
        let Some(t) = replayed.iter().find(|t| t.name == curve.test) else { continue };
        if t.tear_front.len() < 2 {
            continue;
        }
        let column = curve.time.iter().map(|&at| Some(between(&t.time, &t.tear_front, at))).collect();
        curve.columns.retain(|c| c.0 != TEAR_FRONT);
        curve.columns.push((TEAR_FRONT.to_owned(), column));
    }
    out
}

/// Value at `at` of a series over growing times, on the line between its neighbours.
fn between(times: &[f64], values: &[f64], at: f64) -> f64 {
    let i = times.partition_point(|t| *t < at).clamp(1, times.len().min(values.len()) - 1);
    let span = times[i] - times[i - 1];
    let share = if span > 0.0 { ((at - times[i - 1]) / span).clamp(0.0, 1.0) } else { 1.0 };
    values[i - 1] + share * (values[i] - values[i - 1])
}

fn measured_curves(done: &Identified) -> Vec<Curve> {
    let mut out: Vec<Curve> = Vec::new();
    for (block, slot) in done.measured.data.blocks.iter().zip(&done.measured.slots) {
        let test = &done.model.tests[slot.test].test;
        let Some(record) = &test.record else { continue };
        let model = &done.fit.prediction.values.as_slice()[block.range.clone()];
        if slot.channel == Channel::Force {
            out.push(Curve {
                test: test.name.clone(),
                time: record.time.clone(),
                displacement: record.displacement.clone(),
                measured: record.force.clone(),
                model: model.to_vec(),
                segment: segments(record, test),
                noise: block.noise.sd,
                cut: done.model.case.geometry.cut,
                columns: Vec::new(),
            });
        } else if let Some(curve) = out.iter_mut().find(|c| c.test == test.name) {
            let spread = |values: &[f64]| {
                let mut column = vec![None; record.len()];
                for (&row, &v) in slot.rows.iter().zip(values) {
                    column[row] = Some(v);
                }
                column
            };
            let (word, unit) = (slot.channel.word(), slot.channel.unit());
            curve.columns.push((format!("{word}_measured_{unit}"), spread(&block.measured)));
            curve.columns.push((format!("{word}_model_{unit}"), spread(model)));
        }
    }
    out
}

/// The curve of a simulated test.
pub fn simulated_curve(name: &str, t: &TestCurve) -> Curve {
    let column = |name: &str, values: &[f64]| (name.to_owned(), values.iter().map(|v| Some(*v)).collect());
    let mut columns = vec![
        column("grip_displacement_mm", &t.grip_displacement_mm),
        column("width_change_mm", &t.width_change_mm),
    ];
    if !t.force_x_N.is_empty() {
        columns.push(column("displacement_x_mm", &t.displacement_x_mm));
        columns.push(column("force_x_N", &t.force_x_N));
    }
    if !t.tear_front_mm.is_empty() {
        columns.push(column("tear_front_mm", &t.tear_front_mm));
    }
    Curve {
        test: name.to_owned(),
        time: t.time_s.clone(),
        displacement: t.displacement_mm.clone(),
        model: t.force_N.clone(),
        columns,
        ..Curve::default()
    }
}

/// The user's names of segments, or our own.
fn segments(record: &Record, test: &Test) -> Vec<String> {
    let kind = if test.kind.tears { RecordKind::Tearing } else { RecordKind::Intact };
    let mut out = record.segment.clone().unwrap_or_else(|| {
        let mut out = vec![String::new(); record.len()];
        for s in cut(&record.time, &record.displacement, &record.force, kind) {
            for name in &mut out[s.range] {
                name.clone_from(&s.name);
            }
        }
        out
    });
    for (name, _) in out.iter_mut().zip(&record.time).filter(|(_, t)| test.weight_at(**t) == 0.0) {
        LEFT_OUT.clone_into(name);
    }
    out
}

impl Curve {
    /// A curve as [`Curve::csv`] wrote it; `None` for anything else.
    pub(crate) fn parse(test: &str, content: &[u8]) -> Option<Self> {
        let mut reader = csv::Reader::from_reader(content);
        let header: Vec<String> = reader.headers().ok()?.iter().map(str::to_owned).collect();
        let rows: Vec<csv::StringRecord> = reader.records().collect::<Result<_, _>>().ok()?;
        let text = |name: &str| -> Vec<String> {
            let Some(at) = header.iter().position(|h| h == name) else { return Vec::new() };
            rows.iter().map(|r| r.get(at).unwrap_or_default().to_owned()).collect()
        };
        let numbers = |name: &str| -> Vec<f64> { text(name).iter().filter_map(|t| t.parse().ok()).collect() };
        let further = header.iter().filter(|h| !OWN.contains(&h.as_str()));
        let columns = further.map(|h| (h.clone(), text(h).iter().map(|t| t.parse().ok()).collect()));
        Some(Self {
            test: test.to_owned(),
            time: numbers("time_s"),
            displacement: numbers("displacement_mm"),
            measured: numbers("force_measured_N"),
            model: numbers("force_model_N"),
            segment: text("segment"),
            columns: columns.collect(),
            ..Self::default()
        })
    }

    /// Measured minus computed force, N.
    pub fn residual(&self) -> Vec<f64> {
        self.measured.iter().zip(&self.model).map(|(m, c)| m - c).collect()
    }

    /// Whether a row takes no part in the fit.
    pub fn is_left_out(&self, row: usize) -> bool {
        self.segment.get(row).is_some_and(|s| s == LEFT_OUT)
    }

    /// Stretches of equal segment names; the kind is of no use here.
    pub(crate) fn segments(&self) -> Vec<Segment> {
        let mut out: Vec<Segment> = Vec::new();
        for (i, name) in self.segment.iter().enumerate() {
            match out.last_mut().filter(|s| s.name == *name) {
                Some(s) => s.range.end = i + 1,
                None => out.push(Segment { name: name.clone(), range: i..i + 1, kind: SegmentKind::Load }),
            }
        }
        out
    }

    /// What the model leaves of the record.
    pub(crate) fn residuals(&self) -> Residuals {
        let front = self.columns.iter().find(|c| c.0 == TEAR_FRONT);
        // The cut's own faces open from its mouth on, before anything tears.
        let beyond = |x: &Option<f64>| x.map(|x| x.max(self.cut));
        Residuals {
            test: self.test.clone(),
            time: self.time.clone(),
            displacement: self.displacement.clone(),
            force: self.measured.clone(),
            // What the user left out is no fault of the model.
            misfit: self
                .residual()
                .iter()
                .enumerate()
                .map(|(i, r)| if self.is_left_out(i) { 0.0 } else { *r })
                .collect(),
            noise: self.noise,
            segments: self.segments(),
            tear_front: front.and_then(|c| c.1.iter().map(beyond).collect()).unwrap_or_default(),
        }
    }

    /// The CSV file `curves/<test>.csv`.
    ///
    /// # Errors
    /// If a row cannot be written, which only a full memory could cause.
    pub fn csv(&self) -> Result<Vec<u8>, ReportError> {
        let measured = !self.measured.is_empty();
        let mut header = vec!["time_s".to_owned(), "displacement_mm".into()];
        if measured {
            header.push("force_measured_N".into());
        }
        header.push("force_model_N".into());
        if measured {
            header.extend(["residual_N".into(), "segment".into()]);
        }
        header.extend(self.columns.iter().map(|c| c.0.clone()));
        let residual = self.residual();
        let rows = (0..self.time.len()).map(|i| {
            let mut row = vec![number(self.time[i]), number(self.displacement[i])];
            if measured {
                row.push(number(self.measured[i]));
            }
            row.push(number(self.model[i]));
            if measured {
                row.extend([number(residual[i]), self.segment.get(i).cloned().unwrap_or_default()]);
            }
            row.extend(
                self.columns.iter().map(|c| c.1.get(i).copied().flatten().map_or(String::new(), number)),
            );
            row
        });
        table(header, rows)
    }
}

/// The shortest digits that read back to the same number.
pub(crate) fn number(x: f64) -> String {
    format!("{x}")
}

/// A CSV file.
pub(crate) fn table(
    header: Vec<String>,
    rows: impl Iterator<Item = Vec<String>>,
) -> Result<Vec<u8>, ReportError> {
    let fault =
        |e: &dyn std::fmt::Display| ReportError::NotARun { path: "csv".into(), reason: e.to_string() };
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(&header).map_err(|e| fault(&e))?;
    for row in rows {
        writer.write_record(&row).map_err(|e| fault(&e))?;
    }
    writer.into_inner().map_err(|e| fault(&e))
}
