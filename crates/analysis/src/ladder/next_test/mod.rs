//! The cheapest addition to the protocol that would tell rivals apart, by simulating them on it.

pub(crate) mod extension;

use super::{FeLadder, Fitted};
use crate::columns::transfer;
use crate::cost::Phase;
use crate::data::DataBlock;
use crate::problem::FeProblem;
use diagnose::Discovery;
use diagnose::power::{noncentrality, power};
use extension::{Extension, Part, extensions};
use inverse::{Data, Noise, NoiseModel, Prediction, Problem as _, Whitened};
use model::{Channel, Model};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use serde::Serialize;
use std::sync::Arc;
use std::sync::atomic::Ordering;

/// More rivals than that are not simulated: each costs a run per proposal.
const MOST_RIVALS: usize = 3;

/// Power that is enough; among the proposals that have it, the cheapest is taken.
const ENOUGH: f64 = 0.9;

/// With less power than this nothing is proposed.
const WORTHWHILE: f64 = 0.5;

/// An addition that was simulated.
#[derive(Clone, Debug, Serialize)]
pub struct Tried {
    /// What to add, in words.
    pub proposal: String,
    /// How much longer the tests get, s; 0 for a channel.
    pub seconds: f64,
    /// Chance that the wrong one of two rivals is told from the right one; the least over all pairs and either truth.
    pub expected_power: f64,
}

/// What would separate rivals.
#[derive(Clone, Debug, Serialize)]
pub struct NextTest {
    /// What to do, in words.
    pub proposal: String,
    /// The rivals it would separate.
    pub separates: Vec<String>,
    /// Its power, where it was simulated.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub expected_power: Option<f64>,
    /// How the proposal was found.
    pub basis: String,
    /// All that was simulated, the best first.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub tried: Vec<Tried>,
}

/// What a rival of an effect is called where it is that nothing acts.
const NOTHING: &str = "nothing";

/// A model that may be the truth.
struct Rival<'a> {
    name: String,
    fit: &'a Fitted,
}

/// Names that these records cannot tell apart, and those of them that were fitted.
struct Rivals<'a> {
    names: Vec<String>,
    models: Vec<Rival<'a>>,
}

/// What a rival says of an addition: its forces there, and their derivatives.
struct Predicted(Vec<(Data, Prediction)>);

impl FeLadder<'_> {
    /// What separates the members of the first group with rivals, or, where no effect is named, the leading one from nothing:
    /// simulated, or, where nothing helps or nothing could be simulated, what the effect's card says.
    pub fn next_test(&self, d: &Discovery) -> Option<NextTest> {
        let Rivals { names, models } = self.in_a_group(d).or_else(|| self.undecided(d))?;
        self.cancelled.phase(Phase::NextTest);
        let tried = if models.len() > 1 { self.powers(&models) } else { Vec::new() };
        let best = tried.first().filter(|t| t.expected_power >= WORTHWHILE).cloned();
        let card = self.catalogue.get(&names[0])?.card().separated_by;
        Some(match best {
            Some(t) => NextTest {
                proposal: t.proposal,
                separates: models.into_iter().map(|r| r.name).collect(),
                expected_power: Some(t.expected_power),
                basis: format!(
                    "simulated at the fitted rivals with the records' noise, {} additions in all",
                    tried.len()
                ),
                tried,
            },
            None => NextTest {
                proposal: card.to_owned(),
                separates: names,
                expected_power: None,
                basis: match tried.first() {
                    Some(t) => format!(
                        "the effect's card; of {} additions that were simulated none has more than {:.0} % power",
                        tried.len(),
                        (100.0 * t.expected_power).ceil()
                    ),
                    None => "the effect's card; its power was not simulated".to_owned(),
                },
                tried,
            },
        })
    }

    /// The first group with several effects.
    fn in_a_group(&self, d: &Discovery) -> Option<Rivals<'_>> {
        let at = d.groups.iter().position(|g| g.len() > 1)?;
        let with = |e: &String| {
            let mut effects = d.found.clone();
            effects[at].clone_from(e);
            self.rival(e, &effects)
        };
        let models = d.groups[at].iter().filter_map(with).take(MOST_RIVALS).collect();
        Some(Rivals { names: d.groups[at].clone(), models })
    }

    /// The most probable effect that is not named, and nothing.
    fn undecided(&self, d: &Discovery) -> Option<Rivals<'_>> {
        let (first, nothing) = (d.undecided.first()?, NOTHING.to_owned());
        let models = [(first, std::slice::from_ref(first)), (&nothing, &[])];
        let models = models.into_iter().filter_map(|(name, effects)| self.rival(name, effects)).collect();
        Some(Rivals { names: vec![first.clone(), nothing], models })
    }

    fn rival(&self, name: &str, effects: &[String]) -> Option<Rival<'_>> {
        let fit = self.fitted_models.get(&Self::key(effects))?;
        Some(Rival { name: name.to_owned(), fit })
    }

    /// All additions that can be simulated: the cheapest with enough power, then by power.
    fn powers(&self, rivals: &[Rival]) -> Vec<Tried> {
        (self.progress)("what would tell the rivals apart: simulating additions to the protocol");
        let one = |x: &Extension| {
            let said: Option<Vec<Predicted>> = rivals.par_iter().map(|r| self.said(r.fit, x)).collect();
            // No better known than to a part in a thousand.
            let least = (1e3 * self.least_power(rivals, &said?)).round() / 1e3;
            Some(Tried { proposal: x.words.clone(), seconds: x.seconds, expected_power: least })
        };
        let mut tried: Vec<Tried> = extensions(&self.case).par_iter().filter_map(one).collect();
        // What takes no time takes an instrument: segments first.
        let cost = |t: &Tried| if t.seconds > 0.0 { t.seconds } else { f64::INFINITY };
        tried.sort_by(|a, b| {
            let enough = |t: &Tried| t.expected_power >= ENOUGH;
            let by_cost = || cost(a).total_cmp(&cost(b));
            let by_power = || b.expected_power.total_cmp(&a.expected_power);
            enough(b).cmp(&enough(a)).then_with(|| if enough(a) { by_cost() } else { by_power() })
        });
        tried
    }

    /// The least power over all pairs, either of which may be the truth.
    fn least_power(&self, rivals: &[Rival], said: &[Predicted]) -> f64 {
        let mut least = 1.0f64;
        for (i, truth) in said.iter().enumerate() {
            for (j, rival) in said.iter().enumerate().filter(|(j, _)| *j != i) {
                least = least.min(power(self.lambda(truth, rival, rivals[j].fit), self.policy.separate_chi2));
            }
        }
        least
    }

    /// χ² by which a rival misses the new data of a truth.
    fn lambda(&self, truth: &Predicted, rival: &Predicted, f: &Fitted) -> f64 {
        let old = Whitened::new(
            &self.measured.data,
            &f.free_parameters,
            &f.fit.theta,
            &f.fit.prediction,
            Noise::Total,
        );
        let (mut d, mut new) = (Vec::new(), DMatrix::zeros(0, f.free_parameters.len()));
        for ((data, said), (_, true_said)) in rival.0.iter().zip(&truth.0) {
            let mut data = data.clone();
            data.blocks[0].measured = true_said.values.iter().copied().collect();
            let white = Whitened::new(&data, &f.free_parameters, &f.fit.theta, said, Noise::Record);
            let rows = white.rows.len();
            d.extend(white.r.iter().take(rows));
            let above = new.nrows();
            new = new.resize_vertically(above + rows, 0.0);
            new.rows_mut(above, rows).copy_from(&white.jacobian.rows(0, rows));
        }
        noncentrality(&DVector::from_vec(d), &new, &old.jacobian)
    }

    /// A rival on an addition; `None` where it cannot be computed.
    fn said(&self, f: &Fitted, x: &Extension) -> Option<Predicted> {
        x.parts.iter().map(|p| self.said_of(f, p)).collect::<Option<Vec<_>>>().map(Predicted)
    }

    fn said_of(&self, f: &Fitted, part: &Part) -> Option<(Data, Prediction)> {
        let mut case = (*f.model.case).clone();
        case.tests[part.test].record = Some(part.record.clone());
        let model = Model::new(Arc::new(case), self.catalogue, self.how).ok()?;
        let theta = transfer(&f.model, &f.theta, &model);
        let path = |i: &usize| model.find(&f.model.parameters[*i].path);
        let free = f.free.iter().map(path).collect::<Option<Vec<usize>>>()?;
        let rows: Vec<usize> = part.channel.of(&part.record).iter().map(|m| m.0).collect();
        let new: Vec<bool> = rows.iter().map(|r| part.rows.contains(r)).collect();
        let slots = [DataBlock { test: part.test, channel: part.channel, rows }];
        let mut problem = FeProblem::new(&model, theta, free, &slots, self.options, self.cancelled);
        problem.options.stepping.budget = crate::identify::TRIAL_BUDGET;
        self.runs.fetch_add(1, Ordering::Relaxed);
        let prediction = problem.predict(&f.fit.theta, true).ok()?;
        let noise = self.noise_like(part)?;
        let name = String::from("added");
        let mut data = Data::from_parts([(name, vec![0.0; new.len()], noise)]).ok()?;
        data.held_out = new.iter().map(|n| !n).collect();
        Some((data, prediction))
    }

    /// The noise that the records at hand lead to expect.
    fn noise_like(&self, part: &Part) -> Option<NoiseModel> {
        if let Some(sd) = part.sd {
            return Some(NoiseModel::white(sd));
        }
        let mine = |s: &DataBlock| s.test == part.test && s.channel == Channel::Force;
        let block = self.measured.slots.iter().position(mine)?;
        let noise = &self.measured.data.blocks[block].noise;
        Some(NoiseModel::ar1(noise.sd, noise.ar1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ladder::tests::{undecided, unexplained};

    /// An effect that may act is told from nothing by what the base model would miss of it, and it of the base.
    #[test]
    fn an_undecided_effect_is_told_from_nothing() {
        let catalogue = effects::catalogue();
        let mut ladder = unexplained(&catalogue);
        ladder.columns_at(&[]).expect("columns");
        ladder.fit_sets(&[vec!["drift".to_owned()]]).expect("fits");
        let next = ladder.next_test(&undecided(&["drift"])).expect("a proposal");
        assert_eq!(next.separates, ["drift", NOTHING]);
        let best = next.tried.first().expect("additions").expected_power;
        assert!(best > 0.5, "{:?}", next.tried);
        // Of one that was not fitted the card speaks.
        let next = ladder.next_test(&undecided(&["lag"])).expect("a proposal");
        assert!(next.tried.is_empty() && next.separates == ["lag", NOTHING], "{next:?}");
        assert!(ladder.next_test(&undecided(&[])).is_none());
    }
}
