//! Integration of a peaked function of one or two variables on a lattice that is laid by its own curvature.

use std::collections::BTreeMap;

/// Cells whose integrand is below the largest by more than this (nats) are left out.
const DEPTH: f64 = 8.0;
/// Most cells of a lattice.
const MOST: usize = 600;

/// Points with the logarithm of the volume each stands for, so that Σ exp(f + ln volume) is ∫ exp(f).
/// `f` must have a maximum and fall towards all sides; on a lattice one standard deviation wide the error for a Gaussian is
/// 2·exp(−2π²). Cells where `f` is below `floor` are left out. Empty where it is all around its maximum, or vanishes (−∞) all around
/// the start.
pub(crate) fn lattice(
    dimensions: usize,
    start: [f64; 2],
    floor: f64,
    mut f: impl FnMut([f64; 2]) -> f64,
) -> Vec<([f64; 2], f64)> {
    let top = if dimensions > 0 { climb(dimensions, start, &mut f) } else { [0.0; 2] };
    let mut most = f(top);
    if !most.is_finite() || most < floor {
        return Vec::new();
    }
    if dimensions == 0 {
        return vec![(top, 0.0)];
    }
    let axes = axes(dimensions, top, &mut f);
    let at = |c: (i32, i32)| {
        let (i, j) = (f64::from(c.0), f64::from(c.1));
        [0, 1].map(|k| top[k] + axes[0][k] * i + axes[1][k] * j)
    };
    let mut known: BTreeMap<(i32, i32), f64> = BTreeMap::new();
    let mut open = vec![(0, 0)];
    known.insert((0, 0), most);
    while !open.is_empty() && known.len() < MOST {
        let mut next = Vec::new();
        for &c in &open {
            if known[&c] < floor.max(most - DEPTH) {
                continue;
            }
            let mut around = vec![(c.0 - 1, c.1), (c.0 + 1, c.1)];
            if dimensions > 1 {
                around.extend([(c.0, c.1 - 1), (c.0, c.1 + 1)]);
            }
            for n in around {
                if let std::collections::btree_map::Entry::Vacant(place) = known.entry(n) {
                    let value = *place.insert(f(at(n)));
                    most = most.max(value);
                    next.push(n);
                }
            }
        }
        open = next;
    }
    let volume = if dimensions == 1 {
        axes[0][0].abs()
    } else {
        (axes[0][0] * axes[1][1] - axes[0][1] * axes[1][0]).abs()
    };
    let kept = known.into_iter().filter(|(_, value)| *value >= floor.max(most - DEPTH));
    kept.map(|(c, _)| (at(c), volume.ln())).collect()
}

/// Uphill by steps along the axes that halve where none helps.
fn climb(dimensions: usize, start: [f64; 2], f: &mut impl FnMut([f64; 2]) -> f64) -> [f64; 2] {
    let (mut x, mut step) = (start, 0.8);
    let mut best = f(x);
    for _ in 0..60 {
        let mut moved = false;
        for k in 0..dimensions {
            for sign in [1.0, -1.0] {
                let mut y = x;
                y[k] += sign * step;
                let value = f(y);
                if value > best {
                    (x, best, moved) = (y, value, true);
                    break;
                }
            }
        }
        if !moved {
            step *= 0.5;
            if step < 0.04 {
                break;
            }
        }
    }
    x
}

/// Principal axes of the peak, one standard deviation long, at most 0.7.
fn axes(dimensions: usize, top: [f64; 2], f: &mut impl FnMut([f64; 2]) -> f64) -> [[f64; 2]; 2] {
    const H: f64 = 0.1;
    const LEAST: f64 = 1.0 / (0.7 * 0.7);
    let middle = f(top);
    let mut second = |k: usize| {
        let mut ends = [top, top];
        ends[0][k] += H;
        ends[1][k] -= H;
        (2.0 * middle - f(ends[0]) - f(ends[1])) / (H * H)
    };
    let a = second(0);
    if dimensions == 1 {
        return [[a.max(LEAST).sqrt().recip(), 0.0], [0.0, 1.0]];
    }
    let d = second(1);
    let mut corner = |x: f64, y: f64| f([top[0] + x, top[1] + y]);
    let b = -(corner(H, H) - corner(H, -H) - corner(-H, H) + corner(-H, -H)) / (4.0 * H * H);
    let eigen = nalgebra::Matrix2::new(a, b, b, d).symmetric_eigen();
    [0, 1].map(|k| {
        let length = eigen.eigenvalues[k].max(LEAST).sqrt().recip();
        [eigen.eigenvectors[(0, k)] * length, eigen.eigenvectors[(1, k)] * length]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn total(dimensions: usize, f: impl Fn([f64; 2]) -> f64) -> (f64, usize) {
        let cells = lattice(dimensions, [-4.0, -5.0], f64::NEG_INFINITY, &f);
        (cells.iter().map(|(x, v)| (f(*x) + v).exp()).sum(), cells.len())
    }

    #[test]
    fn sharp_wide_and_skewed_peaks_are_integrated() {
        let tau = std::f64::consts::TAU;
        for sd in [0.02, 0.1, 0.5, 2.0] {
            let (got, cells) = total(1, |x| -0.5 * ((x[0] + 3.3) / sd).powi(2));
            assert!((got / (sd * tau.sqrt()) - 1.0).abs() < 2e-3 && cells < 60, "{sd}: {got} {cells}");
            let f = |x: [f64; 2]| {
                let (a, b) = (x[0] + 3.3, x[1] + 4.1);
                -0.5 * (a * a + b * b - 1.6 * a * b) / (0.36 * sd * sd)
            };
            let (got, cells) = total(2, f);
            assert!((got / (tau * sd * sd * 0.6) - 1.0).abs() < 5e-3 && cells < 600, "{sd}: {got} {cells}");
        }
        // What is below a floor is left out, and nothing is looked at where all is.
        let peak = |x: [f64; 2]| -0.5 * (x[0] + 3.3).powi(2);
        let kept = |floor: f64| lattice(1, [-4.0, 0.0], floor, peak);
        assert!(kept(-2.0).iter().all(|(x, _)| peak(*x) >= -2.0) && kept(-2.0).len() > 3);
        assert!(kept(-2.0).len() < kept(f64::NEG_INFINITY).len() && kept(0.1).is_empty());
        // ∫ e^y exp(−½ e^{2y}) dy = √(π/2): a half-normal in the logarithm.
        let (got, _) = total(1, |x| x[0] - 0.5 * (2.0 * x[0]).exp());
        assert!((got / (0.25 * tau).sqrt() - 1.0).abs() < 2e-3, "{got}");
        // ∫ exp(−k (y + e^{−y})) dy = Γ(k)/k^k: what a likelihood with 2k degrees of freedom makes.
        let (got, _) = total(1, |x| -6.0 * (x[0] + (-x[0]).exp()));
        assert!((got / (120.0 / 6f64.powi(6)) - 1.0).abs() < 2e-3, "{got}");
    }
}
