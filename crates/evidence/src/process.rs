//! Noise and rest of one block as a Gaussian process with memory of four numbers, so that its covariance
//!
//! C = R (AR(1)) + τ² Matérn-3/2(ℓ₁) + υ² Ornstein–Uhlenbeck(ℓ₂)
//!
//! is whitened, inverted and sampled in time proportional to the number of points (Hartikainen & Särkkä 2010): a Kalman
//! filter's innovations, divided by their standard deviations, are L⁻¹v with C = L Lᵀ, exactly; the adjoint of
//! the filter is L⁻ᵀ. State: Matérn x and x'/λ, Ornstein–Uhlenbeck, AR(1) noise. The rest may begin anew with every
//! leg of the protocol, or be multiplied by the profile of what a model predicts; where that jumps a point has a variance
//! of its own.

use crate::rest::{RestForm, RestSize};
use inverse::Random;

/// Points of a block in order: path coordinates, gaps in sampling, noise; all in shares of the peak.
#[derive(Clone, Debug, PartialEq)]
pub struct Points {
    /// Path coordinate of each point, not decreasing.
    pub s: Vec<f64>,
    /// Sampling steps since the point before (1 where none is missing); the first is not used.
    pub gap: Vec<u32>,
    /// Noise standard deviation of one point.
    pub sd: f64,
    /// Correlation of neighbouring samples, −1 < ar1 < 1.
    pub ar1: f64,
    /// Which leg of the protocol each point belongs to; empty: all to one.
    pub leg: Vec<usize>,
}

impl Points {
    /// Whether two points belong to one leg of the protocol.
    pub(crate) fn on_one_leg(&self, i: usize, j: usize) -> bool {
        self.leg.get(i) == self.leg.get(j)
    }

    /// Covariance of the rest at two points; of a proportional one, to be multiplied by the profile at both.
    pub(crate) fn rest_covariance(&self, size: &RestSize, i: usize, j: usize) -> f64 {
        if size.form == RestForm::PerLeg && !self.on_one_leg(i, j) {
            return 0.0;
        }
        size.covariance((self.s[i] - self.s[j]).abs())
    }
}

type Vec4 = [f64; 4];

/// One step of the filter: transition, gain, 1/√S.
#[derive(Clone, Copy)]
struct Step {
    matern: [f64; 4],
    jerk: f64,
    noise: f64,
    gain: Vec4,
    weight: f64,
    /// What the rest is multiplied by here.
    factor: f64,
    /// Standard deviation of what is not known here besides noise and rest.
    unknown: f64,
}

impl Step {
    #[inline(always)]
    fn forward(&self, m: &Vec4) -> Vec4 {
        let a = &self.matern;
        [a[0] * m[0] + a[1] * m[1], a[2] * m[0] + a[3] * m[1], self.jerk * m[2], self.noise * m[3]]
    }

    #[inline(always)]
    fn backward(&self, m: &Vec4) -> Vec4 {
        let a = &self.matern;
        [a[0] * m[0] + a[2] * m[1], a[1] * m[0] + a[3] * m[1], self.jerk * m[2], self.noise * m[3]]
    }
}

/// The covariance of one block, ready to whiten.
pub struct Process<'a> {
    points: &'a Points,
    size: RestSize,
    steps: Vec<Step>,
    /// ln |C|.
    pub ln_det: f64,
}

fn transition(points: &Points, size: &RestSize, k: usize) -> Step {
    let zero = Step {
        matern: [0.0; 4],
        jerk: 0.0,
        noise: 0.0,
        gain: [0.0; 4],
        weight: 0.0,
        factor: 1.0,
        unknown: 0.0,
    };
    if k == 0 {
        return zero;
    }
    let noise = points.ar1.powi(i32::try_from(points.gap[k]).unwrap_or(i32::MAX));
    if size.form == RestForm::PerLeg && !points.on_one_leg(k - 1, k) {
        return Step { noise, ..zero };
    }
    let d = (points.s[k] - points.s[k - 1]).max(0.0);
    let a = 3f64.sqrt() * d / size.smooth_length;
    let e = (-a).exp();
    let matern = [e * (1.0 + a), e * a, -e * a, e * (1.0 - a)];
    Step { matern, jerk: (-d / size.jerk_length).exp(), noise, ..zero }
}

/// A P Aᵀ + P∞ − A P∞ Aᵀ: the stationary covariance is kept by every step.
fn one_step_ahead(step: &Step, p: &[Vec4; 4], at_rest: &Vec4) -> [Vec4; 4] {
    let mut rows = [[0.0; 4]; 4];
    for (i, row) in rows.iter_mut().enumerate() {
        let mut excess = p[i];
        excess[i] -= at_rest[i];
        *row = step.forward(&excess);
    }
    let mut out = [[0.0; 4]; 4];
    for j in 0..4 {
        let column = step.forward(&[rows[0][j], rows[1][j], rows[2][j], rows[3][j]]);
        for i in 0..4 {
            out[i][j] = column[i];
        }
        out[j][j] += at_rest[j];
    }
    out
}

impl<'a> Process<'a> {
    /// The covariance of these points, where the rest is not `proportional`.
    pub fn new(points: &'a Points, size: RestSize) -> Self {
        Self::beside(points, size, &[], &[])
    }

    /// The covariance of these points, for a model whose prediction has this `profile` (over its root mean square; 1 where nothing is
    /// given) and where it jumps is known to a standard deviation of `jumps` (shares of the peak; 0 where nothing is given).
    pub fn beside(points: &'a Points, size: RestSize, profile: &[f64], jumps: &[f64]) -> Self {
        let at_rest = [size.tau, size.tau, size.upsilon, points.sd].map(|x| x * x);
        let mut p = [[0.0; 4]; 4];
        for (i, v) in at_rest.iter().enumerate() {
            p[i][i] = *v;
        }
        let (mut steps, mut ln_det) = (Vec::with_capacity(points.s.len()), 0.0);
        for k in 0..points.s.len() {
            let mut step = transition(points, &size, k);
            if k > 0 {
                p = one_step_ahead(&step, &p, &at_rest);
            }
            step.factor =
                profile.get(k).copied().filter(|_| size.form == RestForm::Proportional).unwrap_or(1.0);
            step.unknown = jumps.get(k).copied().unwrap_or(0.0);
            let h = step.factor;
            let seen: Vec4 = std::array::from_fn(|i| h * (p[i][0] + p[i][2]) + p[i][3]);
            let variance = h * (seen[0] + seen[2]) + seen[3] + step.unknown.powi(2);
            let variance = variance.max(f64::MIN_POSITIVE);
            step.gain = seen.map(|x| x / variance);
            step.weight = variance.sqrt().recip();
            ln_det += variance.ln();
            for (row, gain) in p.iter_mut().zip(step.gain) {
                for (x, seen) in row.iter_mut().zip(seen) {
                    *x -= gain * seen;
                }
            }
            steps.push(step);
        }
        Self { points, size, steps, ln_det }
    }

    /// L⁻¹ v, in place.
    pub fn whiten(&self, v: &mut [f64]) {
        self.whiten_all(v, 1);
    }

    /// Number of points.
    pub(crate) fn points(&self) -> usize {
        self.steps.len()
    }

    /// L⁻¹ V of so many columns at once, in place; `v` holds them point by point.
    pub(crate) fn whiten_all(&self, v: &mut [f64], columns: usize) {
        let mut states = vec![[0.0; 4]; columns];
        for (row, step) in v.chunks_exact_mut(columns.max(1)).zip(&self.steps) {
            for (x, m) in row.iter_mut().zip(&mut states) {
                *m = step.forward(m);
                let innovation = *x - (step.factor * (m[0] + m[2]) + m[3]);
                for (m, gain) in m.iter_mut().zip(&step.gain) {
                    *m += gain * innovation;
                }
                *x = innovation * step.weight;
            }
        }
    }

    /// L⁻ᵀ w, in place.
    pub fn whiten_transposed(&self, w: &mut [f64]) {
        let mut m = [0.0; 4];
        for (x, step) in w.iter_mut().zip(&self.steps).rev() {
            let bar = *x * step.weight + (0..4).map(|i| step.gain[i] * m[i]).sum::<f64>();
            *x = bar;
            m[0] -= step.factor * bar;
            m[2] -= step.factor * bar;
            m[3] -= bar;
            m = step.backward(&m);
        }
    }

    /// C⁻¹ v, in place.
    pub fn solve(&self, v: &mut [f64]) {
        self.whiten(v);
        self.whiten_transposed(v);
    }

    /// R v: the covariance of the noise, and of what is unknown where the model jumps, times a vector.
    pub fn noise_times(&self, v: &[f64]) -> Vec<f64> {
        let variance = self.points.sd.powi(2);
        let noise = |step: &Step, sum: [f64; 2], x| [step.noise * (sum[0] + x), 0.0];
        let mut out = self.two_way(v, noise, |sum| variance * sum[0], variance);
        for ((out, v), step) in out.iter_mut().zip(v).zip(&self.steps) {
            *out += step.unknown.powi(2) * v;
        }
        out
    }

    /// K v: the rest's covariance times a vector.
    pub fn rest_times(&self, v: &[f64]) -> Vec<f64> {
        let times_factor = |v: &mut [f64]| v.iter_mut().zip(&self.steps).for_each(|(x, s)| *x *= s.factor);
        let mut v = v.to_vec();
        times_factor(&mut v);
        let (smooth, jerk) = (self.size.tau.powi(2), self.size.upsilon.powi(2));
        // Matérn: Σ (1 + a) e^{−a} v with a growing along the path: carry Σ e^{−a} v and Σ a e^{−a} v.
        let matern = |step: &Step, sum: [f64; 2], x: f64| {
            let (e, ea) = (step.matern[0] - step.matern[1], step.matern[1]);
            [e * (sum[0] + x), e * sum[1] + ea * (sum[0] + x)]
        };
        let mut out = self.two_way(&v, matern, |sum| smooth * (sum[0] + sum[1]), smooth);
        let ou = |step: &Step, sum: [f64; 2], x: f64| [step.jerk * (sum[0] + x), 0.0];
        let jerks = self.two_way(&v, ou, |sum| jerk * sum[0], jerk);
        out.iter_mut().zip(jerks).for_each(|(a, b)| *a += b);
        times_factor(&mut out);
        out
    }

    /// What comes from the points before, then from those behind, and the diagonal once.
    fn two_way(
        &self,
        v: &[f64],
        carry: impl Fn(&Step, [f64; 2], f64) -> [f64; 2],
        take: impl Fn([f64; 2]) -> f64,
        diagonal: f64,
    ) -> Vec<f64> {
        let n = v.len();
        let mut out: Vec<f64> = v.iter().map(|x| diagonal * x).collect();
        let mut sum = [0.0; 2];
        for k in 1..n {
            sum = carry(&self.steps[k], sum, v[k - 1]);
            out[k] += take(sum);
        }
        sum = [0.0; 2];
        for k in (1..n).rev() {
            sum = carry(&self.steps[k], sum, v[k]);
            out[k - 1] += take(sum);
        }
        out
    }

    /// One draw of the rest and one of the noise.
    pub fn draw(&self, random: &mut Random) -> (Vec<f64>, Vec<f64>) {
        let (mut rest, mut noise) = (Vec::new(), Vec::new());
        let (t, u, sd) = (self.size.tau, self.size.upsilon, self.points.sd);
        let mut m: Vec4 = std::array::from_fn(|_| random.normal());
        for (k, step) in self.steps.iter().enumerate() {
            if k > 0 {
                let a = &step.matern;
                // Cholesky of I − A Aᵀ; differences of nearly equal numbers may fall below zero.
                let q00 = (1.0 - a[0] * a[0] - a[1] * a[1]).max(0.0);
                let q01 = -(a[0] * a[2] + a[1] * a[3]);
                let q11 = (1.0 - a[2] * a[2] - a[3] * a[3]).max(0.0);
                let l00 = q00.sqrt();
                let l10 = if l00 > 0.0 { q01 / l00 } else { 0.0 };
                let (x, y) = (random.normal(), random.normal());
                let fresh = |phi: f64, z: f64| (1.0 - phi * phi).max(0.0).sqrt() * z;
                let (ou, ar) = (fresh(step.jerk, random.normal()), fresh(step.noise, random.normal()));
                m = step.forward(&m);
                m[0] += l00 * x;
                m[1] += l10 * x + (q11 - l10 * l10).max(0.0).sqrt() * y;
                m[2] += ou;
                m[3] += ar;
            }
            rest.push(step.factor * (t * m[0] + u * m[2]));
            let jump = if step.unknown > 0.0 { step.unknown * random.normal() } else { 0.0 };
            noise.push(sd * m[3] + jump);
        }
        (rest, noise)
    }
}

#[cfg(test)]
mod tests;
