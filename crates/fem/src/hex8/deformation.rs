//! Deformation of a brick in plain numbers, in lanes over its nodes, and what it makes of stresses: common to
//! the tangent and to forces alone.

use super::{DOFS, Geometry, POINTS};
use crate::error::ElementFault;
use constitutive::tensor;
use wide::f64x8;

/// One number per node.
pub type Lane = f64x8;
pub type Matrix = [f64; 9];

pub const NO_LANES: [Lane; 3] = [Lane::ZERO; 3];

/// Sum of three lanes.
#[inline(always)]
pub fn combine(m: [f64; 3], x: &[Lane; 3]) -> Lane {
    let m = m.map(Lane::splat);
    m[2].mul_add(x[2], m[1].mul_add(x[1], m[0] * x[0]))
}

/// Deformation at the points.
pub struct Deformation {
    /// F, then F̄.
    pub f: [Matrix; POINTS],
    /// ∂N/∂x, by direction.
    pub spatial: [[Lane; 3]; POINTS],
    /// w J.
    pub current: [f64; POINTS],
    /// J, before F̄.
    pub j: [f64; POINTS],
    /// Current, mm³.
    pub volume: f64,
    /// Volume average of the spatial gradients.
    pub mean: [Lane; 3],
}

/// Deformation by the displacements.
///
/// # Errors
/// [`ElementFault::Inverted`].
#[inline(always)]
pub fn deform(element: usize, geo: &Geometry<f64>, u: &[Lane; 3]) -> Result<Deformation, ElementFault> {
    let mut d = Deformation {
        f: [tensor::identity(); POINTS],
        spatial: [NO_LANES; POINTS],
        current: [0.0; POINTS],
        j: [0.0; POINTS],
        volume: 0.0,
        mean: NO_LANES,
    };
    for q in 0..POINTS {
        let (f, g) = (&mut d.f[q], &geo.gradients[q].map(Lane::from));
        for i in 0..3 {
            for j in 0..3 {
                f[3 * i + j] += (u[i] * g[j]).reduce_add();
            }
        }
        let cof = tensor::cofactor(f);
        let det = f[0] * cof[0] + f[1] * cof[1] + f[2] * cof[2];
        let r = 1.0 / det;
        for i in 0..3 {
            d.spatial[q][i] = combine([cof[3 * i] * r, cof[3 * i + 1] * r, cof[3 * i + 2] * r], g);
        }
        d.j[q] = det;
        d.current[q] = geo.volumes[q] * det;
        d.volume += d.current[q];
    }
    for q in 0..POINTS {
        let share = d.current[q] / d.volume;
        for i in 0..3 {
            d.mean[i] = d.spatial[q][i].mul_add(Lane::splat(share), d.mean[i]);
        }
    }
    let least = d.j.iter().copied().fold(f64::INFINITY, f64::min);
    if least <= 0.0 || d.volume.is_nan() {
        return Err(ElementFault::Inverted { element, jacobian: least });
    }
    Ok(d)
}

/// Displacements by direction, in lanes over the nodes.
#[inline(always)]
pub fn lanes_of(u: &[[f64; 3]; 8]) -> [Lane; 3] {
    std::array::from_fn(|i| Lane::new(std::array::from_fn(|a| u[a][i])))
}

impl Deformation {
    /// F becomes F̄ at a point, which the law sees; the factor.
    #[inline(always)]
    pub fn dilate(&mut self, q: usize, j_bar: f64) -> f64 {
        let scale = constitutive::Scalar::cbrt(j_bar / self.j[q]);
        for c in &mut self.f[q] {
            *c *= scale;
        }
        scale
    }

    /// # Errors
    /// [`ElementFault::Overflow`].
    pub fn finite(&self, element: usize, pressure: f64) -> Result<(), ElementFault> {
        if pressure.is_finite() {
            return Ok(());
        }
        let stretch = self.f.iter().map(super::largest_stretch).fold(0.0, f64::max);
        Err(ElementFault::Overflow { element, stretch })
    }

    /// What a point's stress adds to the residual; `g` is F̄'s gradient, by J.
    #[inline(always)]
    pub fn add_forces(&self, q: usize, w: f64, p: &Matrix, mean: f64, g: &[Lane; 3], to: &mut [Lane; 3]) {
        let hydrostatic = Lane::splat(-w * mean);
        for i in 0..3 {
            let row = [w * p[3 * i], w * p[3 * i + 1], w * p[3 * i + 2]];
            to[i] += hydrostatic.mul_add(self.spatial[q][i], combine(row, g));
        }
    }

    /// Adds the pressure to a residual and writes it node by node.
    #[inline(always)]
    pub fn close(&self, pressure: f64, residual: &mut [Lane; 3], forces: &mut [f64; DOFS]) {
        for i in 0..3 {
            residual[i] = self.mean[i].mul_add(Lane::splat(pressure), residual[i]);
            for (a, r) in residual[i].as_array().iter().enumerate() {
                forces[3 * a + i] = *r;
            }
        }
    }
}
