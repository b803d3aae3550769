//! `name`, `provenance`, `[geometry]`.

use super::scalar::{self, Item};
use super::section::{Context, Section};
use crate::case::{Geometry, Test};
use crate::csv;
use crate::diagnostics::Report;
use crate::experiment::Layout;
use crate::keys::{self, Fallback, plain};
use crate::text::{short, visible};
use std::ops::Range;
use std::path::{Path, PathBuf};
use toml::de::DeValue;

/// A path of the file, relative to the folder the file is in.
pub(crate) fn resolve(context: Context<'_>, given: &str) -> PathBuf {
    let folder = context.file.path.parent().unwrap_or(Path::new(""));
    folder.join(given)
}

/// A table behind a key, opened with the keys of `section`.
pub(crate) fn subsection<'a>(parent: &Section<'a>, name: &'static str) -> Section<'a> {
    subsection_of(parent, name, keys::of(name))
}

/// A table behind a key, opened with these keys.
pub(crate) fn subsection_of<'a>(
    parent: &Section<'a>,
    name: &'static str,
    keys: Vec<keys::Key>,
) -> Section<'a> {
    let title = format!("[{name}]");
    let Some(entry) = parent.entry(name) else { return Section::absent(parent.context, title, keys) };
    match entry.item.get_ref() {
        DeValue::Table(table) => Section::open(parent.context, title, entry.key_span.clone(), table, keys),
        _ => {
            scalar::wrong_type(parent.context, name, entry.item, &format!("the table [{name}]"));
            Section::absent(parent.context, title, keys)
        }
    }
}

/// Why a text cannot be the name of a specimen: it is that of files and folders too.
pub fn name_fault(name: &str) -> Option<&'static str> {
    match name {
        "" => Some("it is empty"),
        "." | ".." => Some("it stands for a folder"),
        n if n.trim() != n => Some("it begins or ends with a blank"),
        n if n.chars().count() > 100 => Some("it has more than 100 characters"),
        n if n.contains(['/', '\\', ':', '*', '?', '"', '<', '>', '|']) => {
            Some("it has one of / \\ : * ? \" < > |")
        }
        n if visible(n) != n => Some("it has characters that cannot be seen"),
        _ => None,
    }
}

/// A name that can be a folder's or a file's, else an error.
pub(crate) fn checked_name(section: &Section<'_>) -> Option<String> {
    let name = section.text("name")?;
    if let Some(why) = name_fault(name) {
        let message =
            format!("`name` is \"{}\"; expected a name for files and folders, but {why}", short(name));
        let span = section.entry("name").map_or(section.span.clone(), |e| e.item.span());
        section.context.report(Report::error(message).key("name"), span);
        return None;
    }
    Some(name.to_owned())
}

/// `[geometry]`
pub(crate) fn geometry(top: &Section<'_>) -> Geometry {
    of_section(&subsection(top, "geometry"))
}

/// `[geometry]` of a file that need not give all of it: what is left out is NaN, what is given must be right.
pub(crate) fn given_geometry(top: &Section<'_>) -> Geometry {
    let mut keys = keys::of("geometry");
    for key in keys.iter_mut().filter(|k| matches!(k.default, Fallback::Required)) {
        key.default = Fallback::Number(f64::NAN);
    }
    of_section(&subsection_of(top, "geometry", keys))
}

fn of_section(s: &Section<'_>) -> Geometry {
    let geometry = Geometry {
        length: s.number("length"),
        width: s.number("width"),
        thickness: s.number("thickness"),
        cut: s.number("cut"),
        path_y: s.optional_number("path_y"),
        outline: rows::<3>(s, "outline"),
        thickness_profile: rows::<2>(s, "thickness_profile"),
    };
    check_outline(s, &geometry);
    check_thickness(s, &geometry);
    geometry
}

/// Whether the cut ends inside the piece and the tear path lies in it, for the ways the tests lay it.
pub(crate) fn check_fit(top: &Section<'_>, geometry: &Geometry, tests: &[Test]) {
    let s = subsection(top, "geometry");
    // What is wrong with the keys themselves was said when they were read.
    let split = tests.iter().any(|t| t.kind.layout == Layout::Split);
    let layout = if split { Layout::Split } else { Layout::Sheet };
    let ([across, along, _], [x, y, _]) = (layout.extents(geometry), layout.keys());
    if geometry.cut >= across {
        let (cut, spelt) = (s.spelling("cut"), s.spelling(x));
        let message = format!(
            "`{cut}` is {} mm, but the {x} is {} mm (`{spelt}`); expected a cut shorter than the {x}",
            plain(geometry.cut),
            plain(across)
        );
        s.fault("cut", message);
    }
    if let Some(at) = geometry.path_y
        && at >= along
    {
        let message =
            format!("`path_y` is {} mm; expected less than the {y}, {} mm", plain(at), plain(along));
        s.fault("path_y", message);
    }
    // A key that is itself wrong was said so; what the test then makes of it would only be noise.
    let good = geometry.cut.is_finite() && geometry.thickness > 0.0;
    for test in tests.iter().filter(|_| good) {
        if let Some((key, why)) = (test.kind.objection)(geometry) {
            let (word, spelt) = (test.kind.word(), s.spelling(key));
            s.fault(key, format!("`{spelt}`: a `{word}` test {why}"));
        }
    }
    for test in tests.iter().filter(|t| !t.kind.shaped) {
        for (key, given) in [
            ("outline", geometry.outline.is_some()),
            ("thickness_profile", geometry.thickness_profile.is_some()),
        ] {
            if given {
                let word = test.kind.word();
                s.fault(
                    key,
                    format!("`{key}`: a `{word}` test takes a piece that is a rectangle, of one thickness"),
                );
            }
        }
    }
}

/// A CSV file, or rows written in place.
fn rows<const N: usize>(s: &Section<'_>, name: &str) -> Option<Vec<[f64; N]>> {
    let entry = s.entry(name)?;
    let context = s.context;
    match entry.item.get_ref() {
        DeValue::String(path) => match csv::read_rows::<N>(&resolve(context, path), context.sink) {
            Ok(rows) => rows,
            Err(diagnostic) => {
                linked(s, name, *diagnostic);
                None
            }
        },
        DeValue::Array(items) => {
            items.iter().map(|item| row(context, entry.written, item, entry.factor)).collect()
        }
        _ => {
            let expected = format!("a CSV file, or a list of rows of {N} numbers");
            scalar::wrong_type(context, entry.written, entry.item, &expected);
            None
        }
    }
}

fn row<const N: usize>(
    context: Context<'_>,
    written: &str,
    item: &Item<'_>,
    factor: f64,
) -> Option<[f64; N]> {
    let DeValue::Array(items) = item.get_ref() else {
        scalar::wrong_type(context, written, item, &format!("a row of {N} numbers"));
        return None;
    };
    if items.len() != N {
        scalar::wrong_type(context, written, item, &format!("a row of {N} numbers"));
        return None;
    }
    let mut out = [0.0; N];
    for (x, item) in out.iter_mut().zip(items.iter()) {
        *x = scalar::row_number(context, written, item, factor)?;
    }
    Some(out)
}

/// Reports a file that cannot be read where the key that names it stands.
pub(crate) fn linked(s: &Section<'_>, name: &str, diagnostic: crate::diagnostics::Diagnostic) {
    if diagnostic.line.is_some() {
        s.context.sink.push(diagnostic);
        return;
    }
    let span: Range<usize> = s.entry(name).map_or(s.span.clone(), |e| e.item.span());
    let file = visible(&diagnostic.file.display().to_string());
    let mut report = Report::error(format!("`{file}`: {}", diagnostic.message)).key(name);
    if let Some(help) = diagnostic.help {
        report = report.help(help);
    }
    s.context.report(report, span);
}

/// y from 0 to the length, increasing.
fn check_heights(s: &Section<'_>, name: &str, length: f64, heights: &[f64]) -> bool {
    let slack = 1e-6 * length;
    let fault = |message: String| {
        s.fault(name, message);
        false
    };
    if heights.len() < 2 {
        return fault(format!("`{name}` has {} rows; expected at least 2", heights.len()));
    }
    if let Some(i) = heights.windows(2).position(|w| w[1] <= w[0]) {
        let (row, y, before) = (i + 2, plain(heights[i + 1]), plain(heights[i]));
        return fault(format!(
            "`{name}`: y is {y} mm in row {row}, after {before} mm; expected y to increase"
        ));
    }
    let (first, last) = (heights[0], heights[heights.len() - 1]);
    if first.abs() > slack || (last - length).abs() > slack {
        let (first, last, length) = (plain(first), plain(last), plain(length));
        return fault(format!(
            "`{name}`: y runs from {first} to {last} mm; expected 0 to the length, {length} mm"
        ));
    }
    true
}

fn check_outline(s: &Section<'_>, g: &Geometry) {
    let Some(outline) = &g.outline else { return };
    let heights: Vec<f64> = outline.iter().map(|r| r[0]).collect();
    if !check_heights(s, "outline", g.length, &heights) {
        return;
    }
    if let Some(i) = outline.iter().position(|r| r[2] <= r[1]) {
        let [y, left, right] = outline[i].map(plain);
        let message = format!(
            "`outline`: at y = {y} mm the right edge ({right} mm) is not right of the left edge ({left} mm)"
        );
        s.fault("outline", message);
    }
}

fn check_thickness(s: &Section<'_>, g: &Geometry) {
    let Some(profile) = &g.thickness_profile else { return };
    let heights: Vec<f64> = profile.iter().map(|r| r[0]).collect();
    if !check_heights(s, "thickness_profile", g.length, &heights) {
        return;
    }
    if let Some(row) = profile.iter().find(|r| r[1] <= 0.0) {
        let (y, h) = (plain(row[0]), plain(row[1]));
        s.fault(
            "thickness_profile",
            format!("`thickness_profile`: at y = {y} mm the thickness is {h} mm; expected more than 0"),
        );
    }
}
