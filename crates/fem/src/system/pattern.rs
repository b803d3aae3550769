//! Numbering of the sparse matrix, and functionals of the unknowns that do not change with them.

use super::{NONE, SKIP};
use crate::hex8;
use crate::problem::{CohesiveElement, Problem};

/// The equation of each degree of freedom, and how many there are.
pub(super) fn numbered(problem: &Problem) -> (Vec<usize>, usize) {
    let mut equation = vec![NONE; 3 * problem.body.nodes.len()];
    let mut unknowns = 0;
    for &node in &problem.body.order {
        for c in 0..3 {
            if problem.supports[3 * node + c].is_none() {
                equation[3 * node + c] = unknowns;
                unknowns += 1;
            }
        }
    }
    (equation, unknowns)
}

/// Degrees of freedom of a brick in the order of its residual.
pub(super) fn hex_dofs(nodes: &[usize; 8]) -> [usize; hex8::DOFS] {
    std::array::from_fn(|i| 3 * nodes[i / 3] + i % 3)
}

/// Entries of the lower triangle of a brick's tangent, row by row.
fn lower_triangle() -> impl Iterator<Item = (usize, usize)> {
    (0..hex8::DOFS).flat_map(|i| (0..=i).map(move |j| (i, j)))
}

/// Degrees of freedom of an interface element in the order of its residual.
pub(super) fn path_dofs(el: &CohesiveElement) -> Vec<usize> {
    match &el.upper {
        None => el.lower.iter().map(|n| 3 * n + 1).collect(),
        Some(upper) => el.lower.iter().chain(upper).flat_map(|n| [3 * n, 3 * n + 1, 3 * n + 2]).collect(),
    }
}

/// Lower-triangle pattern in compressed columns, held by sprs while it is built.
pub(super) fn pattern(
    n: usize,
    equation: &[usize],
    elements: impl Iterator<Item = Vec<usize>>,
) -> (Vec<usize>, Vec<usize>) {
    let mut entries = sprs::TriMat::<u8>::new((n, n));
    for i in 0..n {
        entries.add_triplet(i, i, 1);
    }
    // Node pairs repeat between neighbouring elements: keep each once.
    let mut seen = std::collections::HashSet::new();
    for dofs in elements {
        for &i in &dofs {
            for &j in &dofs {
                let (ei, ej) = (equation[i], equation[j]);
                if ei != NONE && ej != NONE && ei > ej && seen.insert((ei, ej)) {
                    entries.add_triplet(ei, ej, 1);
                }
            }
        }
    }
    let csc: sprs::CsMat<u8> = entries.to_csc();
    let (ptr, mut rows, _) = csc.into_raw_storage();
    for j in 0..n {
        rows[ptr[j]..ptr[j + 1]].sort_unstable();
    }
    (ptr, rows)
}

/// Where pairs of degrees of freedom stand among the stored values.
pub(super) struct Places<'a> {
    pub equation: &'a [usize],
    pub col_ptr: &'a [usize],
    pub row_idx: &'a [usize],
}

impl Places<'_> {
    /// Of the lower triangle of a brick's tangent.
    pub fn of_hex(&self, dofs: &[usize; hex8::DOFS]) -> [u32; hex8::PACKED] {
        let mut map = [SKIP; hex8::PACKED];
        for (at, (i, j)) in map.iter_mut().zip(lower_triangle()) {
            *at = self.locate(dofs[i], dofs[j]);
        }
        map
    }

    /// Of the lower triangle of an interface element's, row by row.
    pub fn of_path(&self, dofs: &[usize]) -> Vec<u32> {
        (0..dofs.len()).flat_map(|i| (0..=i).map(move |j| self.locate(dofs[i], dofs[j]))).collect()
    }

    fn locate(&self, i: usize, j: usize) -> u32 {
        let (ei, ej) = (self.equation[i], self.equation[j]);
        if ei == NONE || ej == NONE {
            return SKIP;
        }
        let (row, col) = (ei.max(ej), ei.min(ej));
        let rows = &self.row_idx[self.col_ptr[col]..self.col_ptr[col + 1]];
        rows.binary_search(&row).map_or(SKIP, |k| (self.col_ptr[col] + k) as u32)
    }
}
