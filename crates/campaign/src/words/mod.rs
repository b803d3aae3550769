//! The study page, the paragraph for a methods section, the script for Slurm.

mod methods;
mod slurm;

pub use methods::methods;
pub use slurm::{Job, slurm};

use crate::summary::{GroupSummary, ModelSummary, Quantity, SpecimenRow, StudySummary};
use report::figures::{ForestGroup, ForestRow, forest};
use report::html::{StudyHead, StudySection, StudyTable, study_page};
use report::terminal::significant;

/// The page of a study, one self-contained HTML file.
pub fn page(study: &StudySummary) -> String {
    let mut sections: Vec<StudySection> = study.models.iter().map(|m| of_model(study, m)).collect();
    sections.push(left_out(study));
    sections.push(StudySection {
        title: "Methods, to copy".into(),
        to_copy: Some(methods(study)),
        ..StudySection::default()
    });
    study_page(&head(study), &sections)
}

fn head(study: &StudySummary) -> StudyHead {
    let s = &study.status;
    let specimens = study.models.first().map_or(&[][..], |m| m.specimens.as_slice());
    let answered = || specimens.iter().filter(|r| r.answered);
    let synthetic = answered().filter(|r| r.provenance.to_lowercase().starts_with("synthetic")).count();
    let badge = match synthetic {
        0 => String::new(),
        n if n == answered().count() => "synthetic records".into(),
        n => format!("{n} of {} synthetic", answered().count()),
    };
    let open = s.waiting + s.running;
    let mut lead = format!("{} of {} tasks are done", s.done, s.tasks);
    for (n, what) in [(open, "open"), (s.failed, "failed"), (s.set_aside, "set aside")] {
        if n > 0 {
            lead.push_str(&format!(", {n} {what}"));
        }
    }
    match s.wrong_rows.len() {
        0 => {}
        1 => lead.push_str("; one row of the table cannot be used"),
        n => lead.push_str(&format!("; {n} rows of the table cannot be used")),
    }
    lead.push('.');
    StudyHead { name: s.study.clone(), badge, lead, good: s.done == s.tasks && s.wrong_rows.is_empty() }
}

fn of_model(study: &StudySummary, m: &ModelSummary) -> StudySection {
    let counted = m.specimens.iter().filter(|r| r.counted()).count();
    let n = m.specimens.len();
    let mut words = vec![format!(
        "{counted} of {n} specimens count: their model explains their records and nothing excludes them. Each is weighed by \
         its own interval and by how much specimens differ; the dashed line is where 95 % of further specimens would lie \
         (in the table \u{201c}further\u{201d}). \u{201c}sd between\u{201d} is the scatter between specimens without their own uncertainty, \
         \u{201c}own sd\u{201d} that uncertainty."
    )];
    words.extend(m.groups.iter().filter_map(unexplained));
    words.extend(m.differences.iter().map(difference));
    words.extend(shared_donors(m));
    let quantities: Vec<&Quantity> = m.groups.iter().fold(Vec::new(), |mut all, g| {
        if !all.contains(&&g.quantity) {
            all.push(&g.quantity);
        }
        all
    });
    let pictures = quantities.iter().map(|q| {
        (
            forest(&axis(q), &forest_groups(m, q)),
            format!("{}: specimens and means, {}", axis(q), study.status.study),
        )
    });
    let mut tables = vec![means(m), effects(m), specimens(m)];
    tables.retain(|t| !t.rows.is_empty());
    StudySection {
        title: format!("{} ({})", m.model, m.task),
        words,
        pictures: pictures.filter(|p| !p.0.is_empty()).collect(),
        tables,
        to_copy: None,
    }
}

/// What a quantity is called, with its unit.
pub(crate) fn axis(q: &Quantity) -> String {
    let name = match q.path.as_str() {
        "gc" => "Gc",
        "sigma_c" => "σc",
        path => path.strip_prefix("effects.").unwrap_or(path),
    };
    if q.unit.is_empty() { name.to_owned() } else { format!("{name} ({})", q.unit) }
}

fn forest_groups(m: &ModelSummary, q: &Quantity) -> Vec<ForestGroup> {
    let named: Vec<&GroupSummary> = m.groups.iter().filter(|g| g.quantity == *q).collect();
    let several = named.iter().any(|g| !g.group.is_empty());
    let of = |g: &GroupSummary| {
        // All together stand below their groups as one mean, not as rows once more.
        let rows = if several && g.group.is_empty() { Vec::new() } else { forest_rows(m, g) };
        let mean = g.pooled.interval_95.map(|i| (g.pooled.mean, i));
        let name = if g.group.is_empty() { "all specimens".into() } else { g.group.clone() };
        ForestGroup { name, rows, mean, prediction: g.pooled.prediction_95 }
    };
    named.into_iter().map(of).collect()
}

fn forest_rows(m: &ModelSummary, g: &GroupSummary) -> Vec<ForestRow> {
    let mut rows: Vec<&SpecimenRow> =
        m.specimens.iter().filter(|r| g.group.is_empty() || r.group == g.group).collect();
    let mut weights = g.pooled.weights.iter();
    let mut out: Vec<(&str, ForestRow)> = Vec::new();
    for r in rows.drain(..) {
        let Some(s) = r.strength(&g.quantity) else { continue };
        let weight = if r.counted() { weights.next().copied() } else { None };
        let donor = if r.donor.is_empty() { String::new() } else { format!(", {}", r.donor) };
        let label = format!("{}{donor}", r.specimen);
        out.push((&r.donor, ForestRow { label, value: s.value, interval: s.interval_95, weight }));
    }
    // Specimens of a donor side by side.
    out.sort_by(|a, b| a.0.cmp(b.0));
    out.into_iter().map(|r| r.1).collect()
}

fn of_group(g: &str) -> String {
    if g.is_empty() { "all specimens".into() } else { g.to_owned() }
}

fn unexplained(g: &GroupSummary) -> Option<String> {
    let with = g.with_unexplained?;
    Some(format!(
        "{}, {}: with the specimens that their model does not explain the mean would be {} instead of {}; they are not in it.",
        axis(&g.quantity),
        of_group(&g.group),
        significant(with, 3),
        significant(g.pooled.mean, 3)
    ))
}

fn difference(d: &crate::summary::GroupDifference) -> String {
    let x = &d.difference;
    format!(
        "{}: {} minus {} is {} (95 %: {} – {}, p = {}).",
        axis(&d.quantity),
        d.second,
        d.first,
        significant(x.difference, 3),
        significant(x.interval_95[0], 3),
        significant(x.interval_95[1], 3),
        significant(x.p_value, 2)
    )
}

/// Specimens of one donor are alike: the model does not know it, so the reader must.
fn shared_donors(m: &ModelSummary) -> Option<String> {
    let g = m.groups.iter().find(|g| g.donors.is_some_and(|d| d < g.pooled.specimens))?;
    let donors = match g.donors.unwrap_or_default() {
        1 => "one donor".to_owned(),
        n => format!("{n} donors"),
    };
    Some(format!(
        "{} specimens of {donors} stand behind the mean of {}: specimens of a donor count as independent here, so that the \
         intervals are too narrow where donors differ more than their specimens.",
        g.pooled.specimens,
        of_group(&g.group)
    ))
}

fn means(m: &ModelSummary) -> StudyTable {
    let range = |i: Option<[f64; 2]>| {
        i.map_or("–".into(), |[a, b]| format!("{} – {}", significant(a, 3), significant(b, 3)))
    };
    let row = |g: &GroupSummary| {
        let p = &g.pooled;
        vec![
            axis(&g.quantity),
            of_group(&g.group),
            p.specimens.to_string(),
            significant(p.mean, 3),
            range(p.interval_95),
            p.between().map_or("–".into(), |b| significant(b.0, 2)),
            significant(p.within_sd, 2),
            p.between().map_or("–".into(), |b| format!("{:.0} %", 100.0 * b.1)),
            range(p.prediction_95),
        ]
    };
    let header = vec![
        "quantity",
        "group",
        "specimens",
        "mean",
        "95 % interval",
        "sd between",
        "own sd",
        "I²",
        "further, 95 %",
    ];
    StudyTable { header, rows: m.groups.iter().map(row).collect(), numbers: (2..9).collect() }
}

fn effects(m: &ModelSummary) -> StudyTable {
    let row = |e: &crate::summary::EffectCount| {
        vec![e.effect.clone(), of_group(&e.group), format!("{} of {}", e.specimens, e.of)]
    };
    let rows = m.effects.iter().map(row).collect();
    StudyTable { header: vec!["effect in the model", "group", "specimens"], rows, numbers: vec![2] }
}

fn specimens(m: &ModelSummary) -> StudyTable {
    let value = |r: &SpecimenRow, path: &str| {
        let found = r.strengths.iter().find(|(q, _)| q.path == path).map(|(_, s)| s);
        found.map_or("–".into(), |s| {
            let bootstrap =
                s.bootstrap_sd.map_or(String::new(), |b| format!(", {} by repeats", significant(b, 2)));
            let [known, all] = s.areas;
            let of = if known < all { format!(", {known} of {all} areas") } else { String::new() };
            format!("{} ± {}{of}{bootstrap}", significant(s.value, 3), significant(s.std_error, 2))
        })
    };
    let row = |r: &SpecimenRow| {
        vec![
            r.row.to_string(),
            r.specimen.clone(),
            r.group.clone(),
            r.donor.clone(),
            value(r, "gc"),
            value(r, "sigma_c"),
            r.effects.join(" + "),
            r.reduced_chi2_total.map_or("–".into(), |x| significant(x, 3)),
            if r.counted() { "yes".into() } else { "no".into() },
        ]
    };
    let header =
        vec!["row", "specimen", "group", "donor", "Gc (N/mm)", "σc (MPa)", "effects", "reduced χ²", "counts"];
    StudyTable { header, rows: m.specimens.iter().map(row).collect(), numbers: vec![0, 4, 5, 7] }
}

/// Everything that is in no mean, and why.
fn left_out(study: &StudySummary) -> StudySection {
    let mut rows: Vec<Vec<String>> = Vec::new();
    for m in &study.models {
        rows.extend(m.specimens.iter().filter_map(|r| {
            Some(vec![r.row.to_string(), r.specimen.clone(), m.model.clone(), r.left_out.clone()?])
        }));
    }
    let wrong = study.status.wrong_rows.iter();
    rows.extend(wrong.map(|w| vec![w.row.to_string(), String::new(), String::new(), w.reason.clone()]));
    let set_aside = study.status.look_at.iter().filter(|t| t.repeat > 0);
    rows.extend(set_aside.map(|t| {
        vec![
            t.row.to_string(),
            t.specimen.clone(),
            format!("{}, repeat {}", t.model, t.repeat),
            t.reason.clone(),
        ]
    }));
    let words = if rows.is_empty() { vec!["Nothing.".into()] } else { Vec::new() };
    let header = vec!["row", "specimen", "model", "why"];
    let tables =
        if rows.is_empty() { Vec::new() } else { vec![StudyTable { header, rows, numbers: vec![0] }] };
    StudySection { title: "In no mean, and why".into(), words, tables, ..StudySection::default() }
}
