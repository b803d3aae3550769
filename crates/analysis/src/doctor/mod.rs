//! What a record is good for: sampling, noise, protocol, faults of the usual kinds with their remedies, and which
//! parameters and effects it can show.

mod faults;
mod motion;

use crate::design::{Foresight, foresight_of_records};
use crate::problem::Cancelled;
use input::{Case, Geometry, Record, Test};
use model::{Catalogue, corner_rows, encoder_noise};
use motion::Motion;
use serde::Serialize;
use std::sync::Arc;

/// A doubt about a record, and what to do.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Advice {
    /// One word: `force_sign`, `swapped`, `units`, ….
    pub fault: &'static str,
    /// What was found.
    pub found: String,
    /// What to do about it.
    pub remedy: String,
}

/// What one record holds.
#[derive(Clone, Debug, Serialize)]
pub struct RecordFindings {
    /// Test.
    pub test: String,
    /// Rows.
    pub rows: usize,
    /// Points that a fit uses, where rows are averaged.
    pub points: usize,
    /// Usual time between rows, s.
    pub interval_s: f64,
    /// Duration, s.
    pub duration_s: f64,
    /// Largest force, N.
    #[serde(rename = "peak_N")]
    pub peak_n: f64,
    /// Sd of the force at a point that a fit uses (the mean of several rows in a long record), N; none where it cannot be
    /// estimated.
    #[serde(rename = "noise_N")]
    pub noise_n: Option<f64>,
    /// Correlation of the noise of neighbouring points.
    pub noise_correlation: Option<f64>,
    /// Why there is no estimate.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub noise_unknown: Option<String>,
    /// Smallest step between two forces, N.
    #[serde(rename = "resolution_N")]
    pub resolution_n: f64,
    /// Noise of the displacement, mm.
    pub jitter_mm: f64,
    /// What the actuator did.
    pub motion: Motion,
    /// Whether the force falls for good while the pull goes on.
    pub tears: bool,
    /// Doubts, the gravest first.
    pub advice: Vec<Advice>,
}

/// What all records of a case are good for.
#[derive(Clone, Debug, Serialize)]
pub struct Doctor {
    /// The records.
    pub records: Vec<RecordFindings>,
    /// What they can show; none where it was not asked or could not be computed.
    pub shows: Option<Foresight>,
    /// Why that could not be computed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub shows_not: Option<String>,
}

/// Examines the records of a case. `with_model`: also what they can show, from the model at its start values on a coarse
/// mesh.
pub fn doctor(case: &Arc<Case>, catalogue: &Catalogue, with_model: bool, cancelled: Cancelled) -> Doctor {
    let one = |t: &Test| t.record.as_ref().map(|r| examined(t, r, &case.geometry));
    let records: Vec<RecordFindings> = case.tests.iter().filter_map(one).collect();
    let (mut shows, mut shows_not) = (None, None);
    if with_model && !records.is_empty() {
        match foresight_of_records(case, catalogue, cancelled) {
            Ok(f) => shows = Some(f),
            Err(e) => shows_not = Some(e.to_string()),
        }
    }
    Doctor { records, shows, shows_not }
}

fn examined(test: &Test, record: &Record, geometry: &Geometry) -> RecordFindings {
    let corners = corner_rows(record);
    let (noise, points) = crate::condense::force_noise(record, &corners);
    let mut findings = RecordFindings {
        test: test.name.clone(),
        rows: record.len(),
        points,
        interval_s: faults::usual(record.time.windows(2).map(|w| w[1] - w[0])),
        duration_s: record.time[record.len() - 1] - record.time[0],
        peak_n: record.force.iter().fold(0.0f64, |m, f| m.max(f.abs())),
        noise_n: test.force_sd.or(noise.as_ref().ok().map(|n| n.sd)),
        noise_correlation: noise.as_ref().ok().map(|n| n.ar1),
        noise_unknown: noise.err().filter(|_| test.force_sd.is_none()).map(|e| e.to_string()),
        resolution_n: faults::resolution(&record.force),
        jitter_mm: encoder_noise(&record.time, &record.displacement),
        motion: Motion::of(&corners),
        tears: faults::tears(record),
        advice: Vec::new(),
    };
    findings.advice = faults::advice(test, record, geometry, &findings);
    findings
}
