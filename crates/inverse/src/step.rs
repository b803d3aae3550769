//! One damped step inside bounds.

use crate::linalg::{Reduced, columns, damped_solve};
use nalgebra::DVector;

/// A box around the present point, as displacements.
pub(crate) struct StepBox {
    pub lower: DVector<f64>,
    pub upper: DVector<f64>,
}

/// A step and the reduction of the objective that the linear model predicts for it.
pub(crate) struct Step {
    pub dz: DVector<f64>,
    pub predicted: f64,
}

/// min |r − J dz|² + λ Σ d dz² inside the box, by an active set: a variable at the edge of the box that
/// is pushed outwards stays there; one that would leave the box is put on its edge and the others are
/// solved again.
pub(crate) fn bounded_step(system: &Reduced, d: &DVector<f64>, lambda: f64, space: &StepBox) -> Step {
    let p = d.len();
    let gradient = system.gradient();
    let mut held: Vec<Option<f64>> = (0..p)
        .map(|k| {
            let outward = (space.lower[k] >= 0.0 && gradient[k] <= 0.0)
                || (space.upper[k] <= 0.0 && gradient[k] >= 0.0);
            outward.then_some(0.0)
        })
        .collect();
    for _ in 0..=p {
        let open: Vec<usize> = (0..p).filter(|&k| held[k].is_none()).collect();
        let mut dz = DVector::from_iterator(p, held.iter().map(|h| h.unwrap_or(0.0)));
        if !open.is_empty() {
            let rhs = &system.c - &system.r * &dz;
            let damping = DVector::from_iterator(open.len(), open.iter().map(|&k| lambda * d[k]));
            let Some(x) = damped_solve(&columns(&system.r, &open), &rhs, &damping) else { break };
            for (n, &k) in open.iter().enumerate() {
                dz[k] = x[n];
            }
        }
        // Only the worst offender is put on its edge: the others may come back once it is there.
        let excess = |k: usize| {
            let size = (space.upper[k] - space.lower[k]).max(f64::MIN_POSITIVE);
            (space.lower[k] - dz[k]).max(dz[k] - space.upper[k]) / size
        };
        let worst = open
            .iter()
            .copied()
            .filter(|&k| excess(k) > 0.0)
            .max_by(|&a, &b| excess(a).total_cmp(&excess(b)));
        let mut left = false;
        if let Some(k) = worst {
            held[k] = Some(dz[k].clamp(space.lower[k], space.upper[k]));
            left = true;
        }
        if !left {
            let predicted = system.predicted_reduction(&dz);
            return Step { dz, predicted };
        }
    }
    Step { dz: DVector::zeros(p), predicted: 0.0 }
}

/// √Σ d dz²: the length of a step in Marquardt's scale.
pub(crate) fn length(dz: &DVector<f64>, d: &DVector<f64>) -> f64 {
    dz.iter().zip(d.iter()).map(|(z, d)| d * z * z).sum::<f64>().sqrt()
}

/// Whether a step changes any coordinate beyond rounding.
pub(crate) fn moves(z: &DVector<f64>, dz: &DVector<f64>) -> bool {
    z.iter().zip(dz.iter()).any(|(z, d)| d.abs() > 1e-14 * z.abs().max(1e-300))
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::DMatrix;

    /// Undamped the step would be (0.3, 11): by their own sizes the first leaves its box the farthest, and with that on its
    /// edge the second comes back inside. By plain lengths the second would be put on its edge first, and stay there.
    #[test]
    fn the_worst_offender_is_told_by_the_size_of_its_box() {
        let j = DMatrix::from_row_slice(2, 2, &[1.0, 0.0, -10.0, 1.0]);
        let r = &j * DVector::from_vec(vec![0.3, 11.0]);
        let space = StepBox {
            lower: DVector::from_vec(vec![-0.1, -10.0]),
            upper: DVector::from_vec(vec![0.1, 10.0]),
        };
        let step = bounded_step(&Reduced::new(&j, &r), &DVector::from_element(2, 1.0), 0.0, &space);
        assert!((step.dz[0] - 0.1).abs() < 1e-12 && (step.dz[1] - 9.0).abs() < 1e-9, "{}", step.dz);
        // |r|² − |r − J dz|²
        let left = &r - &j * &step.dz;
        assert!((step.predicted - (r.norm_squared() - left.norm_squared())).abs() < 1e-9);
    }
}
