//! The bend of a valley, learnt from the step before.
//!
//! Where parameters trade against each other the objective is a long bent valley: a straight step along
//! its floor leaves it by a second-order defect. How the jacobian changed along the last step tells that
//! defect for a step that goes on the same way, at no cost; the next step follows the parabola
//! s v + s² a whose a takes it back (geodesic acceleration, Transtrum & Sethna 2012, arXiv:1201.5885,
//! without its extra model run).

use crate::linalg::Reduced;
use crate::step::{Step, StepBox, bounded_step};
use crate::whiten::Whitened;
use nalgebra::DVector;

/// Shares of the straight step that the bent step may take.
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
fn shared<'a>(before: &'a [usize], here: &'a [usize]) -> impl Iterator<Item = (usize, usize)> + 'a {
    let row = |point: &usize| before.binary_search(point).ok();
    here.iter().enumerate().filter_map(move |(k, point)| row(point).map(|old| (k, old)))
}

/// The bent step that the parabola through `defect` at the end of `step` promises most of, or `None`
/// where it promises nothing.
pub(crate) fn bent_step(
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
    (after < before && dz.iter().all(|x| x.is_finite())).then_some(Step { dz, fall: before - after })
}
