//! Sparse symmetric indefinite factorisation: faer's supernodal LBLᵀ (Bunch–Kaufman inside the
//! supernodes), symbolic part computed once, buffers kept, every solution checked.
//!
//! The unknowns arrive already in nested-dissection order, so faer is told not to reorder.

use crate::error::FemError;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::perm::PermRef;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, IntranodeLbltRef, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMat};
use faer::{Conj, MatMut, Par, Side};

/// Backward error above which a solution is refined, and refused if refinement does not help.
const BACKWARD_ERROR: f64 = 1e-12;

/// The lower triangle of a symmetric sparse matrix, its factor, and kept workspace.
pub struct Factor {
    pattern: SymbolicSparseColMat<usize>,
    symbolic: SymbolicCholesky<usize>,
    values: Vec<f64>,
    factor: Vec<f64>,
    subdiagonal: Vec<f64>,
    forward: Vec<usize>,
    inverse: Vec<usize>,
    workspace: MemBuffer,
    solve_workspace: (usize, MemBuffer),
    correction: Vec<f64>,
}

impl Factor {
    /// Analyses the pattern of a lower triangle in compressed columns.
    pub fn new(n: usize, col_ptr: Vec<usize>, row_idx: Vec<usize>) -> Result<Self, FemError> {
        let pattern = SymbolicSparseColMat::new_checked(n, n, col_ptr, None, row_idx);
        // With no reordering faer's analysis reads the upper triangle whatever side is named (0.24),
        // while its numeric part takes the lower one without a copy: each gets what it wants.
        let upper = transposed(&pattern);
        let params = CholeskySymbolicParams {
            supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
            ..Default::default()
        };
        let symbolic =
            factorize_symbolic_cholesky(upper.as_ref(), Side::Upper, SymmetricOrdering::Identity, params)
                .map_err(|e| FemError::Setup(format!("symbolic factorisation failed: {e:?}")))?;
        let workspace = MemBuffer::new(
            symbolic.factorize_numeric_intranode_lblt_scratch::<f64>(Par::Seq, Default::default()),
        );
        let nnz = pattern.row_idx().len();
        Ok(Self {
            values: vec![0.0; nnz],
            factor: vec![0.0; symbolic.len_val()],
            subdiagonal: vec![0.0; n],
            forward: vec![0; n],
            inverse: vec![0; n],
            workspace,
            solve_workspace: (0, MemBuffer::new(symbolic.solve_in_place_scratch::<f64>(1, Par::Seq))),
            correction: Vec::new(),
            pattern,
            symbolic,
        })
    }

    /// Number of unknowns.
    pub fn len(&self) -> usize {
        self.forward.len()
    }

    /// Whether there are no unknowns.
    pub fn is_empty(&self) -> bool {
        self.forward.is_empty()
    }

    /// Stored entries of the factor.
    pub fn fill(&self) -> usize {
        self.factor.len()
    }

    /// Multiplications and additions of one factorisation: the sum over the factor's columns of their length squared.
    pub fn flops(&self) -> f64 {
        let SymbolicCholeskyRaw::Supernodal(s) = self.symbolic.raw() else { return f64::NAN };
        let node = |k: usize| {
            let columns = s.supernode_end()[k] - s.supernode_begin()[k];
            let rows = (s.col_ptr_for_val()[k + 1] - s.col_ptr_for_val()[k]) / columns.max(1);
            (0..columns).map(|j| ((rows - j) as f64).powi(2)).sum::<f64>()
        };
        (0..s.n_supernodes()).map(node).sum()
    }

    /// Factorises the matrix with these lower-triangle values (same order as the pattern).
    pub fn factorise(&mut self, values: &[f64]) {
        self.values.copy_from_slice(values);
        let a = SparseColMatRef::new(self.pattern.as_ref(), &self.values);
        self.symbolic.factorize_numeric_intranode_lblt(
            &mut self.factor,
            &mut self.subdiagonal,
            &mut self.forward,
            &mut self.inverse,
            a,
            Side::Lower,
            Par::Seq,
            MemStack::new(&mut self.workspace),
            Default::default(),
        );
    }

    /// Number of negative pivots: 1 × 1 by sign, 2 × 2 by determinant and trace.
    pub fn negative_pivots(&self) -> usize {
        let SymbolicCholeskyRaw::Supernodal(s) = self.symbolic.raw() else { return 0 };
        let mut negative = 0;
        for node in 0..s.n_supernodes() {
            let (start, end) = (s.supernode_begin()[node], s.supernode_end()[node]);
            let columns = end - start;
            let offset = s.col_ptr_for_val()[node];
            let rows = (s.col_ptr_for_val()[node + 1] - offset) / columns.max(1);
            let diagonal = |j: usize| self.factor[offset + j * rows + j];
            let mut j = 0;
            while j < columns {
                let below = self.subdiagonal[start + j];
                if below == 0.0 {
                    negative += usize::from(diagonal(j) < 0.0);
                    j += 1;
                } else {
                    let (a, c) = (diagonal(j), diagonal(j + 1));
                    let det = a * c - below * below;
                    negative += if det < 0.0 { 1 } else { 2 * usize::from(a + c < 0.0) };
                    j += 2;
                }
            }
        }
        negative
    }

    fn solve_unchecked(&mut self, rhs: &mut [f64], columns: usize) {
        let n = self.len();
        if self.solve_workspace.0 < columns {
            let need = self.symbolic.solve_in_place_scratch::<f64>(columns, Par::Seq);
            self.solve_workspace = (columns, MemBuffer::new(need));
        }
        // The permutation was written by faer's own factorisation of the same symbolic object.
        let Some(perm) = checked_perm(&self.forward, &self.inverse, n) else { return };
        let lblt = IntranodeLbltRef::new(&self.symbolic, &self.factor, &self.subdiagonal, perm);
        lblt.solve_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(rhs, n, columns),
            Par::Seq,
            MemStack::new(&mut self.solve_workspace.1),
        );
    }

    /// Solves for several right-hand sides in place (column-major, n × `columns`).
    ///
    /// The residual is checked on a sum of all columns, each scaled to its own size; where it is
    /// not at rounding, every column takes a step of refinement.
    ///
    /// # Errors
    /// [`FemError::Singular`] when the residual stays large: a factor is never trusted unseen.
    pub fn solve(&mut self, rhs: &mut [f64], columns: usize) -> Result<(), FemError> {
        let n = self.len();
        if n == 0 || columns == 0 {
            return Ok(());
        }
        let wanted = rhs.to_vec();
        self.solve_unchecked(rhs, columns);
        if self.checked(rhs, &wanted, columns) <= BACKWARD_ERROR {
            return Ok(());
        }
        let mut correction = std::mem::take(&mut self.correction);
        correction.clear();
        correction.extend_from_slice(&wanted);
        for c in 0..columns {
            self.subtract_product(&rhs[c * n..(c + 1) * n], &mut correction[c * n..(c + 1) * n]);
        }
        self.solve_unchecked(&mut correction, columns);
        for (x, d) in rhs.iter_mut().zip(&correction) {
            *x += d;
        }
        self.correction = correction;
        if self.checked(rhs, &wanted, columns) <= 1e-9 { Ok(()) } else { Err(FemError::Singular) }
    }

    /// Backward error of the scaled sum of all columns, against the sum of their sizes: the columns
    /// of a homogeneous deformation are multiples of each other, and their sum may vanish.
    fn checked(&self, x: &[f64], b: &[f64], columns: usize) -> f64 {
        let n = self.len();
        let (mut xs, mut bs) = (vec![0.0; n], vec![0.0; n]);
        let (mut xn, mut bn) = (0.0, 0.0);
        for c in 0..columns {
            let (xc, bc) = (&x[c * n..(c + 1) * n], &b[c * n..(c + 1) * n]);
            let size = largest(bc);
            if size > 0.0 {
                let scale = 1.0 / size;
                for i in 0..n {
                    xs[i] += scale * xc[i];
                    bs[i] += scale * bc[i];
                }
                xn += scale * largest(xc);
                bn += 1.0;
            }
        }
        self.subtract_product(&xs, &mut bs);
        let (a, rn) = (largest(&self.values), largest(&bs));
        // A solution 1e13 times larger than the load over the stiffness is a null vector.
        if !xn.is_finite() || !rn.is_finite() || a * xn > 1e13 * bn {
            return f64::INFINITY;
        }
        // ‖b − A x‖∞ / (‖A‖ ‖x‖∞ + ‖b‖∞), with the largest entry for ‖A‖.
        rn / (a * xn + bn).max(f64::MIN_POSITIVE)
    }

    /// b ← b − A x.
    fn subtract_product(&self, x: &[f64], b: &mut [f64]) {
        let (ptr, row) = (self.pattern.col_ptr(), self.pattern.row_idx());
        for j in 0..x.len() {
            // The diagonal comes first in every column.
            let first = ptr[j];
            let mut below = self.values[first] * x[j];
            for (&i, &v) in row[first + 1..ptr[j + 1]].iter().zip(&self.values[first + 1..ptr[j + 1]]) {
                b[i] -= v * x[j];
                below += v * x[i];
            }
            b[j] -= below;
        }
    }
}

/// ‖v‖∞; NaN where v holds one.
fn largest(v: &[f64]) -> f64 {
    v.iter().fold(0.0f64, |m, a| if m.is_nan() || a.is_nan() { f64::NAN } else { m.max(a.abs()) })
}

fn transposed(lower: &SymbolicSparseColMat<usize>) -> SymbolicSparseColMat<usize> {
    let n = lower.ncols();
    let mut columns: Vec<Vec<usize>> = vec![Vec::new(); n];
    for j in 0..n {
        for &i in &lower.row_idx()[lower.col_ptr()[j]..lower.col_ptr()[j + 1]] {
            columns[i].push(j);
        }
    }
    let mut ptr = vec![0];
    for c in &columns {
        ptr.push(ptr[ptr.len() - 1] + c.len());
    }
    SymbolicSparseColMat::new_checked(n, n, ptr, None, columns.concat())
}

fn checked_perm<'a>(forward: &'a [usize], inverse: &'a [usize], n: usize) -> Option<PermRef<'a, usize>> {
    let valid = forward.iter().enumerate().all(|(i, &f)| f < n && inverse[f] == i);
    valid.then(|| PermRef::new_checked(forward, inverse, n))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A chain of springs, the middle one softening.
    fn chain(n: usize, soft: f64) -> (Vec<usize>, Vec<usize>, Vec<f64>) {
        let (mut ptr, mut row, mut val) = (vec![0], vec![], vec![]);
        let k = |i: usize| if i == n / 2 { soft } else { 1.0 };
        for j in 0..n {
            row.push(j);
            val.push(k(j) + k(j + 1));
            if j + 1 < n {
                row.push(j + 1);
                val.push(-k(j + 1));
            }
            ptr.push(row.len());
        }
        (ptr, row, val)
    }

    #[test]
    fn solves_and_counts_negative_pivots() {
        for (soft, negative) in [(1.0, 0), (-0.5, 1)] {
            let (ptr, row, val) = chain(40, soft);
            let mut f = Factor::new(40, ptr, row).unwrap();
            f.factorise(&val);
            assert_eq!(f.negative_pivots(), negative, "soft = {soft}");
            let mut b = vec![1.0; 80];
            f.solve(&mut b, 2).unwrap();
            let mut r = vec![1.0; 40];
            f.subtract_product(&b[40..], &mut r);
            assert!(r.iter().all(|x| x.abs() < 1e-10));
        }
    }

    #[test]
    fn a_singular_matrix_is_reported() {
        // Free chain: remove both supports.
        let (ptr, row, mut val) = chain(10, 1.0);
        val[0] -= 1.0;
        let last = val.len() - 1;
        val[last] -= 1.0;
        let mut f = Factor::new(10, ptr, row).unwrap();
        f.factorise(&val);
        let mut b = vec![1.0; 10];
        assert_eq!(f.solve(&mut b, 1), Err(FemError::Singular));
    }

    /// In a homogeneous deformation the residual and the response to the grip are multiples of each
    /// other, of opposite sign: what the check adds up vanishes, which is no fault of the factor.
    #[test]
    fn opposite_right_hand_sides_are_solved() {
        let (ptr, row, val) = chain(10, 1.0);
        let mut f = Factor::new(10, ptr, row).unwrap();
        f.factorise(&val);
        let column: Vec<f64> = (0..10).map(|i| 1.0 + 0.1 * f64::from(i)).collect();
        let opposite = column.iter().map(|x| -3.7 * x * (1.0 + 1e-16));
        let mut b: Vec<f64> = column.iter().copied().chain(opposite).collect();
        b[13] *= 1.0 - 2e-16;
        assert_eq!(f.solve(&mut b, 2), Ok(()));
    }
}
