//! The deformed strip at the typical points with contours of the axial Cauchy stress S22 (the
//! paper's Fig. 7), as one SVG per test, from the same fields as the VTU files.

use super::Snapshot;
use super::vtu::Grid;
use crate::terminal::significant;
use std::fmt::Write;

/// Viridis in ten steps: even to the eye, and to colour-blind eyes.
const COLOURS: [&str; 10] = [
    "#440154", "#482878", "#3e4a89", "#31688e", "#26828e", "#1f9e89", "#35b779", "#6dcd59", "#b4de2c",
    "#fde725",
];
/// Faces of a brick in VTK's order of nodes.
const FACES: [[usize; 4]; 6] =
    [[0, 1, 2, 3], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]];
/// Panels beside each other.
const COLUMNS: usize = 4;
/// Size of a panel and of the captions under it, px.
const PANEL: [f64; 2] = [170.0, 190.0];
const CAPTION: f64 = 34.0;
const BAR: f64 = 46.0;

/// A corner of a triangle: where it is now, mm, and its S22, MPa.
type Corner = ([f64; 2], f64);

/// The picture of one test; `None` without fields.
pub fn svg(test: &str, snapshots: &[Snapshot]) -> Option<String> {
    let panels: Vec<Vec<[Corner; 4]>> = snapshots.iter().map(|s| front(&s.bulk)).collect();
    let all: Vec<&Corner> = panels.iter().flatten().flatten().collect();
    if all.is_empty() {
        return None;
    }
    let most = upper(&all);
    let frame = Frame::of(&all);
    let rows = panels.len().div_ceil(COLUMNS);
    let (width, height) = (PANEL[0] * COLUMNS as f64, (PANEL[1] + CAPTION) * rows as f64 + BAR);
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\" \
         font-family=\"sans-serif\" font-size=\"12\" role=\"img\">\n<title>{test}: deformed strip, S22</title>\n\
         <rect width=\"{width}\" height=\"{height}\" fill=\"#FFFFFF\"/>\n",
        test = test.replace('&', "&amp;").replace('<', "&lt;"),
    );
    for (n, (quads, s)) in panels.iter().zip(snapshots).enumerate() {
        let x = (n % COLUMNS) as f64 * PANEL[0];
        let y = (n / COLUMNS) as f64 * (PANEL[1] + CAPTION);
        // Writing to a String cannot fail.
        let _ = writeln!(out, "<g transform=\"translate({x} {y})\">");
        contours(&mut out, quads, &frame, most);
        let middle = PANEL[0] / 2.0;
        let (u, f) = (
            significant(s.point.displacement, 3),
            significant(if s.point.force.abs() < 1e-9 { 0.0 } else { s.point.force }, 3),
        );
        let _ = writeln!(
            out,
            "<text x=\"{middle}\" y=\"{}\" text-anchor=\"middle\" fill=\"#222226\">{}: {u} mm, {f} N</text></g>",
            PANEL[1] + 16.0,
            n + 1,
        );
    }
    bar(&mut out, most, width, height);
    out.push_str("</svg>\n");
    Some(out)
}

/// The faces seen from the front: those at the largest z, deformed, with nodal S22.
fn front(grid: &Grid) -> Vec<[Corner; 4]> {
    let (u, s22) = (grid.point_field("displacement"), grid.point_field("S22"));
    let z = grid.points.iter().map(|p| p[2]).fold(f64::MIN, f64::max);
    let flat = |n: usize| grid.points[n][2] > z - 1e-9;
    let corner = |n: usize| -> Option<Corner> {
        let p = grid.points[n];
        Some(([p[0] + u.get(3 * n)?, p[1] + u.get(3 * n + 1)?], *s22.get(n)?))
    };
    let faces = grid.cells.iter().filter(|c| c.len() == 8).flat_map(|c| FACES.map(|f| f.map(|i| c[i])));
    faces
        .filter(|f| f.iter().all(|&n| flat(n)))
        .filter_map(|[a, b, c, d]| Some([corner(a)?, corner(b)?, corner(c)?, corner(d)?]))
        .collect()
}

/// Upper end of the scale: the 98th percentile, so that one corner of a clamp does not set it.
fn upper(all: &[&Corner]) -> f64 {
    let mut values: Vec<f64> = all.iter().map(|c| c.1).filter(|v| v.is_finite()).collect();
    values.sort_by(f64::total_cmp);
    let at = (values.len().saturating_sub(1) as f64 * 0.98) as usize;
    values.get(at).copied().unwrap_or(0.0).max(1e-9)
}

/// From mm to a panel's px, the same in every panel.
struct Frame {
    low: [f64; 2],
    scale: f64,
    shift: [f64; 2],
}

impl Frame {
    fn of(all: &[&Corner]) -> Self {
        let ends = |k: usize| {
            all.iter().map(|c| c.0[k]).fold((f64::MAX, f64::MIN), |(l, h), v| (l.min(v), h.max(v)))
        };
        let ((x0, x1), (y0, y1)) = (ends(0), ends(1));
        let size = [(x1 - x0).max(1e-9), (y1 - y0).max(1e-9)];
        let room = [PANEL[0] - 16.0, PANEL[1] - 10.0];
        let scale = (room[0] / size[0]).min(room[1] / size[1]);
        let shift = [(PANEL[0] - scale * size[0]) / 2.0, PANEL[1] - 2.0];
        Self { low: [x0, y0], scale, shift }
    }
    fn place(&self, p: [f64; 2]) -> [f64; 2] {
        let [x, y] = [p[0] - self.low[0], p[1] - self.low[1]];
        [self.shift[0] + self.scale * x, self.shift[1] - self.scale * y]
    }
}

/// Filled contours: every quad as four triangles about its middle, each cut into bands of S22.
fn contours(out: &mut String, quads: &[[Corner; 4]], frame: &Frame, most: f64) {
    let mut paths = vec![String::new(); COLOURS.len()];
    for quad in quads {
        let middle = mean(quad);
        if whole(&mut paths, quad, frame, most) {
            continue;
        }
        for k in 0..4 {
            triangle(&mut paths, [quad[k], quad[(k + 1) % 4], middle], frame, most);
        }
    }
    for (path, colour) in paths.iter().zip(COLOURS).filter(|p| !p.0.is_empty()) {
        // The thin line of the same colour closes the seams that antialiasing leaves.
        let _ = writeln!(
            out,
            "<path transform=\"scale(.1)\" d=\"{path}\" fill=\"{colour}\" stroke=\"{colour}\" stroke-width=\"5\"/>"
        );
    }
}

/// A quad within one band needs no cutting; most are.
fn whole(paths: &mut [String], quad: &[Corner; 4], frame: &Frame, most: f64) -> bool {
    let band = level(quad[0].1, most, paths.len());
    let one = quad.iter().all(|c| level(c.1, most, paths.len()) == band);
    if one {
        draw(&mut paths[band], quad, frame);
    }
    one
}

/// Band of a value.
fn level(v: f64, most: f64, bands: usize) -> usize {
    ((v / most * bands as f64).floor().max(0.0) as usize).min(bands - 1)
}

/// Tenths of a pixel, each corner from the one before: a picture of a fine mesh stays a small file. What is smaller than
/// that is not drawn.
fn draw(path: &mut String, polygon: &[Corner], frame: &Frame) {
    let tenths = |c: &Corner| frame.place(c.0).map(|x| (10.0 * x).round() as i64);
    let mut corners: Vec<[i64; 2]> = polygon.iter().map(tenths).collect();
    corners.dedup();
    if corners.len() < 3 {
        return;
    }
    // Writing to a String cannot fail.
    let _ = write!(path, "M{} {}l", corners[0][0], corners[0][1]);
    for (i, pair) in corners.windows(2).enumerate() {
        for (k, d) in [pair[1][0] - pair[0][0], pair[1][1] - pair[0][1]].into_iter().enumerate() {
            // A minus sign separates, too.
            let gap = if d < 0 || (i == 0 && k == 0) { "" } else { " " };
            let _ = write!(path, "{gap}{d}");
        }
    }
    path.push('z');
}

fn mean(quad: &[Corner; 4]) -> Corner {
    let sum = |f: &dyn Fn(&Corner) -> f64| quad.iter().map(f).sum::<f64>() / 4.0;
    ([sum(&|c| c.0[0]), sum(&|c| c.0[1])], sum(&|c| c.1))
}

fn triangle(paths: &mut [String], corners: [Corner; 3], frame: &Frame, most: f64) {
    let bands = paths.len();
    let levels = corners.map(|c| level(c.1, most, bands));
    let (first, last) =
        (levels.iter().min().copied().unwrap_or(0), levels.iter().max().copied().unwrap_or(0));
    for (band, path) in paths.iter_mut().enumerate().take(last + 1).skip(first) {
        let mut polygon = corners.to_vec();
        if band > first {
            polygon = clip(&polygon, most * band as f64 / bands as f64, 1.0);
        }
        if band < last {
            polygon = clip(&polygon, most * (band + 1) as f64 / bands as f64, -1.0);
        }
        if polygon.len() > 2 {
            draw(path, &polygon, frame);
        }
    }
}

/// The part of a polygon where `sign · (value − at) ≥ 0` (Sutherland & Hodgman's step).
fn clip(polygon: &[Corner], at: f64, sign: f64) -> Vec<Corner> {
    let mut out = Vec::with_capacity(polygon.len() + 1);
    for (i, &(p, v)) in polygon.iter().enumerate() {
        let (q, w) = polygon[(i + 1) % polygon.len()];
        let (here, there) = (sign * (v - at) >= 0.0, sign * (w - at) >= 0.0);
        if here {
            out.push((p, v));
        }
        if here != there {
            let t = (at - v) / (w - v);
            out.push(([p[0] + t * (q[0] - p[0]), p[1] + t * (q[1] - p[1])], at));
        }
    }
    out
}

/// The colour scale underneath, in kPa.
fn bar(out: &mut String, most: f64, width: f64, height: f64) {
    let (x, y, w) = (width * 0.2, height - BAR + 8.0, width * 0.6 / COLOURS.len() as f64);
    for (i, colour) in COLOURS.iter().enumerate() {
        let _ = write!(
            out,
            "<rect x=\"{:.1}\" y=\"{y}\" width=\"{w:.1}\" height=\"10\" fill=\"{colour}\"/>",
            x + w * i as f64
        );
    }
    for i in [0, 5, 10] {
        let value = significant(1e3 * most * f64::from(i) / 10.0, 3);
        let end = if i == 10 { " kPa and more" } else { "" };
        let _ = writeln!(
            out,
            "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\" fill=\"#222226\">{value}{end}</text>",
            x + w * f64::from(i),
            y + 26.0,
        );
    }
    let _ = writeln!(
        out,
        "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\" fill=\"#222226\">Cauchy stress S22</text>",
        x - 10.0,
        y + 10.0
    );
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Bands of a triangle tile it: their areas add up to its own.
    #[test]
    fn bands_tile_a_triangle() {
        let corners: [Corner; 3] = [([0.0, 0.0], 0.0), ([4.0, 0.0], 7.0), ([0.0, 3.0], 10.0)];
        let area = |p: &[Corner]| -> f64 {
            let next = |i: usize| p[(i + 1) % p.len()].0;
            (0..p.len()).map(|i| p[i].0[0] * next(i)[1] - next(i)[0] * p[i].0[1]).sum::<f64>().abs() / 2.0
        };
        let bands = (0..10).map(|k| {
            let low = clip(&corners, f64::from(k), 1.0);
            area(&clip(&low, f64::from(k + 1), -1.0))
        });
        assert!((bands.sum::<f64>() - 6.0).abs() < 1e-12);
    }
}
