//! What an import says on a terminal.

use super::write::Plan;
use ::report::terminal::wrap;
use records::{Found, Geometry, Import, Test};
use std::fmt::Write;
use std::path::Path;

/// Columns of the text.
const WIDE: usize = 96;

/// Everything that was understood, found, done and written.
pub fn text(
    folder: &Path,
    geometry: &Geometry,
    read: &[Import],
    plan: &Plan,
    kinds: &[String],
    answered: &[String],
) -> String {
    let mut out = String::new();
    for import in read {
        file(&mut out, import);
        for test in &import.tests {
            self::test(&mut out, test);
        }
    }
    for line in kinds {
        let _ = writeln!(out, "{}", wrap(line, WIDE, 2));
    }
    if !answered.is_empty() {
        let _ = writeln!(out, "The same without questions: {}", answered.join(" "));
    }
    let lengths = [
        ("length", geometry.length),
        ("width", geometry.width),
        ("thickness", geometry.thickness),
        ("cut", geometry.cut),
    ];
    let known: Vec<String> = lengths.iter().filter_map(|(n, v)| v.map(|v| format!("{n} {v} mm"))).collect();
    let known = if known.is_empty() { "no dimensions".to_owned() } else { known.join(", ") };
    let _ = writeln!(out, "{}", wrap(&format!("specimen: {known}"), WIDE, 2));
    let specimen = folder.join("specimen.toml");
    out.push_str("written:\n");
    for path in plan.paths() {
        let _ = writeln!(out, "  {}", path.display());
    }
    if geometry.is_complete() {
        let _ = writeln!(out, "next:\n  fct check {}", specimen.display());
    } else {
        let _ = writeln!(
            out,
            "next: fill in the dimensions in {s} (or say --geometry), then\n  fct check {s}",
            s = specimen.display()
        );
    }
    out
}

fn file(out: &mut String, import: &Import) {
    let r = &import.reading;
    let sheet = r.sheet.as_ref().map_or(String::new(), |s| format!(", sheet `{s}`"));
    let head = format!(
        "{}: {}, {} ({}){sheet}, cells separated by {}, decimal mark {} ({})",
        import.file.display(),
        r.dialect,
        r.encoding,
        r.encoding_because,
        r.delimiter,
        r.decimal,
        r.decimal_because
    );
    let _ = writeln!(out, "{}", wrap(&head, WIDE, 2));
    for c in &r.columns {
        let role = c.role.spoken();
        let unit = if c.unit.is_empty() { String::new() } else { format!(" in {}", c.unit) };
        let _ = writeln!(out, "  {role:<13} column {} `{}`{unit}", c.column, c.name);
    }
    for said in &import.header {
        let about = format!("{:?}", said.about).to_lowercase();
        let _ = writeln!(out, "  {about:<13} {} (row {})", said.text, said.row);
    }
    for line in import.done.iter().chain(&import.remarks) {
        let _ = writeln!(out, "  {}", wrap(line, WIDE, 4));
    }
    import.faults.iter().for_each(|f| fault(out, f));
}

fn test(out: &mut String, test: &Test) {
    let rows = test.full.row.len();
    let (first, last) = test.file_rows;
    let noise = |x: f64| format!("{x:.2e} N");
    let points = match &test.reduction {
        Some(r) if r.rows_per_point > 1 => format!(
            "{} points: {} corners, else means of {} rows; noise of the force {} a row, {} a point",
            r.points,
            r.corners,
            r.rows_per_point,
            noise(test.force_sd_of_rows),
            noise(test.force_sd_of_points.unwrap_or(test.force_sd_of_rows))
        ),
        Some(r) => format!("{} points, single rows", r.points),
        None => format!("all kept; noise of the force {}", noise(test.force_sd_of_rows)),
    };
    let line = format!("{}: {rows} rows ({first} to {last}); {points}", test.name);
    let _ = writeln!(out, "  {}", wrap(&line, WIDE, 4));
    if !test.segments.is_empty() {
        let mut names: Vec<&str> = test.segments.iter().map(String::as_str).take(8).collect();
        if test.segments.len() > 8 {
            names.push("…");
        }
        let line = format!("{} segments: {}", test.segments.len(), names.join(", "));
        let _ = writeln!(out, "  {}", wrap(&line, WIDE, 4));
    }
    for done in &test.done {
        let _ = writeln!(out, "  {}", wrap(done, WIDE, 4));
    }
    test.faults.iter().for_each(|f| fault(out, f));
    for p in &test.proposals {
        let flag = if p.flag.is_empty() { "note".to_owned() } else { p.flag.clone() };
        let _ = writeln!(out, "  {}", wrap(&format!("{flag}? {}", p.why), WIDE, 4));
    }
}

fn fault(out: &mut String, found: &Found) {
    let rows: Vec<String> = found.rows.iter().map(ToString::to_string).collect();
    let more = if found.count > found.rows.len() { ", …" } else { "" };
    let place = if rows.is_empty() { String::new() } else { format!(" (rows {}{more})", rows.join(", ")) };
    let line = format!("{}: {}{place}; {}", found.rule, found.what, found.remedy);
    let _ = writeln!(out, "  {}", wrap(&line, WIDE, 4));
}
