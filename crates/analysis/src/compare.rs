//! How far off a fitted model is, and where.

use crate::identify::AnalysisError;
use crate::ladder::FeLadder;
use crate::problem::Cancelled;
use diagnose::atlas::SegmentMisfit;
use diagnose::{Policy, RecordKind, Segment};
use input::{Case, Record, Test, TestKind};
use model::{Catalogue, Channel};
use serde::Serialize;
use std::sync::Arc;

/// The segments of a test's record.
pub fn segments(test: &Test, record: &Record) -> Vec<Segment> {
    let kind = match test.kind {
        TestKind::Uniaxial => RecordKind::Intact,
        TestKind::Tearing => RecordKind::Tearing,
    };
    diagnose::segments::cut(&record.time, &record.displacement, &record.force, kind)
}

/// A segment's share of the whole misfit.
#[derive(Clone, Debug, Serialize)]
pub struct Where {
    /// Test.
    pub test: String,
    /// Segment.
    pub segment: String,
    /// Share of χ² over all tests.
    pub share: f64,
    /// Mean misfit, N: positive where the measurement lies above the model.
    #[serde(rename = "mean_N")]
    pub mean_n: f64,
    /// Correlation of neighbouring points.
    pub autocorrelation: f64,
}

/// Whitened force misfits of each test at the base fit, with the test's index.
fn force_misfits(l: &FeLadder) -> Vec<(usize, f64, Vec<f64>)> {
    let Some(base) = l.rungs.get(&Vec::new()) else { return Vec::new() };
    let misfit = l.measured.data.misfit(&base.fit.prediction.values);
    l.measured
        .slots
        .iter()
        .zip(&l.measured.data.blocks)
        .filter(|(s, _)| s.channel == Channel::Force)
        .map(|(s, b)| (s.test, b.noise.sd, b.range.clone().map(|i| misfit[i]).collect()))
        .collect()
}

/// The residual atlas of the base fit, tests joined; shares count χ².
pub(crate) fn atlas_of(l: &FeLadder) -> Vec<SegmentMisfit> {
    let mut all = Vec::new();
    for (t, _, misfit) in force_misfits(l) {
        let test = &l.case().tests[t];
        if let Some(r) = &test.record {
            all.extend(diagnose::atlas::atlas(&misfit, &segments(test, r)));
        }
    }
    all
}

/// Where the base model fails, largest share first.
pub(crate) fn places(l: &FeLadder) -> Vec<Where> {
    let blocks = force_misfits(l);
    let total: f64 = blocks.iter().map(|(_, sd, m)| m.iter().map(|r| (r / sd).powi(2)).sum::<f64>()).sum();
    let mut out = Vec::new();
    for (t, sd, misfit) in &blocks {
        let test = &l.case().tests[*t];
        let Some(r) = &test.record else { continue };
        let own: f64 = misfit.iter().map(|r| (r / sd).powi(2)).sum();
        for s in diagnose::atlas::atlas(misfit, &segments(test, r)) {
            out.push(Where {
                test: test.name.clone(),
                segment: s.segment,
                share: s.share * own / total.max(f64::MIN_POSITIVE),
                mean_n: s.mean,
                autocorrelation: s.autocorrelation,
            });
        }
    }
    out.sort_by(|a, b| b.share.total_cmp(&a.share));
    out
}

/// What a misfit depends on, beyond the other variables.
#[derive(Clone, Debug, Serialize)]
pub struct DependsOn {
    /// Test.
    pub test: String,
    /// Variable: `rate`, `clock time`, `largest displacement so far`, …
    pub variable: String,
    /// Share of the misfit's variance that it explains beyond the others.
    pub share: f64,
}

/// One test's distance from the model.
#[derive(Clone, Debug, Serialize)]
pub struct TestRow {
    /// Test (and channel).
    pub name: String,
    /// Points.
    pub points: usize,
    /// Root mean square misfit, unit of the channel.
    pub rms: f64,
    /// Noise of one point, same unit.
    pub noise: f64,
    /// Reduced χ² with the record's noise alone.
    pub reduced_chi2: f64,
    /// The same with the model's numerical error.
    pub reduced_chi2_total: f64,
}

/// Answer of `fct compare`.
#[derive(Clone, Debug, Serialize)]
pub struct CompareAnswer {
    /// Version of this answer's form.
    pub schema: u32,
    /// Specimen.
    pub specimen: String,
    /// Per test.
    pub tests: Vec<TestRow>,
    /// Reduced χ² over everything, numerical error included.
    pub reduced_chi2_total: f64,
    /// Whether the misfit is at the noise floor.
    pub explained: bool,
    /// Where the misfit sits.
    #[serde(rename = "where")]
    pub place: Vec<Where>,
    /// What it depends on.
    pub depends_on: Vec<DependsOn>,
    /// In words.
    pub words: Vec<String>,
}

/// Compares the identified model with the records.
///
/// # Errors
/// [`AnalysisError`].
pub fn compare(
    case: Arc<Case>,
    catalogue: &Catalogue,
    progress: &(dyn Fn(&str) + Sync),
    cancelled: Cancelled,
) -> Result<CompareAnswer, AnalysisError> {
    let policy = Policy::default();
    let mut l = FeLadder::new(case.clone(), catalogue, policy.clone(), progress, cancelled)?;
    let rung = diagnose::Ladder::fit(&mut l, &[], &diagnose::Hints::new())?;
    let mut depends_on = Vec::new();
    let mut words = vec![diagnose::words::place(&atlas_of(&l))];
    for (t, _, misfit) in force_misfits(&l) {
        let test = &case.tests[t];
        let Some(r) = &test.record else { continue };
        let turns = diagnose::segments::breaks(&r.time, &r.displacement);
        let variables = diagnose::dependence::protocol_variables(&r.time, &r.displacement, &r.force, &turns);
        let rows = diagnose::dependence::dependence(&misfit, &variables);
        words.push(format!("{}: {}", test.name, diagnose::words::depends(&rows)));
        depends_on.extend(rows.iter().map(|d| DependsOn {
            test: test.name.clone(),
            variable: d.variable.clone(),
            share: d.share_beyond,
        }));
    }
    let Some(base) = l.rungs.get(&Vec::new()) else { return Err(AnalysisError::Case("no fit".into())) };
    let tests = base
        .quality
        .blocks
        .iter()
        .map(|b| TestRow {
            name: b.name.clone(),
            points: b.points,
            rms: b.rms,
            noise: b.noise,
            reduced_chi2: b.reduced_chi2,
            reduced_chi2_total: b.reduced_chi2_total,
        })
        .collect();
    Ok(CompareAnswer {
        schema: 1,
        specimen: case.name.clone(),
        tests,
        reduced_chi2_total: rung.reduced_chi2_total(),
        explained: rung.explained(&policy),
        place: places(&l),
        depends_on,
        words,
    })
}
