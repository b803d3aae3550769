//! The bend of a valley, learnt from a trial that failed.
//!
//! Where parameters trade against each other the objective is a long bent valley: a step along its
//! floor leaves it by a second-order defect, and plain Levenberg–Marquardt answers with ever shorter
//! steps. The failed trial itself tells that defect, q = r(z + v) − (r − J v): the next trial follows
//! the parabola s v + s² a whose a takes the defect back (the second-order correction of sequential
//! quadratic programming; geodesic acceleration, Transtrum & Sethna 2012, arXiv:1201.5885, without its
//! extra model run).

use crate::linalg::Reduced;
use crate::step::{Step, StepBox, bounded_step};
use crate::whiten::Whitened;
use nalgebra::DVector;

/// Shares of the failed step that the bent step may take.
const SHARES: [f64; 12] = [0.05, 0.1, 0.15, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0];

/// The bent step that the parabola through the failed trial promises most of, or `None` where it
/// promises nothing.
///
/// `there` is the whitened misfit at the failed trial, on the rows of `here`.
pub(crate) fn bent_step(
    here: &Whitened,
    d: &DVector<f64>,
    lambda: f64,
    space: &StepBox,
    failed: &DVector<f64>,
    there: &DVector<f64>,
) -> Option<Step> {
    let along = &here.jacobian * failed;
    let defect = there - (&here.r - &along);
    let system = Reduced::new(&here.jacobian, &defect);
    let back = bounded_step(&system, d, lambda, space).dz;
    let left = &defect - &here.jacobian * &back;
    let before = here.r.norm_squared();
    let (share, after) = SHARES
        .iter()
        .map(|&s| (s, (&here.r - &along * s + &left * (s * s)).norm_squared()))
        .min_by(|a, b| a.1.total_cmp(&b.1))?;
    let dz = failed * share + back * (share * share);
    let dz = dz.zip_zip_map(&space.lower, &space.upper, |x, lo, hi| x.clamp(lo, hi));
    (after < before && dz.iter().all(|x| x.is_finite())).then_some(Step { dz, fall: before - after })
}
