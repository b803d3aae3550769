//! The part of a misfit's curvature that the jacobian does not tell.
//!
//! With r the misfit, r(z + s) ≈ r − J s, half the hessian of |r|² is JᵀJ + S, S = −Σ rᵢ ∇²fᵢ. Where a model misses its
//! records by far, S is no smaller than JᵀJ, and steps by JᵀJ alone creep along a valley. S is learnt from the steps that
//! were taken (structured secant update, sized), and used where it foretold the last step better than JᵀJ did: Dennis, Gay
//! & Welsch 1981 (NL2SOL), doi:10.1145/355958.355965.

use crate::acceleration::{Last, shared};
use crate::linalg::Reduced;
use crate::whiten::Whitened;
use nalgebra::{DMatrix, DVector};

/// Least curvature in the parameters' scale: what rounding leaves.
const LEAST: f64 = 1e-12;

/// What the steps so far say of S.
#[derive(Clone, Debug)]
pub(crate) struct Curvature {
    s: DMatrix<f64>,
    /// Whether it foretold the last step better.
    trusted: bool,
}

impl Curvature {
    /// Nothing is known yet of `p` parameters.
    pub fn none(p: usize) -> Self {
        Self { s: DMatrix::zeros(p, p), trusted: false }
    }

    /// Learns from a step that was taken.
    pub fn learn(&mut self, last: &Last, here: &Whitened) {
        let (before, step) = (&last.whitened, &last.dz);
        let (then, now) = common(before, here);
        let (r0, r1) = (rows(&before.r, &then), rows(&here.r, &now));
        let (j0, j1) = (before.jacobian.select_rows(&then), here.jacobian.select_rows(&now));
        let actual = r0.norm_squared() - r1.norm_squared();
        let plain = r0.norm_squared() - (&r0 - &j0 * step).norm_squared();
        let own = step.dot(&(&self.s * step));
        self.trusted = (plain - own - actual).abs() < (plain - actual).abs();
        let turned = j0.tr_mul(&r1) - j1.tr_mul(&r1);
        self.update(step, &(j0.tr_mul(&r0) - j1.tr_mul(&r1)), &turned);
    }

    /// S such that S s = `turned`, nearest to S in the metric of a matrix that takes s to `gradient`, its change along s.
    fn update(&mut self, step: &DVector<f64>, gradient: &DVector<f64>, turned: &DVector<f64>) {
        let along = gradient.dot(step);
        if along.abs() <= 1e-12 * gradient.norm() * step.norm() {
            return;
        }
        let own = step.dot(&(&self.s * step)).abs();
        if own > 0.0 {
            self.s *= (step.dot(turned).abs() / own).min(1.0);
        }
        let miss = turned - &self.s * step;
        let cross = &miss * gradient.transpose();
        self.s += (&cross + cross.transpose()) / along
            - gradient * gradient.transpose() * (step.dot(&miss) / (along * along));
        if self.s.iter().any(|x| !x.is_finite()) {
            self.s.fill(0.0);
            self.trusted = false;
        }
    }

    /// The system with S in it, as another of the same gradient; `None` where JᵀJ alone is the better model. A direction
    /// that falls ever more steeply counts as if it rose as much.
    pub fn system(&self, plain: &Reduced, scale: &DVector<f64>) -> Option<Reduced> {
        if !self.trusted {
            return None;
        }
        let root = scale.map(f64::sqrt);
        let full = plain.r.tr_mul(&plain.r) + &self.s;
        let scaled = DMatrix::from_fn(full.nrows(), full.ncols(), |i, k| full[(i, k)] / (root[i] * root[k]));
        let eigen = scaled.symmetric_eigen();
        let roots = eigen.eigenvalues.map(|v| v.abs().max(LEAST).sqrt());
        // R = diag(√λ) Vᵀ D, c = R⁻ᵀ g.
        let mut r = eigen.eigenvectors.transpose();
        let mut c = &r * plain.gradient().component_div(&root);
        for (i, (mut row, &v)) in r.row_iter_mut().zip(roots.iter()).enumerate() {
            row.iter_mut().zip(root.iter()).for_each(|(x, d)| *x *= v * d);
            c[i] /= v;
        }
        let finite = r.iter().chain(c.iter()).all(|x| x.is_finite());
        finite.then_some(Reduced { r, c })
    }
}

fn rows(v: &DVector<f64>, which: &[usize]) -> DVector<f64> {
    DVector::from_iterator(which.len(), which.iter().map(|&i| v[i]))
}

/// Rows that two systems share, priors included: in the one, in the other.
fn common(before: &Whitened, here: &Whitened) -> (Vec<usize>, Vec<usize>) {
    let points = shared(&before.rows, &here.rows).map(|(row, old)| (old, row));
    let priors = (before.rows.len()..before.r.len()).zip(here.rows.len()..here.r.len());
    points.chain(priors).unzip()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Data;
    use crate::whiten::{Noise, Whitener};

    /// Two points f_i = a_i z + ½ z H_i z against 7 and −5, and the system at z.
    fn at(z: &DVector<f64>) -> Whitened {
        let h = [[2.0, 0.5, 0.5, -1.0], [0.3, -0.7, -0.7, 4.0]].map(|h| DMatrix::from_row_slice(2, 2, &h));
        let a = [[1.0, 2.0], [-3.0, 0.5]].map(|a| DVector::from_row_slice(&a));
        let value = |i: usize| a[i].dot(z) + 0.5 * z.dot(&(&h[i] * z));
        let r = DVector::from_row_slice(&[7.0 - value(0), -5.0 - value(1)]);
        let j = DMatrix::from_rows(&[0, 1].map(|i: usize| (&a[i] + &h[i] * z).transpose()));
        let whitener = Whitener::new(&Data::default(), None, Noise::None);
        Whitened { r, jacobian: j, rows: vec![0, 1], prior_rows: 0, whitener }
    }

    fn walk(steps: &[[f64; 2]]) -> (Curvature, Whitened, DVector<f64>) {
        let (mut curvature, mut z) = (Curvature::none(2), DVector::zeros(2));
        let mut dz = z.clone();
        for step in steps {
            dz = DVector::from_row_slice(step);
            let last = Last { dz: dz.clone(), whitened: at(&z) };
            z += &dz;
            curvature.learn(&last, &at(&z));
        }
        (curvature, at(&z), dz)
    }

    #[test]
    fn along_the_last_step_it_is_what_the_jacobians_say() {
        let (curvature, here, dz) = walk(&[[0.1, 0.0], [0.02, 0.1]]);
        // −Σ r_i H_i s, exact on a quadratic.
        let h = [[2.0, 0.5, 0.5, -1.0], [0.3, -0.7, -0.7, 4.0]].map(|h| DMatrix::from_row_slice(2, 2, &h));
        let want = (&h[0] * here.r[0] + &h[1] * here.r[1]) * &dz * -1.0;
        assert!((&curvature.s * &dz - want).amax() < 1e-12);
        assert!((&curvature.s - curvature.s.transpose()).amax() < 1e-12);
    }

    #[test]
    fn its_system_has_the_same_gradient_and_the_hessian_with_it() {
        let (mut curvature, here, _) = walk(&[[0.1, 0.0], [0.02, 0.1]]);
        curvature.trusted = true;
        let plain = Reduced::new(&here.jacobian, &here.r);
        let scale = DVector::from_row_slice(&[3.0, 0.2]);
        curvature.s = DMatrix::identity(2, 2) * 5.0;
        let own = curvature.system(&plain, &scale).expect("trusted");
        assert!((own.gradient() - plain.gradient()).amax() < 1e-10);
        let want = plain.r.tr_mul(&plain.r) + DMatrix::identity(2, 2) * 5.0;
        assert!((own.r.tr_mul(&own.r) - want).amax() < 1e-10);
        curvature.trusted = false;
        assert!(curvature.system(&plain, &scale).is_none());
    }

    #[test]
    fn it_is_trusted_where_it_foretold_the_last_step_better() {
        assert!(!walk(&[[0.1, 0.0]]).0.trusted, "nothing was known");
        assert!(walk(&[[0.1, 0.0], [0.1, 0.0]]).0.trusted);
    }

    #[test]
    fn rows_that_did_not_count_before_are_left_out() {
        let (z, dz) = (DVector::zeros(2), DVector::from_row_slice(&[0.1, 0.05]));
        let mut here = at(&dz);
        here.rows = vec![1, 9];
        here.r.swap_rows(0, 1);
        here.jacobian.swap_rows(0, 1);
        here.r[1] = 1e9;
        let mut curvature = Curvature::none(2);
        curvature.learn(&Last { dz: dz.clone(), whitened: at(&z) }, &here);
        let h = DMatrix::from_row_slice(2, 2, &[0.3, -0.7, -0.7, 4.0]);
        assert!((&curvature.s * &dz + h * &dz * here.r[0]).amax() < 1e-10);
    }
}
