//! The score statistic of one block of columns, with signs of amplitudes respected.

use crate::ratio::ratio;
use crate::{Amplitude, Side};
use nalgebra::{DMatrix, DVector};

/// The fall of χ² that an effect promises, and the amplitudes that give it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Fall {
    pub fall: f64,
    pub amplitudes: Vec<f64>,
}

impl Fall {
    /// What is left of the promise within the limits of the amplitudes: along the estimate it is a parabola, of which a
    /// share t of the estimate has 1 − (1 − t)².
    pub fn within<'a>(&self, amplitudes: impl IntoIterator<Item = &'a Amplitude>) -> Self {
        let shares = amplitudes.into_iter().zip(&self.amplitudes).map(|(a, e)| a.admitted(*e));
        let t = shares.fold(1.0, f64::min);
        Self {
            fall: self.fall * (1.0 - (1.0 - t).powi(2)),
            amplitudes: self.amplitudes.iter().map(|a| t * a).collect(),
        }
    }
}

/// max over admissible a of 2 bᵀa − aᵀGa, with G = s⊥ᵀs⊥ and b = s⊥ᵀr. The maximum under sign constraints is
/// the best of the unconstrained maxima over subsets of amplitudes that happen to be admissible.
pub(crate) fn statistic(gram: &DMatrix<f64>, b: &DVector<f64>, sides: &[Side]) -> Fall {
    let k = b.len();
    let mut best = Fall { fall: 0.0, amplitudes: vec![0.0; k] };
    if k == 1 {
        let a = ratio(b[0], gram[(0, 0)]);
        if sides[0].admits(a) {
            best = Fall { fall: a * b[0], amplitudes: vec![a] };
        }
        return best;
    }
    if k == 2 {
        return two(gram, b, sides);
    }
    for subset in 1..(1usize << k.min(16)) {
        let which: Vec<usize> = (0..k).filter(|i| subset >> i & 1 == 1).collect();
        let Some(a) = solve(gram, b, &which) else { continue };
        if !which.iter().zip(a.iter()).all(|(&i, &a)| sides[i].admits(a)) {
            continue;
        }
        let fall: f64 = which.iter().zip(a.iter()).map(|(&i, &a)| a * b[i]).sum();
        if fall > best.fall {
            let mut amplitudes = vec![0.0; k];
            for (&i, &a) in which.iter().zip(a.iter()) {
                amplitudes[i] = a;
            }
            best = Fall { fall, amplitudes };
        }
    }
    best
}

/// The same for two amplitudes, in closed form: the pair when admissible, else the better single one.
fn two(gram: &DMatrix<f64>, b: &DVector<f64>, sides: &[Side]) -> Fall {
    let (g00, g01, g11) = (gram[(0, 0)], gram[(0, 1)], gram[(1, 1)]);
    let determinant = g00 * g11 - g01 * g01;
    if determinant > 1e-10 * g00 * g11 {
        let x = (g11 * b[0] - g01 * b[1]) / determinant;
        let y = (g00 * b[1] - g01 * b[0]) / determinant;
        if sides[0].admits(x) && sides[1].admits(y) {
            return Fall { fall: (x * b[0] + y * b[1]).max(0.0), amplitudes: vec![x, y] };
        }
    }
    let mut best = Fall { fall: 0.0, amplitudes: vec![0.0; 2] };
    for i in 0..2 {
        let a = ratio(b[i], gram[(i, i)]);
        if sides[i].admits(a) && a * b[i] > best.fall {
            let mut amplitudes = vec![0.0; 2];
            amplitudes[i] = a;
            best = Fall { fall: a * b[i], amplitudes };
        }
    }
    best
}

/// G_AA⁻¹ b_A with columns scaled to length 1; `None` when they are (nearly) dependent.
fn solve(gram: &DMatrix<f64>, b: &DVector<f64>, which: &[usize]) -> Option<DVector<f64>> {
    let scale: Vec<f64> = which.iter().map(|&i| gram[(i, i)].sqrt()).collect();
    if scale.iter().any(|&s| s <= 0.0) {
        return None;
    }
    let n = which.len();
    let g = DMatrix::from_fn(n, n, |i, j| gram[(which[i], which[j])] / (scale[i] * scale[j]));
    let rhs = DVector::from_fn(n, |i, _| b[which[i]] / scale[i]);
    let chol = g.cholesky()?;
    if chol.l_dirty().diagonal().min() < 1e-5 {
        return None;
    }
    let x = chol.solve(&rhs);
    Some(DVector::from_fn(n, |i, _| x[i] / scale[i]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use inverse::Random;

    #[test]
    fn signs_are_respected_and_the_maximum_is_found() {
        let mut random = Random::new(1);
        for _ in 0..200 {
            let s = DMatrix::from_fn(6, 2, |_, _| random.normal());
            let r = random.normals(6);
            let (g, b) = (s.tr_mul(&s), s.tr_mul(&r));
            let sides = [Side::Positive, Side::Both];
            let best = statistic(&g, &b, &sides);
            assert!(best.amplitudes[0] >= 0.0);
            let value = |x: f64, y: f64| {
                let a = DVector::from_vec(vec![x, y]);
                2.0 * b.dot(&a) - a.dot(&(&g * &a))
            };
            for i in 0..20 {
                for j in -20..20 {
                    assert!(value(0.2 * f64::from(i), 0.2 * f64::from(j)) <= best.fall + 1e-9);
                }
            }
        }
    }

    #[test]
    fn two_amplitudes_in_closed_form_agree_with_the_general_search() {
        let mut random = Random::new(2);
        for _ in 0..500 {
            let s = DMatrix::from_fn(6, 3, |_, c| if c == 2 { 0.0 } else { random.normal() });
            let r = random.normals(6);
            for sides in [[Side::Positive, Side::Negative], [Side::Both, Side::Positive]] {
                let pair = s.columns(0, 2).into_owned();
                let closed = statistic(&pair.tr_mul(&pair), &pair.tr_mul(&r), &sides);
                let wide = [sides[0], sides[1], Side::Both];
                let general = statistic(&s.tr_mul(&s), &s.tr_mul(&r), &wide);
                assert!((closed.fall - general.fall).abs() < 1e-9);
                assert!((closed.amplitudes[0] - general.amplitudes[0]).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn dependent_columns_count_once() {
        let s = DMatrix::from_row_slice(3, 2, &[1.0, 2.0, 1.0, 2.0, 0.0, 0.0]);
        let r = DVector::from_vec(vec![1.0, 1.0, 5.0]);
        let both = statistic(&s.tr_mul(&s), &s.tr_mul(&r), &[Side::Both, Side::Both]);
        assert!((both.fall - 2.0).abs() < 1e-9);
    }
}
