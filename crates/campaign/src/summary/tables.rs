//! The study as CSV: a line per specimen and quantity, a line per group and quantity.

use super::{ModelSummary, SpecimenRow, StudySummary};
use report::ReportError;

const SPECIMENS: [&str; 20] = [
    "model",
    "row",
    "specimen",
    "group",
    "donor",
    "counted",
    "left_out",
    "explained",
    "reduced_chi2_total",
    "effects",
    "quantity",
    "unit",
    "value",
    "std_error",
    "low_95",
    "high_95",
    "areas_counted",
    "areas",
    "along_path_sd",
    "bootstrap_sd",
];

const GROUPS: [&str; 17] = [
    "model",
    "group",
    "quantity",
    "unit",
    "specimens",
    "donors",
    "mean",
    "std_error",
    "low_95",
    "high_95",
    "between_specimens_sd",
    "within_specimen_sd",
    "i2",
    "q",
    "p_q",
    "prediction_low_95",
    "prediction_high_95",
];

/// `specimens.csv` and `groups.csv`.
///
/// # Errors
/// If a table cannot be written, which only a lack of memory does.
pub fn csv_files(study: &StudySummary) -> Result<Vec<(&'static str, Vec<u8>)>, ReportError> {
    let models = &study.models;
    let specimens = models.iter().flat_map(|m| m.specimens.iter().flat_map(|s| specimen(m, s)));
    let groups = models.iter().flat_map(group);
    Ok(vec![
        ("specimens.csv", table("specimens.csv", &SPECIMENS, specimens)?),
        ("groups.csv", table("groups.csv", &GROUPS, groups)?),
    ])
}

fn number(x: impl Into<Option<f64>>) -> String {
    x.into().filter(|v| v.is_finite()).map_or(String::new(), |v| v.to_string())
}

/// A line per quantity; one without values where there is none.
fn specimen(m: &ModelSummary, s: &SpecimenRow) -> Vec<Vec<String>> {
    let head = vec![
        m.model.clone(),
        s.row.to_string(),
        s.specimen.clone(),
        s.group.clone(),
        s.donor.clone(),
        s.counted().to_string(),
        s.left_out.clone().unwrap_or_default(),
        if s.answered { s.explained.to_string() } else { String::new() },
        number(s.reduced_chi2_total),
        s.effects.join(" + "),
    ];
    let line = |tail: Vec<String>| head.iter().cloned().chain(tail).collect::<Vec<String>>();
    if s.strengths.is_empty() {
        return vec![line(vec![String::new(); SPECIMENS.len() - head.len()])];
    }
    let of = s.strengths.iter().map(|(q, v)| {
        line(vec![
            q.path.clone(),
            q.unit.clone(),
            number(v.value),
            number(v.std_error),
            number(v.interval_95[0]),
            number(v.interval_95[1]),
            v.areas[0].to_string(),
            v.areas[1].to_string(),
            number(v.along_sd),
            number(v.bootstrap_sd),
        ])
    });
    of.collect()
}

fn group(m: &ModelSummary) -> Vec<Vec<String>> {
    let one = |g: &super::GroupSummary| {
        let p = &g.pooled;
        let [low, high] = p.interval_95.map_or([None; 2], |i| i.map(Some));
        let [below, above] = p.prediction_95.map_or([None; 2], |i| i.map(Some));
        vec![
            m.model.clone(),
            if g.group.is_empty() { "all".into() } else { g.group.clone() },
            g.quantity.path.clone(),
            g.quantity.unit.clone(),
            p.specimens.to_string(),
            g.donors.map_or(String::new(), |d| d.to_string()),
            number(p.mean),
            number(p.std_error),
            number(low),
            number(high),
            number(p.between().map(|b| b.0)),
            number(p.within_sd),
            number(p.between().map(|b| b.1)),
            number(p.q),
            number(p.p_q),
            number(below),
            number(above),
        ]
    };
    m.groups.iter().map(one).collect()
}

fn table(
    name: &str,
    header: &[&str],
    rows: impl Iterator<Item = Vec<String>>,
) -> Result<Vec<u8>, ReportError> {
    let fault = |e: String| ReportError::NotARun { path: name.into(), reason: e };
    let mut out = csv::Writer::from_writer(Vec::new());
    out.write_record(header).map_err(|e| fault(e.to_string()))?;
    for row in rows {
        out.write_record(row.iter().map(|c| harmless(c))).map_err(|e| fault(e.to_string()))?;
    }
    out.into_inner().map_err(|e| fault(e.to_string()))
}

/// A cell that no spreadsheet takes for a formula.
fn harmless(cell: &str) -> String {
    let text = input::visible(cell);
    let number = text.parse::<f64>().is_ok();
    if !number && text.starts_with(['=', '+', '-', '@']) { format!("'{text}") } else { text }
}
