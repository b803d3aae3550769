//! Plumlee's rest, orthogonal to what the parameters can do: K⊥ = K − KH(HᵀKH)⁻¹HᵀK (Plumlee 2017).
//!
//! With C = R + K: C⊥ = C − U M⁻¹Uᵀ, U = KH, M = HᵀKH, so that by Woodbury and Sylvester
//!
//! ```text
//! xᵀC⊥⁻¹y = xᵀC⁻¹y + (UᵀC⁻¹x)ᵀ W⁻¹ (UᵀC⁻¹y),   |C⊥| = |C| |W| / |M|,   W = M − UᵀC⁻¹U = (KH)ᵀC⁻¹(RH),
//! ```
//!
//! the last form without a difference of nearly equal numbers. UᵀC⁻¹x = (C⁻¹U)ᵀx. Hence p further rows W^{−½}UᵀC⁻¹x stand
//! below the whitened ones. Inner products are of shares of the peak, every point alike.

use crate::process::Process;
use crate::record::Record;
use nalgebra::DMatrix;

/// The further rows for the columns `x` (shares), and ln|W| − ln|M|; `None` where H is (nearly) dependent in K.
pub(crate) fn rows(
    record: &Record,
    processes: &[Process<'_>],
    x: &DMatrix<f64>,
    columns: usize,
) -> Option<(DMatrix<f64>, f64)> {
    let (mut u, mut solved_u, mut solved_rh) = (
        x.columns(0, columns).into_owned(),
        x.columns(0, columns).into_owned(),
        x.columns(0, columns).into_owned(),
    );
    for k in 0..columns {
        let mut at = 0;
        for (block, process) in record.blocks.iter().zip(processes) {
            let n = block.rows.len();
            let h: Vec<f64> = x.view((at, k), (n, 1)).iter().copied().collect();
            let mut kh = process.rest_times(&h);
            let mut rh = process.noise_times(&h);
            u.view_mut((at, k), (n, 1)).copy_from_slice(&kh);
            process.solve(&mut kh);
            process.solve(&mut rh);
            solved_u.view_mut((at, k), (n, 1)).copy_from_slice(&kh);
            solved_rh.view_mut((at, k), (n, 1)).copy_from_slice(&rh);
            at += n;
        }
    }
    let h = x.columns(0, columns);
    // Columns of very different size (dF/dz of sloppy parameters): scaled to the same diagonal.
    let m = h.tr_mul(&u);
    let scale: Vec<f64> = m.diagonal().iter().map(|d| d.max(0.0).sqrt()).collect();
    if scale.iter().any(|s| *s <= 0.0) {
        return None;
    }
    let even = |a: DMatrix<f64>| {
        DMatrix::from_fn(columns, columns, |i, j| 0.5 * (a[(i, j)] + a[(j, i)]) / (scale[i] * scale[j]))
    };
    let m = even(m).cholesky()?;
    let w = even(u.tr_mul(&solved_rh)).cholesky()?;
    let mut down = solved_u.tr_mul(x);
    for (i, s) in scale.iter().enumerate() {
        down.row_mut(i).unscale_mut(*s);
    }
    let rows = w.l_dirty().solve_lower_triangular(&down)?;
    let ln = |c: &nalgebra::Cholesky<f64, nalgebra::Dyn>| {
        2.0 * c.l_dirty().diagonal().iter().map(|d| d.ln()).sum::<f64>()
    };
    Some((rows, ln(&w) - ln(&m)))
}
