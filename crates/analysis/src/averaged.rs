//! The tissue's values averaged over what may be missing: each set of effects says them with its share of the posterior. What is
//! missing moves them, whether or not a record can tell it from nothing.

use crate::ladder::{FeLadder, Fitted};
use crate::probable::{LISTED, measured};
use crate::weigh::{AtFit, Beliefs, Scale};
use diagnose::Candidate;
use evidence::{EvidenceError, Linear, Normal, Posterior, Quantity, SetProbability, quantile};
use inverse::{Free, Identifiability};
use model::Model;
use nalgebra::DVector;
use params::{Owner, ParamPath};
use rayon::prelude::*;
use serde::Serialize;
use std::collections::BTreeMap;

/// From which share of the posterior on a set is asked at all sizes of the rest; others at a few.
const WHOLE: f64 = 0.05;

/// A value with its 95 % interval, both of the mixture.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AveragedValue {
    /// Unit.
    pub unit: String,
    /// Median.
    pub value: f64,
    /// 2.5 and 97.5 %.
    pub interval_95: [f64; 2],
}

/// What all sets of effects say of the tissue together.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Averaged {
    /// Parameters of tissue and tear, by path.
    pub parameters: BTreeMap<String, AveragedValue>,
    /// Means of what varies along the tear path, by name (`gc`, `sigma_c`), without those that the records do not fix.
    pub path_means: BTreeMap<String, AveragedValue>,
    /// Share of the posterior that the sets in it hold: those with a thousandth at least.
    pub share: f64,
}

/// The average over the sets of a posterior.
///
/// # Errors
/// [`EvidenceError`] when a number cannot be used or no base model was fitted.
pub(crate) fn averaged(ladder: &FeLadder, posterior: &Posterior) -> Result<Averaged, EvidenceError> {
    let beliefs = Beliefs::of(ladder.case(), ladder.catalogue());
    let measured = measured(ladder)?;
    let all = ladder.fitted_models.values().map(AtFit::from);
    let scale = Scale::new(&measured, all, ladder.catalogue(), &beliefs)?;
    let base = ladder.fitted_models.get(&Vec::new()).ok_or(EvidenceError::Empty)?;
    let asked = asked_of(base);
    let listed = |s: &&SetProbability| s.probability + s.with_something_else >= LISTED;
    let sets: Vec<&SetProbability> = posterior.sets.iter().filter(listed).collect();
    let says = |set: &&SetProbability| {
        let share = set.probability + set.with_something_else;
        let of_set = said_by(ladder, &scale, posterior, (&set.effects, share), &asked)?;
        Ok(of_set.map(|said| (share, said)))
    };
    let said: Vec<Option<(f64, Vec<Vec<Normal>>)>> =
        sets.par_iter().map(says).collect::<Result<_, EvidenceError>>()?;
    let mut parts = vec![Vec::new(); asked.len()];
    let mut share = 0.0;
    for (weight, said) in said.into_iter().flatten() {
        share += weight;
        for (parts, said) in parts.iter_mut().zip(said) {
            parts.extend(said.into_iter().map(|n| Normal { weight: n.weight * weight, ..n }));
        }
    }
    let mut out = Averaged { share, ..Averaged::default() };
    for (asked, parts) in asked.iter().zip(&parts).filter(|(_, parts)| !parts.is_empty()) {
        let value = asked.value(parts);
        match asked.is_mean() {
            true if spread(parts) > Identifiability::default().max_sd => continue,
            true => out.path_means.insert(asked.name.clone(), value),
            false => out.parameters.insert(asked.name.clone(), value),
        };
    }
    Ok(out)
}

/// One quantity of the tissue, as the base model has it.
struct Asked {
    name: String,
    unit: String,
    /// Paths of its parameters: several for a mean along the tear.
    of: Vec<String>,
    /// Whose coordinate its mixture has; of a mean it is the logarithm.
    free: Option<Free>,
}

impl Asked {
    const fn is_mean(&self) -> bool {
        self.free.is_none()
    }

    fn value(&self, parts: &[Normal]) -> AveragedValue {
        let bounds = self.free.as_ref().map_or((f64::NEG_INFINITY, f64::INFINITY), Free::bounds_z);
        let at = |p: f64| {
            let z = quantile(parts, [bounds.0, bounds.1], p);
            self.free.as_ref().map_or_else(|| z.exp(), |f| f.backward(z))
        };
        AveragedValue { unit: self.unit.clone(), value: at(0.5), interval_95: [at(0.025), at(0.975)] }
    }

    /// In the coordinates of a model's parameters; `None` where it has others.
    fn in_model<'a>(&self, free: &'a [Free]) -> Option<Box<Quantity<'a>>> {
        let place = |path: &String| free.iter().position(|f| &f.path == path);
        let places = self.of.iter().map(place).collect::<Option<Vec<usize>>>()?;
        Some(match places.as_slice() {
            &[one] if !self.is_mean() => Box::new(move |z| {
                let mut gradient = DVector::zeros(z.len());
                gradient[one] = 1.0;
                (z[one], gradient)
            }),
            _ => Box::new(move |z| logarithm_of_mean(free, &places, z)),
        })
    }
}

/// ln of the mean of parameters, and its gradient.
fn logarithm_of_mean(free: &[Free], places: &[usize], z: &DVector<f64>) -> (f64, DVector<f64>) {
    let value = |i: usize| free[i].backward(z[i]);
    let sum: f64 = places.iter().map(|&i| value(i)).sum();
    let mut gradient = DVector::zeros(z.len());
    for &i in places {
        gradient[i] = free[i].transform.slope(value(i)) / sum;
    }
    ((sum / places.len() as f64).ln(), gradient)
}

/// Parameters of bulk and tear, and means along the path over the areas that stand at no bound.
fn asked_of(base: &Fitted) -> Vec<Asked> {
    let mut out = Vec::new();
    let mut along: BTreeMap<String, Asked> = BTreeMap::new();
    for (k, f) in base.free_parameters.iter().enumerate() {
        let Ok(path) = f.path.parse::<ParamPath>() else { continue };
        let unit = unit(&base.model, &f.path);
        match path.owner {
            Owner::Effect(_) => continue,
            Owner::Area(_) if !base.fit.at_bound.get(k).copied().unwrap_or(false) => {
                let mean = along.entry(path.name.clone()).or_insert_with(|| Asked {
                    name: path.name.clone(),
                    unit: unit.clone(),
                    of: Vec::new(),
                    free: None,
                });
                mean.of.push(f.path.clone());
            }
            _ => {}
        }
        out.push(Asked { name: f.path.clone(), unit, of: vec![f.path.clone()], free: Some(f.clone()) });
    }
    out.into_iter().chain(along.into_values()).collect()
}

fn unit(model: &Model, path: &str) -> String {
    let of = |i: usize| model.parameters[i].spec.quantity.unit().to_owned();
    model.find(path).map(of).unwrap_or_default()
}

/// Standard deviation of a mixture whose parts' weights need not sum to 1.
fn spread(parts: &[Normal]) -> f64 {
    let mean_of = |f: &dyn Fn(&Normal) -> f64| {
        let sum: f64 = parts.iter().map(|n| n.weight).sum();
        parts.iter().map(|n| n.weight * f(n)).sum::<f64>() / sum
    };
    let mean = mean_of(&|n| n.mean);
    mean_of(&|n| n.sd * n.sd + (n.mean - mean) * (n.mean - mean)).sqrt()
}

/// What a set says, as it was fitted, else by its columns at a smaller one. `None` where it has neither.
fn said_by(
    ladder: &FeLadder,
    scale: &Scale,
    posterior: &Posterior,
    (effects, share): (&[String], f64),
    asked: &[Asked],
) -> Result<Option<Vec<Vec<Normal>>>, EvidenceError> {
    if let Some(f) = ladder.fitted_models.get(effects) {
        let linear = scale.best(f.into())?;
        return said_by_model(scale, &linear, &f.free_parameters, (share >= WHOLE, asked)).map(Some);
    }
    let Some((smaller, candidate)) = smaller(ladder, posterior, effects) else { return Ok(None) };
    let extended = scale.extended(&scale.linear(smaller.into())?, smaller.into(), candidate)?;
    let mut out: Option<Vec<Vec<Normal>>> = None;
    for linear in extended.iter().flatten() {
        let said = said_by_model(scale, linear, &smaller.free_parameters, (false, asked))?;
        match &mut out {
            Some(all) => all.iter_mut().zip(said).for_each(|(all, said)| all.extend(said)),
            None => out = Some(said),
        }
    }
    // Shapes share what their effect has.
    let shapes = extended.map_or(1.0, |e| e.len() as f64);
    out.iter_mut().flatten().flatten().for_each(|n| n.weight /= shapes);
    Ok(out)
}

/// `whole`: at all sizes of the rest. Parameters beyond those of `free` are no part of a quantity.
fn said_by_model(
    scale: &Scale,
    linear: &Linear,
    free: &[Free],
    (whole, asked): (bool, &[Asked]),
) -> Result<Vec<Vec<Normal>>, EvidenceError> {
    let evidence = if whole { scale.evidence(linear)? } else { scale.at_few_sizes(linear)? };
    let found: Vec<Option<Box<Quantity>>> = asked.iter().map(|a| a.in_model(free)).collect();
    let known: Vec<&Quantity> = found.iter().flatten().map(AsRef::as_ref).collect();
    let Beliefs { rest, sets, .. } = scale.beliefs;
    let mut said = evidence.says(rest, sets.unlike(), &known).into_iter();
    Ok(found.iter().map(|q| q.as_ref().and_then(|_| said.next()).unwrap_or_default()).collect())
}

/// The most probable fitted set with one effect less whose screen has that effect.
fn smaller<'a>(
    ladder: &'a FeLadder,
    posterior: &Posterior,
    effects: &[String],
) -> Option<(&'a Fitted, &'a Candidate)> {
    let probability = |key: &Vec<String>| {
        let here = posterior.by_evidence.iter().find(|s| &s.effects == key);
        here.map_or(0.0, |s| s.probability + s.with_something_else)
    };
    let without = |effect: &String| {
        let key: Vec<String> = effects.iter().filter(|e| *e != effect).cloned().collect();
        let candidate = ladder.screened.get(&key)?.iter().find(|c| &c.effect == effect)?;
        let fitted = ladder.fitted_models.get(&key)?;
        Some((probability(&key), fitted, candidate))
    };
    let all = effects.iter().filter_map(without);
    all.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, fitted, candidate)| (fitted, candidate))
}

#[cfg(test)]
mod tests;
