//! Principal values and axes of a symmetric tensor, and divided differences of powers.

use crate::tensor::Tensor;

/// Sweeps of Jacobi's method; four are enough for 3 × 3.
const SWEEPS: usize = 12;

/// Principal values x_a and axes of a symmetric tensor; the columns of the second answer are the axes, row-major.
///
/// By Jacobi's rotations: axes are orthogonal to rounding however close the values are. NaN in, NaN out.
pub fn principal(a: &Tensor<f64>) -> ([f64; 3], Tensor<f64>) {
    let mut a = *a;
    let mut q = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
    for _ in 0..SWEEPS {
        let off = a[1] * a[1] + a[2] * a[2] + a[5] * a[5];
        if off.is_nan() || off == 0.0 {
            break;
        }
        for (i, j) in [(0, 1), (0, 2), (1, 2)] {
            rotate(&mut a, &mut q, i, j);
        }
    }
    ([a[0], a[4], a[8]], q)
}

/// Makes the entry (i, j) of `a` zero.
fn rotate(a: &mut Tensor<f64>, q: &mut Tensor<f64>, i: usize, j: usize) {
    let off = a[3 * i + j];
    let scale = a[4 * i].abs() + a[4 * j].abs();
    if off.abs() <= 1e-300 || off.abs() < 1e-18 * scale {
        (a[3 * i + j], a[3 * j + i]) = (0.0, 0.0);
        return;
    }
    let half = 0.5 * (a[4 * j] - a[4 * i]) / off;
    let t = if half >= 0.0 { 1.0 } else { -1.0 } / (half.abs() + half.hypot(1.0));
    let c = 1.0 / t.hypot(1.0);
    let s = t * c;
    for k in 0..3 {
        let (x, y) = (a[3 * k + i], a[3 * k + j]);
        (a[3 * k + i], a[3 * k + j]) = (c * x - s * y, s * x + c * y);
    }
    for k in 0..3 {
        let (x, y) = (a[3 * i + k], a[3 * j + k]);
        (a[3 * i + k], a[3 * j + k]) = (c * x - s * y, s * x + c * y);
        let (x, y) = (q[3 * k + i], q[3 * k + j]);
        (q[3 * k + i], q[3 * k + j]) = (c * x - s * y, s * x + c * y);
    }
    (a[3 * i + j], a[3 * j + i]) = (0.0, 0.0);
}

/// (x^p − y^p)/(x − y) for positive x, y; at x = y the derivative p x^(p−1). No digits are lost between: both
/// differences are written through the logarithm of x/y.
pub fn power_difference(x: f64, y: f64, p: f64) -> f64 {
    let h = (x / y).ln();
    let ratio = if h == 0.0 { p } else { (p * h).exp_m1() / h.exp_m1() };
    y.powf(p - 1.0) * ratio
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{tensor, testing};

    fn built(x: [f64; 3], q: &Tensor<f64>) -> Tensor<f64> {
        tensor::mul(&tensor::mul(q, &[x[0], 0.0, 0.0, 0.0, x[1], 0.0, 0.0, 0.0, x[2]]), &tensor::transpose(q))
    }

    #[test]
    fn axes_and_values_build_the_tensor_again() {
        for x in
            [[1.0, 2.0, 3.0], [1.0, 1.0, 2.0], [1.0, 1.0, 1.0], [1.0, 1.0 + 1e-12, 0.5], [1e-6, 1.0, 1e6]]
        {
            let a = built(x, &testing::rotation(0.3, 1.1, -0.7));
            let (found, q) = principal(&a);
            let again = built(found, &q);
            let scale = x.iter().fold(0.0f64, |m, v| m.max(*v));
            assert!(a.iter().zip(&again).all(|(a, b)| (a - b).abs() < 4e-15 * scale), "{x:?}");
            let unit = tensor::mul(&tensor::transpose(&q), &q);
            assert!(unit.iter().zip(tensor::identity::<f64>()).all(|(a, b)| (a - b).abs() < 1e-14));
        }
    }

    #[test]
    fn powers_of_close_numbers_keep_their_digits() {
        for p in [-3.0, -0.5, 0.0, 0.5, 1.0, 4.7] {
            let slope = |x: f64| p * x.powf(p - 1.0);
            assert_eq!(power_difference(1.3, 1.3, p), slope(1.3));
            let close = power_difference(1.3, 1.3 * (1.0 + 1e-9), p);
            assert!((close - slope(1.3)).abs() < 1e-8 * (1.0 + slope(1.3).abs()));
            let far = (2.0f64.powf(p) - 0.5f64.powf(p)) / 1.5;
            assert!((power_difference(2.0, 0.5, p) - far).abs() < 1e-14 * (1.0 + far.abs()));
        }
    }
}
