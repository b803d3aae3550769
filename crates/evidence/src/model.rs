//! Evidence of one model: the Gaussian integral over its parameters, integrated over the size of the rest.

use crate::integral::lattice;
use crate::linear::{Linear, Parameter, Solved};
use crate::node::{Node, kappas, reduce};
use crate::record::{EvidenceError, Record};
use crate::rest::{RestPrior, RestSize, SUPPORTS};
use crate::shares::Shares;
use crate::special::ln_sum_exp;
use crate::spectrum::{Beliefs, Spectrum};
use nalgebra::DVector;

/// Which covariance the rest has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Kernel {
    /// K: whatever the processes give (Kennedy & O'Hagan 2001).
    #[default]
    Plain,
    /// K⊥: orthogonal to what the parameters can do (Plumlee 2017).
    Orthogonal,
}

/// What an evidence is asked under: priors as given, or changed for sensitivity.
#[derive(Clone, Debug)]
pub struct View<'a> {
    /// Prior of the rest.
    pub rest: &'a RestPrior,
    /// Factor on the spread of every amplitude's belief.
    pub amplitude: f64,
}

/// Sizes of the rest, wherever it is and whatever its form, and levels of the noise, whose integrand is below the largest by more
/// than this (nats) are left out.
pub(crate) const NEGLIGIBLE: f64 = 10.0;

/// Which rest: its parts, its place, its lengths and form, and the prior mass of the last three.
struct Support {
    support: usize,
    only: Option<usize>,
    lengths: RestSize,
    ln_mass: f64,
}

/// The evidence of a model, with everything to ask it again under other priors.
#[derive(Clone, Debug)]
pub struct Evidence {
    /// ln Z: density of the records under the model, its rest being that of a complete model.
    pub ln_z: f64,
    /// ln Z where the rest holds a cause outside the catalogue.
    pub ln_z_else: f64,
    /// How far the mode is from the point of linearisation: largest |step| of a parameter in its posterior
    /// standard deviations. Above 1 the linearisation is void: compute the model at `mode` and ask again.
    pub moved: f64,
    /// Mode of the parameters in the coordinates of their transforms, averaged over the sizes of the rest.
    pub mode: Vec<f64>,
    pub(crate) parameters: Vec<Parameter>,
    pub(crate) nodes: Vec<Node>,
    pub(crate) beliefs: Beliefs,
    pub(crate) kappas: Vec<(f64, f64)>,
    pub(crate) meshes: usize,
    pub(crate) ln_units: f64,
    /// What the model predicts, block by block, over its root mean square there.
    pub(crate) profile: Vec<Vec<f64>>,
}

impl Evidence {
    /// The evidence of a linearised model.
    ///
    /// # Errors
    /// [`EvidenceError`] when shapes disagree or a number cannot be used.
    pub fn of(
        record: &Record,
        linear: &Linear,
        rest: &RestPrior,
        kernel: Kernel,
    ) -> Result<Self, EvidenceError> {
        linear.check(record)?;
        let shares = Shares::of(record, linear);
        let mut out = Self::empty(record, linear);
        let view = View { rest, amplitude: 1.0 };
        let mut most = f64::NEG_INFINITY;
        for (support, parts) in SUPPORTS.into_iter().enumerate() {
            for (only, m1) in rest.places(parts, record.tests) {
                for (lengths, m2) in rest.shapes(parts) {
                    let at = Support { support, only, lengths, ln_mass: (m1 * m2).ln() };
                    let nodes = out.integrate(record, &shares, kernel, &view, &at, &mut most);
                    out.nodes.extend(nodes);
                }
            }
        }
        out.profile = shares.profile;
        [out.ln_z, out.ln_z_else] = out.under(&view);
        (out.mode, out.moved) = out.modes(&view);
        Ok(out)
    }

    /// The evidence on a few sizes of the rest alone: none, then τ, υ and both at multiples of their scales. Good for comparing
    /// models that leave about the same; no integral.
    pub(crate) fn on(
        record: &Record,
        linear: &Linear,
        rest: &RestPrior,
        kernel: Kernel,
        multiples: &[f64],
    ) -> Result<Self, EvidenceError> {
        linear.check(record)?;
        let shares = Shares::of(record, linear);
        let mut out = Self::empty(record, linear);
        for (support, [smooth, jerk]) in SUPPORTS.into_iter().enumerate() {
            for &m in if support == 0 { &[1.0] } else { multiples } {
                let size = |there: bool, scale: f64| if there { m * scale } else { 0.0 };
                let (tau, upsilon) = (size(smooth, rest.smooth), size(jerk, rest.jerk));
                for (shape, m1) in rest.shapes([smooth, jerk]) {
                    let size = RestSize { tau, upsilon, ..shape };
                    for (only, m2) in rest.places([smooth, jerk], record.tests) {
                        let reduced = reduce(record, &shares, (size, only), kernel);
                        let ln_z = out.over_noise(&reduced, &out.beliefs, None);
                        let ln_volume = (m1 * m2).ln();
                        out.nodes.push(Node { size, support, only, ln_volume, reduced, ln_z });
                    }
                }
            }
        }
        out.profile = shares.profile;
        Ok(out)
    }

    /// ln Z at one size of the rest, noise as estimated.
    ///
    /// # Errors
    /// As [`Evidence::of`].
    pub fn at_size(
        record: &Record,
        linear: &Linear,
        size: RestSize,
        kernel: Kernel,
    ) -> Result<f64, EvidenceError> {
        linear.check(record)?;
        let reduced = reduce(record, &Shares::of(record, linear), (size, None), kernel);
        let beliefs = Beliefs::new(&linear.parameters, 1.0, record.mesh.len());
        Ok(Spectrum::new(&reduced, &beliefs, 1.0).ln_z(1.0) - record.ln_units)
    }

    fn empty(record: &Record, linear: &Linear) -> Self {
        Self {
            ln_z: 0.0,
            ln_z_else: 0.0,
            moved: 0.0,
            mode: Vec::new(),
            beliefs: Beliefs::new(&linear.parameters, 1.0, record.mesh.len()),
            parameters: linear.parameters.clone(),
            nodes: Vec::new(),
            kappas: kappas(record),
            meshes: record.mesh.len(),
            ln_units: record.ln_units,
            profile: Vec::new(),
        }
    }

    /// The nodes of one support, place and shape. `most` is the largest integrand of all so far, prior masses counted: what is
    /// [`NEGLIGIBLE`] beside it is left out.
    fn integrate(
        &self,
        record: &Record,
        shares: &Shares,
        kernel: Kernel,
        view: &View<'_>,
        &Support { support, only, lengths, ln_mass }: &Support,
        most: &mut f64,
    ) -> Vec<Node> {
        let [smooth, jerk] = SUPPORTS[support];
        let size = |y: [f64; 2]| match (smooth, jerk) {
            (false, false) => lengths,
            (true, false) => RestSize { tau: y[0].exp(), ..lengths },
            (false, true) => RestSize { upsilon: y[0].exp(), ..lengths },
            (true, true) => RestSize { tau: y[0].exp(), upsilon: y[1].exp(), ..lengths },
        };
        let node = |y: [f64; 2]| {
            let size = size(y);
            let reduced = reduce(record, shares, (size, only), kernel);
            let ln_z = self.over_noise(&reduced, &self.beliefs, None);
            Node { size, support, only, ln_volume: 0.0, reduced, ln_z }
        };
        let first = if smooth { view.rest.smooth } else { view.rest.jerk };
        let start = [(0.5 * first).ln(), (0.5 * view.rest.jerk).ln()];
        let mut seen: Vec<([f64; 2], f64, Node)> = Vec::new();
        let dimensions = usize::from(smooth) + usize::from(jerk);
        let cells = lattice(dimensions, start, *most - NEGLIGIBLE - ln_mass, |y| {
            if let Some(known) = seen.iter().find(|s| s.0 == y) {
                return known.1;
            }
            let at = node(y);
            let [own, other] = self.node_value(&at, &at.ln_z, view.rest);
            // Both are wanted on the same points, where either counts.
            let here = ln_sum_exp([own, other - 2.0]);
            seen.push((y, here, at));
            here
        });
        let kept = cells.into_iter().filter_map(|(y, volume)| {
            let (_, here, at) = seen.swap_remove(seen.iter().position(|s| s.0 == y)?);
            *most = most.max(here + ln_mass);
            Some(Node { ln_volume: ln_mass + volume, ..at })
        });
        kept.collect()
    }

    /// ln Z under other priors, of a complete model's rest and of one with a cause outside the catalogue. The sizes of the
    /// rest are those that the evidence was computed on.
    pub fn under(&self, view: &View<'_>) -> [f64; 2] {
        let all = self.node_values(view);
        [0, 1].map(|k| ln_sum_exp(all.iter().map(|v| v[k]).collect::<Vec<_>>()))
    }

    /// Nodes with the share of the posterior that each holds, both kinds of rest together; `beyond` is the prior mass of the second.
    pub(crate) fn weights(&self, view: &View<'_>, beyond: f64) -> Vec<f64> {
        let both = |[own, other]: [f64; 2]| ln_sum_exp([own + (1.0 - beyond).ln(), other + beyond.ln()]);
        let ln: Vec<f64> = self.node_values(view).into_iter().map(both).collect();
        let sum = ln_sum_exp(ln.clone());
        ln.iter().map(|x| (x - sum).exp()).collect()
    }

    /// Probability that nothing is left beyond noise; `beyond` is the prior mass of a cause from outside.
    pub(crate) fn noise_alone(&self, view: &View<'_>, beyond: f64) -> f64 {
        let weights = self.weights(view, beyond);
        weights.iter().zip(&self.nodes).filter(|(_, n)| n.support == 0).map(|(w, _)| w).sum()
    }

    /// The solution at a node, noise as estimated, the mesh's error with half its scale.
    pub(crate) fn solved(&self, node: usize) -> Solved {
        self.nodes[node].reduced.solve(&self.parameters, 0.5)
    }

    fn modes(&self, view: &View<'_>) -> (Vec<f64>, f64) {
        let weights = self.weights(view, 0.0);
        let p = self.parameters.len();
        let (mut mode, mut moved) = (DVector::zeros(p), 0.0f64);
        for (k, w) in weights.iter().enumerate().filter(|(_, w)| **w > 1e-4) {
            let solved = self.solved(k);
            let (step, covariance) = (solved.bounded_step(&self.parameters), solved.covariance());
            let far =
                (0..p).map(|i| step[i].abs() / covariance[(i, i)].sqrt().max(1e-300)).fold(0.0, f64::max);
            moved += w * far;
            mode += step.rows(0, p) * *w;
        }
        (self.parameters.iter().zip(mode.iter()).map(|(q, s)| q.at + s).collect(), moved)
    }

    /// Parameters of the model.
    pub fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    /// How many sizes of the rest were looked at.
    pub fn sizes(&self) -> usize {
        self.nodes.len()
    }
}

#[cfg(test)]
mod tests;
