//! What is written: the canonical CSV, the specimen file.

use crate::error::visible;
use crate::geometry::Geometry;
use crate::import::Test;
use crate::rows::Rows;
use std::fmt::Write;

/// Names of the camera channels in the canonical form.
const CAMERA: [&str; 3] = ["grip_displacement_mm", "tear_front_mm", "width_change_mm"];
/// Names of the channels of a second axis in the canonical form.
const ACROSS: [&str; 2] = ["displacement_x_mm", "force_x_N"];

/// The canonical CSV of a test; comments say where it is from. Numbers are the shortest that read back the same.
pub(crate) fn csv(rows: &Rows, comments: &[String]) -> String {
    let mut out = String::with_capacity(rows.len() * 40 + 200);
    for comment in comments {
        let _ = writeln!(out, "# {}", visible(comment));
    }
    out.push_str("time_s,displacement_mm,force_N");
    if !rows.label.is_empty() {
        out.push_str(",segment");
    }
    for (name, channel) in ACROSS.iter().zip(&rows.across).chain(CAMERA.iter().zip(&rows.camera)) {
        if channel.is_some() {
            let _ = write!(out, ",{name}");
        }
    }
    out.push('\n');
    for i in 0..rows.len() {
        let _ = write!(out, "{},{},{}", rows.time[i], rows.displacement[i], rows.force[i]);
        if !rows.label.is_empty() {
            let label = rows.labels.get(rows.label[i] as usize).map_or("", String::as_str);
            let _ = write!(out, ",{}", cell(label));
        }
        for channel in rows.across.iter().chain(&rows.camera).flatten() {
            // Empty: not seen at that time.
            let _ = if channel[i].is_finite() { write!(out, ",{}", channel[i]) } else { write!(out, ",") };
        }
        out.push('\n');
    }
    out
}

/// A text as a CSV cell on one line.
fn cell(text: &str) -> String {
    let text: String = visible(text);
    if text.contains([',', '"']) || text.trim() != text || text.starts_with('#') {
        format!("\"{}\"", text.trim().replace('"', "\"\""))
    } else {
        text
    }
}

/// A specimen file with these tests. What is not known of the geometry stands there as a comment to be filled in.
pub fn specimen(name: &str, provenance: &str, geometry: &Geometry, tests: &[Test]) -> String {
    let text = |s: &str| toml::Value::String(visible(s)).to_string();
    let mut out = format!("name = {}\nprovenance = {}\n\n[geometry]\n", text(name), text(provenance));
    let table = geometry.table.as_ref();
    out.push_str(&table.and_then(|t| toml::to_string(t).ok()).unwrap_or_default());
    for (name, value, what) in [
        ("length", geometry.length, "between the clamps, along the load"),
        ("width", geometry.width, "along the tear"),
        ("thickness", geometry.thickness, "through the strip"),
        ("cut", geometry.cut, "initial cut from the edge x = 0"),
    ] {
        let _ = match value {
            Some(_) if table.is_some_and(|t| crate::geometry::length(t, name).is_some()) => Ok(()),
            Some(v) => writeln!(out, "{name}_mm = {v:?}    # {what}; from the record's header"),
            None if table.is_some() && name == "cut" => Ok(()),
            None => writeln!(out, "# {name}_mm =     # {what}: not in the record; fill it in"),
        };
    }
    for test in tests {
        let _ = write!(
            out,
            "\n[[tests]]\nkind = {}\nname = {}\ndata = {}\n",
            text(&test.kind),
            text(&test.name),
            text(&format!("{}.csv", test.name))
        );
        if let (Some(_), Some(sd)) = (&test.reduction, test.force_sd_of_points) {
            let _ = writeln!(out, "force_sd_N = {sd:?}    # of the means, not of the rows in full/");
        }
    }
    out
}
