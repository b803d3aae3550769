//! The Gaussian integral over the parameters at one covariance, for every scale of the noise at once.
//!
//! In units of their beliefs the parameters are u ~ N(e, 1), and the whitened misfit is |S u − r|². With the eigenvalues s² of SᵀS and
//! p = Sᵀr in their directions, the least of |S u − r|²/κ² + |u − e|² is a sum for any scale κ,
//!
//! ```text
//! r²/κ² + Σ [s²e² − 2pe − p²/κ²]/(s² + κ²)     at     u = (p + κ²e)/(s² + κ²),
//! ```
//!
//! where a triangle would have to be made anew for each.

use crate::linear::{LN_TAU, Parameter, Reduced, told_apart};
use crate::truncated::{Belief, ln_box};
use nalgebra::{DMatrix, DVector};

/// A parameter with bounds: its place, and the bounds from the point of linearisation.
#[derive(Clone, Debug)]
struct Bounded {
    place: usize,
    lower: f64,
    upper: f64,
}

/// What is believed of the parameters and of the mesh's factors, as one way of asking has it.
#[derive(Clone, Debug)]
pub(crate) struct Beliefs {
    /// Means from the point of linearisation, then zeros for the mesh.
    mean: DVector<f64>,
    /// Standard deviations, then 1 for the mesh.
    sd: DVector<f64>,
    parameters: usize,
    bounded: Vec<Bounded>,
    /// ln of what the bounds leave of the beliefs.
    ln_mass: f64,
}

impl Beliefs {
    /// With the beliefs of amplitudes `wider`, beside so many factors of the mesh.
    pub fn new(parameters: &[Parameter], wider: f64, meshes: usize) -> Self {
        let belief =
            |p: &Parameter| Belief { sd: p.belief.sd * if p.amplitude { wider } else { 1.0 }, ..p.belief };
        let q = parameters.len() + meshes;
        let bounded: Vec<(usize, &Parameter)> = (parameters.iter().enumerate())
            .filter(|(_, p)| p.belief.lower.is_finite() || p.belief.upper.is_finite())
            .collect();
        let bound = |&(place, p): &(usize, &Parameter)| Bounded {
            place,
            lower: p.belief.lower - p.at,
            upper: p.belief.upper - p.at,
        };
        Self {
            mean: DVector::from_fn(q, |k, _| parameters.get(k).map_or(0.0, |p| p.belief.mean - p.at)),
            sd: DVector::from_fn(q, |k, _| parameters.get(k).map_or(1.0, |p| belief(p).sd)),
            parameters: parameters.len(),
            ln_mass: bounded.iter().map(|(_, p)| belief(p).ln_mass()).sum(),
            bounded: bounded.iter().map(bound).collect(),
        }
    }
}

/// A reduced model in the directions that the records tell apart.
pub(crate) struct Spectrum<'a> {
    beliefs: &'a Beliefs,
    sd: DVector<f64>,
    /// Eigenvalues of SᵀS.
    squares: DVector<f64>,
    /// p.
    pull: DVector<f64>,
    /// e.
    believed: DVector<f64>,
    /// Vᵀ.
    directions: DMatrix<f64>,
    /// r².
    misfit: f64,
    ln_det: f64,
    points: f64,
}

impl<'a> Spectrum<'a> {
    /// With mesh factors a ~ N(0, `mesh`²).
    pub fn new(reduced: &Reduced, beliefs: &'a Beliefs, mesh: f64) -> Self {
        let q = reduced.square.ncols() - 1;
        let mut sd = beliefs.sd.clone();
        sd.rows_mut(beliefs.parameters, q - beliefs.parameters).fill(mesh);
        let scaled = DMatrix::from_fn(q, q, |i, j| sd[i] * reduced.square[(i, j)] * sd[j]);
        let pull = DVector::from_fn(q, |k, _| sd[k] * reduced.square[(k, q)]);
        let (squares, axes) = told_apart(scaled);
        // What the records do not see does not pull.
        let pull = axes.tr_mul(&pull).zip_map(&squares, |p, s| if s > 0.0 { p } else { 0.0 });
        Self {
            beliefs,
            pull,
            believed: axes.tr_mul(&beliefs.mean.component_div(&sd)),
            sd,
            squares,
            directions: axes.transpose(),
            misfit: reduced.square[(q, q)],
            ln_det: reduced.ln_det,
            points: reduced.points,
        }
    }

    /// ln ∫ p(r | x, a) p(x) p(a) dx da with noise and rest scaled by `kappa`. In shares of the peak.
    pub fn ln_z(&self, kappa: f64) -> f64 {
        let square = kappa * kappa;
        let (mut misfit, mut ln_volume) = (self.misfit / square, 0.0);
        for ((s, p), e) in self.squares.iter().zip(self.pull.iter()).zip(self.believed.iter()) {
            misfit += (s * e * e - 2.0 * p * e - p * p / square) / (s + square);
            ln_volume -= 0.5 * (s / square).ln_1p();
        }
        ln_volume - 0.5 * (misfit + self.ln_det + self.points * (LN_TAU + square.ln()))
            + self.ln_bounds(square)
    }

    /// ln of what the bounds leave of the posterior, over what they leave of the beliefs.
    fn ln_bounds(&self, square: f64) -> f64 {
        let bounded = &self.beliefs.bounded;
        let parts = self.squares.iter().zip(self.pull.iter()).zip(self.believed.iter());
        let mode: Vec<f64> = parts.map(|((s, p), e)| (p + square * e) / (s + square)).collect();
        let narrower: Vec<f64> = self.squares.iter().map(|s| square / (s + square)).collect();
        let covariance = |i: usize, j: usize| {
            let (a, b) = (self.directions.column(i), self.directions.column(j));
            let sum: f64 = a.iter().zip(b.iter()).zip(&narrower).map(|((a, b), n)| a * b * n).sum();
            self.sd[i] * self.sd[j] * sum
        };
        let mut near = Vec::new();
        for b in bounded {
            let column = self.directions.column(b.place);
            let here = self.sd[b.place] * column.iter().zip(&mode).map(|(v, u)| v * u).sum::<f64>();
            let spread = covariance(b.place, b.place).max(0.0).sqrt();
            // Others the posterior does not reach.
            if here - 9.0 * spread < b.lower || here + 9.0 * spread > b.upper {
                near.push((b.place, (b.lower - here, b.upper - here)));
            }
        }
        let bounds: Vec<(f64, f64)> = near.iter().map(|n| n.1).collect();
        let c = DMatrix::from_fn(near.len(), near.len(), |i, j| covariance(near[i].0, near[j].0));
        ln_box(&DVector::zeros(near.len()), &c, &bounds) - self.beliefs.ln_mass
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use inverse::Random;

    /// By the normal equations: A = HᵀH/κ² + Λ, g = Hᵀr/κ² + Λm, and the box of what is bounded.
    fn by_normal_equations(
        reduced: &Reduced,
        parameters: &[Parameter],
        (wider, mesh, kappa): (f64, f64, f64),
    ) -> f64 {
        let q = reduced.square.ncols() - 1;
        let square = &reduced.square / (kappa * kappa);
        let belief = |k: usize| {
            parameters.get(k).map_or(Belief::normal(0.0, mesh), |p| {
                let sd = p.belief.sd * if p.amplitude { wider } else { 1.0 };
                Belief {
                    mean: p.belief.mean - p.at,
                    sd,
                    lower: p.belief.lower - p.at,
                    upper: p.belief.upper - p.at,
                }
            })
        };
        let beliefs: Vec<Belief> = (0..q).map(belief).collect();
        let mean = DVector::from_fn(q, |k, _| beliefs[k].mean);
        let precision = DMatrix::from_diagonal(&DVector::from_fn(q, |k, _| beliefs[k].sd.powi(-2)));
        let a = square.view((0, 0), (q, q)) + &precision;
        let g = square.view((0, q), (q, 1)).column(0) + &precision * &mean;
        let c = a.clone().try_inverse().expect("positive");
        let mode = &c * &g;
        let misfit = square[(q, q)] + mean.dot(&(&precision * &mean)) - g.dot(&mode);
        let ln_sd: f64 = beliefs.iter().map(|b| b.sd.ln()).sum();
        let ln_det = a.cholesky().expect("positive").l().diagonal().iter().map(|d| d.ln()).sum::<f64>();
        let p = parameters.len();
        let bounds: Vec<(f64, f64)> =
            (0..p).map(|k| (beliefs[k].lower - mode[k], beliefs[k].upper - mode[k])).collect();
        let inside = ln_box(&DVector::zeros(p), &c.view((0, 0), (p, p)).into_owned(), &bounds);
        let before: f64 = beliefs[..p].iter().map(Belief::ln_mass).sum();
        -0.5 * (misfit + reduced.ln_det + reduced.points * (LN_TAU + 2.0 * kappa.ln())) - ln_det - ln_sd
            + inside
            - before
    }

    /// Records that are next to without noise and know one sum of four parameters alone: of each apart the beliefs stay. In closed form.
    #[test]
    fn what_is_not_told_apart_keeps_its_beliefs_without_noise() {
        let above = Belief::above(0.2, 0.4);
        let of = [Belief::normal(0.5, 0.3), above, Belief::normal(-0.3, 0.7), Belief::normal(0.1, 0.2)];
        let times = [1.0, 1.7, 0.6, -0.37];
        let free = |(k, belief): (usize, &Belief)| Parameter {
            path: format!("p{k}"),
            at: 0.0,
            belief: *belief,
            amplitude: false,
        };
        let parameters: Vec<Parameter> = of.iter().enumerate().map(free).collect();
        // Linearised at a fit: what is left is of the noise's size.
        let (known, size) = (2e-10, 1e10);
        let shape = Random::new(3).normals(16).normalize();
        let columns: Vec<_> = times.iter().chain([&known]).map(|t| &shape * (t * size)).collect();
        let columns = DMatrix::from_columns(&columns);
        let reduced = Reduced { square: columns.tr_mul(&columns), ln_det: 0.0, points: 16.0 };
        let sum = |f: fn(&Belief, f64) -> f64| of.iter().zip(times).map(|(b, t)| f(b, t)).sum::<f64>();
        let (mean, variance) = (sum(|b, t| t * b.mean), sum(|b, t| (t * b.sd).powi(2)));
        // The second beside what is known of the sum, and above its bound.
        let gain = times[1] * above.sd.powi(2) / variance;
        let at = above.mean + gain * (known - mean);
        let sd = above.sd * (1.0 - times[1] * gain).sqrt();
        let beyond = (above.lower - at, f64::INFINITY);
        let inside = ln_box(&DVector::zeros(1), &DMatrix::from_element(1, 1, sd * sd), &[beyond]);
        let beliefs = Beliefs::new(&parameters, 1.0, 0);
        // Beside it much that no parameter takes, by which what is rounding would be pulled.
        let left = 1e7;
        let other = Random::new(4).normals(16);
        let other = (&other - &shape * shape.dot(&other)).normalize() * left;
        let mut missed = columns.clone();
        missed.column_mut(4).axpy(1.0, &other, 1.0);
        let missed = Reduced { square: missed.tr_mul(&missed), ..reduced.clone() };
        for kappa in [1.0, 0.5] {
            let got = Spectrum::new(&reduced, &beliefs, 1.0).ln_z(kappa);
            let beside = Spectrum::new(&missed, &beliefs, 1.0).ln_z(kappa) + 0.5 * (left / kappa).powi(2);
            let noise = (kappa / size).powi(2);
            let ln_sum = -0.5 * ((known - mean).powi(2) / (variance + noise) + (variance / noise).ln_1p());
            let want = ln_sum - 0.5 * 16.0 * (LN_TAU + 2.0 * kappa.ln()) + inside + std::f64::consts::LN_2;
            assert!((got - want).abs() < 1e-3, "{kappa}: {got} {want}");
            // To the rounding of what is left.
            assert!((beside - want).abs() < 1.0, "{kappa}: {beside} {want}");
        }
        let solved = reduced.solve(&parameters, 1.0);
        assert!((solved.step[1] - at).abs() < 1e-4, "{} {at}", solved.step[1]);
        assert!((solved.covariance()[(1, 1)].sqrt() / sd - 1.0).abs() < 1e-4);
    }

    #[test]
    fn it_is_the_integral_by_normal_equations() {
        let mut random = Random::new(11);
        let parameter = |k: usize, belief: Belief| Parameter {
            path: format!("p{k}"),
            at: 0.1 * k as f64,
            belief,
            amplitude: k.is_multiple_of(2),
        };
        let beliefs = [
            Belief::normal(0.4, 2.0),
            Belief::above(0.0, 0.5),
            Belief::normal(0.0, 30.0).within(-5.0, 5.0),
            Belief::below(0.2, 1.0),
        ];
        let parameters: Vec<Parameter> =
            beliefs.into_iter().enumerate().map(|(k, b)| parameter(k, b)).collect();
        // Columns of very different size, one nearly twice, two of the mesh.
        let mut x =
            DMatrix::from_fn(60, 7, |_, k| random.normal() * [1e3, 1.0, 10.0, 0.01, 1.0, 0.1, 3.0][k]);
        let twice = x.column(0) * 0.5 + x.column(3);
        x.set_column(2, &twice);
        let reduced = Reduced { square: x.tr_mul(&x), ln_det: 3.0, points: 60.0 };
        for (wider, mesh, kappa) in [(1.0, 0.2, 1.0), (2.0, 0.8, 0.6), (0.5, 0.5, 1.7)] {
            let beliefs = Beliefs::new(&parameters, wider, 2);
            let got = Spectrum::new(&reduced, &beliefs, mesh).ln_z(kappa);
            let want = by_normal_equations(&reduced, &parameters, (wider, mesh, kappa));
            assert!((got - want).abs() < 1e-7 * want.abs(), "{wider} {mesh} {kappa}: {got} {want}");
        }
    }
}
