//! Camera channels computed from a state: tear front and width change.

use constitutive::Scalar;
use fem::{Observer, State};
use mesh::Mesh;

/// Index of the outputs in [`fem::StepRecord::extra`].
pub mod output {
    /// Largest reference x with an opening of at least the threshold, mm from the edge x = 0; the end of the cut while
    /// nothing beyond it is open that far.
    pub const TEAR_FRONT: usize = 0;
    /// Width change at mid-height, mm.
    pub const WIDTH_CHANGE: usize = 1;
    /// ∂(tear front)/∂(threshold), a value without derivative.
    pub const FRONT_BY_THRESHOLD: usize = 2;
    /// Area (from 0) whose threshold places the front.
    pub const FRONT_AREA: usize = 3;
    /// Elements of the path in the softening zone; infinite while there is no whole one.
    pub const SOFTENING: usize = 4;
}

/// A line of path nodes through the thickness at one x.
#[derive(Clone, Debug)]
struct PathLine {
    x: f64,
    /// (lower, upper) node; the lower is `None` in a mirrored model.
    pairs: Vec<(Option<usize>, usize)>,
    area: usize,
}

/// The camera of one test.
#[derive(Clone, Debug)]
pub struct Camera {
    lines: Vec<PathLine>,
    /// End of the cut, mm: no front stands before it.
    cut: f64,
    left: Vec<usize>,
    right: Vec<usize>,
    /// Opening threshold of each area, mm.
    pub thresholds: Vec<f64>,
    /// δc of each area, mm.
    pub critical: Vec<f64>,
    /// Opening at which the softening zone ends, over δc.
    pub spent: f64,
}

impl Camera {
    /// The camera on a mesh with `areas` areas.
    pub fn new(mesh: &Mesh, areas: usize) -> Self {
        let set = |n: &str| mesh.set(n).map(<[usize]>::to_vec).unwrap_or_default();
        let mut pairs: Vec<(f64, Option<usize>, usize)> = if mesh.interfaces.is_empty() {
            Vec::new()
        } else if mesh.half_height {
            set("mid_height").into_iter().map(|n| (mesh.nodes[n][0], None, n)).collect()
        } else {
            set("path_lower")
                .into_iter()
                .zip(set("path_upper"))
                .map(|(l, u)| (mesh.nodes[l][0], Some(l), u))
                .collect()
        };
        pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut lines: Vec<PathLine> = Vec::new();
        let left_edge = pairs.first().map_or(0.0, |p| p.0);
        for (x, l, u) in pairs {
            let x = x - left_edge;
            match lines.last_mut() {
                Some(line) if (line.x - x).abs() < 1e-9 => line.pairs.push((l, u)),
                _ => lines.push(PathLine {
                    x,
                    pairs: vec![(l, u)],
                    area: mesh::area_of(x.max(mesh.cut), mesh.cut, mesh.path_width, areas.max(1)),
                }),
            }
        }
        let none = vec![0.0; areas.max(1)];
        Self {
            lines,
            cut: mesh.cut,
            left: set("left_mid"),
            right: set("right_mid"),
            thresholds: none.clone(),
            critical: none,
            spent: f64::INFINITY,
        }
    }

    fn excess<S: Scalar>(&self, line: &PathLine, u: &dyn Fn(usize) -> S) -> S {
        Self::opening(line, u) - self.thresholds[line.area]
    }

    /// Mean opening over the thickness.
    fn opening<S: Scalar>(line: &PathLine, u: &dyn Fn(usize) -> S) -> S {
        let mut sum = S::zero();
        for &(lower, upper) in &line.pairs {
            sum += match lower {
                Some(l) => u(3 * upper + 1) - u(3 * l + 1),
                None => u(3 * upper + 1) * 2.0,
            };
        }
        sum * (1.0 / line.pairs.len() as f64)
    }

    /// How many elements lie between the places where the opening is δc and where the softening zone ends.
    fn softening(&self, u: &dyn Fn(usize) -> f64) -> f64 {
        let over: Vec<f64> = self.lines.iter().map(|l| Self::opening(l, u) / self.critical[l.area]).collect();
        // Index of the last line that is open that far, and the place beyond it where the opening falls below.
        let place = |ratio: f64| {
            let i = over.iter().rposition(|o| *o >= ratio)?;
            let next = self.lines.get(i + 1)?;
            let share = (over[i] - ratio) / (over[i] - over[i + 1]);
            let width = next.x - self.lines[i].x;
            Some((self.lines[i].x + share * width, width))
        };
        match (place(self.spent), place(1.0)) {
            (Some((spent, _)), Some((peak, width))) => (peak - spent) / width,
            _ => f64::INFINITY,
        }
    }

    /// Front position, its derivative by the threshold, the area.
    fn front<S: Scalar>(&self, u: &dyn Fn(usize) -> S) -> (S, f64, usize) {
        let not_begun = (S::from(self.cut), 0.0, 0);
        let Some(last) = self.lines.iter().rposition(|l| self.excess(l, u).value() >= 0.0) else {
            return not_begun;
        };
        let here = &self.lines[last];
        let Some(next) = self.lines.get(last + 1) else { return (S::from(here.x), 0.0, here.area) };
        let (a, b) = (self.excess(here, u), self.excess(next, u));
        let x = S::from(here.x) + a / (a - b) * (next.x - here.x);
        // The faces of the cut open before anything tears.
        if x.value() <= self.cut {
            return not_begun;
        }
        (x, -(next.x - here.x) / (a - b).value(), here.area)
    }

    fn width<S: Scalar>(&self, u: &dyn Fn(usize) -> S) -> S {
        let mean = |nodes: &[usize]| {
            let mut s = S::zero();
            for &n in nodes {
                s += u(3 * n);
            }
            s * (1.0 / nodes.len().max(1) as f64)
        };
        mean(&self.right) - mean(&self.left)
    }
}

impl Observer for Camera {
    fn observe(&self, state: &State) -> Vec<f64> {
        let u = |dof: usize| state.u[dof];
        let (front, by_threshold, area) = self.front(&u);
        vec![front, self.width(&u), by_threshold, area as f64, self.softening(&u)]
    }

    fn derive(&self, state: &State, du: &[f64], count: usize) -> Vec<Vec<f64>> {
        let mut out = vec![Vec::with_capacity(count), Vec::with_capacity(count)];
        for c in 0..count {
            let u = |dof: usize| constitutive::Jet::<1> { re: state.u[dof], eps: [du[dof * count + c]] };
            out[output::TEAR_FRONT].push(self.front(&u).0.eps[0]);
            out[output::WIDTH_CHANGE].push(self.width(&u).eps[0]);
        }
        out
    }
}
