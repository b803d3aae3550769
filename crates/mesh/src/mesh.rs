//! The mesh: nodes, hexes, cohesive quads and named node sets.

use std::collections::BTreeMap;

/// A structured hexahedral mesh of a strip, intact or with a tear path.
///
/// Axes: x across the width (the tear runs towards +x), y along the load, z through the thickness with
/// **z = 0 at mid-thickness in every mesh**. Lengths are mm. The grid is numbered with z fastest, then x,
/// then y: `node = (j · grid[0] + i) · grid[2] + k`. The upper side of a doubled tear path comes after all
/// grid nodes, so the intact and the torn mesh of a strip share the numbers of all grid nodes and of all hexes.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Mesh {
    /// Reference coordinates, mm.
    pub nodes: Vec<[f64; 3]>,
    /// Corner nodes in the order of `VTK_HEXAHEDRON`; the Jacobian is positive.
    pub hexes: Vec<[usize; 8]>,
    /// Cohesive quads ahead of the cut, in the order of x, then z; empty when intact.
    pub interfaces: Vec<Interface>,
    /// Grid column (i, j) of each node; both nodes of a doubled pair have the same.
    pub columns: Vec<[usize; 2]>,
    /// Node lines along x, y and z; doubled path nodes are not counted.
    pub grid: [usize; 3],
    /// Named node sets, see [`Mesh::set`].
    pub sets: BTreeMap<String, Vec<usize>>,
    /// Height of the tear path, mm.
    pub path_y: f64,
    /// Width of the strip on the tear path, mm (differs from the nominal width when there is an outline).
    pub path_width: f64,
    /// Length of the initial cut from the left edge on the tear path, mm.
    pub cut: f64,
    /// Whether only the upper half, y ≥ length/2, is meshed.
    pub half_height: bool,
    /// Whether only the half z ≥ 0 is meshed.
    pub half_thickness: bool,
}

/// A zero-thickness cohesive quad on the tear path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interface {
    /// Nodes of the lower side (y−), ordered along z first, then x, so that (node 2 − node 1) × (node 4 − node 1)
    /// points to +y. In a half-height mesh these are the bottom nodes of the meshed **upper** half.
    pub lower: [usize; 4],
    /// Matching nodes of the upper side; `None` in a half-height mesh, where the path is the mirror and the
    /// opening is 2 u_y of `lower`.
    pub upper: Option<[usize; 4]>,
    /// Reference x range of the quad, as distance from the left edge along the tear path, mm.
    pub x: [f64; 2],
}

impl Interface {
    /// Middle of the reference x range, mm.
    pub fn x_mid(&self) -> f64 {
        0.5 * (self.x[0] + self.x[1])
    }
}

impl Mesh {
    /// The nodes of a named set, or `None` if this mesh has no such set.
    ///
    /// | set | nodes | in |
    /// |---|---|---|
    /// | `bottom`, `top` | faces y = 0 and y = length | `bottom`: full height only |
    /// | `left`, `right` | faces at the left and right edge | all |
    /// | `mouth_bottom`, `mouth_top` | left edge at y = 0, y = length | `mouth_bottom`: full height only |
    /// | `mid_height` | mirror plane y = length/2 | half height |
    /// | `mid_thickness` | mirror plane z = 0 | half thickness |
    /// | `path_lower`, `path_upper` | the two sides of the tear path, in matching order | full height, torn |
    /// | `left_mid`, `right_mid` | left and right edge on the node line nearest to y = length/2 | when a node line lies inside |
    pub fn set(&self, name: &str) -> Option<&[usize]> {
        self.sets.get(name).map(Vec::as_slice)
    }

    /// The names of the sets of this mesh, in alphabetical order.
    pub fn set_names(&self) -> impl Iterator<Item = &str> {
        self.sets.keys().map(String::as_str)
    }

    /// Area of a cohesive quad, from 0, when the path ahead of the cut is divided into `m` equal areas.
    ///
    /// # Panics
    /// If there is no such interface.
    pub fn area(&self, interface: usize, m: usize) -> usize {
        area_of(self.interfaces[interface].x_mid(), self.cut, self.path_width, m)
    }

    /// The coordinates of the eight corners of a hex, mm.
    ///
    /// # Panics
    /// If there is no such element.
    pub fn corners(&self, hex: usize) -> [[f64; 3]; 8] {
        self.hexes[hex].map(|node| self.nodes[node])
    }
}

/// Area of a point of the tear path, from 0: `floor(m (x − cut)/(width − cut))`, clamped to `0 … m − 1`.
///
/// A point on the border of two areas belongs to the one further from the cut, whatever the rounding.
/// `x`, `cut` and `width` are measured from the left edge, mm; `m = 0` counts as 1.
///
/// ```
/// assert_eq!(mesh::area_of(1.05, 1.0, 4.0, 10), 0);
/// assert_eq!(mesh::area_of(1.3, 1.0, 4.0, 10), 1);
/// assert_eq!(mesh::area_of(4.0, 1.0, 4.0, 10), 9);
/// ```
pub fn area_of(x: f64, cut: f64, width: f64, m: usize) -> usize {
    let share = m as f64 * (x - cut) / (width - cut);
    // `as` saturates: anything left of the cut, and NaN, is area 0.
    let area = (share + 1e-9).floor() as usize;
    area.min(m.saturating_sub(1))
}
