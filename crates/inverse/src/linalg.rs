//! The little dense linear algebra that the crate shares.

use nalgebra::{DMatrix, DVector};

/// min |r − J x|² reduced once by QR: |r − J x|² = |c − R x|² + rest.
pub(crate) struct Reduced {
    /// R, p × p, upper triangular.
    pub r: DMatrix<f64>,
    /// c = Qᵀr, length p.
    pub c: DVector<f64>,
}

impl Reduced {
    /// Reduces a system of any number of rows.
    pub fn new(jacobian: &DMatrix<f64>, r: &DVector<f64>) -> Self {
        let (m, p) = jacobian.shape();
        let rows = m.max(p);
        let mut j = DMatrix::zeros(rows, p);
        j.rows_mut(0, m).copy_from(jacobian);
        let mut rhs = DVector::zeros(rows);
        rhs.rows_mut(0, m).copy_from(r);
        let qr = j.qr();
        qr.q_tr_mul(&mut rhs);
        Self { r: qr.r(), c: rhs.rows(0, p).into_owned() }
    }

    /// Jᵀr.
    pub fn gradient(&self) -> DVector<f64> {
        self.r.tr_mul(&self.c)
    }

    /// |r|² − |r − J x|²: the reduction that the linear model predicts.
    pub fn predicted_reduction(&self, x: &DVector<f64>) -> f64 {
        self.c.norm_squared() - (&self.c - &self.r * x).norm_squared()
    }
}

/// Solves min |c − R x|² + Σ d x² by QR; `d` must be positive.
pub(crate) fn damped_solve(r: &DMatrix<f64>, c: &DVector<f64>, d: &DVector<f64>) -> Option<DVector<f64>> {
    let (m, p) = r.shape();
    let mut a = DMatrix::zeros(m + p, p);
    a.rows_mut(0, m).copy_from(r);
    for k in 0..p {
        a[(m + k, k)] = d[k].sqrt();
    }
    let mut rhs = DVector::zeros(m + p);
    rhs.rows_mut(0, m).copy_from(c);
    let qr = a.qr();
    qr.q_tr_mul(&mut rhs);
    let x = qr.r().solve_upper_triangular(&rhs.rows(0, p).into_owned())?;
    x.iter().all(|v| v.is_finite()).then_some(x)
}

/// Selected columns of a matrix.
pub(crate) fn columns(a: &DMatrix<f64>, which: &[usize]) -> DMatrix<f64> {
    DMatrix::from_fn(a.nrows(), which.len(), |i, k| a[(i, which[k])])
}

/// Thin singular value decomposition through the QR factor: singular values and right vectors, largest first.
pub(crate) fn spectrum(a: &DMatrix<f64>) -> (Vec<f64>, DMatrix<f64>) {
    let p = a.ncols();
    if p == 0 {
        return (Vec::new(), DMatrix::zeros(0, 0));
    }
    let r = Reduced::new(a, &DVector::zeros(a.nrows())).r;
    let svd = r.svd(false, true);
    let vt = svd.v_t.unwrap_or_else(|| DMatrix::identity(p, p));
    let mut order: Vec<usize> = (0..p).collect();
    order.sort_by(|&a, &b| svd.singular_values[b].total_cmp(&svd.singular_values[a]).then(a.cmp(&b)));
    let values = order.iter().map(|&k| svd.singular_values[k]).collect();
    let v = DMatrix::from_fn(p, p, |i, k| vt[(order[k], i)]);
    (values, v)
}
