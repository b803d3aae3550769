//! Where a model's posterior has its mode. Least squares weigh the misfit by noise alone and know no beliefs; where much is left, their
//! optimum is far from it.

use super::{AtFit, Scale};
use evidence::{EvidenceError, Linear, at_the_mode, density};
use inverse::Prediction;

/// A mode that is nearer than so many posterior standard deviations is where the model was linearised.
pub(crate) const NEAR: f64 = 1.0;
/// Steps to it at most.
const STEPS: usize = 3;

/// A model computed at, or on its way to, the mode of its posterior.
#[derive(Clone, Debug)]
pub(crate) struct Mode {
    /// Values of the free parameters.
    pub theta: Vec<f64>,
    /// What it predicts there, with its derivatives.
    pub prediction: Prediction,
    /// What its evidence claims too much, nats ([`evidence::Mode::unseen`]).
    pub unseen: f64,
    /// What is left of its evidence, ln Z.
    pub ln_z: f64,
}

impl Scale<'_> {
    /// A model linearised at its mode, where that was found.
    pub(super) fn linear_at_mode(&self, f: AtFit) -> Result<Option<Linear>, EvidenceError> {
        f.mode.map(|m| self.linear_at(f, &m.theta, &m.prediction)).transpose()
    }

    /// A model linearised where its evidence is computed.
    pub fn best(&self, f: AtFit) -> Result<Linear, EvidenceError> {
        self.linear_at_mode(f)?.map_or_else(|| self.linear(f), Ok)
    }

    /// To the mode from a fit, or from `seed`, values of the free parameters that are known from elsewhere, where that is denser.
    /// `predict` is the model at values of its free parameters, where it has an answer. The densest start itself where no step is of use.
    pub fn mode<E: From<EvidenceError>>(
        &self,
        f: AtFit,
        seed: Option<&[f64]>,
        mut predict: impl FnMut(&[f64]) -> Result<Option<Prediction>, E>,
    ) -> Result<Mode, E> {
        let seen = |theta, prediction| Mode { theta, prediction, unseen: 0.0, ln_z: 0.0 };
        let mut tried = vec![seen(f.fit.theta.clone(), f.fit.prediction.clone())];
        let mut start = self.linear(f)?;
        let mut at = |theta: Vec<f64>| {
            let Some(prediction) = predict(&theta)? else { return Ok(None) };
            let linear = self.linear_at(f, &theta, &prediction)?;
            tried.push(seen(theta, prediction));
            Ok::<_, E>(Some(linear))
        };
        let dense = |linear: &Linear| density(&self.record, linear, &self.beliefs.rest);
        if let Some(seeded) = seed.map(|s| at(s.to_vec())).transpose()?.flatten()
            && dense(&seeded)? > dense(&start)?
        {
            start = seeded;
        }
        let end = at_the_mode(&self.record, start, &self.beliefs.rest, (STEPS, NEAR), |z: &[f64]| {
            at(f.free_parameters.iter().zip(z).map(|(p, &z)| p.backward(z)).collect())
        })?;
        let stands = |m: &Mode| Ok(self.linear_at(f, &m.theta, &m.prediction)? == end.linear);
        let of_end = tried.iter().map(stands).collect::<Result<Vec<bool>, EvidenceError>>()?;
        let at = tried.swap_remove(of_end.iter().position(|&x| x).unwrap_or(0));
        Ok(Mode { unseen: end.unseen, ln_z: end.evidence.ln_z - end.unseen, ..at })
    }
}
