//! How well more data would tell two fitted models apart (Hunter & Reiner 1965, doi:10.1080/00401706.1965.10490265;
//! Box & Hill 1967, doi:10.1080/00401706.1967.10490441): each in turn is taken for the truth, and the other one may move
//! its parameters as far as the data at hand allow.

use crate::tails::normal_sf;
use nalgebra::{DMatrix, DVector};

/// A coordinate that the data at hand leave free is known to this much: a factor of twenty where it is a logarithm.
const WIDE: f64 = 3.0;

/// χ² that the rival leaves on new points where the other model is the truth: the least of |d − N z|² + |O z|² over
/// moves z of the rival's parameters.
///
/// `difference` d: truth − rival on the new points, whitened. `new` N and `old` O: the rival's whitened jacobians on the
/// new points and on the data at hand (rows of priors included), both in its transformed coordinates.
pub fn noncentrality(difference: &DVector<f64>, new: &DMatrix<f64>, old: &DMatrix<f64>) -> f64 {
    let p = new.ncols();
    let hessian = new.tr_mul(new) + old.tr_mul(old) + DMatrix::identity(p, p) / (WIDE * WIDE);
    let gradient = new.tr_mul(difference);
    match hessian.cholesky() {
        Some(c) => (difference.norm_squared() - gradient.dot(&c.solve(&gradient))).max(0.0),
        None => 0.0,
    }
}

/// Chance that χ² of the wrong one of two models exceeds that of the right one by `separate`, where it is expected to by
/// `noncentrality` λ: their difference is normal with mean λ and variance 4 λ.
pub fn power(noncentrality: f64, separate: f64) -> f64 {
    if noncentrality > 0.0 {
        normal_sf((separate - noncentrality) / (2.0 * noncentrality.sqrt()))
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::{noncentrality, power};
    use approx::assert_relative_eq;
    use nalgebra::{DMatrix, DVector};

    fn v(x: &[f64]) -> DVector<f64> {
        DVector::from_column_slice(x)
    }

    fn m(rows: usize, x: &[f64]) -> DMatrix<f64> {
        DMatrix::from_row_slice(rows, x.len() / rows, x)
    }

    #[test]
    fn a_rival_without_parameters_leaves_all() {
        let d = v(&[3.0, 4.0]);
        assert_relative_eq!(noncentrality(&d, &DMatrix::zeros(2, 0), &DMatrix::zeros(5, 0)), 25.0);
    }

    /// One parameter, one new point: d²/(1 + n²/h), h what is known of the parameter.
    #[test]
    fn a_rival_moves_as_far_as_the_old_data_allow() {
        let (d, n, o) = (v(&[2.0]), m(1, &[3.0]), m(2, &[0.5, 1.5]));
        let known = 0.5 * 0.5 + 1.5 * 1.5 + 1.0 / 9.0;
        assert_relative_eq!(noncentrality(&d, &n, &o), 4.0 / (1.0 + 9.0 / known), max_relative = 1e-12);
        let tight = noncentrality(&d, &n, &m(1, &[1e6]));
        assert_relative_eq!(tight, 4.0, max_relative = 1e-9);
    }

    #[test]
    fn what_the_rival_can_imitate_does_not_count() {
        let n = m(3, &[1.0, 0.0, 1.0, 1.0, 1.0, 2.0]);
        let imitable = &n * v(&[0.7, -0.2]);
        let rest = v(&[1.0, -2.0, 1.0]);
        let nothing_known = DMatrix::zeros(1, 2);
        let all = noncentrality(&(imitable * 100.0 + &rest), &(n * 1e6), &nothing_known);
        assert_relative_eq!(all, rest.norm_squared(), max_relative = 1e-6);
    }

    #[test]
    fn power_grows_from_nothing_to_one() {
        assert_relative_eq!(power(9.0, 9.0), 0.5);
        assert_relative_eq!(power(25.0, 9.0), 1.0 - crate::tails::normal_sf(1.6), max_relative = 1e-12);
        assert!(power(0.0, 9.0) == 0.0 && power(1e4, 9.0) > 0.999 && power(1.0, 9.0) < 1e-4);
        assert!(noncentrality(&DVector::zeros(3), &DMatrix::zeros(3, 1), &DMatrix::zeros(3, 1)) == 0.0);
    }
}
