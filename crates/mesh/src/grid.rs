//! From node lines to nodes, hexes, cohesive quads and sets.

use std::collections::BTreeMap;

use crate::lines::Lines;
use crate::{Interface, Mesh, MeshError, Strip, quality};

/// Meshes a strip.
///
/// The intact and the torn mesh of a strip, alike but for `tear`, have the same hexes in the same order, and the same
/// numbers for all nodes but the upper side of the tear path, which comes last.
///
/// # Errors
/// If a number is not sensible, the cut or tear path is out of place, the shape does not have the symmetry asked for,
/// or an element would be degenerate.
pub fn strip(strip: &Strip) -> Result<Mesh, MeshError> {
    strip.validate()?;
    let lines = Lines::new(strip)?;
    let grid = Grid::new(strip, &lines);
    let (nodes, columns) = grid.nodes();
    let mesh = Mesh {
        nodes,
        columns,
        hexes: grid.hexes(),
        interfaces: if strip.tear { grid.interfaces() } else { Vec::new() },
        grid: grid.n,
        sets: grid.sets(),
        path_y: strip.path_y(),
        path_width: strip.path_width(),
        cut: strip.cut,
        half_height: strip.half_height,
        half_thickness: strip.half_thickness,
    };
    grid.check_jacobians(&mesh)?;
    Ok(mesh)
}

struct Grid<'a> {
    strip: &'a Strip,
    lines: &'a Lines,
    /// Node lines along x, y, z.
    n: [usize; 3],
    /// Line of y whose nodes are doubled.
    doubled: Option<usize>,
}

impl<'a> Grid<'a> {
    fn new(strip: &'a Strip, lines: &'a Lines) -> Self {
        let n = [lines.x.len(), lines.y.len(), lines.z.len()];
        let doubled = lines.path.filter(|_| strip.tear && !strip.half_height);
        Self { strip, lines, n, doubled }
    }

    fn node(&self, i: usize, j: usize, k: usize) -> usize {
        (j * self.n[0] + i) * self.n[2] + k
    }

    /// The node seen from above the line j: differs from `node` on the doubled line.
    fn node_above(&self, i: usize, j: usize, k: usize) -> usize {
        if self.doubled == Some(j) {
            self.n.iter().product::<usize>() + i * self.n[2] + k
        } else {
            self.node(i, j, k)
        }
    }

    fn nodes(&self) -> (Vec<[f64; 3]>, Vec<[usize; 2]>) {
        let rows = (0..self.n[1]).chain(self.doubled);
        rows.flat_map(|j| (0..self.n[0]).map(move |i| [i, j]))
            .flat_map(|column| (0..self.n[2]).map(move |k| (column, k)))
            .map(|([i, j], k)| (self.place(i, j, k), [i, j]))
            .unzip()
    }

    /// Reference coordinates of a grid point, mapped to the outline and the thickness profile.
    fn place(&self, i: usize, j: usize, k: usize) -> [f64; 3] {
        let (x, y, z) = (self.lines.x[i], self.lines.y[j], self.lines.z[k]);
        let x = match &self.strip.outline {
            Some(outline) => outline.left(y) + x / self.strip.path_width() * outline.width(y),
            None => x,
        };
        let z = match &self.strip.thickness_profile {
            Some(profile) => z / self.strip.thickness * profile.at(y),
            None => z,
        };
        [x, y, z]
    }

    fn hexes(&self) -> Vec<[usize; 8]> {
        let [nx, ny, nz] = self.n.map(|n| n - 1);
        let mut hexes = Vec::with_capacity(nx * ny * nz);
        for j in 0..ny {
            for i in 0..nx {
                for k in 0..nz {
                    let quad = |k| {
                        [
                            self.node_above(i, j, k),
                            self.node_above(i + 1, j, k),
                            self.node(i + 1, j + 1, k),
                            self.node(i, j + 1, k),
                        ]
                    };
                    let ([a, b, c, d], [e, f, g, h]) = (quad(k), quad(k + 1));
                    hexes.push([a, b, c, d, e, f, g, h]);
                }
            }
        }
        hexes
    }

    fn interfaces(&self) -> Vec<Interface> {
        let Some(j) = self.lines.path else { return Vec::new() };
        let quads = |i: usize| (0..self.n[2] - 1).map(move |k| (i, k));
        (self.lines.tip..self.n[0] - 1)
            .flat_map(quads)
            .map(|(i, k)| {
                let corners = [(i, k), (i, k + 1), (i + 1, k + 1), (i + 1, k)];
                Interface {
                    lower: corners.map(|(i, k)| self.node(i, j, k)),
                    upper: self.doubled.map(|_| corners.map(|(i, k)| self.node_above(i, j, k))),
                    x: [self.lines.x[i], self.lines.x[i + 1]],
                }
            })
            .collect()
    }

    /// Grid nodes of the given ranges, and, on the doubled line, those of the upper side too.
    fn pick(
        &self,
        i: std::ops::RangeInclusive<usize>,
        j: std::ops::RangeInclusive<usize>,
        k: std::ops::RangeInclusive<usize>,
    ) -> Vec<usize> {
        let mut picked = Vec::new();
        for j in j {
            for i in i.clone() {
                for k in k.clone() {
                    picked.push(self.node(i, j, k));
                    if self.doubled == Some(j) {
                        picked.push(self.node_above(i, j, k));
                    }
                }
            }
        }
        picked
    }

    fn sets(&self) -> BTreeMap<String, Vec<usize>> {
        let [i, j, k] = self.n.map(|n| n - 1);
        let (xs, ys, zs) = (0..=i, 0..=j, 0..=k);
        let pick = |i: &std::ops::RangeInclusive<usize>, j, k| self.pick(i.clone(), j, k);
        let mut sets = BTreeMap::new();
        let mut add = |name: &str, nodes| sets.insert(name.to_owned(), nodes);
        add("top", pick(&xs, j..=j, zs.clone()));
        add("mouth_top", self.pick(0..=0, j..=j, zs.clone()));
        add("left", self.pick(0..=0, ys.clone(), zs.clone()));
        add("right", self.pick(i..=i, ys.clone(), zs.clone()));
        if self.strip.half_height {
            add("mid_height", pick(&xs, 0..=0, zs.clone()));
        } else {
            add("bottom", pick(&xs, 0..=0, zs.clone()));
            add("mouth_bottom", self.pick(0..=0, 0..=0, zs.clone()));
        }
        if self.strip.half_thickness {
            add("mid_thickness", pick(&xs, ys, 0..=0));
        }
        if let Some(mid) = self.mid_line() {
            add("left_mid", self.pick(0..=0, mid..=mid, zs.clone()));
            add("right_mid", self.pick(i..=i, mid..=mid, zs.clone()));
        }
        if let Some(path) = self.doubled {
            let both = self.pick(xs, path..=path, zs);
            add("path_lower", both.iter().copied().step_by(2).collect());
            add("path_upper", both.iter().copied().skip(1).step_by(2).collect());
        }
        sets
    }

    /// The line of y nearest to mid-height: the tear path where that is centred.
    fn mid_line(&self) -> Option<usize> {
        self.lines.path?;
        let away = |j: &usize| (self.lines.y[*j] - 0.5 * self.strip.length).abs();
        (0..self.n[1]).min_by(|a, b| away(a).total_cmp(&away(b)))
    }

    fn check_jacobians(&self, mesh: &Mesh) -> Result<(), MeshError> {
        let quality = quality(mesh);
        let (element, scaled_jacobian) = (quality.worst_element, quality.min_scaled_jacobian);
        // Written so that NaN fails.
        if scaled_jacobian > 1e-6 {
            return Ok(());
        }
        let corners = mesh.corners(element);
        let centre = [0, 1, 2].map(|a| corners.iter().map(|c| c[a]).sum::<f64>() / 8.0);
        let [nx, _, nz] = self.n.map(|n| n - 1);
        let place = [element / nz % nx, element / (nx * nz), element % nz];
        Err(MeshError::Degenerate { element, place, centre, scaled_jacobian })
    }
}
