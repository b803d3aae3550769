//! One size of the rest: the integrand there, over all scales of the noise.

use crate::linear::Reduced;
use crate::model::{Evidence, Kernel, NEGLIGIBLE, View};
use crate::orthogonal;
use crate::record::Record;
use crate::rest::{RestPrior, RestSize, SUPPORTS};
use crate::shares::Shares;
use crate::special::ln_sum_exp;
use crate::spectrum::{Beliefs, Spectrum};

/// Where a noise level estimated with fewer degrees of freedom than this is integrated over.
const KNOWN: f64 = 1e4;

/// The two-point Gauss–Legendre rule for the mesh error's scale in [0, 1].
const MESH_SCALES: [f64; 2] = [0.211_324_865_405, 0.788_675_134_595];

/// One size of the rest.
#[derive(Clone, Debug)]
pub(crate) struct Node {
    pub size: RestSize,
    pub support: usize,
    /// The only test with a rest; `None`: all of them.
    pub only: Option<usize>,
    /// ln of (prior mass of the place and of the lengths × volume in (ln τ, ln υ)).
    pub ln_volume: f64,
    pub reduced: Reduced,
    /// ln of the integral over the parameters for every scale of the noise, beliefs as they are; −∞ where it is negligible.
    pub ln_z: Vec<f64>,
}

/// The model at one size of the rest.
pub(crate) fn reduce(
    record: &Record,
    shares: &Shares,
    (size, only): (RestSize, Option<usize>),
    kernel: Kernel,
) -> Reduced {
    let Shares { x, parameters, .. } = shares;
    let processes = shares.processes(record, size, only);
    let mut ln_det: f64 = processes.iter().map(|p| p.ln_det).sum();
    let mut square = shares.square(&processes);
    let orthogonal =
        kernel == Kernel::Orthogonal && (size.tau > 0.0 || size.upsilon > 0.0) && *parameters > 0;
    let further = orthogonal.then(|| orthogonal::rows(record, &processes, x, *parameters)).flatten();
    if let Some((rows, ln)) = further {
        square += rows.tr_mul(&rows);
        ln_det += ln;
    }
    Reduced { square, ln_det, points: record.used as f64 }
}

/// Scales κ of the noise's level with the logarithms of their masses: ln κ normal with the standard error that the level was
/// estimated with. C(κσ, κτ, κυ) = κ²C(σ, τ, υ), so that no covariance is computed anew.
pub(crate) fn kappas(record: &Record) -> Vec<(f64, f64)> {
    if record.freedom >= KNOWN {
        return vec![(1.0, 0.0)];
    }
    let sd = (0.5 / record.freedom.max(1.0)).sqrt();
    // As fine as the record itself knows its level, so that no peak falls between two nodes.
    let step = sd.min((0.5 / record.used as f64).sqrt()).max(sd / 5.0);
    let most = (4.0 * sd / step).ceil() as i32;
    let z = |k: i32| f64::from(k) * step / sd;
    let norm = ln_sum_exp((-most..=most).map(|k| -0.5 * z(k) * z(k)).collect::<Vec<_>>());
    (-most..=most).map(|k| ((f64::from(k) * step).exp(), -0.5 * z(k) * z(k) - norm)).collect()
}

impl Evidence {
    /// ln of the integral over the parameters for every scale of the noise, from the middle outwards until it is negligible: it has one
    /// maximum. Where `known` says that it is negligible, it is not asked.
    pub(crate) fn over_noise(&self, reduced: &Reduced, beliefs: &Beliefs, known: Option<&[f64]>) -> Vec<f64> {
        let scales = if self.meshes > 0 { MESH_SCALES.as_slice() } else { &[1.0] };
        let each: Vec<Spectrum> = scales.iter().map(|&c| Spectrum::new(reduced, beliefs, c)).collect();
        let at = |kappa: f64| {
            ln_sum_exp(each.iter().map(|s| s.ln_z(kappa)).collect::<Vec<_>>()) - (each.len() as f64).ln()
        };
        let mut out = vec![f64::NEG_INFINITY; self.kappas.len()];
        let (middle, mut most) = (self.kappas.len() / 2, f64::NEG_INFINITY);
        let (down, up): (Vec<usize>, Vec<usize>) =
            ((0..middle).rev().collect(), (middle..self.kappas.len()).collect());
        for side in [up, down] {
            for k in side {
                if known.is_some_and(|z| z[k] == f64::NEG_INFINITY) {
                    continue;
                }
                let (kappa, ln_kappa) = self.kappas[k];
                out[k] = at(kappa);
                let here = out[k] + ln_kappa;
                most = most.max(here);
                if here < most - NEGLIGIBLE {
                    break;
                }
            }
        }
        out
    }

    /// ln of the integrand at a node, of a complete model's rest and of one with a cause outside the catalogue. `ln_z`: the integrals
    /// over the parameters for every scale of the noise.
    pub(crate) fn node_value(&self, node: &Node, ln_z: &[f64], rest: &RestPrior) -> [f64; 2] {
        let mut parts = [Vec::new(), Vec::new()];
        for (&(kappa, ln_kappa), ln_z) in self.kappas.iter().zip(ln_z) {
            let density =
                rest.density(SUPPORTS[node.support], [kappa * node.size.tau, kappa * node.size.upsilon]);
            for (part, d) in parts.iter_mut().zip(density) {
                part.push(ln_kappa + d.ln() + ln_z);
            }
        }
        parts.map(|p| node.ln_volume - self.ln_units + ln_sum_exp(p))
    }

    /// ln of the integrand at every node.
    pub(crate) fn node_values(&self, view: &View<'_>) -> Vec<[f64; 2]> {
        if view.amplitude == 1.0 {
            return self.nodes.iter().map(|n| self.node_value(n, &n.ln_z, view.rest)).collect();
        }
        let beliefs = Beliefs::new(&self.parameters, view.amplitude, self.meshes);
        let one =
            |n: &Node| self.node_value(n, &self.over_noise(&n.reduced, &beliefs, Some(&n.ln_z)), view.rest);
        self.nodes.iter().map(one).collect()
    }
}
