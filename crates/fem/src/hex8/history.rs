//! The history of a brick after a step, and how it follows the displacements.

use super::{Geometry, POINTS, mean_dilatation_gradients};
use constitutive::{Context, Jet, Law, PointLaw, Scalar, history_tangent_9, tensor};

/// F̄ at the points: displacements over `S`, positions in plain numbers.
fn gradients<S: Scalar>(geo: &Geometry<f64>, u: &[[S; 3]; 8]) -> [[S; 9]; POINTS] {
    let mut f = [tensor::identity::<S>(); POINTS];
    let mut det = [S::zero(); POINTS];
    let (mut volume, mut reference) = (S::zero(), 0.0);
    for q in 0..POINTS {
        for a in 0..8 {
            for i in 0..3 {
                for j in 0..3 {
                    f[q][3 * i + j] += u[a][i].times(geo.gradients[q][j][a]);
                }
            }
        }
        det[q] = tensor::det(&f[q]);
        volume += det[q].times(geo.volumes[q]);
        reference += geo.volumes[q];
    }
    let j_bar = volume.times(1.0 / reference);
    for q in 0..POINTS {
        let s = (j_bar * det[q].recip()).cbrt();
        f[q] = f[q].map(|c| c * s);
    }
    f
}

/// The history after a step, without forces: displacements over `S`, positions in plain numbers.
pub fn update_history<S: Scalar>(
    law: &(dyn PointLaw<9> + 'static),
    ctx: &Context,
    params: &[S],
    geo: &Geometry<f64>,
    u: &[[S; 3]; 8],
    old: &[S],
    new: &mut [S],
) where
    dyn PointLaw<9>: Law<S, 9>,
{
    let nh = old.len() / POINTS;
    for (q, f_bar) in gradients(geo, u).iter().enumerate() {
        let h = q * nh..(q + 1) * nh;
        law.respond(ctx, f_bar, params, &old[h.clone()], &mut new[h]);
    }
}

/// A brick's new history and its derivative by the displacements: what all columns of a step share.
///
/// F̄ = s F with s = (J̄/J)^⅓ varies by s δF + α F̄, where α = (θ̄ − tr l)/3, tr l = F⁻ᵀ : δF and θ̄ is its mean over the
/// current volume.
#[derive(Clone, Debug, Default)]
pub struct HistoryTangent {
    new: Vec<f64>,
    /// ∂h/∂F̄, times s.
    rows: Vec<[f64; 9]>,
    /// ∂h/∂F̄ : F̄.
    along: Vec<f64>,
    points: [Dilatation; POINTS],
}

/// What a point needs for the change of its volume.
#[derive(Clone, Copy, Debug, Default)]
struct Dilatation {
    /// F⁻ᵀ.
    inverse: [f64; 9],
    /// Share of the brick's current volume.
    share: f64,
    /// (J̄/J)^⅓.
    s: f64,
}

impl HistoryTangent {
    /// At displacements `u`, from the history `old` of the 8 points, one after the other.
    pub fn fill(
        &mut self,
        law: &(dyn PointLaw<9> + 'static),
        ctx: &Context,
        params: &[f64],
        geo: &Geometry<f64>,
        u: &[[f64; 3]; 8],
        old: &[f64],
    ) {
        let nh = old.len() / POINTS;
        self.new.resize(old.len(), 0.0);
        self.rows.resize(old.len(), [0.0; 9]);
        self.along.resize(old.len(), 0.0);
        self.dilate(geo, u);
        // F̄ to the bit as the partial sweep has it: where a history is the larger of two values, both must take the same.
        for (q, f_bar) in mean_dilatation_gradients(geo, u).iter().enumerate() {
            let h = q * nh..(q + 1) * nh;
            let rows = &mut self.rows[h.clone()];
            history_tangent_9(law, ctx, f_bar, params, &old[h.clone()], &mut self.new[h.clone()], rows);
            for (row, along) in rows.iter_mut().zip(&mut self.along[h]) {
                *along = row.iter().zip(f_bar).map(|(r, f)| r * f).sum();
                *row = row.map(|r| self.points[q].s * r);
            }
        }
    }

    fn dilate(&mut self, geo: &Geometry<f64>, u: &[[f64; 3]; 8]) {
        let (mut volume, mut reference) = (0.0, 0.0);
        for (q, p) in self.points.iter_mut().enumerate() {
            let mut f = tensor::identity();
            for (k, x) in f.iter_mut().enumerate() {
                for (a, u) in u.iter().enumerate() {
                    *x += u[k / 3] * geo.gradients[q][k % 3][a];
                }
            }
            let cofactor = tensor::cofactor(&f);
            let j = tensor::det(&f);
            *p = Dilatation { inverse: cofactor.map(|c| c / j), share: j * geo.volumes[q], s: j };
            volume += p.share;
            reference += geo.volumes[q];
        }
        for p in &mut self.points {
            p.share /= volume;
            p.s = (volume / reference / p.s).cbrt();
        }
    }

    /// The new history without derivatives.
    pub fn values(&self) -> &[f64] {
        &self.new
    }

    /// Adds to the new history what it varies by the displacements, whose derivatives are those of `u`.
    pub fn carry<const W: usize>(&self, geo: &Geometry<f64>, u: &[[Jet<W>; 3]; 8], new: &mut [Jet<W>]) {
        let mut df = [[[0.0; W]; 9]; POINTS];
        let (mut trace, mut mean) = ([[0.0; W]; POINTS], [0.0; W]);
        for (q, p) in self.points.iter().enumerate() {
            for (k, to) in df[q].iter_mut().enumerate() {
                for (u, g) in u.iter().zip(&geo.gradients[q][k % 3]) {
                    add(to, *g, &u[k / 3].eps);
                }
                add(&mut trace[q], p.inverse[k], to);
            }
            add(&mut mean, p.share, &trace[q]);
        }
        let nh = self.rows.len() / POINTS;
        for q in 0..POINTS {
            let alpha: [f64; W] = std::array::from_fn(|c| (mean[c] - trace[q][c]) / 3.0);
            for (h, to) in new[q * nh..(q + 1) * nh].iter_mut().enumerate() {
                let row = &self.rows[q * nh + h];
                if *row == [0.0; 9] {
                    continue;
                }
                let mut sum = to.eps;
                row.iter().zip(&df[q]).for_each(|(slope, df)| add(&mut sum, *slope, df));
                add(&mut sum, self.along[q * nh + h], &alpha);
                to.eps = sum;
            }
        }
    }
}

#[inline(always)]
fn add<const W: usize>(to: &mut [f64; W], factor: f64, x: &[f64; W]) {
    for (to, x) in to.iter_mut().zip(x) {
        *to += factor * x;
    }
}
