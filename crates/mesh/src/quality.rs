//! Shapes and sizes of elements.

use crate::Mesh;

/// The corners next to each corner, so that the three edges form a right-handed frame.
const NEIGHBOURS: [[usize; 3]; 8] =
    [[1, 3, 4], [2, 0, 5], [3, 1, 6], [0, 2, 7], [7, 5, 0], [4, 6, 1], [5, 7, 2], [6, 4, 3]];

/// The worst element shapes of a mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quality {
    /// Least scaled Jacobian over all corners of all hexes: 1 for a box, ≤ 0 for a folded element.
    pub min_scaled_jacobian: f64,
    /// The hex it belongs to.
    pub worst_element: usize,
    /// Largest ratio of the longest to the shortest edge of a hex.
    pub aspect_max: f64,
}

/// Shapes of the hexes of a mesh. Without hexes: scaled Jacobian and aspect 1.
pub fn quality(mesh: &Mesh) -> Quality {
    let mut worst = Quality { min_scaled_jacobian: f64::INFINITY, worst_element: 0, aspect_max: 1.0 };
    for hex in 0..mesh.hexes.len() {
        let (jacobian, aspect) = shape(&mesh.corners(hex));
        // A NaN is the worst of all, and stays.
        if jacobian.is_nan() || jacobian < worst.min_scaled_jacobian {
            (worst.min_scaled_jacobian, worst.worst_element) = (jacobian, hex);
        }
        worst.aspect_max = worst.aspect_max.max(aspect);
    }
    if mesh.hexes.is_empty() {
        worst.min_scaled_jacobian = 1.0;
    }
    worst
}

/// Least scaled corner Jacobian, and ratio of the longest to the shortest edge.
fn shape(corners: &[[f64; 3]; 8]) -> (f64, f64) {
    let mut least = f64::INFINITY;
    let (mut short, mut long) = (f64::INFINITY, 0.0_f64);
    for (corner, ends) in NEIGHBOURS.iter().enumerate() {
        let edges = ends.map(|end| minus(corners[end], corners[corner]));
        let lengths = edges.map(|e| dot(e, e).sqrt());
        let jacobian = dot(cross(edges[0], edges[1]), edges[2]) / lengths.iter().product::<f64>();
        if jacobian.is_nan() {
            return (f64::NAN, f64::INFINITY);
        }
        least = least.min(jacobian);
        short = lengths.into_iter().fold(short, f64::min);
        long = lengths.into_iter().fold(long, f64::max);
    }
    (least, long / short)
}

impl Mesh {
    /// Volume of a hex, mm³, exact for its trilinear geometry.
    ///
    /// # Panics
    /// If there is no such element.
    pub fn hex_volume(&self, hex: usize) -> f64 {
        let corners = self.corners(hex);
        let at = 1.0 / 3.0_f64.sqrt();
        let mut volume = 0.0;
        for point in 0..8 {
            let xi = [0, 1, 2].map(|a| if point >> a & 1 == 0 { -at } else { at });
            let [a, b, c] = jacobian(&corners, xi);
            volume += dot(cross(a, b), c);
        }
        volume
    }

    /// Volume of the meshed part, mm³.
    pub fn volume(&self) -> f64 {
        (0..self.hexes.len()).map(|hex| self.hex_volume(hex)).sum()
    }

    /// Area of a cohesive quad, mm². The tear path is flat, so half the cross product of the diagonals is exact.
    ///
    /// # Panics
    /// If there is no such interface.
    pub fn interface_area(&self, interface: usize) -> f64 {
        let [a, b, c, d] = self.interfaces[interface].lower.map(|node| self.nodes[node]);
        let normal = cross(minus(c, a), minus(d, b));
        0.5 * dot(normal, normal).sqrt()
    }

    /// Area of all cohesive quads of the meshed part, mm².
    pub fn path_area(&self) -> f64 {
        (0..self.interfaces.len()).map(|interface| self.interface_area(interface)).sum()
    }

    /// How many cohesive elements lie within `length` (mm) where they are longest: how well a process zone of that
    /// length is resolved. `None` for an intact mesh.
    pub fn elements_per_length(&self, length: f64) -> Option<f64> {
        let longest = self.interfaces.iter().map(|q| q.x[1] - q.x[0]).max_by(f64::total_cmp)?;
        Some(length / longest)
    }
}

/// Derivatives of the position along the three directions of the reference cube [−1, 1]³.
fn jacobian(corners: &[[f64; 3]; 8], xi: [f64; 3]) -> [[f64; 3]; 3] {
    const SIGNS: [[f64; 3]; 8] = [
        [-1., -1., -1.],
        [1., -1., -1.],
        [1., 1., -1.],
        [-1., 1., -1.],
        [-1., -1., 1.],
        [1., -1., 1.],
        [1., 1., 1.],
        [-1., 1., 1.],
    ];
    let mut rows = [[0.0; 3]; 3];
    for (corner, sign) in corners.iter().zip(SIGNS) {
        for (a, row) in rows.iter_mut().enumerate() {
            let (b, c) = ((a + 1) % 3, (a + 2) % 3);
            let slope = 0.125 * sign[a] * (1.0 + sign[b] * xi[b]) * (1.0 + sign[c] * xi[c]);
            row.iter_mut().zip(corner).for_each(|(r, x)| *r += slope * x);
        }
    }
    rows
}

fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
