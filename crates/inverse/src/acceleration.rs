//! Geodesic acceleration, learnt from the step before.
//!
//! Where parameters trade against each other the objective is a long curved valley: a straight step along
//! its floor leaves it by a second-order defect. How the jacobian changed along the last step tells that
//! defect for a step that goes on the same way, at no cost; the next step follows the parabola
//! s v + s² a whose a takes it back (geodesic acceleration, Transtrum & Sethna 2012, arXiv:1201.5885,
//! without its extra model run).

use crate::linalg::Reduced;
use crate::step::{Step, StepBox, bounded_step};
use crate::whiten::Whitened;
use nalgebra::DVector;

/// Shares of the straight step that the accelerated step may take.
const SHARES: [f64; 12] = [0.05, 0.1, 0.15, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0];
/// Least squared cosine between two steps along one valley.
const ALONG: f64 = 0.5;

/// The last step, and the linearised problem where it began.
pub(crate) struct Last {
    pub dz: DVector<f64>,
    pub whitened: Whitened,
}

impl Last {
    /// What the linear model at `here` will miss at the end of a step v. With v = c s + w, s the last
    /// step and H s ≈ J − J_before, −½ H v v ≈ −½ c (J − J_before)(v + w). `None` where v does not go on
    /// along s; zero at points that did not count before.
    pub fn defect(&self, here: &Whitened, d: &DVector<f64>, v: &DVector<f64>) -> Option<DVector<f64>> {
        let (before, s) = (&self.whitened, &self.dz);
        let inner = |a: &DVector<f64>, b: &DVector<f64>| a.component_mul(d).dot(b);
        let (ss, sv, vv) = (inner(s, s), inner(s, v), inner(v, v));
        if sv * sv < ALONG * ss * vv {
            return None;
        }
        let c = sv / ss;
        let twice = v * 2.0 - s * c;
        let (now, then) = (&here.jacobian * &twice, &before.jacobian * &twice);
        let mut defect = DVector::zeros(now.len());
        for (row, old) in shared(&before.rows, &here.rows) {
            defect[row] = -0.5 * c * (now[row] - then[old]);
        }
        Some(defect)
    }
}

/// Rows of `here` whose point has a row in `before`, too, and which; both ascend.
pub(crate) fn shared<'a>(
    before: &'a [usize],
    here: &'a [usize],
) -> impl Iterator<Item = (usize, usize)> + 'a {
    let row = |point: &usize| before.binary_search(point).ok();
    here.iter().enumerate().filter_map(move |(k, point)| row(point).map(|old| (k, old)))
}

/// The step along the parabola through `defect` at the end of `step` with the largest predicted reduction, or `None`
/// where that is not positive.
pub(crate) fn accelerated_step(
    here: &Whitened,
    d: &DVector<f64>,
    lambda: f64,
    space: &StepBox,
    step: &DVector<f64>,
    defect: &DVector<f64>,
) -> Option<Step> {
    let along = &here.jacobian * step;
    let system = Reduced::new(&here.jacobian, defect);
    let back = bounded_step(&system, d, lambda, space).dz;
    let left = defect - &here.jacobian * &back;
    let before = here.r.norm_squared();
    let (share, after) = SHARES
        .iter()
        .map(|&s| (s, (&here.r - &along * s + &left * (s * s)).norm_squared()))
        .min_by(|a, b| a.1.total_cmp(&b.1))?;
    let dz = step * share + back * (share * share);
    let dz = dz.zip_zip_map(&space.lower, &space.upper, |x, lo, hi| x.clamp(lo, hi));
    (after < before && dz.iter().all(|x| x.is_finite())).then_some(Step { dz, predicted: before - after })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Data;
    use crate::whiten::{Noise, Whitener};
    use nalgebra::DMatrix;

    fn vector(x: [f64; 2]) -> DVector<f64> {
        DVector::from_row_slice(&x)
    }

    fn matrix(x: [f64; 4]) -> DMatrix<f64> {
        DMatrix::from_row_slice(2, 2, &x)
    }

    /// Two points of a model with f_i = a_i z + ½ z H_i z, and their misfit of `r`.
    fn linearised(r: DVector<f64>, jacobian: DMatrix<f64>, rows: &[usize]) -> Whitened {
        let whitener = Whitener::new(&Data::default(), None, Noise::None);
        Whitened { r, jacobian, rows: rows.to_vec(), prior_rows: 0, whitener }
    }

    fn second() -> [DMatrix<f64>; 2] {
        [matrix([2.0, 0.5, 0.5, -1.0]), matrix([0.3, -0.7, -0.7, 4.0])]
    }

    fn jacobian(z: &DVector<f64>) -> DMatrix<f64> {
        let first = matrix([1.0, 2.0, -3.0, 0.5]);
        let [a, b] = second().map(|h| h * z);
        first + DMatrix::from_rows(&[a.transpose(), b.transpose()])
    }

    /// −½ v H v − (−½ w H w) point by point: what is told of a step v = c s + w.
    fn told(v: &DVector<f64>, w: &DVector<f64>) -> DVector<f64> {
        let twice = |x: &DVector<f64>| DVector::from_iterator(2, second().iter().map(|h| (h * x).dot(x)));
        (twice(w) - twice(v)) * 0.5
    }

    fn last_step(before: &[usize]) -> (Last, Whitened, DVector<f64>) {
        let (start, s) = (vector([0.2, -0.1]), vector([0.3, 0.2]));
        let r = || DVector::zeros(2);
        let here = linearised(r(), jacobian(&(&start + &s)), &[4, 7]);
        let last = Last { dz: s.clone(), whitened: linearised(r(), jacobian(&start), before) };
        (last, here, s)
    }

    #[test]
    fn two_jacobians_tell_what_a_step_on_the_same_way_misses() {
        let (last, here, s) = last_step(&[4, 7]);
        let d = vector([1.0, 1.0]);
        for c in [0.4, 1.0, 3.0] {
            let defect = last.defect(&here, &d, &(&s * c)).expect("along");
            assert!((defect - told(&(&s * c), &DVector::zeros(2))).amax() < 1e-14);
        }
        // Aside from it, to second order in what lies aside.
        let w = vector([-0.02, 0.03]);
        let defect = last.defect(&here, &d, &(&s * 1.5 + &w)).expect("along");
        assert!((defect - told(&(&s * 1.5 + &w), &w)).amax() < 1e-14);
    }

    #[test]
    fn a_way_that_turns_off_is_told_nothing() {
        let (last, here, s) = last_step(&[4, 7]);
        let across = vector([-s[1], s[0]]);
        let tells = |share: f64, d: &DVector<f64>| last.defect(&here, d, &(&s + &across * share)).is_some();
        let round = vector([1.0, 1.0]);
        assert!(tells(0.9, &round) && !tells(1.1, &round), "45° divides");
        // Angles are seen in the scale of the parameters.
        assert!(last.defect(&here, &vector([1.0, 100.0]), &vector([1.0, 0.0])).is_none());
        assert!(last.defect(&here, &vector([100.0, 1.0]), &vector([1.0, 0.0])).is_some());
    }

    #[test]
    fn points_that_did_not_count_before_are_told_nothing() {
        let (last, here, s) = last_step(&[1, 7]);
        let defect = last.defect(&here, &vector([1.0, 1.0]), &s).expect("along");
        assert_eq!(defect[0], 0.0);
        assert!((defect[1] - told(&s, &DVector::zeros(2))[1]).abs() < 1e-14);
    }

    /// Rosenbrock's valley f = (10 (z₁ − z₀²), z₀) to (0, 1), seen from its middle; the straight step is (1, 0).
    fn valley(upper: f64, step: &DVector<f64>) -> Option<Step> {
        let here = linearised(vector([0.0, 1.0]), matrix([0.0, 10.0, 1.0, 0.0]), &[0, 1]);
        let space = StepBox { lower: vector([-2.0, -2.0]), upper: vector([2.0, upper]) };
        accelerated_step(&here, &vector([1.0, 1.0]), 0.0, &space, step, &vector([10.0, 0.0]))
    }

    #[test]
    fn an_accelerated_step_stays_in_the_valley() {
        let step = valley(2.0, &vector([1.0, 0.0])).expect("a step");
        assert!((step.dz - vector([1.0, 1.0])).amax() < 1e-12 && (step.predicted - 1.0).abs() < 1e-12);
    }

    #[test]
    fn where_a_bound_cuts_the_parabola_a_shorter_step_is_worth_more() {
        let step = valley(0.5, &vector([1.0, 0.0])).expect("a step");
        // (1 − s)² + (5 s²)² is least of all shares at 0.2.
        assert!((step.dz - vector([0.2, 0.02])).amax() < 1e-12 && (step.predicted - 0.32).abs() < 1e-12);
    }

    #[test]
    fn an_acceleration_that_predicts_no_reduction_is_none() {
        assert!(valley(2.0, &vector([-1.0, 0.0])).is_none());
        assert!(valley(2.0, &vector([f64::NAN, 0.0])).is_none());
    }
}
