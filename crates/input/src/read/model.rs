//! `[mesh]`, `[bulk]`, `[interface]`

use super::scalar;
use super::section::Section;
use super::specimen::subsection;
use crate::case::Geometry;
use crate::config::{BulkConfig, FibreInvariants, InterfaceConfig, MeshConfig, Profile, Symmetry, Value};
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

/// `[bulk]`
pub(crate) fn bulk(top: &Section<'_>) -> BulkConfig {
    let s = subsection(top, "bulk");
    let d = match (s.entry("bulk_modulus"), s.entry("d")) {
        (Some(k), Some(d)) => {
            let message =
                format!("`{}` and `{}` mean the same (D = 2/K0); expected one of them", k.written, d.written);
            s.fault("d", message);
            Value::default()
        }
        (None, Some(_)) => s.parameter("d"),
        _ => inverse(s.parameter("bulk_modulus")),
    };
    BulkConfig {
        mu: s.parameter("mu"),
        k1: s.parameter("k1"),
        k2: s.parameter("k2"),
        gamma: s.parameter("gamma"),
        kappa: s.parameter("kappa"),
        d,
        tension_only: s.flag("tension_only"),
        fibre_invariants: [FibreInvariants::Isochoric, FibreInvariants::Full][s.choice("fibre_invariants")],
    }
}

/// D = 2/K0: the bounds change places, and a bound of 0 is none.
fn inverse(k: Value) -> Value {
    let two_over = |x: Option<f64>| x.map(|x| 2.0 / x).filter(|x| x.is_finite());
    Value { value: two_over(k.value), min: two_over(k.max), max: two_over(k.min), fixed: k.fixed }
}

/// `[interface]`
pub(crate) fn interface(top: &Section<'_>) -> InterfaceConfig {
    let s = subsection(top, "interface");
    let areas = s.checked_integer("areas");
    InterfaceConfig {
        areas: areas.unwrap_or(1),
        profile: [Profile::Piecewise, Profile::Smooth][s.choice("profile")],
        gc: s.parameter_list("gc", areas),
        sigma_c: s.parameter_list("sigma_c", areas),
        lambda: s.parameter("lambda"),
        penalty: s.parameter("penalty"),
    }
}
