//! Eight-node brick with mean dilatation (Q1P0; Simo, Taylor, Pister 1985,
//! doi:10.1016/0045-7825(85)90033-7), the counterpart of Abaqus's C3D8H.
//!
//! The law sees one gradient, F̄ = (J̄/J)^⅓ F with J̄ = ∫J dV / ∫dV, and the residual is the virtual
//! work ∫ P(F̄) : δF̄ dV: for an elastic law the exact gradient of ∫Ψ(F̄) dV, so that the tangent is
//! symmetric whenever the law's is. For a split energy this is the three-field element with
//! constant pressure and dilatation.

mod deformation;
mod forces;
mod history;
mod tangent;
mod volume;

pub use forces::forces;
pub use history::{HistoryTangent, update_history};
pub use tangent::{Scratch, Tangent, tangent};
pub use volume::{Pressure, Volume};

use constitutive::{Context, Law, Over, PointLaw, Scalar, tensor};

/// Integration points of the brick (2 × 2 × 2 Gauss).
pub const POINTS: usize = 8;
/// Unknowns of the brick.
pub const DOFS: usize = 24;
/// Entries of the lower triangle of its tangent.
pub const PACKED: usize = DOFS * (DOFS + 1) / 2;

/// Corner signs in VTK order.
const CORNERS: [[f64; 3]; 8] = [
    [-1.0, -1.0, -1.0],
    [1.0, -1.0, -1.0],
    [1.0, 1.0, -1.0],
    [-1.0, 1.0, -1.0],
    [-1.0, -1.0, 1.0],
    [1.0, -1.0, 1.0],
    [1.0, 1.0, 1.0],
    [-1.0, 1.0, 1.0],
];

/// Shape gradients in the reference configuration and point volumes.
#[derive(Clone, Debug)]
pub struct Geometry<X> {
    /// ∂N_a/∂X_j at each point, 1/mm: `gradients[point][j][a]`.
    pub gradients: [[[X; 8]; 3]; POINTS],
    /// Reference volume of each point, mm³.
    pub volumes: [X; POINTS],
}

/// Geometry from the eight reference positions, mm.
pub fn geometry<X: Scalar>(nodes: &[[X; 3]; 8]) -> Geometry<X> {
    let g = 1.0 / 3f64.sqrt();
    let mut out = Geometry { gradients: [[[X::zero(); 8]; 3]; POINTS], volumes: [X::zero(); POINTS] };
    for q in 0..POINTS {
        let xi = CORNERS[q].map(|c| c * g);
        let local = local_gradients(xi);
        let mut jac = [X::zero(); 9]; // ∂X_i/∂ξ_j
        for a in 0..8 {
            for i in 0..3 {
                for j in 0..3 {
                    jac[3 * i + j] += nodes[a][i] * local[a][j];
                }
            }
        }
        let det = tensor::det(&jac);
        let inv = tensor::inverse(&jac); // ∂ξ_j/∂X_i at [3 j + i]
        for a in 0..8 {
            for i in 0..3 {
                let mut s = X::zero();
                for j in 0..3 {
                    s += inv[3 * j + i] * local[a][j];
                }
                out.gradients[q][i][a] = s;
            }
        }
        out.volumes[q] = det;
    }
    out
}

fn local_gradients(xi: [f64; 3]) -> [[f64; 3]; 8] {
    CORNERS.map(|c| {
        let f = [1.0 + c[0] * xi[0], 1.0 + c[1] * xi[1], 1.0 + c[2] * xi[2]];
        [0.125 * c[0] * f[1] * f[2], 0.125 * c[1] * f[0] * f[2], 0.125 * c[2] * f[0] * f[1]]
    })
}

/// Everything about the deformation that the residual needs, at all points.
struct Kinematics<X> {
    f_bar: [[X; 9]; POINTS],
    /// Spatial shape gradients F⁻ᵀ ∂N/∂X.
    spatial: [[[X; 3]; 8]; POINTS],
    /// Current point volumes w J.
    current: [X; POINTS],
    volume: X,
    /// Volume average of the spatial gradients (mean dilatation).
    mean: [[X; 3]; 8],
    smallest_j: f64,
}

#[inline(always)]
fn kinematics<X: Scalar>(geo: &Geometry<X>, u: &[[X; 3]; 8]) -> Kinematics<X> {
    let mut k = Kinematics {
        f_bar: [tensor::identity(); POINTS],
        spatial: [[[X::zero(); 3]; 8]; POINTS],
        current: [X::zero(); POINTS],
        volume: X::zero(),
        mean: [[X::zero(); 3]; 8],
        smallest_j: f64::INFINITY,
    };
    let mut reference = X::zero();
    let mut j_point = [X::zero(); POINTS];
    for q in 0..POINTS {
        let f = &mut k.f_bar[q];
        for a in 0..8 {
            for i in 0..3 {
                for j in 0..3 {
                    f[3 * i + j] += u[a][i] * geo.gradients[q][j][a];
                }
            }
        }
        let cof = tensor::cofactor(f);
        let det = f[0] * cof[0] + f[1] * cof[1] + f[2] * cof[2];
        let r = det.recip();
        for a in 0..8 {
            let g = geo.gradients[q].map(|d| d[a]);
            for i in 0..3 {
                k.spatial[q][a][i] = (cof[3 * i] * g[0] + cof[3 * i + 1] * g[1] + cof[3 * i + 2] * g[2]) * r;
            }
        }
        k.smallest_j = k.smallest_j.min(det.value());
        j_point[q] = det;
        k.current[q] = geo.volumes[q] * det;
        k.volume += k.current[q];
        reference += geo.volumes[q];
    }
    let per_volume = k.volume.recip();
    for q in 0..POINTS {
        let w = k.current[q] * per_volume;
        for a in 0..8 {
            for i in 0..3 {
                k.mean[a][i] += k.spatial[q][a][i] * w;
            }
        }
    }
    if k.smallest_j > 0.0 {
        let j_bar = k.volume * reference.recip();
        for q in 0..POINTS {
            let s = (j_bar * j_point[q].recip()).cbrt();
            for c in &mut k.f_bar[q] {
                *c = *c * s;
            }
        }
    }
    k
}

fn largest_stretch(f: &[f64; 9]) -> f64 {
    (0..3).map(|j| (f[j].powi(2) + f[3 + j].powi(2) + f[6 + j].powi(2)).sqrt()).fold(0.0, f64::max)
}

/// Residual of a brick over any scalar: kinematics over `X`, law over `S`.
///
/// `old`, `new`: histories of the 8 points, one after the other. With `X = f64` only parameters
/// and history carry derivatives (partial sweep); with `X = S` displacements and node positions do
/// too (total sweep).
#[allow(clippy::too_many_arguments)]
pub fn residual<X: Scalar, S: Scalar + Over<X>>(
    law: &(dyn PointLaw<9> + 'static),
    ctx: &Context,
    params: &[S],
    geo: &Geometry<X>,
    u: &[[X; 3]; 8],
    old: &[S],
    new: &mut [S],
) -> [[S; 3]; 8]
where
    dyn PointLaw<9>: Law<S, 9>,
{
    let k = kinematics(geo, u);
    let nh = old.len() / POINTS;
    let mut r = [[S::zero(); 3]; 8];
    let mut pressure = S::zero();
    for q in 0..POINTS {
        let f = k.f_bar[q].map(S::lift);
        let h = q * nh..(q + 1) * nh;
        let p = law.respond(ctx, &f, params, &old[h.clone()], &mut new[h]).force;
        let mut tau = [S::zero(); 9];
        for i in 0..3 {
            for j in 0..3 {
                let mut s = S::zero();
                for m in 0..3 {
                    s += p[3 * i + m].times(k.f_bar[q][3 * j + m]);
                }
                tau[3 * i + j] = s.times(geo.volumes[q]);
            }
        }
        let mean = (tau[0] + tau[4] + tau[8]) * (1.0 / 3.0);
        pressure += mean;
        for d in [0, 4, 8] {
            tau[d] -= mean;
        }
        for a in 0..8 {
            for i in 0..3 {
                let mut s = r[a][i];
                for j in 0..3 {
                    s += tau[3 * i + j].times(k.spatial[q][a][j]);
                }
                r[a][i] = s;
            }
        }
    }
    for a in 0..8 {
        for i in 0..3 {
            r[a][i] += pressure.times(k.mean[a][i]);
        }
    }
    r
}

/// F̄ at the points, for energies and fields.
pub fn mean_dilatation_gradients(geo: &Geometry<f64>, u: &[[f64; 3]; 8]) -> [[f64; 9]; POINTS] {
    kinematics(geo, u).f_bar
}
