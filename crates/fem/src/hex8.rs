//! Eight-node brick with mean dilatation (Q1P0; Simo, Taylor, Pister 1985,
//! doi:10.1016/0045-7825(85)90033-7), the counterpart of Abaqus's C3D8H.
//!
//! The law sees one gradient, F̄ = (J̄/J)^⅓ F with J̄ = ∫J dV / ∫dV, and the residual is the virtual
//! work ∫ P(F̄) : δF̄ dV: for an elastic law the exact gradient of ∫Ψ(F̄) dV, so that the tangent is
//! symmetric whenever the law's is. For a split energy this is the three-field element with
//! constant pressure and dilatation.

use crate::error::ElementFault;
use constitutive::{Context, Describe, Law, Over, PointLaw, Scalar, tangent_by_jets_9, tensor};

/// Integration points of the brick (2 × 2 × 2 Gauss).
pub const POINTS: usize = 8;
/// Unknowns of the brick.
pub const DOFS: usize = 24;
/// Entries of its packed lower triangle.
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
    /// ∂N_a/∂X at each point, 1/mm.
    pub gradients: [[[X; 3]; 8]; POINTS],
    /// Reference volume of each point, mm³.
    pub volumes: [X; POINTS],
}

/// Position of packed entry (i ≥ j).
#[inline(always)]
pub const fn packed(i: usize, j: usize) -> usize {
    i * (i + 1) / 2 + j
}

/// Geometry from the eight reference positions, mm.
pub fn geometry<X: Scalar>(nodes: &[[X; 3]; 8]) -> Geometry<X> {
    let g = 1.0 / 3f64.sqrt();
    let mut out = Geometry { gradients: [[[X::zero(); 3]; 8]; POINTS], volumes: [X::zero(); POINTS] };
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
                out.gradients[q][a][i] = s;
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
                    f[3 * i + j] += u[a][i] * geo.gradients[q][a][j];
                }
            }
        }
        let cof = tensor::cofactor(f);
        let det = f[0] * cof[0] + f[1] * cof[1] + f[2] * cof[2];
        let r = det.recip();
        for a in 0..8 {
            let g = &geo.gradients[q][a];
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
pub fn residual<X: Scalar, S: Over<X>>(
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

/// Result buffers of [`tangent`].
#[derive(Clone, Debug)]
pub struct Tangent {
    /// Residual, N.
    pub residual: [f64; DOFS],
    /// Lower triangle, packed by rows, N/mm.
    pub stiffness: [f64; PACKED],
}

impl Default for Tangent {
    fn default() -> Self {
        Self { residual: [0.0; DOFS], stiffness: [0.0; PACKED] }
    }
}

/// One point's share of the tangent, laid out in lanes over the eight nodes.
///
/// `Lane` = one number per node; the compiler turns loops over it into vector instructions.
type Lane = [f64; 8];

struct Point {
    /// Spatial shape gradients, by direction.
    g: [Lane; 3],
    /// w (g · a): for each row direction i, each column pair kl.
    c: [[Lane; 9]; 3],
    /// w (m g + ½ s α), by direction.
    h: [Lane; 3],
    /// (mean gradient − gradient)/3, by direction.
    alpha: [Lane; 3],
    /// Factor of g_ai g_bk.
    share: f64,
    /// Factor of g_ak g_bi.
    exchange: f64,
}

/// Kirchhoff stress τ and a_ijkl = F_jJ A_iJkL F_lL.
#[inline(always)]
fn spatial_response(p: &[f64; 9], a: &[[f64; 9]; 9], f: &[f64; 9]) -> ([f64; 9], [[f64; 9]; 9]) {
    let mut tau = [0.0; 9];
    for i in 0..3 {
        for j in 0..3 {
            tau[3 * i + j] = p[3 * i] * f[3 * j] + p[3 * i + 1] * f[3 * j + 1] + p[3 * i + 2] * f[3 * j + 2];
        }
    }
    // Left pair first, over whole rows; then the right pair.
    let mut half = [[0.0; 9]; 9];
    for i in 0..3 {
        for j in 0..3 {
            for c in 0..9 {
                half[3 * i + j][c] =
                    a[3 * i][c] * f[3 * j] + a[3 * i + 1][c] * f[3 * j + 1] + a[3 * i + 2][c] * f[3 * j + 2];
            }
        }
    }
    let mut modulus = [[0.0; 9]; 9];
    for row in 0..9 {
        for k in 0..3 {
            for l in 0..3 {
                modulus[row][3 * k + l] = half[row][3 * k] * f[3 * l]
                    + half[row][3 * k + 1] * f[3 * l + 1]
                    + half[row][3 * k + 2] * f[3 * l + 2];
            }
        }
    }
    (tau, modulus)
}

/// Residual and tangent in plain numbers: the hot loop.
///
/// With l = δF F⁻¹, α = (θ̄ − tr l)/3 and τ, a at F̄, the second variation of the element energy is
/// Σ w [ l̄ : a : L̄ + β τ:l + α τ:L + 3 p αβ + p tr(l L) ] + (Σ w p) Δθ̄ (docs/theory.md).
#[allow(clippy::too_many_arguments)]
pub fn tangent(
    element: usize,
    law: &(dyn PointLaw<9> + 'static),
    ctx: &Context,
    params: &[f64],
    geo: &Geometry<f64>,
    u: &[[f64; 3]; 8],
    old: &[f64],
    new: &mut [f64],
    out: &mut Tangent,
) -> Result<(), ElementFault> {
    let k = kinematics(geo, u);
    if k.smallest_j <= 0.0 || k.smallest_j.is_nan() {
        return Err(ElementFault::Inverted { element, jacobian: k.smallest_j });
    }
    let nh = old.len() / POINTS;
    let mut points: [Point; POINTS] = std::array::from_fn(|_| Point {
        g: [[0.0; 8]; 3],
        c: [[[0.0; 8]; 9]; 3],
        h: [[0.0; 8]; 3],
        alpha: [[0.0; 8]; 3],
        share: 0.0,
        exchange: 0.0,
    });
    let mut residual = [[0.0; 8]; 3];
    let mut mean_stress = [0.0; POINTS];
    let mut pressure = 0.0;
    for q in 0..POINTS {
        let h = q * nh..(q + 1) * nh;
        let f = &k.f_bar[q];
        let (p, a) = match Describe::hand_tangent(law, ctx, f, params, &old[h.clone()], &mut new[h.clone()]) {
            Some(done) => done,
            None => tangent_by_jets_9(law, ctx, f, params, &old[h.clone()], &mut new[h]),
        };
        let (tau, modulus) = spatial_response(&p, &a, f);
        mean_stress[q] = tensor::trace(&tau) / 3.0;
        pressure += geo.volumes[q] * mean_stress[q];
        prepare(&k, q, geo.volumes[q], &tau, &modulus, &mut points[q], &mut residual);
    }
    if !pressure.is_finite() {
        let stretch = k.f_bar.iter().map(largest_stretch).fold(0.0, f64::max);
        return Err(ElementFault::Overflow { element, stretch });
    }
    for q in 0..POINTS {
        points[q].share = k.current[q] / k.volume * pressure;
        points[q].exchange = geo.volumes[q] * mean_stress[q] - points[q].share;
    }
    let mut mean = [[0.0; 8]; 3];
    for a in 0..8 {
        for i in 0..3 {
            mean[i][a] = k.mean[a][i];
            out.residual[3 * a + i] = residual[i][a] + pressure * k.mean[a][i];
        }
    }
    for a in 0..8 {
        for i in 0..3 {
            stiffness_row(&points, &mean, pressure, a, i, &mut out.stiffness);
        }
    }
    Ok(())
}

/// What a point contributes, in lanes over the nodes; its residual is added at once.
#[inline(always)]
fn prepare(
    k: &Kinematics<f64>,
    q: usize,
    w: f64,
    tau: &[f64; 9],
    modulus: &[[f64; 9]; 9],
    point: &mut Point,
    residual: &mut [Lane; 3],
) {
    let p = tensor::trace(tau) / 3.0;
    let mut dev = *tau;
    for d in [0, 4, 8] {
        dev[d] -= p;
    }
    // m = I : a + τ (3 × 3), s = I : a : I + 3 p
    let mut m = *tau;
    for c in 0..9 {
        m[c] += modulus[0][c] + modulus[4][c] + modulus[8][c];
    }
    let s = m[0] + m[4] + m[8];
    for a in 0..8 {
        for i in 0..3 {
            point.g[i][a] = k.spatial[q][a][i];
            point.alpha[i][a] = (k.mean[a][i] - k.spatial[q][a][i]) / 3.0;
        }
    }
    let g = &point.g;
    for i in 0..3 {
        for b in 0..8 {
            residual[i][b] +=
                w * (dev[3 * i] * g[0][b] + dev[3 * i + 1] * g[1][b] + dev[3 * i + 2] * g[2][b]);
            point.h[i][b] = w
                * (m[3 * i] * g[0][b]
                    + m[3 * i + 1] * g[1][b]
                    + m[3 * i + 2] * g[2][b]
                    + 0.5 * s * point.alpha[i][b]);
        }
        for kl in 0..9 {
            let (m0, m1, m2) =
                (w * modulus[3 * i][kl], w * modulus[3 * i + 1][kl], w * modulus[3 * i + 2][kl]);
            for b in 0..8 {
                point.c[i][kl][b] = m0 * g[0][b] + m1 * g[1][b] + m2 * g[2][b];
            }
        }
    }
}

/// One row of the element stiffness, summed over the points, written to the packed triangle.
#[inline(always)]
fn stiffness_row(
    points: &[Point; POINTS],
    mean: &[Lane; 3],
    pressure: f64,
    a: usize,
    i: usize,
    packed_out: &mut [f64; PACKED],
) {
    let mut acc = [[0.0; 8]; 3];
    let f = pressure * mean[i][a];
    for k in 0..3 {
        for b in 0..8 {
            acc[k][b] = -f * mean[k][b];
        }
    }
    for point in points {
        let (alpha, h) = (point.alpha[i][a], point.h[i][a]);
        let share = point.share * point.g[i][a];
        for k in 0..3 {
            let (c0, c1, c2) = (point.c[i][3 * k][a], point.c[i][3 * k + 1][a], point.c[i][3 * k + 2][a]);
            let exchange = point.exchange * point.g[k][a];
            let (g, hk, ak, gi) = (&point.g, &point.h[k], &point.alpha[k], &point.g[i]);
            for b in 0..8 {
                acc[k][b] += c0 * g[0][b]
                    + c1 * g[1][b]
                    + c2 * g[2][b]
                    + alpha * hk[b]
                    + h * ak[b]
                    + exchange * gi[b]
                    + share * g[k][b];
            }
        }
    }
    let base = packed(3 * a + i, 0);
    for b in 0..=a {
        for (k, lane) in acc.iter().enumerate() {
            if b < a || k <= i {
                packed_out[base + 3 * b + k] = lane[b];
            }
        }
    }
}
