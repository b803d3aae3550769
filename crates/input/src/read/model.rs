//! `[mesh]`

use super::scalar;
use super::section::Section;
use super::specimen::subsection;
use crate::case::Geometry;
use crate::config::{MeshConfig, Symmetry};
use crate::diagnostics::Report;
use crate::keys::plain;

/// More elements than any laptop solves.
const MOST_ELEMENTS: f64 = 4e6;
/// Most elements along one axis.
const MOST_DIVISIONS: i64 = 20_000;

/// `[mesh]`
pub(crate) fn mesh(top: &Section<'_>, geometry: &Geometry) -> MeshConfig {
    let s = subsection(top, "mesh");
    let bulk_size = s.number("bulk_size");
    let mesh = MeshConfig {
        divisions: divisions(&s),
        bulk_size,
        path_size: s.optional_number("path_size").unwrap_or(bulk_size.min(0.1)),
        layers: s.integer("layers"),
        symmetry: [Symmetry::Auto, Symmetry::None][s.choice("symmetry")],
    };
    if s.entry("divisions").is_some() {
        for name in ["bulk_size", "path_size", "layers"] {
            if s.entry(name).is_some() {
                let message = format!(
                    "`{}` has no meaning beside `divisions`; expected one or the other",
                    s.spelling(name)
                );
                s.fault(name, message);
            }
        }
        return mesh;
    }
    if mesh.path_size > mesh.bulk_size {
        let (path, bulk) = (plain(mesh.path_size), plain(mesh.bulk_size));
        let (name, other) = (s.spelling("path_size"), s.spelling("bulk_size"));
        s.fault("path_size", format!("`{name}` is {path} mm; expected no more than `{other}`, {bulk} mm"));
    }
    let count = (geometry.width / mesh.path_size) * (geometry.length / mesh.bulk_size) * mesh.layers as f64;
    if count > MOST_ELEMENTS {
        let name = if s.entry("path_size").is_some() { "path_size" } else { "bulk_size" };
        let message =
            format!("this mesh would have about {count:.0e} elements; expected at most {MOST_ELEMENTS:.0e}");
        s.fault(name, message);
    }
    mesh
}

fn divisions(s: &Section<'_>) -> Option<[usize; 3]> {
    let entry = s.entry("divisions")?;
    let expected = "three whole numbers, elements along x, y, z";
    let items = scalar::list(s.context, "divisions", entry.item, expected)?;
    if items.len() != 3 {
        scalar::wrong_type(s.context, "divisions", entry.item, expected);
        return None;
    }
    let mut out = [0; 3];
    for (n, item) in out.iter_mut().zip(items) {
        *n = usize::try_from(scalar::integer(s.context, "divisions", item, 1, MOST_DIVISIONS)?).ok()?;
    }
    let count = out.iter().map(|&n| n as f64).product::<f64>();
    if count > MOST_ELEMENTS {
        let message = format!("`divisions` make {count:.1e} elements; expected at most {MOST_ELEMENTS:.0e}");
        s.context.report(Report::error(message).key("divisions"), entry.item.span());
    }
    Some(out)
}
