//! A sheet that is meshed as it lies, in its plane.

use crate::Setting;
use input::{Ends, Symmetry};
use mesh::{MeshError, Outline, Profile, Sizing, Strip};

/// The strip of a sheet that is pulled in its plane, with or without a tear path.
///
/// # Errors
/// An outline or a thickness profile that is none.
pub fn flat_strip(setting: &Setting<'_>) -> Result<Strip, MeshError> {
    let (case, test) = (setting.case, setting.test);
    let (g, tear) = (&case.geometry, test.kind.tears);
    let homogeneous =
        test.ends == Ends::Sliding && !tear && g.outline.is_none() && g.thickness_profile.is_none();
    let alone = case.tests.iter().all(|t| !t.kind.tears && t.ends == Ends::Sliding);
    let one_element = homogeneous && alone;
    let outline = g.outline.as_ref().map(|o| Outline::new(o)).transpose()?;
    let thickness_profile = g.thickness_profile.clone().map(Profile::thickness).transpose()?;
    // The cut of a piece that another test splits is none across its width.
    let cut = if one_element || (!tear && g.cut >= g.width) { 0.0 } else { g.cut };
    let mut strip = Strip {
        cut,
        path_y: g.path_y,
        tear,
        // A homogeneous state needs one element; only a history that later tests inherit needs more.
        sizing: if one_element { Sizing::Divisions([1, 2, 1]) } else { setting.sizing() },
        split: setting.split,
        outline,
        thickness_profile,
        ..Strip::new(g.length, g.width, g.thickness)
    };
    if case.mesh.symmetry == Symmetry::Auto {
        strip.half_thickness = true;
        let even = case.mesh.divisions.is_none_or(|d| d[1] % 2 == 0) || one_element;
        strip.half_height = setting.half_height && even && strip.is_symmetric(1e-6 * g.length);
    }
    Ok(strip)
}

impl Setting<'_> {
    /// Element sizes as the file gives them, coarser where that is asked for.
    pub fn sizing(&self) -> Sizing {
        let mesh = &self.case.mesh;
        match mesh.divisions {
            Some(d) => Sizing::Divisions(d),
            None => Sizing::Graded {
                bulk_size: mesh.bulk_size * self.coarsen,
                path_size: mesh.path_size * self.coarsen,
                layers: mesh.layers,
            },
        }
    }
}
