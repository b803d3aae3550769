//! Several runs side by side: the batch's table and the ladder. Field names are those of the answers.
#![allow(non_snake_case)]

use super::{Style, significant, table};
use crate::answer::IdentifyAnswer;
use crate::runs::StoredRun;
use serde::Serialize;

/// One specimen of a batch.
#[derive(Clone, Debug, Serialize)]
pub struct BatchRow {
    /// Name.
    pub specimen: String,
    /// Number of areas.
    pub areas: usize,
    /// Mean and SD of Gc over the areas, N/mm.
    pub gc_N_per_mm: Option<[f64; 2]>,
    /// Mean and SD of σc over the areas, MPa.
    pub sigma_c_MPa: Option<[f64; 2]>,
    /// The same of the published rows, where there are some: Gc, N/mm.
    pub published_gc_N_per_mm: Option<[f64; 2]>,
    /// σc, MPa.
    pub published_sigma_c_MPa: Option<[f64; 2]>,
    /// Areas whose Gc or σc the record does not fix.
    pub not_identifiable: usize,
    /// Fit.
    pub reduced_chi2_total: f64,
    /// Verdict.
    pub explained: bool,
}

/// Rows of the batch's table.
pub fn batch_rows(answers: &[IdentifyAnswer]) -> Vec<BatchRow> {
    answers.iter().map(batch_row).collect()
}

fn batch_row(a: &IdentifyAnswer) -> BatchRow {
    let of = |what: &str| -> Vec<f64> {
        let areas =
            a.parameters.iter().filter(|p| p.path.starts_with("interface.area[") && p.path.ends_with(what));
        areas.map(|p| p.value).collect()
    };
    let printed = |what: &str| -> Vec<f64> {
        let areas =
            a.parameters.iter().filter(|p| p.path.starts_with("interface.area[") && p.path.ends_with(what));
        areas.filter_map(|p| p.published).collect()
    };
    let (gc, sigma_c) = (of("].gc"), of("].sigma_c"));
    let loose =
        a.parameters.iter().filter(|p| p.path.starts_with("interface.area[") && !p.identifiable).count();
    BatchRow {
        specimen: a.specimen.clone(),
        areas: gc.len().max(sigma_c.len()),
        gc_N_per_mm: mean_sd(&gc),
        sigma_c_MPa: mean_sd(&sigma_c),
        published_gc_N_per_mm: mean_sd(&printed("].gc")),
        published_sigma_c_MPa: mean_sd(&printed("].sigma_c")),
        not_identifiable: loose,
        reduced_chi2_total: a.reduced_chi2_total,
        explained: a.explained,
    }
}

/// Mean and sample standard deviation.
pub(crate) fn mean_sd(x: &[f64]) -> Option<[f64; 2]> {
    if x.is_empty() {
        return None;
    }
    let n = x.len() as f64;
    let mean = x.iter().sum::<f64>() / n;
    let variance = x.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0).max(1.0);
    Some([mean, variance.sqrt()])
}

/// Mean ± SD of Gc and σc per specimen, as the paper's Table 2.
pub fn batch(rows: &[BatchRow], style: Style) -> String {
    let pair = |p: Option<[f64; 2]>| p.map_or("–".into(), |[m, s]| format!("{m:.3} ± {s:.3}"));
    let header = [
        "specimen",
        "areas",
        "Gc (N/mm)",
        "published",
        "σc (MPa)",
        "published",
        "not identif.",
        "χ²/ν",
        "explained",
    ];
    let lines = rows.iter().map(|r| {
        vec![
            r.specimen.clone(),
            r.areas.to_string(),
            pair(r.gc_N_per_mm),
            pair(r.published_gc_N_per_mm),
            pair(r.sigma_c_MPa),
            pair(r.published_sigma_c_MPa),
            r.not_identifiable.to_string(),
            significant(r.reduced_chi2_total, 3),
            if r.explained { "yes" } else { "no" }.into(),
        ]
    });
    format!("{}\n{}", style.bold("Mean ± SD over the areas"), table(&header, &[0], lines.collect()))
}

/// One rung of a ladder of runs.
#[derive(Clone, Debug, Serialize)]
pub struct LadderRow {
    /// Run directory.
    pub run: String,
    /// Effects in the model.
    pub effects: Vec<String>,
    /// Free parameters.
    pub parameters: usize,
    /// One number over all force points, N.
    pub rms_N: f64,
    /// Fit with the record's noise.
    pub reduced_chi2: f64,
    /// Fit with numerical error.
    pub reduced_chi2_total: f64,
    /// Rms misfit of held-out segments, N.
    pub held_out_rms_N: Option<f64>,
    /// Bayesian information criterion.
    pub bic: Option<f64>,
    /// Mean Gc over the areas, N/mm.
    pub gc_mean_N_per_mm: Option<f64>,
    /// Mean σc over the areas, MPa.
    pub sigma_c_mean_MPa: Option<f64>,
}

/// Rungs in the order of the number of effects, then of falling misfit.
pub fn ladder_rows(runs: &[(StoredRun, IdentifyAnswer)]) -> Vec<LadderRow> {
    let mut rows: Vec<LadderRow> = runs
        .iter()
        .map(|(run, a)| {
            let means = batch_row(a);
            LadderRow {
                run: run.path.display().to_string(),
                effects: a.effects.clone(),
                parameters: a.parameters.len(),
                rms_N: a.rms_N,
                reduced_chi2: a.reduced_chi2,
                reduced_chi2_total: a.reduced_chi2_total,
                held_out_rms_N: a.held_out_rms_N,
                bic: a.bic,
                gc_mean_N_per_mm: means.gc_N_per_mm.map(|p| p[0]),
                sigma_c_mean_MPa: means.sigma_c_MPa.map(|p| p[0]),
            }
        })
        .collect();
    rows.sort_by(|a, b| a.effects.len().cmp(&b.effects.len()).then(b.rms_N.total_cmp(&a.rms_N)));
    rows
}

/// Columns of a bar: few, so that the effects' names keep theirs.
const BAR: f64 = 5.0;

/// The staircase of error against effects.
pub fn ladder(rows: &[LadderRow], style: Style) -> String {
    let most = rows.iter().fold(f64::MIN_POSITIVE, |m, r| m.max(r.rms_N));
    let header =
        ["effects", "par.", "rms (N)", "", "held out (N)", "χ²/ν", "with num. error", "BIC", "Gc", "σc"];
    let number = |x: Option<f64>, digits| x.map_or("–".into(), |x| significant(x, digits));
    let lines = rows.iter().map(|r| {
        let bar = "█".repeat(((r.rms_N / most) * BAR).round().max(1.0) as usize);
        vec![
            if r.effects.is_empty() { "none".into() } else { r.effects.join(" + ") },
            r.parameters.to_string(),
            significant(r.rms_N, 3),
            bar,
            number(r.held_out_rms_N, 3),
            significant(r.reduced_chi2, 3),
            significant(r.reduced_chi2_total, 3),
            number(r.bic, 5),
            number(r.gc_mean_N_per_mm, 3),
            number(r.sigma_c_mean_MPa, 3),
        ]
    });
    format!("{}\n{}", style.bold("Ladder"), table(&header, &[0, 3], lines.collect()))
}
