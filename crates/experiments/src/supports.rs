//! Supports that several experiments share.

use crate::{SupportFault, Supports};
use fem::Prescribed;
use input::{Ends, Grips, Test};
use mesh::Mesh;

/// Supports while they are written.
pub struct Held<'a> {
    mesh: &'a Mesh,
    supports: Supports,
    /// Share of the grip's displacement that a pulled end makes: half of it where half the height is modelled.
    pub share: f64,
}

impl<'a> Held<'a> {
    /// All free but for the mirror planes of the model; without a tear path mid-height is one.
    ///
    /// # Errors
    /// [`SupportFault`].
    pub fn at_mirrors(mesh: &'a Mesh, test: &Test) -> Result<Self, SupportFault> {
        let share = if mesh.half_height { 0.5 } else { 1.0 };
        let mut held = Self { mesh, supports: vec![None; 3 * mesh.nodes.len()], share };
        if mesh.half_thickness {
            held.set("mid_thickness")?.iter().for_each(|&n| held.hold(n, 2, 0.0));
        }
        if mesh.half_height && !test.kind.tears {
            held.set("mid_height")?.iter().for_each(|&n| held.hold(n, 1, 0.0));
        }
        Ok(held)
    }

    /// The nodes of a set of the mesh.
    ///
    /// # Errors
    /// [`SupportFault`] if the mesh has no such set.
    pub fn set(&self, name: &str) -> Result<&'a [usize], SupportFault> {
        self.mesh.set(name).ok_or_else(|| SupportFault { set: name.to_owned() })
    }

    /// Component `c` of node `n` moves with this share of the grip's displacement.
    pub fn hold(&mut self, n: usize, c: usize, grip: f64) {
        self.supports[3 * n + c] = Some(Prescribed { grip, mount: 0.0 });
    }

    /// Component `c` of node `n` moves so from where it is mounted, `mount` mm from where it lies.
    pub fn mount(&mut self, n: usize, c: usize, grip: f64, mount: f64) {
        self.supports[3 * n + c] = Some(Prescribed { grip, mount });
    }

    /// What was written.
    pub fn done(self) -> Supports {
        self.supports
    }

    /// Sliding ends leave the strip free to move sideways: one edge is kept straight.
    fn hold_rigid_motion(&mut self, left: &[usize]) {
        let homogeneous = self.mesh.interfaces.is_empty();
        let ends: Vec<usize> = if homogeneous {
            left.to_vec()
        } else {
            left.first().into_iter().chain(left.last()).copied().collect()
        };
        for n in ends {
            self.hold(n, 0, 0.0);
        }
        if !self.mesh.half_thickness {
            let low = self.mesh.nodes.iter().fold(f64::MAX, |m, x| m.min(x[2]));
            for (n, x) in self.mesh.nodes.iter().enumerate() {
                if (x[2] - low).abs() < 1e-12 && (homogeneous || left.contains(&n)) {
                    self.hold(n, 2, 0.0);
                }
            }
        }
    }
}

/// Where the test says that its grips are: at the end faces, or at the mouth of the cut.
///
/// # Errors
/// [`SupportFault`].
pub fn at_the_grips(mesh: &Mesh, test: &Test) -> Result<Supports, SupportFault> {
    match test.grips {
        Grips::Ends => across_the_ends(mesh, test),
        Grips::Mouth => at_the_mouth(mesh, test),
    }
}

/// Both end faces y = 0 and y = length are held, and pulled apart along y; sideways they are held or slide.
///
/// # Errors
/// [`SupportFault`].
pub fn across_the_ends(mesh: &Mesh, test: &Test) -> Result<Supports, SupportFault> {
    let mut held = Held::at_mirrors(mesh, test)?;
    let lateral = test.ends == Ends::Clamped;
    let faces: &[(&str, f64)] =
        if mesh.half_height { &[("top", 0.5)] } else { &[("top", 1.0), ("bottom", 0.0)] };
    for &(face, grip) in faces {
        for &n in held.set(face)? {
            held.hold(n, 1, grip);
            if lateral {
                held.hold(n, 0, 0.0);
                held.hold(n, 2, 0.0);
            }
        }
    }
    if !lateral {
        let left = held.set("left")?;
        held.hold_rigid_motion(left);
    }
    Ok(held.done())
}

/// Pulled open at the two edges x = 0, y = 0 and y = length: a double-cantilever beam.
///
/// # Errors
/// [`SupportFault`].
pub fn at_the_mouth(mesh: &Mesh, test: &Test) -> Result<Supports, SupportFault> {
    let mut held = Held::at_mirrors(mesh, test)?;
    let share = held.share;
    for &n in held.set("mouth_top")? {
        held.hold(n, 1, share);
        held.hold(n, 0, 0.0);
    }
    if !mesh.half_height {
        for &n in held.set("mouth_bottom")? {
            held.hold(n, 1, 0.0);
            held.hold(n, 0, 0.0);
        }
    }
    if !mesh.half_thickness
        && let Some(&n) = held.set("mouth_top")?.first()
    {
        held.hold(n, 2, 0.0);
    }
    Ok(held.done())
}
