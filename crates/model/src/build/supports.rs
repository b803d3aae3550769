//! The strip that a test is meshed as, and which of its nodes are held or follow the grip.

use super::{BuildError, Discretisation};
use fem::Prescribed;
use input::{Case, Ends, Grips, Symmetry, Test, TestKind};
use mesh::{Mesh, Outline, Sizing, Strip};

pub(super) fn strip_of(
    case: &Case,
    test: &Test,
    half_height: bool,
    how: Discretisation,
) -> Result<Strip, mesh::MeshError> {
    let g = &case.geometry;
    let tear = test.kind == TestKind::Tearing;
    let homogeneous =
        test.ends == Ends::Sliding && !tear && g.outline.is_none() && g.thickness_profile.is_none();
    let alone = case.tests.iter().all(|t| t.kind == TestKind::Uniaxial && t.ends == Ends::Sliding);
    let sizing = match case.mesh.divisions {
        // A homogeneous state needs one element; only a history that later tests inherit needs more.
        _ if homogeneous && alone => Sizing::Divisions([1, 2, 1]),
        Some(d) => Sizing::Divisions(d),
        None => Sizing::Graded {
            bulk_size: case.mesh.bulk_size * how.coarsen,
            path_size: case.mesh.path_size * how.coarsen,
            layers: case.mesh.layers,
        },
    };
    let outline = g.outline.as_ref().map(|o| Outline::new(o)).transpose()?;
    let thickness_profile = g.thickness_profile.clone().map(mesh::Profile::thickness).transpose()?;
    let mut strip = Strip {
        cut: if homogeneous && alone { 0.0 } else { g.cut },
        path_y: g.path_y,
        tear,
        sizing,
        split: how.split,
        outline,
        thickness_profile,
        ..Strip::new(g.length, g.width, g.thickness)
    };
    if case.mesh.symmetry == Symmetry::Auto {
        strip.half_thickness = true;
        let even = case.mesh.divisions.is_none_or(|d| d[1] % 2 == 0) || (homogeneous && alone);
        strip.half_height = half_height && even && strip.is_symmetric(1e-6 * g.length);
    }
    Ok(strip)
}

/// Supports: which components are held, and which follow the grip.
pub(super) fn supports(mesh: &Mesh, test: &Test) -> Result<Vec<Option<Prescribed>>, BuildError> {
    let mut s: Vec<Option<Prescribed>> = vec![None; 3 * mesh.nodes.len()];
    let share = if mesh.half_height { 0.5 } else { 1.0 };
    let nodes = |name: &str| -> Result<&[usize], BuildError> {
        mesh.set(name)
            .ok_or_else(|| BuildError::Case(format!("test {}: the mesh has no `{name}`", test.name)))
    };
    let mut hold = |n: usize, c: usize, grip: f64| s[3 * n + c] = Some(Prescribed { grip, mount: 0.0 });
    if mesh.half_thickness {
        nodes("mid_thickness")?.iter().for_each(|&n| hold(n, 2, 0.0));
    }
    if mesh.half_height && test.kind == TestKind::Uniaxial {
        nodes("mid_height")?.iter().for_each(|&n| hold(n, 1, 0.0));
    }
    let lateral = test.ends == Ends::Clamped;
    match test.grips {
        Grips::Ends => {
            for &n in nodes("top")? {
                hold(n, 1, share);
                if lateral {
                    hold(n, 0, 0.0);
                    hold(n, 2, 0.0);
                }
            }
            if !mesh.half_height {
                for &n in nodes("bottom")? {
                    hold(n, 1, 0.0);
                    if lateral {
                        hold(n, 0, 0.0);
                        hold(n, 2, 0.0);
                    }
                }
            }
            if !lateral {
                hold_rigid_motion(mesh, &mut hold, nodes("left")?);
            }
        }
        Grips::Mouth => {
            for &n in nodes("mouth_top")? {
                hold(n, 1, share);
                hold(n, 0, 0.0);
            }
            if !mesh.half_height {
                for &n in nodes("mouth_bottom")? {
                    hold(n, 1, 0.0);
                    hold(n, 0, 0.0);
                }
            }
            if !mesh.half_thickness
                && let Some(&n) = nodes("mouth_top")?.first()
            {
                hold(n, 2, 0.0);
            }
        }
    }
    Ok(s)
}

/// Sliding ends leave the strip free to move sideways: one edge is kept straight.
fn hold_rigid_motion(mesh: &Mesh, hold: &mut impl FnMut(usize, usize, f64), left: &[usize]) {
    let homogeneous = mesh.interfaces.is_empty();
    let ends: Vec<usize> = if homogeneous {
        left.to_vec()
    } else {
        left.first().into_iter().chain(left.last()).copied().collect()
    };
    for n in ends {
        hold(n, 0, 0.0);
    }
    if !mesh.half_thickness {
        let low = mesh.nodes.iter().fold(f64::MAX, |m, x| m.min(x[2]));
        for (n, x) in mesh.nodes.iter().enumerate() {
            if (x[2] - low).abs() < 1e-12 && (homogeneous || left.contains(&n)) {
                hold(n, 2, 0.0);
            }
        }
    }
}
