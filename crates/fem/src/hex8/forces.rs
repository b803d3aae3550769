//! Residual of the brick in plain numbers without its tangent, where the last one serves.

use super::deformation::{Lane, NO_LANES, deform, lanes_of};
use super::{Geometry, POINTS, Tangent};
use crate::error::ElementFault;
use constitutive::{Context, Law, PointLaw};

/// Residual and pressure alone; rows and the rest of the volume stay as they were.
///
/// # Errors
/// As [`super::tangent()`].
#[allow(clippy::too_many_arguments)]
pub fn forces(
    element: usize,
    law: &(dyn PointLaw<9> + 'static),
    ctx: &Context,
    params: &[f64],
    geo: &Geometry<f64>,
    u: &[[f64; 3]; 8],
    old: &[f64],
    new: &mut [f64],
    out: &mut Tangent,
) -> Result<(), ElementFault> {
    let mut d = deform(element, geo, &lanes_of(u))?;
    let j_bar = d.volume / geo.volumes.iter().sum::<f64>();
    let nh = old.len() / POINTS;
    let (mut pressure, mut residual) = (0.0, NO_LANES);
    for q in 0..POINTS {
        let (w, scale, h) = (geo.volumes[q], Lane::splat(d.dilate(q, j_bar)), q * nh..(q + 1) * nh);
        let f = &d.f[q];
        let p = Law::<f64, 9>::respond(law, ctx, f, params, &old[h.clone()], &mut new[h]).force;
        let mean = p.iter().zip(f).map(|(p, f)| p * f).sum::<f64>() / 3.0;
        pressure += w * mean;
        let g = geo.gradients[q].map(|g| Lane::from(g) * scale);
        d.add_forces(q, w, &p, mean, &g, &mut residual);
    }
    d.finite(element, pressure)?;
    (out.volume.pressure, out.volume.excess) = (pressure, 0.0);
    d.close(pressure, &mut residual, &mut out.residual);
    Ok(())
}
