//! Two effects at once: what they explain together, and whether the record can tell them apart.

use crate::score::Projected;
use crate::statistic::statistic;
use crate::tails::chi2_sf;
use crate::{Policy, Side};
use inverse::orthonormal;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use serde::Serialize;

/// Two effects of the catalogue against one misfit.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Pair {
    /// First effect.
    pub a: String,
    /// Second effect.
    pub b: String,
    /// Expected fall of χ² with both, over all pairs of shapes, within the limits of their amplitudes.
    pub joint_fall: f64,
    /// What `a` adds to `b` alone, limits apart.
    pub a_after_b: f64,
    /// What `b` adds to `a` alone, limits apart.
    pub b_after_a: f64,
    /// p-value of the joint fall (limits apart), an upper bound (χ² with as many degrees of freedom as amplitudes, times
    /// the number of pairs of shapes).
    pub p_value: f64,
    /// Smallest angle between what the two do beyond base parameters, degrees; 90 when neither does anything.
    pub angle_degrees: f64,
    /// Whether these records cannot tell the two apart.
    pub alike: bool,
}

/// Every pair, largest joint fall first.
pub(crate) fn pairs(all: &[Projected], left: &DVector<f64>, policy: &Policy) -> Vec<Pair> {
    let index: Vec<(usize, usize)> = (0..all.len())
        .filter(|&i| !all[i].shapes.is_empty())
        .flat_map(|i| (i + 1..all.len()).map(move |j| (i, j)))
        .filter(|&(_, j)| !all[j].shapes.is_empty())
        .collect();
    let mut out: Vec<Pair> = index.par_iter().map(|&(i, j)| pair(&all[i], &all[j], left, policy)).collect();
    out.sort_by(|x, y| y.joint_fall.total_cmp(&x.joint_fall).then(x.a.cmp(&y.a)).then(x.b.cmp(&y.b)));
    out
}

fn pair(a: &Projected, b: &Projected, left: &DVector<f64>, policy: &Policy) -> Pair {
    let sides: Vec<Side> = a.sides.iter().chain(&b.sides).copied().collect();
    let amplitudes = || a.candidate.amplitudes.iter().chain(&b.candidate.amplitudes);
    let alone = |p: &Projected| p.falls.get(p.best).map_or(0.0, |f| f.within(&p.candidate.amplitudes).fall);
    let (mut joint, mut within) = (a.fall().max(b.fall()), alone(a).max(alone(b)));
    for x in &a.shapes {
        for y in &b.shapes {
            let both = hstack(x, y);
            let fall = statistic(&both.tr_mul(&both), &both.tr_mul(left), &sides);
            joint = joint.max(fall.fall);
            within = within.max(fall.within(amplitudes()).fall);
        }
    }
    let shapes = (a.shapes.len() * b.shapes.len()) as f64;
    let from_a = b.shapes.iter().map(|y| cosine(a, &a.shapes[a.best], b, y)).fold(0.0, f64::max);
    let from_b = a.shapes.iter().map(|x| cosine(b, &b.shapes[b.best], a, x)).fold(0.0, f64::max);
    let (a_after_b, b_after_a) = (joint - b.fall(), joint - a.fall());
    Pair {
        a: a.candidate.effect.clone(),
        b: b.candidate.effect.clone(),
        joint_fall: within,
        a_after_b,
        b_after_a,
        p_value: (shapes * chi2_sf(joint, sides.len() as f64)).min(1.0),
        angle_degrees: from_a.max(from_b).min(1.0).acos().to_degrees(),
        alike: alike(a, b, (a_after_b, b_after_a), from_a.max(from_b), policy),
    }
}

/// Alike when seen on this misfit (both explain it, and neither adds to the other), or when in principle:
/// a small angle, and a signal (found or plausible) too small to show what is left between them.
fn alike(
    a: &Projected,
    b: &Projected,
    (a_after_b, b_after_a): (f64, f64),
    cosine: f64,
    policy: &Policy,
) -> bool {
    let strong = |p: &Projected| p.fall() >= policy.min_fall;
    let nothing_more = a_after_b < policy.separate_chi2 && b_after_a < policy.separate_chi2;
    if strong(a) && strong(b) {
        return nothing_more;
    }
    let close = cosine >= policy.look_alike_degrees.to_radians().cos();
    let signal = |p: &Projected| p.fall().max(p.snr(p.best).powi(2));
    let sine2 = 1.0 - cosine.min(1.0).powi(2);
    close && nothing_more && signal(a).min(signal(b)) * sine2 < policy.separate_chi2
}

/// Cosine of the smallest principal angle between two spans; signed amplitudes must also agree in sign.
fn cosine(a: &Projected, x: &DMatrix<f64>, b: &Projected, y: &DMatrix<f64>) -> f64 {
    if x.norm() == 0.0 || y.norm() == 0.0 {
        return 0.0;
    }
    if x.ncols() == 1 && y.ncols() == 1 {
        let c = x.dot(y) / (x.norm() * y.norm());
        let sign = |s: Side| match s {
            Side::Both => 0.0,
            Side::Positive => 1.0,
            Side::Negative => -1.0,
        };
        let product = sign(a.sides[0]) * sign(b.sides[0]);
        return if product == 0.0 { c.abs() } else { (c * product).max(0.0) };
    }
    let (p, q) = (orthonormal(x), orthonormal(y));
    p.tr_mul(&q).singular_values().max().clamp(0.0, 1.0)
}

fn hstack(x: &DMatrix<f64>, y: &DMatrix<f64>) -> DMatrix<f64> {
    let mut both = DMatrix::zeros(x.nrows(), x.ncols() + y.ncols());
    both.columns_mut(0, x.ncols()).copy_from(x);
    both.columns_mut(x.ncols(), y.ncols()).copy_from(y);
    both
}

/// Standard deviations at which effect `a` (whitened column times its expected amplitude) would show beyond the
/// base jacobian *and* a rival's columns: how well a planned record separates them. `power(snr, alpha, …)`
/// turns it into the chance of success.
pub fn separation(jacobian: &DMatrix<f64>, a: &DVector<f64>, rival: &DMatrix<f64>) -> f64 {
    let q = orthonormal(&hstack(jacobian, rival));
    (a - &q * q.tr_mul(a)).norm()
}
