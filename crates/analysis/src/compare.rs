//! Where a model is off: segments of the records, position of the tear, what the misfit depends on.

use crate::ladder::FeLadder;
use diagnose::atlas::{SegmentMisfit, atlas, atlas_by};
use diagnose::dependence::{Variable, dependence, protocol_variables};
use diagnose::{RecordKind, Segment, words};
use input::{Record, Test};
use model::Channel;
use serde::Serialize;

/// Stretches of the tear path that are told apart.
const STRETCHES: usize = 8;

/// The segments of a test's record.
pub(crate) fn segments(test: &Test, record: &Record) -> Vec<Segment> {
    let kind = if test.kind.tears { RecordKind::Tearing } else { RecordKind::Intact };
    diagnose::segments::cut(&record.time, &record.displacement, &record.force, kind)
}

/// The misfit of one test's force record, one entry per point.
#[derive(Clone, Debug, Default)]
pub struct Residuals {
    /// Test.
    pub test: String,
    /// Time, s.
    pub time: Vec<f64>,
    /// Actuator displacement, mm.
    pub displacement: Vec<f64>,
    /// Measured force, N.
    pub force: Vec<f64>,
    /// Measured minus computed force, N.
    pub misfit: Vec<f64>,
    /// Noise sd of one point, N.
    pub noise: f64,
    /// Segments of the record.
    pub segments: Vec<Segment>,
    /// The model's tear front, mm; empty for an intact strip.
    pub tear_front: Vec<f64>,
}

impl Residuals {
    /// Sum of squared misfits over the noise.
    pub fn chi2(&self) -> f64 {
        self.misfit.iter().map(|r| (r / self.noise.max(f64::MIN_POSITIVE)).powi(2)).sum()
    }
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

/// A stretch of the tear path: the misfit while the model's tear front stood there.
#[derive(Clone, Debug, Serialize)]
pub struct AlongTear {
    /// Test.
    pub test: String,
    /// Ends of the stretch, mm; equal for the points before the tear moves.
    pub from_mm: f64,
    /// See `from_mm`.
    pub to_mm: f64,
    /// Points of the record.
    pub points: usize,
    /// Share of χ² over all tests.
    pub share: f64,
    /// Root mean square misfit, N.
    #[serde(rename = "rms_N")]
    pub rms_n: f64,
    /// Mean misfit, N: positive where the measurement lies above the model.
    #[serde(rename = "mean_N")]
    pub mean_n: f64,
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

/// Rows of all tests with shares of χ² over all of them, largest first.
pub fn located(all: &[Residuals]) -> Vec<(String, SegmentMisfit)> {
    let total: f64 = all.iter().map(Residuals::chi2).sum();
    let mut out: Vec<(String, SegmentMisfit)> = all
        .iter()
        .flat_map(|r| {
            let own = r.chi2() / total.max(f64::MIN_POSITIVE);
            let rows = atlas(&r.misfit, &r.segments).into_iter();
            rows.map(move |s| (r.test.clone(), SegmentMisfit { share: s.share * own, ..s }))
        })
        .collect();
    out.sort_by(|a, b| b.1.share.total_cmp(&a.1.share));
    out
}

/// Where the misfit sits, largest share first.
pub fn places(all: &[Residuals]) -> Vec<Where> {
    located(all)
        .into_iter()
        .map(|(test, s)| Where {
            test,
            segment: s.segment,
            share: s.share,
            mean_n: s.mean,
            autocorrelation: s.autocorrelation,
        })
        .collect()
}

/// The same in a sentence.
pub fn place_in_words(all: &[Residuals]) -> String {
    let named =
        |(test, s): (String, SegmentMisfit)| SegmentMisfit { segment: format!("{test}, {}", s.segment), ..s };
    words::place(&located(all).into_iter().map(named).collect::<Vec<_>>())
}

/// The misfit by the position of the tear front, from the cut on.
pub fn along_the_tear(all: &[Residuals]) -> Vec<AlongTear> {
    let total: f64 = all.iter().map(Residuals::chi2).sum();
    let mut out = Vec::new();
    for r in all.iter().filter(|r| r.tear_front.len() == r.misfit.len()) {
        let own = r.chi2() / total.max(f64::MIN_POSITIVE);
        out.extend(atlas_by(&r.misfit, &r.tear_front, STRETCHES).into_iter().map(|([from, to], s)| {
            AlongTear {
                test: r.test.clone(),
                from_mm: from,
                to_mm: to,
                points: s.points,
                share: s.share * own,
                rms_n: s.rms,
                mean_n: s.mean,
            }
        }));
    }
    out
}

/// What the misfit of each test depends on, and the same in sentences.
pub fn depends_on(all: &[Residuals]) -> (Vec<DependsOn>, Vec<String>) {
    let (mut out, mut sentences) = (Vec::new(), Vec::new());
    for r in all {
        let turns = diagnose::segments::breaks(&r.time, &r.displacement);
        let mut variables = protocol_variables(&r.time, &r.displacement, &r.force, &turns);
        if !r.tear_front.is_empty() {
            variables.push(Variable::new("position of the tear front", r.tear_front.clone()));
        }
        let rows = dependence(&r.misfit, &variables);
        sentences.push(format!("{}: {}", r.test, words::depends(&rows)));
        out.extend(rows.into_iter().map(|d| DependsOn {
            test: r.test.clone(),
            variable: d.variable,
            share: d.share_beyond,
        }));
    }
    (out, sentences)
}

/// Force misfits at the base fit of a search.
pub(crate) fn residuals_of(l: &FeLadder) -> Vec<Residuals> {
    let Some(base) = l.fitted_models.get(&Vec::new()) else { return Vec::new() };
    let misfit = l.measured.data.misfit(&base.fit.prediction.values);
    let blocks = l.measured.slots.iter().zip(&l.measured.data.blocks);
    blocks
        .filter(|(s, _)| s.channel == Channel::Force)
        .filter_map(|(s, b)| {
            let test = &l.case().tests[s.test];
            let record = test.record.as_ref()?;
            Some(Residuals {
                test: test.name.clone(),
                time: record.time.clone(),
                displacement: record.displacement.clone(),
                force: record.force.clone(),
                // What the user left out is no fault of the model.
                misfit: b
                    .range
                    .clone()
                    .map(|i| if l.measured.data.is_used(i) { misfit[i] } else { 0.0 })
                    .collect(),
                noise: b.noise.sd,
                segments: segments(test, record),
                tear_front: Vec::new(),
            })
        })
        .collect()
}
