//! From a fit to the posterior's mode. Least squares know neither the rest nor what is believed; where the mode is far from their
//! optimum, the model is computed on the way there, and linearised where it ends.

use crate::linear::Linear;
use crate::model::{Evidence, Kernel};
use crate::record::{EvidenceError, Record};
use crate::rest::RestPrior;
use nalgebra::DMatrix;

/// Shares of the step to the mode that are tried, until one is denser.
const SHARES: [f64; 4] = [1.0, 0.5, 0.25, 0.125];

/// Where the way to the mode ended.
#[derive(Clone, Debug)]
pub struct Mode {
    /// The model there.
    pub linear: Linear,
    /// Its evidence.
    pub evidence: Evidence,
    /// Whether the mode is as near as was asked.
    pub stands: bool,
    /// By how much more dense, nats, the linearisation says it is at its mode than it was found to be anywhere: what its evidence claims
    /// too much. 0 where the mode is near.
    pub unseen: f64,
}

/// The evidence of a model linearised near its mode. `relinearise` computes the model at a point (coordinates of the transforms), or
/// has no answer there. From each point it goes to the mode of the linearisation, or a share of the way where the density of records
/// and parameters together, which needs no derivatives, is not larger there; until the mode is nearer than `within` standard
/// deviations, no share is denser, or `rounds` steps were taken.
///
/// # Errors
/// [`EvidenceError`], or what `relinearise` says.
pub fn at_the_mode<E: From<EvidenceError>>(
    record: &Record,
    start: Linear,
    rest: &RestPrior,
    (rounds, within): (usize, f64),
    mut relinearise: impl FnMut(&[f64]) -> Result<Option<Linear>, E>,
) -> Result<Mode, E> {
    let evidence = |linear: &Linear| Evidence::of(record, linear, rest, Kernel::Plain);
    let mut at = Mode { evidence: evidence(&start)?, linear: start, stands: false, unseen: 0.0 };
    let mut dense = f64::NEG_INFINITY;
    for round in 0..rounds {
        if at.evidence.moved <= within {
            break;
        }
        if round == 0 {
            dense = density(record, &at.linear, rest)?;
        }
        let Some((next, denser)) = step(record, &at, rest, dense, &mut relinearise)? else { break };
        (at.evidence, dense) = (evidence(&next)?, denser);
        at.linear = next;
    }
    at.stands = at.evidence.moved <= within;
    if !at.stands && rounds > 0 {
        at.unseen = (density(record, &followed(&at), rest)? - dense).max(0.0);
    }
    Ok(at)
}

/// The linearisation at its own mode.
fn followed(at: &Mode) -> Linear {
    let mut there = at.linear.clone();
    for (k, (p, &to)) in there.parameters.iter_mut().zip(&at.evidence.mode).enumerate() {
        there.misfit.axpy(p.at - to, &there.jacobian.column(k), 1.0);
        p.at = to;
    }
    there
}

/// The first point on the way to the mode that is denser than `dense`, and its density.
fn step<E: From<EvidenceError>>(
    record: &Record,
    at: &Mode,
    rest: &RestPrior,
    dense: f64,
    relinearise: &mut impl FnMut(&[f64]) -> Result<Option<Linear>, E>,
) -> Result<Option<(Linear, f64)>, E> {
    for share in SHARES {
        let to = at.evidence.mode.iter().zip(&at.linear.parameters).map(|(m, p)| p.at + share * (m - p.at));
        if let Some(next) = relinearise(&to.collect::<Vec<_>>())? {
            let here = density(record, &next, rest)?;
            if here > dense {
                return Ok(Some((next, here)));
            }
        }
    }
    Ok(None)
}

/// ln of the density of the records and the parameters together where a model was computed, up to what does not depend on the
/// parameters.
///
/// # Errors
/// [`EvidenceError`] when the model does not fit the record.
pub fn density(record: &Record, linear: &Linear, rest: &RestPrior) -> Result<f64, EvidenceError> {
    let points = linear.misfit.len();
    let fixed = Linear { jacobian: DMatrix::zeros(points, 0), parameters: Vec::new(), ..linear.clone() };
    let believed = |p: &crate::Parameter| -0.5 * ((p.at - p.belief.mean) / p.belief.sd).powi(2);
    let belief: f64 = linear.parameters.iter().map(believed).sum();
    Ok(Evidence::of(record, &fixed, rest, Kernel::Plain)?.ln_z + belief)
}
