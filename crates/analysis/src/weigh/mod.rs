//! Fitted models put to `evidence`: their linearisation, their ln Z, and what further effects would add to it.

mod belief;
mod known;
mod mode;

use crate::columns::scales;
use crate::data::Measured;
use crate::ladder::Fitted;
use crate::probable::Left;
use belief::{amplitude, belief};
use diagnose::Candidate;
use evidence::special::ln_sum_exp;
use evidence::{
    Evidence, EvidenceError, HOPELESS, Judged, Kernel, Linear, Parameter, Place, Record, RestPrior, SetPrior,
    excess,
};
use input::{Case, DiagnoseConfig};
use inverse::{Fit, Free, Prediction};
pub(crate) use known::Known;
use known::KnownModel;
pub(crate) use mode::{Mode, NEAR};
use model::{Catalogue, Model, corner_rows};
use nalgebra::DVector;
use rayon::prelude::*;

/// What is believed before a record is looked at.
#[derive(Clone, Debug)]
pub(crate) struct Beliefs {
    /// Of the rest.
    pub rest: RestPrior,
    /// Of the sets.
    pub sets: SetPrior,
    /// Largest rest that counts as explained in practice, share of the peak.
    pub practice: f64,
}

impl Beliefs {
    /// What the `[diagnose]` of a case says, for the effects of a catalogue and the laws that are candidates.
    pub fn of(case: &Case, catalogue: &Catalogue) -> Self {
        let config = &case.diagnose;
        let (rest, usual) = (RestPrior::default(), DiagnoseConfig::default().rest);
        let effects = catalogue.iter().filter(|e| !e.card().negative_control).count();
        let causes = effects + crate::ladder::laws::other_laws(case, catalogue).len();
        let sets = SetPrior { expected: config.expected_effects, ..SetPrior::of_catalogue(causes) };
        Self { rest: rest.scaled(config.rest / usual), sets, practice: config.practice }
    }
}

/// A model at its fit.
#[derive(Clone, Copy)]
pub(crate) struct AtFit<'a> {
    pub model: &'a Model,
    /// All values.
    pub theta: &'a [f64],
    pub free_parameters: &'a [Free],
    pub fit: &'a Fit,
    /// Where the posterior has its mode, if that was looked for.
    pub mode: Option<&'a Mode>,
}

impl<'a> From<&'a Fitted> for AtFit<'a> {
    fn from(f: &'a Fitted) -> Self {
        Self {
            model: &f.model,
            theta: &f.theta,
            free_parameters: &f.free_parameters,
            fit: &f.fit,
            mode: f.mode.as_ref(),
        }
    }
}

/// Which leg of the protocol each row of a record belongs to: a corner ends its leg.
fn legs(record: &input::Record) -> Vec<usize> {
    let corners = corner_rows(record);
    (0..record.time.len()).map(|row| corners.iter().filter(|(at, _)| (1..row).contains(at)).count()).collect()
}

/// Where each block stands on the path of its test.
fn places(measured: &Measured, case: &Case) -> Vec<Place> {
    let one = |(slot, block): (&crate::data::DataBlock, &inverse::Block)| {
        let test = &case.tests[slot.test];
        let record = test.record.as_ref();
        let s = record.map_or(Vec::new(), |r| evidence::path(&r.time, &r.displacement));
        let leg = record.map_or(Vec::new(), legs);
        let peak = block.measured.iter().fold(0.0f64, |m, v| m.max(v.abs()));
        Place {
            test: test.name.clone(),
            s: slot.rows.iter().filter_map(|&r| s.get(r).copied()).collect(),
            leg: slot.rows.iter().filter_map(|&r| leg.get(r).copied()).collect(),
            peak,
        }
    };
    measured.slots.iter().zip(&measured.data.blocks).map(one).collect()
}

/// What a further effect changes, by its columns alone.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Gain {
    /// By how much ln Z changes: the mean over the effect's shapes.
    pub ln_z: f64,
    /// Mean square that is left beyond noise, by the shape that leaves least.
    pub left: f64,
}

/// Effects of a model, its ln Z on a few sizes of the rest, the mean square that it leaves, and its evidence where that was asked.
type Weighed<'a> = (&'a Vec<String>, f64, f64, Option<&'a Judged>);

/// Every model's evidence: of those that have none of their own, as far behind the leading one as the few sizes say. Another one's
/// would not do: on a few sizes a model that leaves much comes out too low, and what it has more is not theirs.
/// None where no model has an evidence.
fn judged_all(models: &[Weighed<'_>]) -> Option<Vec<Judged>> {
    let own = models.iter().filter_map(|&(_, quick, _, judged)| Some((quick, judged?)));
    let (at, leading) = own.max_by(|a, b| a.0.total_cmp(&b.0))?;
    let judged = |&(effects, quick, excess, judged): &Weighed<'_>| {
        judged.cloned().unwrap_or_else(|| leading.with_effects(effects, quick - at)).leaving(excess)
    };
    Some(models.iter().map(judged).collect())
}

/// The records as `evidence` sees them, and what is believed: the same for all models that are compared.
pub(crate) struct Scale<'a> {
    pub record: Record,
    measured: DVector<f64>,
    catalogue: &'a Catalogue,
    pub beliefs: &'a Beliefs,
}

impl<'a> Scale<'a> {
    /// On all points. The noise is that of `measured`, and the case that of the first of `models`.
    pub fn new<'m>(
        measured: &Measured,
        mut models: impl Iterator<Item = AtFit<'m>>,
        catalogue: &'a Catalogue,
        beliefs: &'a Beliefs,
    ) -> Result<Self, EvidenceError> {
        let case = &models.next().ok_or(EvidenceError::Empty)?.model.case;
        let record = Record::new(&measured.data, &places(measured, case), beliefs.rest.smooth)?;
        Ok(Self { record, measured: measured.data.measured(), catalogue, beliefs })
    }

    /// A model linearised at its fit.
    pub fn linear(&self, f: AtFit) -> Result<Linear, EvidenceError> {
        self.linear_at(f, &f.fit.theta, &f.fit.prediction)
    }

    /// The same where the free parameters have other values.
    fn linear_at(&self, f: AtFit, theta: &[f64], prediction: &Prediction) -> Result<Linear, EvidenceError> {
        let sizes = scales(f.model, f.theta);
        let beliefs: Vec<_> =
            f.free_parameters.iter().map(|x| belief(x, f.model, self.catalogue, &sizes)).collect();
        Linear::at_fit(&self.measured, f.free_parameters, theta, prediction, &beliefs)
    }

    /// The integral over the rest.
    pub fn evidence(&self, linear: &Linear) -> Result<Evidence, EvidenceError> {
        Evidence::of(&self.record, linear, &self.beliefs.rest, Kernel::Plain)
    }

    /// The same at a few sizes of the rest.
    pub fn at_few_sizes(&self, linear: &Linear) -> Result<Evidence, EvidenceError> {
        Evidence::few(&self.record, linear, &self.beliefs.rest, Kernel::Plain)
    }

    fn quick(&self, linear: &Linear) -> Result<f64, EvidenceError> {
        let Beliefs { rest, sets, .. } = self.beliefs;
        Evidence::quick(&self.record, linear, (rest, sets), Kernel::Plain)
    }

    /// Every model as a member of the posterior, side by side: the integral over the rest for those that may matter, a few of its
    /// points for the others. What is known already is not computed again.
    pub fn weigh(
        &self,
        all: &[(&Vec<String>, AtFit)],
        known: &mut Known,
    ) -> Result<Vec<Judged>, EvidenceError> {
        known.on(&self.record);
        let quick = |(effects, f): &(&Vec<String>, AtFit)| {
            let linear = self.linear(*f)?;
            let seen = known.holds(effects, &linear);
            let new = |linear: Linear| {
                let excess = excess(&self.record, &linear)?;
                Ok(KnownModel::new(self.quick(&linear)?, excess, linear))
            };
            (!seen).then(|| new(linear)).transpose()
        };
        let fresh: Vec<Option<KnownModel>> =
            all.par_iter().map(quick).collect::<Result<_, EvidenceError>>()?;
        for ((effects, f), model) in all.iter().zip(fresh) {
            model.into_iter().for_each(|m| known.note(effects, m));
            known.at_mode(effects, self.linear_at_mode(*f)?.zip(f.mode.map(|m| m.unseen)));
        }
        self.integrate(all, known)?;
        let models: Vec<Weighed<'_>> = (all.iter())
            .map(|a| {
                let known = known.weighed(a.0);
                known.map(|m| (a.0, m.quick, m.excess, m.judged.as_ref())).ok_or(EvidenceError::Empty)
            })
            .collect::<Result<_, EvidenceError>>()?;
        judged_all(&models).ok_or(EvidenceError::Empty)
    }

    /// The integral over the rest of those models that may matter and have none yet.
    fn integrate(&self, all: &[(&Vec<String>, AtFit)], known: &mut Known) -> Result<(), EvidenceError> {
        let quick = |effects: &Vec<String>| known.weighed(effects).map_or(f64::NEG_INFINITY, |m| m.quick);
        let best = all.iter().map(|a| quick(a.0)).fold(f64::NEG_INFINITY, f64::max);
        let open: Vec<(&Vec<String>, &KnownModel)> = (all.iter())
            .filter_map(|(effects, _)| Some((*effects, known.weighed(effects)?)))
            .filter(|(_, m)| m.quick > best - HOPELESS && m.judged.is_none())
            .collect();
        let one = |(effects, model): &(&Vec<String>, &KnownModel)| {
            let evidence = self.evidence(model.best())?;
            let judged = Judged::new(effects, &evidence, &self.beliefs.rest, 1.0, &self.beliefs.sets);
            let unseen = model.mode.as_ref().map_or(0.0, |m| m.1);
            Ok(((*effects).clone(), judged.less(unseen), evidence.moved))
        };
        let done: Vec<(Vec<String>, Judged, f64)> =
            open.par_iter().map(one).collect::<Result<_, EvidenceError>>()?;
        for (effects, judged, moved) in done {
            known.change(&effects, |m| (m.judged, m.moved) = (Some(judged), moved));
        }
        Ok(())
    }

    /// What a model leaves.
    pub fn left(&self, linear: &Linear) -> Result<Left, EvidenceError> {
        let evidence = self.evidence(linear)?;
        let Beliefs { rest, sets, practice } = self.beliefs;
        let rest = evidence::remains(&self.record, linear, &evidence, rest, sets.unlike());
        Ok(Left { explained_to: rest.explained_to(*practice), rest })
    }

    /// What a candidate of a model's screen changes where it is added, by its columns alone. `None` for a candidate without columns.
    pub fn gain(
        &self,
        of: &KnownModel,
        at: AtFit,
        candidate: &Candidate,
    ) -> Result<Option<Gain>, EvidenceError> {
        if let Some(gain) = of.gain(candidate) {
            return Ok(gain);
        }
        let Some(extended) = self.extended(&of.linear, at, candidate)? else { return Ok(None) };
        let (mut each, mut left) = (Vec::new(), f64::INFINITY);
        for linear in &extended {
            each.push(self.quick(linear)? - of.quick);
            left = left.min(excess(&self.record, linear)?);
        }
        let shapes = each.len() as f64;
        Ok((shapes > 0.0).then(|| Gain { ln_z: ln_sum_exp(each) - shapes.ln(), left }))
    }

    /// A model with a candidate of its screen, by that one's columns, with each of its shapes. `None` for a candidate without columns.
    pub fn extended(
        &self,
        linear: &Linear,
        at: AtFit,
        candidate: &Candidate,
    ) -> Result<Option<Vec<Linear>>, EvidenceError> {
        let Some(effect) = self.catalogue.get(&candidate.effect) else { return Ok(None) };
        let (specs, start) =
            (effect.parameters(&model::Options::new()), effect.start(&scales(at.model, at.theta)));
        let Some(spec) = specs.first() else { return Ok(None) };
        let path = format!("effects.{}.{}", candidate.effect, spec.name);
        let free = Free::new(path, (spec.lower, spec.upper), spec.transform, spec.start);
        let (Some(neutral), Some(belief)) = (spec.neutral, amplitude(&free, spec, 0, effect.card(), &start))
        else {
            return Ok(None);
        };
        let parameter =
            Parameter { path: free.path.clone(), at: free.forward(neutral), belief, amplitude: true };
        let with = |columns: &nalgebra::DMatrix<f64>| {
            linear.with(std::slice::from_ref(&parameter), &(columns * free.transform.slope(neutral)))
        };
        let all = candidate.shapes.iter().map(|s| with(&s.columns)).collect::<Result<Vec<_>, _>>()?;
        Ok((!all.is_empty()).then_some(all))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A base model that was asked while it was alone, whose rest is larger than the few sizes: it lends nothing to others.
    #[test]
    fn what_has_no_evidence_of_its_own_stays_behind_the_leader() {
        let names = [vec![], vec!["leads".to_owned()], vec!["behind".to_owned()]];
        let (base, leader) = (
            Judged::from_numbers(&names[0], 2400.0, 2401.0),
            Judged::from_numbers(&names[1], 2471.0, 2467.0),
        );
        let models = [
            (&names[0], 2300.0, 1.0, Some(&base)),
            (&names[1], 2470.0, 0.1, Some(&leader)),
            (&names[2], 2450.0, 0.2, None),
        ];
        let all = judged_all(&models).expect("evidence");
        let ln_z: Vec<f64> = all.iter().map(Judged::ln_z).collect();
        assert_eq!(ln_z, [2400.0, 2471.0, 2451.0]);
        assert!(judged_all(&models[2..]).is_none());
    }

    /// An effect that takes next to nothing of what is left, where something else acts for certain, is no name whatever it gains; one
    /// that takes all is.
    #[test]
    fn what_takes_little_of_much_is_not_certain() {
        let names = [vec![], vec!["effect".to_owned()]];
        let numbers = [(2400.0, 2450.0), (2410.0, 2480.0)];
        let judged: Vec<Judged> =
            names.iter().zip(numbers).map(|(n, (own, other))| Judged::from_numbers(n, own, other)).collect();
        let probability = |left: f64| {
            let models =
                [(&names[0], 2450.0, 1.0, Some(&judged[0])), (&names[1], 2480.0, left, Some(&judged[1]))];
            let all = judged_all(&models).expect("evidence");
            evidence::Posterior::of(&all, &SetPrior::of_catalogue(20)).effects["effect"]
        };
        assert!(probability(0.95) < 0.5 && probability(0.0) > 0.99, "{}", probability(0.95));
    }

    #[test]
    fn a_corner_ends_its_leg() {
        let displacement: Vec<f64> = (0..=10).chain((5..10).rev()).chain([5; 6]).map(f64::from).collect();
        let record = input::Record {
            time: (0..displacement.len()).map(|i| i as f64).collect(),
            force: vec![0.0; displacement.len()],
            displacement,
            ..input::Record::default()
        };
        let legs = legs(&record);
        let ends = [10, 15, 21].map(|row| legs[row]);
        assert_eq!((legs[0], legs[11], legs[16], ends), (0, 1, 2, [0, 1, 2]), "{legs:?}");
    }
}
