//! Numbering of the sparse matrix, and functionals of the unknowns that do not change with them.

use super::NONE;
use crate::hex8;
use crate::problem::CohesiveElement;

/// Entries of the lower triangle of a brick's tangent, row by row.
pub(super) fn lower_triangle() -> impl Iterator<Item = (usize, usize)> {
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
