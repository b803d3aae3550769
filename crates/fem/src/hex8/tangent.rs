//! Residual and tangent of the brick in plain numbers: the hot loop.
//!
//! With G_aJ = s ∂N_a/∂X_J and s = (J̄/J)^⅓, the gradient that the law sees varies by
//! δF̄_iJ = Σ_a u_ai G_aJ + α F̄_iJ, where α = (θ̄ − tr l)/3 is the change that mean dilatation makes.
//! With P and A = ∂P/∂F̄ at F̄ and p = tr(P F̄ᵀ)/3 the second variation of the element energy is
//!
//! ```text
//! Σ w [ δF̄:A:ΔF̄ + β P:(LF̄) + α P:(lF̄) + 3 p αβ + p tr(l L) ] + (Σ w p) Δθ̄
//! ```
//!
//! (docs/theory.md). The last two terms act through F̄⁻¹ like a modulus, so they are folded into A
//! before it meets the shape gradients: what remains per node pair is 3 + 2 products.
//!
//! The pressure of the law is that of the volume at hand. That of the tangent's geometric part need not be: with
//! a bulk modulus thousands of times the matrix's stiffness it comes from the volume as linearised by the
//! Newton step ([`Pressure`]), since the second order that the step leaves in the volume would swamp it.
//!
//! Everything is laid out in lanes over the eight nodes.

use super::deformation::{Deformation, Lane, Matrix, NO_LANES, combine, deform, lanes_of};
use super::volume::{Pressure, Volume};
use super::{DOFS, Geometry, POINTS};
use crate::error::ElementFault;
use constitutive::{Context, Describe, PointLaw, tangent_by_jets_9, tensor};
use wide::{f64x4, f64x8};

/// Result buffers of [`tangent`].
#[derive(Clone, Debug)]
pub struct Tangent {
    /// Residual, N.
    pub residual: [f64; DOFS],
    /// Lower triangle by rows, N/mm: `rows[i][k][b]` stands for row i and unknown k of node b, as far
    /// as b is not beyond the row's own node. What lies beyond is void.
    pub rows: [[[f64; 8]; 3]; DOFS],
    /// Volume and pressure there.
    pub volume: Volume,
}

impl Default for Tangent {
    fn default() -> Self {
        Self { residual: [0.0; DOFS], rows: [[[0.0; 8]; 3]; DOFS], volume: Volume::default() }
    }
}

/// Working memory of [`tangent`], kept between bricks: clearing it each time would cost as much as
/// the law.
pub struct Scratch {
    answers: [Answer; POINTS],
    points: [Point; POINTS],
}

impl Default for Scratch {
    fn default() -> Self {
        Self { answers: [NO_ANSWER; POINTS], points: [NO_POINT; POINTS] }
    }
}

impl Tangent {
    /// ∂residual_i/∂u_j, N/mm.
    pub fn entry(&self, i: usize, j: usize) -> f64 {
        let (i, j) = (i.max(j), i.min(j));
        self.rows[i][j % 3][j / 3]
    }
}

/// What one point needs in the sum over the node pairs.
#[derive(Clone, Copy)]
struct Point {
    /// G_aJ, by J.
    g: [Lane; 3],
    /// w (F̄:A + P)_kL G_bL + ½ w s α_bk, by direction k.
    h: [Lane; 3],
    /// (mean gradient − gradient)/3, by direction.
    alpha: [Lane; 3],
    /// G_aJ A'_iJkL, by i and kL.
    c: [[Lane; 9]; 3],
}

const NO_POINT: Point = Point { g: NO_LANES, h: NO_LANES, alpha: NO_LANES, c: [[Lane::ZERO; 9]; 3] };

/// Stress and modulus of the law at a point.
#[derive(Clone, Copy)]
struct Answer {
    p: Matrix,
    a: [Matrix; 9],
    mean_stress: f64,
}

const NO_ANSWER: Answer = Answer { p: [0.0; 9], a: [[0.0; 9]; 9], mean_stress: 0.0 };

/// Residual and tangent.
///
/// # Errors
/// [`ElementFault`]: the brick is turned inside out, or the law overflows.
#[allow(clippy::too_many_arguments)]
pub fn tangent(
    element: usize,
    law: &(dyn PointLaw<9> + 'static),
    ctx: &Context,
    params: &[f64],
    geo: &Geometry<f64>,
    u: &[[f64; 3]; 8],
    pressure_of: Pressure<'_>,
    old: &[f64],
    new: &mut [f64],
    scratch: &mut Scratch,
    out: &mut Tangent,
) -> Result<(), ElementFault> {
    let lanes = lanes_of(u);
    let mut d = deform(element, geo, &lanes)?;
    let j_bar = d.volume / geo.volumes.iter().sum::<f64>();
    let nh = old.len() / POINTS;
    let (Scratch { answers, points }, Tangent { residual: forces, rows, volume }) = (scratch, out);
    let (mut pressure, mut scales) = (0.0, [0.0; POINTS]);
    for q in 0..POINTS {
        scales[q] = d.dilate(q, j_bar);
        let (f, answer, h) = (&d.f[q], &mut answers[q], q * nh..(q + 1) * nh);
        (answer.p, answer.a) =
            match Describe::analytic_tangent(law, ctx, f, params, &old[h.clone()], &mut new[h.clone()]) {
                Some(done) => done,
                None => tangent_by_jets_9(law, ctx, f, params, &old[h.clone()], &mut new[h]),
            };
        answer.mean_stress = answer.p.iter().zip(f).map(|(p, f)| p * f).sum::<f64>() / 3.0;
        pressure += geo.volumes[q] * answer.mean_stress;
    }
    d.finite(element, pressure)?;
    *volume = Volume::at(lanes, d.mean, d.volume, pressure, pressure_of);
    let linearised = pressure - volume.excess;
    let (mut residual, mut stiffness) = (NO_LANES, 0.0);
    for q in 0..POINTS {
        let (w, scale) = (geo.volumes[q], Lane::splat(scales[q]));
        points[q].g = geo.gradients[q].map(|g| Lane::from(g) * scale);
        stiffness += w * prepare(&d, q, w, &mut answers[q], linearised, &mut points[q], &mut residual);
    }
    volume.stiffness = stiffness - pressure;
    d.close(pressure, &mut residual, forces);
    for a in 0..4 {
        rows_of_low_node(points, &d.mean, pressure, a, rows);
    }
    for a in 4..8 {
        rows_of_high_node(points, &d.mean, pressure, a, rows);
    }
    Ok(())
}

/// What a point contributes, in lanes over the nodes; its residual is added at once. Returns the slope of its
/// mean stress against the logarithm of the volume.
#[inline(always)]
fn prepare(
    d: &Deformation,
    q: usize,
    w: f64,
    answer: &mut Answer,
    pressure: f64,
    point: &mut Point,
    residual: &mut [Lane; 3],
) -> f64 {
    let (f, p, a) = (&d.f[q], &answer.p, &mut answer.a);
    // M = F̄:A + P and s = M:F̄.
    let mut m = *p;
    for r in 0..9 {
        for c in 0..9 {
            m[c] += f[r] * a[r][c];
        }
    }
    let s: f64 = m.iter().zip(f).map(|(m, f)| m * f).sum();
    let (third, half_s) = (Lane::splat(1.0 / 3.0), Lane::splat(0.5 * w * s));
    let row = |x: &Matrix, i: usize| [w * x[3 * i], w * x[3 * i + 1], w * x[3 * i + 2]];
    for i in 0..3 {
        point.alpha[i] = (d.mean[i] - d.spatial[q][i]) * third;
        point.h[i] = half_s.mul_add(point.alpha[i], combine(row(&m, i), &point.g));
    }
    d.add_forces(q, w, p, answer.mean_stress, &point.g, residual);
    fold_in(a, w, d.current[q] / d.volume * pressure, answer.mean_stress, &inverse_transposed(f));
    for i in 0..3 {
        for kl in 0..9 {
            point.c[i][kl] = combine([a[3 * i][kl], a[3 * i + 1][kl], a[3 * i + 2][kl]], &point.g);
        }
    }
    s / 9.0
}

/// A ← w A + share F̄⁻ᵀ⊗F̄⁻ᵀ + (w p − share) of the same with the legs crossed.
#[inline(always)]
fn fold_in(a: &mut [Matrix; 9], w: f64, share: f64, mean_stress: f64, t: &Matrix) {
    let exchange = w * mean_stress - share;
    for i in 0..3 {
        for j in 0..3 {
            let (row, own) = (&mut a[3 * i + j], share * t[3 * i + j]);
            for k in 0..3 {
                let cross = exchange * t[3 * k + j];
                for l in 0..3 {
                    row[3 * k + l] = w * row[3 * k + l] + (own * t[3 * k + l] + cross * t[3 * i + l]);
                }
            }
        }
    }
}

#[inline(always)]
fn inverse_transposed(f: &Matrix) -> Matrix {
    let cof = tensor::cofactor(f);
    let r = 1.0 / (f[0] * cof[0] + f[1] * cof[1] + f[2] * cof[2]);
    cof.map(|c| c * r)
}

/// The three rows of a node, over the columns of the first nodes, summed over the points: the same
/// for the four nodes that need half a lane and for those that need a whole one.
macro_rules! rows_of_node {
    ($name:ident, $lane:ty, $part:expr) => {
        #[inline(always)]
        fn $name(
            points: &[Point; POINTS],
            mean: &[Lane; 3],
            pressure: f64,
            a: usize,
            rows: &mut [[[f64; 8]; 3]; DOFS],
        ) {
            let part = $part;
            let columns = mean.map(part);
            let mut acc: [[$lane; 3]; 3] = std::array::from_fn(|i| {
                let factor = <$lane>::splat(-pressure * mean[i].as_array()[a]);
                columns.map(|c| factor * c)
            });
            for point in points {
                let (g, h, alpha) = (point.g.map(part), point.h.map(part), point.alpha.map(part));
                for i in 0..3 {
                    let own_alpha = <$lane>::splat(point.alpha[i].as_array()[a]);
                    let own_h = <$lane>::splat(point.h[i].as_array()[a]);
                    for k in 0..3 {
                        let mut sum = own_h.mul_add(alpha[k], own_alpha.mul_add(h[k], acc[i][k]));
                        for l in 0..3 {
                            let c = <$lane>::splat(point.c[i][3 * k + l].as_array()[a]);
                            sum = c.mul_add(g[l], sum);
                        }
                        acc[i][k] = sum;
                    }
                }
            }
            for i in 0..3 {
                for k in 0..3 {
                    let lane = acc[i][k].to_array();
                    rows[3 * a + i][k][..lane.len()].copy_from_slice(&lane);
                }
            }
        }
    };
}

rows_of_node!(rows_of_high_node, f64x8, |x: Lane| x);
rows_of_node!(rows_of_low_node, f64x4, |x: Lane| {
    let v = x.to_array();
    f64x4::new([v[0], v[1], v[2], v[3]])
});
