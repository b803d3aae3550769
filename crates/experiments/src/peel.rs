//! What peels share: a sheet that is split in its plane, and a plateau of the force.

use crate::Setting;
use input::{Balance, Geometry, Layout, Record, Symmetry};
use mesh::{MeshError, Strip};

/// A sheet that is split in its plane: x along the tear, y through the thickness, z across the width. `alike`: both arms
/// are held alike, so that the tear may be a mirror.
///
/// # Errors
/// What cannot be meshed.
pub fn split_strip(setting: &Setting<'_>, alike: bool) -> Result<Strip, MeshError> {
    let (case, g) = (setting.case, &setting.case.geometry);
    let [along, across, width] = Layout::Split.extents(g);
    let mut strip = Strip {
        cut: g.cut,
        path_y: g.path_y,
        tear: true,
        sizing: setting.sizing(),
        split: setting.split,
        ..Strip::new(across, along, width)
    };
    if case.mesh.symmetry == Symmetry::Auto && setting.mirrors {
        strip.half_thickness = true;
        let even = case.mesh.divisions.is_none_or(|d| d[1] % 2 == 0);
        strip.half_height = alike && setting.half_height && even && strip.is_symmetric(1e-6 * across);
    }
    Ok(strip)
}

/// Median force of the loading in the second half of the way, N: the plateau.
fn plateau(record: &Record) -> f64 {
    let most = record.displacement.iter().fold(0.0f64, |m, u| m.max(*u));
    let u = &record.displacement;
    let rising = |i: &usize| u[*i] > 0.5 * most && u[*i] >= u[*i - 1];
    let mut forces: Vec<f64> =
        (1..record.force.len()).filter(rising).map(|i| record.force[i].max(0.0)).collect();
    forces.sort_by(f64::total_cmp);
    forces.get(forces.len() / 2).copied().unwrap_or_default()
}

/// Toughness of arms that do not stretch, 2F/b, by the plateau.
pub fn plateau_balance(g: &Geometry, record: &Record) -> Option<Balance> {
    let gc = 2.0 * plateau(record) / g.width;
    let how = "at least, by 2 F/b of the plateau (arms that do not stretch; stretching arms make it more)";
    (gc > 0.0).then_some(Balance { gc, how })
}

/// Toughness of arms that do not stretch, 2F/b, and a strength of the order of the stress in an arm.
pub fn plateau_estimate(g: &Geometry, record: &Record) -> (f64, f64) {
    let force = plateau(record);
    (2.0 * force / g.width, 4.0 * force / (g.width * g.thickness))
}
