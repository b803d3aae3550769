//! What an identified model leaves unexplained, and intervals that allow for it.

use super::{AnalysisError, Work, finish::Answer};
use crate::data::Measured;
use crate::probable::Left;
use crate::weigh::{AtFit, Beliefs, Scale};
use evidence::EvidenceError;
use inverse::{Fit, Uncertainty};
use model::Catalogue;

/// What is left, and the records with its covariance beside that of the noise.
pub(super) struct Unexplained {
    pub left: Left,
    pub measured: Measured,
}

impl Work<'_> {
    /// The rest of a fitted model. `measured` has the noise and the mesh's error.
    pub(super) fn unexplained(
        &self,
        answer: &Answer,
        fit: &Fit,
        measured: &Measured,
        catalogue: &Catalogue,
    ) -> Result<Unexplained, EvidenceError> {
        let at = AtFit {
            model: answer.fine,
            theta: &self.theta,
            free_parameters: &answer.free_parameters,
            fit,
            mode: None,
        };
        let beliefs = Beliefs::of(self.case, catalogue);
        let scale = Scale::new(measured, std::iter::once(at), catalogue, &beliefs)?;
        let linear = scale.linear(at)?;
        let evidence = scale.evidence(&linear)?;
        let (rest, beyond) = (&beliefs.rest, beliefs.sets.unlike());
        let remains = evidence::remains(&scale.record, &linear, &evidence, rest, beyond);
        let mut with = measured.clone();
        for column in evidence.rest_columns(&scale.record, rest, beyond) {
            for block in &mut with.data.blocks {
                let own = column.rows(block.range.start, block.range.len()).into_owned();
                if own.norm() > 0.0 {
                    block.noise.nuisance.push(own);
                }
            }
        }
        let left = Left { explained_to: remains.explained_to(beliefs.practice), rest: remains };
        Ok(Unexplained { left, measured: with })
    }

    /// The same uncertainty, allowing for the rest.
    pub(super) fn allowing_for(
        &self,
        (answer, fit): (&Answer, &Fit),
        rest: &Unexplained,
        uncertainty: Uncertainty,
    ) -> Result<Uncertainty, AnalysisError> {
        let wider = self.intervals(answer, &rest.measured, fit)?;
        Ok(uncertainty.allowing_for(&wider))
    }
}
