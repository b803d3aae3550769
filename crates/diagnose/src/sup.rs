//! p-values of the score statistic.
//!
//! A single column gives ½χ²₀ + ½χ²₁ (one-sided: Self & Liang 1987) or χ²₁; several unsigned columns χ²_k. A
//! grid of shapes makes the statistic a maximum (sup-test: Davies 1977, Hansen 1996): under no effect the
//! projected columns see nothing but independent normal numbers, so its law is simulated exactly, with a
//! fixed seed. Beyond the draws, an upper bound takes over: the first-crossing form of Bonferroni, in which
//! neighbouring shapes pay only for the angle between them (Davies 1987), so that far tails err on the safe side.

use crate::ratio::ratio;
use crate::statistic::statistic;
use crate::tails::{SMALLEST, chi2_sf, normal_sf};
use crate::{Policy, Side};
use inverse::{Random, orthonormal};
use nalgebra::DMatrix;

/// Exceedances below which the simulation is not trusted.
const ENOUGH: usize = 20;

/// Projected columns of one effect, shape by shape.
pub(crate) struct Family<'a> {
    /// s⊥ of each shape, m × k.
    pub shapes: &'a [DMatrix<f64>],
    /// Admissible side of each of the k amplitudes.
    pub sides: &'a [Side],
}

impl Family<'_> {
    /// P(fall ≥ `fall`) without effect.
    pub fn p_value(&self, fall: f64, policy: &Policy) -> f64 {
        if fall <= 0.0 {
            return 1.0;
        }
        if self.known() {
            return self.one_shape(fall);
        }
        let bound = self.bound(fall);
        if beyond_draws(bound, policy) {
            return bound;
        }
        decided(bound, self.exceedances(fall, policy), policy)
    }

    /// The falls whose p-values are these levels, which grow: the statistic is drawn once for all of them.
    pub fn critical(&self, levels: &[f64], policy: &Policy) -> Vec<f64> {
        let mut drawn = if self.known() { Vec::new() } else { self.draws(policy) };
        drawn.sort_by(f64::total_cmp);
        let p_value = |fall: f64| {
            if self.known() {
                return self.one_shape(fall);
            }
            let bound = self.bound(fall);
            if beyond_draws(bound, policy) {
                return bound;
            }
            decided(bound, drawn.len() - drawn.partition_point(|d| *d < fall), policy)
        };
        let one = |level: &f64| {
            let (mut low, mut high) = (0.0, 200.0);
            for _ in 0..40 {
                let middle = 0.5 * (low + high);
                if p_value(middle) > *level { low = middle } else { high = middle }
            }
            high
        };
        levels.iter().map(one).collect()
    }

    /// Whether the law is known without drawing.
    fn known(&self) -> bool {
        let unsigned = self.sides.iter().all(|&s| s == Side::Both);
        self.shapes.len() == 1 && (unsigned || self.sides.len() == 1)
    }

    /// The law of one shape: exact for one amplitude or unsigned ones, an upper bound for signed ones.
    fn one_shape(&self, fall: f64) -> f64 {
        if self.sides.len() == 1 {
            let sides = if self.sides[0] == Side::Both { 2.0 } else { 1.0 };
            (sides * normal_sf(fall.sqrt())).clamp(SMALLEST, 1.0)
        } else {
            chi2_sf(fall, self.sides.len() as f64)
        }
    }

    /// Plain Bonferroni bound over the shapes.
    pub fn bonferroni(&self, fall: f64) -> f64 {
        if fall <= 0.0 { 1.0 } else { (self.one_shape(fall) * self.shapes.len() as f64).min(1.0) }
    }

    /// Upper bound: Bonferroni, sharpened for one amplitude by the angles between neighbouring shapes.
    pub fn bound(&self, fall: f64) -> f64 {
        if self.sides.len() != 1 {
            return self.bonferroni(fall);
        }
        let one = normal_sf(fall.sqrt());
        let two_sided = self.sides[0] == Side::Both;
        let mut total = one;
        for pair in self.shapes.windows(2) {
            let mut cosine = cosine(&pair[0], &pair[1]);
            if two_sided {
                cosine = cosine.abs();
            }
            let crossing = cosine.clamp(-1.0, 1.0).acos() / std::f64::consts::TAU * (-0.5 * fall).exp();
            total += one.min(crossing);
        }
        (total * if two_sided { 2.0 } else { 1.0 }).clamp(SMALLEST, 1.0)
    }

    /// How many of the draws are at least `fall`.
    fn exceedances(&self, fall: f64, policy: &Policy) -> usize {
        self.draws(policy).iter().filter(|d| **d >= fall).count()
    }

    /// Draws of the statistic. Without effect, Bᵀr of an orthonormal basis B of all shapes is standard normal, and the
    /// statistic depends on r through nothing else.
    fn draws(&self, policy: &Policy) -> Vec<f64> {
        let all: Vec<_> = self.shapes.iter().flat_map(|s| s.column_iter()).map(|c| c.into_owned()).collect();
        let basis = orthonormal(&DMatrix::from_columns(&all));
        let inner: Vec<DMatrix<f64>> = self.shapes.iter().map(|s| basis.tr_mul(s)).collect();
        if self.sides.len() == 1 {
            return self.draws_of_one(policy, basis.ncols(), &inner);
        }
        let grams: Vec<DMatrix<f64>> = inner.iter().map(|s| s.tr_mul(s)).collect();
        let mut random = Random::new(policy.seed);
        let mut one = || {
            let g = random.normals(basis.ncols());
            let falls = inner.iter().zip(&grams).map(|(s, gram)| {
                let b = s.tr_mul(&g);
                statistic(gram, &b, self.sides).fall
            });
            falls.fold(0.0, f64::max)
        };
        (0..policy.draws).map(|_| one()).collect()
    }

    /// The same for one amplitude, where a shape is just a unit vector.
    fn draws_of_one(&self, policy: &Policy, dimensions: usize, inner: &[DMatrix<f64>]) -> Vec<f64> {
        let units: Vec<Vec<f64>> = inner.iter().map(|s| s.iter().map(|v| v / s.norm()).collect()).collect();
        let side = self.sides[0];
        let mut random = Random::new(policy.seed);
        let mut g = vec![0.0; dimensions];
        let mut one = || {
            g.iter_mut().for_each(|v| *v = random.normal());
            let sized = units.iter().map(|u| {
                let z: f64 = u.iter().zip(&g).map(|(a, b)| a * b).sum();
                match side {
                    Side::Both => z.abs(),
                    Side::Positive => z,
                    Side::Negative => -z,
                }
            });
            sized.fold(0.0, f64::max).powi(2)
        };
        (0..policy.draws).map(|_| one()).collect()
    }
}

/// Whether a bound is so small that draws would not reach its fall.
fn beyond_draws(bound: f64, policy: &Policy) -> bool {
    bound < 0.1 * ENOUGH as f64 / policy.draws.max(1) as f64
}

/// The p-value from a bound and the number of draws that reach the fall.
fn decided(bound: f64, count: usize, policy: &Policy) -> f64 {
    if count >= ENOUGH {
        (count + 1) as f64 / (policy.draws + 1) as f64
    } else {
        bound.min((ENOUGH + 1) as f64 / (policy.draws + 1) as f64)
    }
}

fn cosine(a: &DMatrix<f64>, b: &DMatrix<f64>) -> f64 {
    ratio(a.dot(b), a.norm() * b.norm())
}
