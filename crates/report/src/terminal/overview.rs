//! Several runs side by side: the batch's table and the ladder. Field names are those of the answers.
#![allow(non_snake_case)]

use super::{Style, significant, table, wrap};
use crate::answer::{IdentifyAnswer, ParameterAnswer};
use crate::law_columns::{default_laws, said};
use crate::runs::StoredRun;
use analysis::LawNames;
use serde::Serialize;

/// One specimen of a batch.
#[derive(Clone, Debug, Serialize)]
pub struct BatchRow {
    /// Name.
    pub specimen: String,
    /// Number of areas.
    pub areas: usize,
    /// Mean of Gc along the tear path and its standard error, N/mm; null where the records do not fix it.
    pub gc_along_path_N_per_mm: Option<[f64; 2]>,
    /// The same of σc, MPa.
    pub sigma_c_along_path_MPa: Option<[f64; 2]>,
    /// Mean and SD of Gc over the areas that are known one by one and stand at no bound, N/mm; null where none is.
    pub gc_N_per_mm: Option<[f64; 2]>,
    /// The same of σc, MPa.
    pub sigma_c_MPa: Option<[f64; 2]>,
    /// The same of the published rows, where there are some: Gc, N/mm.
    pub published_gc_N_per_mm: Option<[f64; 2]>,
    /// σc, MPa.
    pub published_sigma_c_MPa: Option<[f64; 2]>,
    /// Values of Gc and σc that the records do not fix.
    pub not_identifiable: usize,
    /// Values that stand at a bound.
    pub at_bound: usize,
    /// Values that are in no mean along the path, and why.
    pub left_out: Vec<LeftOut>,
    /// Fit.
    pub reduced_chi2_total: f64,
    /// Verdict.
    pub explained: bool,
}

/// Something that a mean does not count.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct LeftOut {
    /// A parameter's path, or a specimen's name.
    pub what: String,
    /// Why.
    pub why: String,
}

/// Mean and SD over the specimens of a batch that are explained, of their own means.
#[derive(Clone, Debug, Serialize)]
pub struct BatchMean {
    /// Specimens that are counted.
    pub specimens: usize,
    /// Gc, N/mm.
    pub gc_N_per_mm: Option<[f64; 2]>,
    /// σc, MPa.
    pub sigma_c_MPa: Option<[f64; 2]>,
    /// Specimens that are not counted, or not in one of the two, and why.
    pub left_out: Vec<LeftOut>,
}

/// Rows of the batch's table.
pub fn batch_rows(answers: &[IdentifyAnswer]) -> Vec<BatchRow> {
    answers.iter().map(batch_row).collect()
}

fn batch_row(a: &IdentifyAnswer) -> BatchRow {
    let areas = |end: &str| strengths(a).filter(|p| p.path.ends_with(end)).count();
    let printed = |end: &str| -> Vec<f64> {
        strengths(a).filter(|p| p.path.ends_with(end)).filter_map(|p| p.published).collect()
    };
    let mean = |name: &str| a.mean_along_path(name).map(|m| [m.value, m.std_error]);
    let (gc, sigma_c) = (mean("gc"), mean("sigma_c"));
    // What no area tells by itself may still be in the mean.
    let averaged = |p: &ParameterAnswer| {
        let known = [("].gc", gc), ("].sigma_c", sigma_c)];
        !p.at_bound && known.iter().any(|(end, mean)| mean.is_some() && p.path.ends_with(end))
    };
    let left_out: Vec<LeftOut> = strengths(a)
        .filter(|p| !averaged(p))
        .filter_map(|p| Some(LeftOut { what: p.path.clone(), why: unknown(p)?.to_owned() }))
        .collect();
    BatchRow {
        specimen: a.specimen.clone(),
        areas: areas("].gc").max(areas("].sigma_c")),
        gc_along_path_N_per_mm: gc,
        sigma_c_along_path_MPa: sigma_c,
        gc_N_per_mm: mean_sd(&known(a, "].gc")),
        sigma_c_MPa: mean_sd(&known(a, "].sigma_c")),
        published_gc_N_per_mm: mean_sd(&printed("].gc")),
        published_sigma_c_MPa: mean_sd(&printed("].sigma_c")),
        not_identifiable: strengths(a).filter(|p| !p.identifiable).count(),
        at_bound: strengths(a).filter(|p| p.at_bound).count(),
        left_out,
        reduced_chi2_total: a.reduced_chi2_total,
        explained: a.explained,
    }
}

/// Gc and σc of the areas.
fn strengths(a: &IdentifyAnswer) -> impl Iterator<Item = &ParameterAnswer> {
    a.parameters.iter().filter(|p| p.path.starts_with("interface.area["))
}

/// Why a value stands for nothing that was measured; `None`: it does.
fn unknown(p: &ParameterAnswer) -> Option<&'static str> {
    match (p.identifiable, p.at_bound) {
        (_, true) => Some("at a bound"),
        (false, _) => Some("not identifiable"),
        _ => None,
    }
}

/// Values of the areas (`end`: `].gc` or `].sigma_c`) that the records fix and no bound holds, internal unit.
pub(crate) fn known(a: &IdentifyAnswer, end: &str) -> Vec<f64> {
    strengths(a).filter(|p| p.path.ends_with(end) && unknown(p).is_none()).map(|p| p.value).collect()
}

/// The mean of `gc` or `sigma_c` along the tear path where the records fix it, else over the areas that they fix one by one;
/// internal unit.
pub(crate) fn along_path(a: &IdentifyAnswer, name: &str) -> Option<f64> {
    let apart = || mean_sd(&known(a, &format!("].{name}"))).map(|p| p[0]);
    a.mean_along_path(name).map(|m| m.value).or_else(apart)
}

/// Mean and sample standard deviation; of one value the deviation is 0.
pub(crate) fn mean_sd(x: &[f64]) -> Option<[f64; 2]> {
    if x.is_empty() {
        return None;
    }
    let n = x.len() as f64;
    let mean = x.iter().sum::<f64>() / n;
    let variance = x.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0).max(1.0);
    Some([mean, variance.sqrt()])
}

/// Mean ± SD; one value alone has no spread.
pub(crate) fn pair(p: Option<[f64; 2]>) -> String {
    match p {
        None => "–".into(),
        Some([m, 0.0]) => significant(m, 3),
        Some([m, s]) => format!("{} ± {}", significant(m, 3), significant(s, 2)),
    }
}

/// The mean over the specimens: only what is explained is a measurement of anything.
pub fn batch_mean(rows: &[BatchRow]) -> BatchMean {
    let counted: Vec<&BatchRow> = rows.iter().filter(|r| r.explained).collect();
    let mean = |of: &dyn Fn(&BatchRow) -> Option<[f64; 2]>| {
        mean_sd(&counted.iter().filter_map(|r| Some(of(r)?[0])).collect::<Vec<f64>>())
    };
    let left_out = rows.iter().filter_map(|r| {
        let why = match (r.explained, r.gc_along_path_N_per_mm, r.sigma_c_along_path_MPa) {
            (false, ..) => {
                format!("not explained by its model, reduced χ² {}", significant(r.reduced_chi2_total, 3))
            }
            (_, None, None) => "no Gc and no σc that its records fix".to_owned(),
            (_, None, _) => "only from Gc: none that its records fix".to_owned(),
            (_, _, None) => "only from σc: none that its records fix".to_owned(),
            _ => return None,
        };
        Some(LeftOut { what: r.specimen.clone(), why })
    });
    BatchMean {
        specimens: counted.len(),
        gc_N_per_mm: mean(&|r| r.gc_along_path_N_per_mm),
        sigma_c_MPa: mean(&|r| r.sigma_c_along_path_MPa),
        left_out: left_out.collect(),
    }
}

/// The mean over the specimens in a sentence, and what is not in it, line by line.
pub(crate) fn mean_in_words(rows: &[BatchRow]) -> (String, Vec<String>) {
    let all = batch_mean(rows);
    let mean = match all.specimens {
        0 => "No specimen is explained by its model: there is no mean over them.".to_owned(),
        n => format!(
            "Over the {n} explained specimen{} (mean ± SD of their means): Gc {} N/mm, σc {} MPa.",
            if n == 1 { "" } else { "s" },
            pair(all.gc_N_per_mm),
            pair(all.sigma_c_MPa)
        ),
    };
    let specimens = all.left_out.iter().map(|l| format!("Left out of it: {}, {}.", l.what, l.why));
    let values = rows.iter().filter(|r| !r.left_out.is_empty()).map(|r| {
        let count = |why: &str| r.left_out.iter().filter(|l| l.why == why).count();
        let reasons = ["not identifiable", "at a bound"].map(|why| (count(why), why));
        let reasons: Vec<String> =
            reasons.iter().filter(|(n, _)| *n > 0).map(|(n, why)| format!("{n} {why}")).collect();
        format!("{}: values of Gc and σc that are in no mean: {}.", r.specimen, reasons.join(", "))
    });
    let all = specimens.chain(values).collect();
    (mean, all)
}

/// Means of Gc and σc along the path per specimen, beside those of the paper's Table 2, and over them.
pub fn batch(rows: &[BatchRow], style: Style) -> String {
    let published =
        rows.iter().any(|r| r.published_gc_N_per_mm.is_some() || r.published_sigma_c_MPa.is_some());
    let mut header = vec!["specimen", "areas", "Gc (N/mm)", "σc (MPa)", "left out", "χ²/ν", "explained"];
    if published {
        header.insert(3, "published");
        header.insert(5, "published");
    }
    let lines = rows.iter().map(|r| {
        let mut line = vec![
            r.specimen.clone(),
            r.areas.to_string(),
            pair(r.gc_along_path_N_per_mm),
            pair(r.sigma_c_along_path_MPa),
            r.left_out.len().to_string(),
            significant(r.reduced_chi2_total, 3),
            if r.explained { "yes" } else { "no" }.into(),
        ];
        if published {
            line.insert(3, pair(r.published_gc_N_per_mm));
            line.insert(5, pair(r.published_sigma_c_MPa));
        }
        line
    });
    let mut out = format!(
        "{}\n{}\n",
        style.bold(if published {
            "Mean along the tear path ± its standard error (published: mean ± SD of the areas)"
        } else {
            "Mean along the tear path ± its standard error"
        }),
        table(style, &header, &[0], lines.collect())
    );
    let (mean, left_out) = mean_in_words(rows);
    for line in std::iter::once(&mean).chain(&left_out) {
        out.push_str(&format!("\n{}", wrap(line, style.width, 0)));
    }
    out
}

/// One rung of a ladder of runs.
#[derive(Clone, Debug, Serialize)]
pub struct LadderRow {
    /// Run directory.
    pub run: String,
    /// Effects in the model.
    pub effects: Vec<String>,
    /// Laws of the model; unknown of runs of earlier versions.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub laws: Option<LawNames>,
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
    /// Mean Gc along the tear path, else over the areas whose value is known, N/mm.
    pub gc_mean_N_per_mm: Option<f64>,
    /// The same of σc, MPa.
    pub sigma_c_mean_MPa: Option<f64>,
}

/// Rungs in the order of the number of effects, then of falling misfit.
pub fn ladder_rows(runs: &[(StoredRun, IdentifyAnswer)]) -> Vec<LadderRow> {
    let mut rows: Vec<LadderRow> = runs
        .iter()
        .map(|(run, a)| LadderRow {
            run: run.path.display().to_string(),
            effects: a.effects.clone(),
            laws: a.laws.clone(),
            parameters: a.parameters.len(),
            rms_N: a.rms_N,
            reduced_chi2: a.reduced_chi2,
            reduced_chi2_total: a.reduced_chi2_total,
            held_out_rms_N: a.held_out_rms_N,
            bic: a.bic,
            gc_mean_N_per_mm: along_path(a, "gc"),
            sigma_c_mean_MPa: along_path(a, "sigma_c"),
        })
        .collect();
    rows.sort_by(|a, b| a.effects.len().cmp(&b.effects.len()).then(b.rms_N.total_cmp(&a.rms_N)));
    rows
}

/// Columns of a bar: few, so that the effects' names keep theirs.
const BAR: f64 = 5.0;

/// The staircase of error against effects; a law that is not the default stands before them.
pub fn ladder(rows: &[LadderRow], style: Style) -> String {
    let most = rows.iter().fold(f64::MIN_POSITIVE, |m, r| m.max(r.rms_N));
    let default = default_laws();
    let header =
        ["effects", "par.", "rms (N)", "", "held out (N)", "χ²/ν", "with num. error", "BIC", "Gc", "σc"];
    let number = |x: Option<f64>, digits| x.map_or("–".into(), |x| significant(x, digits));
    let lines = rows.iter().map(|r| {
        let bar = "█".repeat(((r.rms_N / most) * BAR).round().max(1.0) as usize);
        let parts = r.laws.as_ref().map_or_else(|| r.effects.clone(), |l| l.parts(&default, &r.effects));
        vec![
            if parts.is_empty() { "none".into() } else { parts.join(" + ") },
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
    let mut out = format!("{}\n{}", style.bold("Ladder"), table(style, &header, &[0, 3], lines.collect()));
    if let Some(said) = said(rows.iter().map(|r| r.laws.as_ref()), &default, "Where no law is named") {
        out.push_str(&format!("\n\n{}", wrap(&said, style.width, 0)));
    }
    out
}
