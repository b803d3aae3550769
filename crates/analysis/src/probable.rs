//! How probable is each set of effects, and how much is left: the rungs of a search put to `evidence`, and sets that were not
//! fitted by the columns of the screens.

use crate::data::Measured;
use crate::ladder::{FeLadder, Fitted};
use crate::weigh::{AtFit, Beliefs, Gain, Known, Scale};
use diagnose::Candidate;
use evidence::{EvidenceError, ExplainedTo, Judged, Posterior, Remains, SetProbability};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::sync::PoisonError;

/// Sets that are listed hold at least this share of the posterior.
pub(crate) const LISTED: f64 = 1e-3;

/// Probabilities under other scales of what is believed; from which probability on a cause from outside is said to act.
pub use evidence::{Brief, LIKELY};

/// Posterior probabilities as an answer has them. `nothing`, `something_else` and the probabilities of all other sets sum to 1.
#[derive(Clone, Debug, Serialize)]
pub struct PosteriorAnswer {
    /// Sets that hold at least a thousandth, most probable first; the empty one is "nothing".
    pub sets: Vec<SetProbability>,
    /// Probability that each effect acts, alone or not.
    pub effects: BTreeMap<String, f64>,
    /// That nothing is missing.
    pub nothing: f64,
    /// That something is missing that the catalogue does not hold.
    pub something_else: f64,
    /// The same with the scales of amplitudes and of the rest doubled and halved.
    pub sensitivity: BTreeMap<&'static str, Brief>,
    /// Share of the sets that were not fitted but judged by their derivatives at smaller models.
    pub not_fitted: f64,
}

/// What is left, and to what the records are explained.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Left {
    /// The rest of the leading model, share of the peak force.
    pub rest: Remains,
    /// To what the records are explained by it.
    pub explained_to: ExplainedTo,
}

/// What all models say together.
#[derive(Clone, Debug, Serialize)]
pub struct Probable {
    /// Probabilities.
    pub posterior: PosteriorAnswer,
    /// What the leading model leaves.
    #[serde(flatten)]
    pub left: Left,
}

impl From<Posterior> for PosteriorAnswer {
    fn from(p: Posterior) -> Self {
        let mut sets = p.sets;
        sets.retain(|s| s.effects.is_empty() || s.probability + s.with_something_else >= LISTED);
        Self {
            sets,
            effects: p.effects,
            nothing: p.nothing,
            something_else: p.something_else,
            sensitivity: p.sensitivity,
            not_fitted: p.unfitted,
        }
    }
}

impl Probable {
    /// The leading answers and what is left, as one line.
    pub fn sentence(&self) -> String {
        format!("{} {}", crate::told::listed(&self.posterior), self.what_is_left())
    }

    /// What is left, as one sentence, with what leaves it: the page may show another model.
    pub(crate) fn what_is_left(&self) -> String {
        let leads = self.posterior.sets.first().is_some_and(|s| !s.effects.is_empty());
        self.left.by(if leads { "the leading set" } else { "the base model" })
    }
}

impl Left {
    /// What is left, as one sentence.
    pub fn sentence(&self) -> String {
        self.by("the model")
    }

    /// The same, with what leaves it.
    fn by(&self, whose: &str) -> String {
        let share = &self.rest.all;
        let [low, high] = share.interval_95.map(|x| 100.0 * x);
        let most = self.rest.tests.iter().max_by(|a, b| a.1.share_of_peak.total_cmp(&b.1.share_of_peak));
        let place = match most {
            Some((test, s)) if self.rest.tests.len() > 1 && s.share_of_peak > 0.0 => {
                format!(", most of it in {test}")
            }
            _ => String::new(),
        };
        format!(
            "What {whose} leaves beyond noise: {:.1} % of the peak force ({low:.1} to {high:.1}){place}.",
            100.0 * share.share_of_peak
        )
    }
}

/// The models of a search weighed against each other, on all points.
///
/// # Errors
/// [`EvidenceError`] when a number cannot be used or nothing was fitted.
pub(crate) fn probable(ladder: &FeLadder) -> Result<Probable, EvidenceError> {
    probable_with_models(ladder).map(|p| p.0)
}

/// The same, with every set that was weighed, and the whole posterior.
pub(crate) fn probable_with_models(
    ladder: &FeLadder,
) -> Result<(Probable, Posterior, Vec<Judged>), EvidenceError> {
    let beliefs = Beliefs::of(ladder.case(), ladder.catalogue());
    let measured = measured(ladder)?;
    let scale =
        Scale::new(&measured, ladder.fitted_models.values().map(AtFit::from), ladder.catalogue(), &beliefs)?;
    let fitted_models: Vec<(&Vec<String>, AtFit)> =
        ladder.fitted_models.iter().map(|(k, f)| (k, f.into())).collect();
    let mut known = ladder.known.lock().unwrap_or_else(PoisonError::into_inner);
    let mut models = scale.weigh(&fitted_models, &mut known)?;
    let unfitted = beside(ladder, &scale, &mut known, &models)?;
    models.extend(unfitted);
    let posterior = Posterior::of(&models, &beliefs.sets);
    // What is left is said of a model that was fitted, and is not far behind.
    let leader = (posterior.sets.iter())
        .find(|s| known.weighed(&s.effects).is_some_and(|m| m.judged.is_some()))
        .ok_or(EvidenceError::Empty)?;
    let left = left(&scale, &mut known, &leader.effects)?;
    Ok((Probable { posterior: posterior.clone().into(), left }, posterior, models))
}

/// To what a fitted set explains the records; `None` where it is not fitted, or no effect is in it.
///
/// # Errors
/// As [`probable`].
pub(crate) fn explained_by(
    ladder: &FeLadder,
    effects: &[String],
) -> Result<Option<ExplainedTo>, EvidenceError> {
    let key = FeLadder::key(effects);
    let Some(fitted) = ladder.fitted_models.get(&key).filter(|_| !key.is_empty()) else { return Ok(None) };
    let beliefs = Beliefs::of(ladder.case(), ladder.catalogue());
    let measured = measured(ladder)?;
    let all = ladder.fitted_models.values().map(AtFit::from);
    let scale = Scale::new(&measured, all, ladder.catalogue(), &beliefs)?;
    Ok(Some(scale.left(&scale.best(fitted.into())?)?.explained_to))
}

/// The records with the noise that the base model's fit shows.
pub(crate) fn measured(ladder: &FeLadder) -> Result<Measured, EvidenceError> {
    let base = ladder.fitted_models.get(&Vec::new()).ok_or(EvidenceError::Empty)?;
    Ok(ladder.measured.as_estimated(&base.model).unwrap_or_else(|_| ladder.measured.clone()))
}

/// What a weighed model leaves.
fn left(scale: &Scale, known: &mut Known, effects: &[String]) -> Result<Left, EvidenceError> {
    let model = known.weighed(effects).ok_or(EvidenceError::Empty)?;
    if let Some(left) = &model.left {
        return Ok(left.clone());
    }
    let left = scale.left(model.best())?;
    known.change(effects, |m| m.left = Some(left.clone()));
    Ok(left)
}

/// A set that was not fitted, beside the one whose screen says what is gained.
struct Asked<'a> {
    larger: Vec<String>,
    judged: &'a Judged,
    fitted: &'a Fitted,
    candidate: &'a Candidate,
}

/// Sets beside the fitted ones, by the columns of every screen: the most that any screen makes of each.
fn beside(
    ladder: &FeLadder,
    scale: &Scale,
    known: &mut Known,
    weighed: &[Judged],
) -> Result<Vec<Judged>, EvidenceError> {
    let mut asked: Vec<Asked> = Vec::new();
    for (key, candidates) in &ladder.screened {
        let (Some(fitted), Some(judged)) =
            (ladder.fitted_models.get(key), weighed.iter().find(|j| &j.effects == key))
        else {
            continue;
        };
        for candidate in candidates {
            let larger = FeLadder::key(&[key.as_slice(), std::slice::from_ref(&candidate.effect)].concat());
            if !ladder.fitted_models.contains_key(&larger) && ladder.compatible(&larger) {
                asked.push(Asked { larger, judged, fitted, candidate });
            }
        }
    }
    let gain = |a: &Asked| {
        let of = known.weighed(&a.judged.effects).ok_or(EvidenceError::Empty)?;
        scale.gain(of, AtFit::from(a.fitted), a.candidate)
    };
    let gains: Vec<Option<Gain>> = asked.par_iter().map(gain).collect::<Result<_, EvidenceError>>()?;
    let mut best: BTreeMap<Vec<String>, Judged> = BTreeMap::new();
    for (a, gain) in asked.iter().zip(gains) {
        known.change(&a.judged.effects, |m| m.note_gain(a.candidate, gain));
        let Some(gain) = gain else { continue };
        let j = a.judged.extended(&a.larger, gain.ln_z).leaving(gain.left);
        if best.get(&j.effects).is_none_or(|b| b.ln_z() < j.ln_z()) {
            best.insert(j.effects.clone(), j);
        }
    }
    Ok(best.into_values().collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ladder::tests::unexplained;

    /// Of the sets that were fitted it is said what each leaves, not what the leading one does.
    #[test]
    fn records_are_explained_by_what_is_named() {
        let catalogue = effects::catalogue();
        let mut ladder = unexplained(&catalogue);
        let [compliance, drift] = ["compliance", "drift"].map(|e| vec![e.to_owned()]);
        ladder.fit_sets(std::slice::from_ref(&compliance)).expect("a fit");
        let explained = |ladder: &FeLadder, set: &[String]| explained_by(ladder, set).expect("a size");
        assert_eq!(explained(&ladder, &compliance), Some(ExplainedTo::Not));
        assert_eq!((explained(&ladder, &[]), explained(&ladder, &drift)), (None, None));
        // As if it had met every point.
        let measured = ladder.measured.data.measured();
        let fit = &mut ladder.fitted_models.get_mut(&compliance).expect("a fit").fit;
        fit.prediction.values = measured;
        assert_ne!(explained(&ladder, &compliance), Some(ExplainedTo::Not));
    }
}
