//! Where the node lines lie along each axis.

use crate::strip::{check_count, check_size};
use crate::{MeshError, Sizing, Strip};

/// Largest ratio of neighbouring element sizes that the grading aims at.
const GROWTH: f64 = 1.3;
/// Beyond this ratio of neighbours the smaller element counts as degenerate.
const MOST_CONTRAST: f64 = 50.0;

/// Node lines of the meshed part of a strip, mm.
#[derive(Debug)]
pub(crate) struct Lines {
    /// Distance from the left edge along the tear path.
    pub x: Vec<f64>,
    /// Height.
    pub y: Vec<f64>,
    /// From mid-thickness, for the nominal thickness.
    pub z: Vec<f64>,
    /// Line of `x` at the tip of the cut.
    pub tip: usize,
    /// Line of `y` on the tear path; `None` only for an intact strip of one element.
    pub path: Option<usize>,
}

impl Lines {
    pub(crate) fn new(strip: &Strip) -> Result<Self, MeshError> {
        let x = x_lines(strip)?;
        let tip = nearest(&x, strip.cut);
        let mut y = y_lines(strip)?;
        let intact_block = y.len() == 2;
        let mut path = (!intact_block).then(|| nearest(&y, strip.path_y()));
        if strip.half_height {
            y.drain(..path.unwrap_or(0));
            path = Some(0);
        }
        check_contrast('x', &x)?;
        check_contrast('y', &y)?;
        let z = z_lines(strip);
        let parts = strip.split.max(1);
        let along = |lines: &[f64]| (lines.len() - 1) as f64 * parts as f64;
        check_count(along(&x) * along(&y) * along(&z))?;
        let (tip, path) = (tip * parts, path.map(|path| path * parts));
        Ok(Self { x: split(&x, parts), y: split(&y, parts), z: split(&z, parts), tip, path })
    }
}

fn x_lines(strip: &Strip) -> Result<Vec<f64>, MeshError> {
    let (width, cut) = (strip.path_width(), strip.cut);
    match strip.sizing {
        Sizing::Divisions([n, _, _]) if cut > 0.0 => with_line_at('x', n, width, cut, "the tip of the cut"),
        Sizing::Divisions([n, _, _]) => Ok(uniform(n, width)),
        Sizing::Graded { bulk_size, path_size, .. } => {
            let ligament = width - cut;
            check_size("ligament ahead of the cut", ligament)?;
            let n = count(ligament, path_size);
            let size = ligament / n as f64;
            let behind = if cut > 0.0 { graded(cut, size, bulk_size) } else { Vec::new() };
            let mut lines = lines_down(cut, &behind);
            lines.extend((1..n).map(|i| cut + size * i as f64));
            lines.push(width);
            Ok(lines)
        }
    }
}

fn y_lines(strip: &Strip) -> Result<Vec<f64>, MeshError> {
    let (length, path_y) = (strip.length, strip.path_y());
    match strip.sizing {
        Sizing::Divisions([_, 1, _]) if !strip.tear => Ok(uniform(1, length)),
        Sizing::Divisions([_, n, _]) => with_line_at('y', n, length, path_y, "the tear path"),
        Sizing::Graded { bulk_size, path_size, .. } => {
            let above = from_path(length - path_y, path_size, bulk_size);
            let below =
                if strip.is_centred() { above.clone() } else { from_path(path_y, path_size, bulk_size) };
            let mut lines = lines_down(path_y, &below);
            let mut at = path_y;
            lines.extend(above.iter().map(|size| {
                at += size;
                at
            }));
            let last = lines.len() - 1;
            lines[last] = length;
            Ok(lines)
        }
    }
}

/// Symmetric about z = 0; the half has the same lines when the number of layers is even.
fn z_lines(strip: &Strip) -> Vec<f64> {
    let layers = match strip.sizing {
        Sizing::Divisions([_, _, n]) => n,
        Sizing::Graded { layers, .. } => layers,
    };
    let (steps, from) = if strip.half_thickness {
        let half = layers.div_ceil(2);
        (2 * half, half)
    } else {
        (layers, 0)
    };
    let z = |k: usize| strip.thickness * ((2 * k) as f64 - steps as f64) / (2 * steps) as f64;
    (from..=steps).map(z).collect()
}

fn uniform(n: usize, length: f64) -> Vec<f64> {
    (0..=n).map(|i| length * i as f64 / n as f64).collect()
}

/// Uniform lines with the one nearest to `at`, but not the first or the last, moved there.
fn with_line_at(
    axis: char,
    n: usize,
    length: f64,
    at: f64,
    what: &'static str,
) -> Result<Vec<f64>, MeshError> {
    if n < 2 {
        return Err(MeshError::TooFewDivisions { axis, at, what, divisions: n });
    }
    let mut lines = uniform(n, length);
    let line = nearest(&lines[1..n], at) + 1;
    lines[line] = at;
    Ok(lines)
}

/// Every interval cut into equal parts.
fn split(lines: &[f64], parts: usize) -> Vec<f64> {
    let inner = |w: &[f64]| {
        let (from, size) = (w[0], w[1] - w[0]);
        (0..parts).map(move |part| from + size * part as f64 / parts as f64)
    };
    lines.windows(2).flat_map(inner).chain(lines.last().copied()).collect()
}

/// Index of the line nearest to `at`; the lines increase.
fn nearest(lines: &[f64], at: f64) -> usize {
    let after = lines.partition_point(|&line| line < at);
    if after == 0 {
        return 0;
    }
    match lines.get(after) {
        Some(&line) if line - at < at - lines[after - 1] => after,
        _ => after - 1,
    }
}

/// Increasing lines from 0 to `from`, given the sizes met when going down from `from`.
fn lines_down(from: f64, sizes: &[f64]) -> Vec<f64> {
    let mut lines = vec![from];
    let mut at = from;
    lines.extend(sizes.iter().map(|size| {
        at -= size;
        at
    }));
    if let [.., last] = lines.as_mut_slice()
        && !sizes.is_empty()
    {
        *last = 0.0;
    }
    lines.reverse();
    lines
}

/// Least number of equal elements not larger than `size`, allowing for rounding.
fn count(length: f64, size: f64) -> usize {
    ((length / size) * (1.0 - 1e-9)).ceil().max(1.0) as usize
}

/// Sizes from the tear path outwards: `path` next to it, then growing to `bulk`.
fn from_path(length: f64, path: f64, bulk: f64) -> Vec<f64> {
    // Not enough room for one element of the path's size and a decent neighbour.
    if length < 1.76 * path {
        let n = count(length, path);
        return vec![length / n as f64; n];
    }
    let mut sizes = vec![path];
    sizes.extend(graded(length - path, path, bulk));
    sizes
}

/// Sizes that fill `length`, growing geometrically from a neighbour of size `first` up to `most`.
///
/// The ratio r of neighbours solves Σ min(first·rᵏ, most) = length for the least number of elements with
/// r ≤ 1.3. Only where there is no room to grow is r below 1 (not below 0.75 from two elements on), or up to
/// 1.33; a length below 0.75 `first` is one smaller element.
fn graded(length: f64, first: f64, most: f64) -> Vec<f64> {
    let (mut n, mut filled) = (0, 0.0);
    for size in sizes(first, GROWTH, most) {
        (n, filled) = (n + 1, filled + size);
        if filled >= length * (1.0 - 1e-9) {
            break;
        }
    }
    let mut ratio = fit(length, first, most, n);
    if let (true, Some(r)) = (n > 1, ratio)
        && r < 1.0
        && let Some(fewer) = fit(length, first, most, n - 1)
        && fewer.ln().abs() < r.ln().abs()
    {
        (ratio, n) = (Some(fewer), n - 1);
    }
    let mut sizes: Vec<f64> = sizes(first, ratio.unwrap_or(GROWTH), most).take(n).collect();
    let exact = length / sizes.iter().sum::<f64>();
    sizes.iter_mut().for_each(|size| *size *= exact);
    sizes
}

fn sizes(first: f64, ratio: f64, most: f64) -> impl Iterator<Item = f64> {
    std::iter::successors(Some((first * ratio).min(most)), move |size| Some((size * ratio).min(most)))
}

fn sum(first: f64, ratio: f64, most: f64, n: usize) -> f64 {
    sizes(first, ratio, most).take(n).sum()
}

/// The ratio at which `n` sizes fill `length`, by bisection; `None` if they cannot.
fn fit(length: f64, first: f64, most: f64, n: usize) -> Option<f64> {
    let (mut low, mut high) = (0.0, 1.4);
    if sum(first, high, most, n) < length * (1.0 - 1e-9) {
        return None;
    }
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if sum(first, middle, most, n) < length { low = middle } else { high = middle }
    }
    Some(high)
}

fn check_contrast(axis: char, lines: &[f64]) -> Result<(), MeshError> {
    for three in lines.windows(3) {
        let (a, b) = (three[1] - three[0], three[2] - three[1]);
        let (size, neighbour) = (a.min(b), a.max(b));
        // Written so that NaN fails.
        if !(size * MOST_CONTRAST >= neighbour && size > 0.0) {
            let [at, size, neighbour] = [three[1], size, neighbour].map(rounded);
            return Err(MeshError::TooThin { axis, at, size, neighbour });
        }
    }
    Ok(())
}

/// Four significant digits, for messages.
fn rounded(value: f64) -> f64 {
    format!("{value:.3e}").parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn graded_sizes_fill_the_length_within_the_ratio() {
        for i in 1..4000 {
            let length = 0.08 + 0.005 * i as f64;
            let sizes = graded(length, 0.1, 0.4);
            approx::assert_relative_eq!(sizes.iter().sum::<f64>(), length, max_relative = 1e-12);
            let mut before = 0.1;
            for (k, &size) in sizes.iter().enumerate() {
                let ratio = f64::max(size / before, before / size);
                assert!(ratio < 1.34, "length {length}: element {k} of {sizes:?}");
                assert!(size <= 0.4 * (1.0 + 1e-9));
                before = size;
            }
            let grows = sizes.windows(2).all(|s| s[1] >= s[0] * (1.0 - 1e-9));
            let shrinks = sizes.windows(2).all(|s| s[1] <= s[0] * (1.0 + 1e-9));
            assert!(grows || shrinks, "length {length}: {sizes:?}");
        }
    }

    #[test]
    fn equal_sizes_stay_equal() {
        assert_eq!(graded(1.0, 0.1, 0.1).len(), 10);
        assert_eq!(count(0.9, 0.1), 9);
        assert_eq!(from_path(0.2, 0.1, 0.1).len(), 2);
    }

    #[test]
    fn nearest_line() {
        let lines = [0.0, 1.0, 2.0];
        for (at, line) in [(-1.0, 0), (0.4, 0), (0.6, 1), (1.0, 1), (1.9, 2), (9.0, 2)] {
            assert_eq!(nearest(&lines, at), line, "{at}");
        }
        // Of two it is the distance that counts, wherever zero is.
        assert_eq!(nearest(&[5.0, 6.0, 9.0], 8.0), 2);
        assert_eq!(nearest(&[5.0, 6.0, 9.0], 7.0), 1);
    }
}
