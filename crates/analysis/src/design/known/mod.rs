//! How well base parameters would be known: by noise, with the error of the mesh, and beside an effect.

use diagnose::Candidate;
use inverse::{Free, Identifiability, Whitened};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use serde::Serialize;
use std::collections::BTreeMap;

/// A look foretells a standard error within this factor, either way (three times of four, docs/reliability.md).
const WITHIN: f64 = 3.0;

/// What a look expects of an identification of a parameter, by the rule that identifications go by ([`Identifiability`]).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Expected {
    /// The records fix it, even were its standard error three times as large as foretold.
    Fixed,
    /// Whether they do depends on where the identification ends.
    Uncertain,
    /// They do not, even were its standard error a third of that.
    Open,
}

impl Expected {
    /// Of a parameter with a standard deviation `sd_z` in the transformed coordinate.
    fn of(free: &Free, value: f64, sd_z: f64) -> Self {
        let rule = Identifiability::default();
        // What the records alone know, over what they would have to: the prior is in `sd_z`.
        let learned = |p: inverse::Prior| {
            let beside = |sd: f64| (sd.powi(-2) - 1.0).max(0.0).sqrt().recip();
            beside(sd_z / p.sd) / beside(rule.prior_shrink)
        };
        let learned = free.prior.map_or(0.0, learned);
        let over = (sd_z / (rule.max_sd * free.natural_scale(value))).max(learned);
        // What is no number is not known.
        match over {
            o if sd_z.is_nan() || o > WITHIN => Self::Open,
            o if o * WITHIN > 1.0 => Self::Uncertain,
            _ => Self::Fixed,
        }
    }
}

/// How well a base parameter would be known.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Known {
    /// Path.
    pub path: String,
    /// Guessed value.
    pub value: f64,
    /// Standard error as a share of the value, no effect present: by noise and, where it was counted, the mesh's numerical
    /// error.
    pub relative_error: f64,
    /// The same by noise alone.
    pub by_noise: f64,
    /// What is expected of an identification, no effect present.
    pub expected: Expected,
    /// Effects that the records show at a plausible size, or may, and beside which less is expected of it: what.
    pub beside: BTreeMap<String, Expected>,
}

impl Known {
    /// What is expected beside effects.
    pub fn expected_beside<'a>(&self, effects: impl IntoIterator<Item = &'a str>) -> Expected {
        let worse = effects.into_iter().filter_map(|e| self.beside.get(e)).max();
        worse.map_or(self.expected, |w| self.expected.max(*w))
    }
}

/// Of each parameter the less known of two, with the first's value and what opens either.
pub(super) fn less_known(first: Vec<Known>, second: Vec<Known>) -> Vec<Known> {
    let of = |(a, b): (Known, Known)| {
        let expected = a.expected.max(b.expected);
        let mut beside = a.beside;
        for (effect, worse) in b.beside {
            let worst = beside.entry(effect).or_insert(worse);
            *worst = worse.max(*worst);
        }
        beside.retain(|_, worst| *worst > expected);
        Known {
            relative_error: a.relative_error.max(b.relative_error),
            by_noise: a.by_noise.max(b.by_noise),
            expected,
            beside,
            ..a
        }
    };
    first.into_iter().zip(second).map(of).collect()
}

/// The normal equations of a linearised model, and what standard errors count.
pub(super) struct Sums<'a> {
    white: &'a Whitened,
    /// Whitened columns of the mesh's error, each of a size of its own.
    mesh: Vec<DVector<f64>>,
}

impl<'a> Sums<'a> {
    pub fn new(white: &'a Whitened, mesh: Vec<DVector<f64>>) -> Self {
        Self { white, mesh }
    }

    /// Every free parameter, at its value; beside effects in each of their shapes.
    pub fn known(&self, (free, theta): (&[Free], &[f64]), effects: &[&Candidate]) -> Vec<Known> {
        let (by_noise, alone) = self.deviations(&[]);
        let beside: Vec<Vec<f64>> = effects.par_iter().map(|c| self.beside(c, free.len())).collect();
        let one = |(k, f): (usize, &Free)| {
            let relative = |sd: f64| (f.transform.slope(theta[k]) * sd / theta[k]).abs();
            let expected = Expected::of(f, theta[k], alone[k]);
            let beside = effects.iter().zip(&beside);
            Known {
                path: f.path.clone(),
                value: theta[k],
                relative_error: relative(alone[k]),
                by_noise: relative(by_noise[k]),
                expected,
                beside: beside
                    .map(|(c, sds)| (c.effect.clone(), Expected::of(f, theta[k], sds[k])))
                    .filter(|(_, worse)| *worse > expected)
                    .collect(),
            }
        };
        free.iter().enumerate().map(one).collect()
    }

    /// Standard deviations beside an effect, of each parameter in the shape that leaves it least known.
    fn beside(&self, effect: &Candidate, parameters: usize) -> Vec<f64> {
        let mut worst = vec![0.0f64; parameters];
        for shape in &effect.shapes {
            let sized = effect.amplitudes.iter().zip(shape.columns.column_iter());
            let columns: Vec<_> = sized.map(|(a, c)| self.white.column(&(c * a.plausible))).collect();
            let (_, all) = self.deviations(&columns);
            worst.iter_mut().zip(all).for_each(|(w, sd)| *w = w.max(sd));
        }
        worst
    }

    /// Standard deviations of the parameters in transformed coordinates, by noise alone and with the mesh's error, where
    /// `added` columns are free too: those of an estimate that weighs by the noise.
    fn deviations(&self, added: &[DVector<f64>]) -> (Vec<f64>, Vec<f64>) {
        let base = &self.white.jacobian;
        let p = base.ncols();
        let mut j = base.clone().resize_horizontally(p + added.len(), 0.0);
        for (k, column) in added.iter().enumerate() {
            j.set_column(p + k, column);
        }
        let n = j.ncols();
        let Some(inverse) = (j.tr_mul(&j) + DMatrix::identity(n, n) * 1e-12).try_inverse() else {
            return (vec![f64::INFINITY; p], vec![f64::INFINITY; p]);
        };
        let shifts: Vec<DVector<f64>> = self.mesh.iter().map(|m| &inverse * j.tr_mul(m)).collect();
        let noise = |k: usize| inverse[(k, k)].max(0.0);
        let mesh = |k: usize| shifts.iter().map(|s| s[k].powi(2)).sum::<f64>();
        ((0..p).map(|k| noise(k).sqrt()).collect(), (0..p).map(|k| (noise(k) + mesh(k)).sqrt()).collect())
    }
}

#[cfg(test)]
mod tests;
