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
mod tests {
    use super::*;
    use diagnose::Side;
    use inverse::{Data, Noise, NoiseModel, Prediction, Random};

    const N: usize = 120;

    fn column(f: impl Fn(f64) -> f64) -> DVector<f64> {
        DVector::from_fn(N, |i, _| f(i as f64 / N as f64))
    }

    fn line() -> (Vec<Free>, Whitened) {
        let free = |path: &str| Free::new(path, (-1e3, 1e3), params::Transform::Identity, 0.0);
        let list = vec![free("a"), free("b")];
        let zero = vec![0.0; N];
        let data = Data::from_parts([(String::from("r"), zero, NoiseModel::white(0.5))]).unwrap();
        let jacobian = DMatrix::from_columns(&[column(|_| 1.0), column(|x| x)]);
        let prediction = Prediction::new(DVector::zeros(N), Some(jacobian));
        let white = Whitened::new(&data, &list, &[4.0, 4.0], &prediction, Noise::Record);
        (list, white)
    }

    /// Fits of a line to noise and a mesh's error of random size scatter as far as is said, with and without a parabola
    /// that is free too.
    #[test]
    fn standard_errors_are_the_scatter_of_fits() {
        let (list, white) = line();
        let error = column(|x| 0.3 * (1.0 - x));
        let parabola = Candidate::simple("parabola", Side::Both, 2.0, column(|x| x * x));
        let sums = Sums::new(&white, vec![white.column(&error)]);
        let known = sums.known((&list, &[4.0, 4.0]), &[]);
        let beside = sums.beside(&parabola, 2);
        let mut random = Random::new(3);
        let columns = [column(|_| 1.0), column(|x| x), column(|x| x * x)];
        let mut squares = [[0.0; 3]; 2];
        let runs = 4000;
        for _ in 0..runs {
            let noise = 0.5 * random.normals(N);
            let record = &noise + random.normal() * &error;
            for (k, sum) in squares[0].iter_mut().enumerate().take(2) {
                *sum += fit(&columns[..2], &record)[k].powi(2);
            }
            squares[0][2] += fit(&columns[..2], &noise)[0].powi(2);
            for (k, sum) in squares[1].iter_mut().enumerate().take(2) {
                *sum += fit(&columns, &record)[k].powi(2);
            }
        }
        let sd = |sum: f64| (sum / f64::from(runs)).sqrt();
        for k in 0..2 {
            let (promised, found) = (4.0 * known[k].relative_error, sd(squares[0][k]));
            assert!((found / promised - 1.0).abs() < 0.04, "{k}: {found} for {promised}");
            let found = sd(squares[1][k]);
            assert!((found / beside[k] - 1.0).abs() < 0.04, "{k} beside: {found} for {}", beside[k]);
        }
        let (promised, found) = (4.0 * known[0].by_noise, sd(squares[0][2]));
        assert!((found / promised - 1.0).abs() < 0.04, "by noise: {found} for {promised}");
    }

    fn fit(columns: &[DVector<f64>], record: &DVector<f64>) -> DVector<f64> {
        let j = DMatrix::from_columns(columns);
        (j.tr_mul(&j)).try_inverse().unwrap() * j.tr_mul(record)
    }

    /// Of two places the worse counts, and what opens either opens; what is open at one is not opened by an effect.
    #[test]
    fn the_worse_of_two_places_counts() {
        use Expected::{Fixed, Open, Uncertain};
        let at = |relative_error: f64, expected: Expected, beside: &[(&str, Expected)]| Known {
            path: "a".into(),
            value: relative_error,
            relative_error,
            by_noise: 0.5 * relative_error,
            expected,
            beside: beside.iter().map(|&(e, x)| (e.to_owned(), x)).collect(),
        };
        let first = || at(0.1, Fixed, &[("slack", Uncertain), ("gain", Open)]);
        let second = vec![at(0.2, Fixed, &[("drift", Open), ("slack", Open)]), at(0.9, Uncertain, &[])];
        let both = less_known(vec![first(), first()], second);
        assert_eq!((both[0].value, both[0].relative_error, both[0].by_noise), (0.1, 0.2, 0.1));
        assert_eq!(both[0].expected, Fixed);
        assert_eq!(both[0].beside, at(0.0, Fixed, &[("drift", Open), ("gain", Open), ("slack", Open)]).beside);
        assert_eq!(both[1].expected, Uncertain);
        assert_eq!(both[1].beside, at(0.0, Open, &[("gain", Open)]).beside);
        let beside = |effects: &[&str]| both[1].expected_beside(effects.iter().copied());
        assert_eq!((beside(&[]), beside(&["slack"]), beside(&["slack", "gain"])), (Uncertain, Uncertain, Open));
    }

    /// By the rule of an identification, with a factor of three either way: a half in natural scales, which for a share of a
    /// box are those of its logit, and 0.7 of a prior.
    #[test]
    fn what_is_expected_goes_by_the_rule_of_identifications() {
        let log = Free::new("k", (1e-3, 1e3), params::Transform::Log, 1.0);
        let at = |sd: f64| Expected::of(&log, 1.0, sd);
        let seen = [0.16, 0.17, 1.49, 1.51, f64::INFINITY, f64::NAN].map(at);
        use Expected::{Fixed, Open, Uncertain};
        assert_eq!(seen, [Fixed, Uncertain, Uncertain, Open, Open, Open]);
        let prior = Free { prior: Some(inverse::Prior { mean: 0.0, sd: 0.2 }), ..log.clone() };
        let at = |sd: f64| Expected::of(&prior, 1.0, sd);
        assert_eq!([0.05, 0.07, 0.18, 0.19, 0.2].map(at), [Fixed, Uncertain, Uncertain, Open, Open]);
    }

    /// What an effect imitates is less sure beside it, and what it does not stays as it was.
    #[test]
    fn an_effect_opens_what_it_imitates() {
        let free = |path: &str| Free::new(path, (-10.0, 10.0), params::Transform::Identity, 0.0);
        let list = vec![free("a"), free("b")];
        let (_, white) = line();
        let slope = Candidate::simple("slope", Side::Both, 1.0, column(|x| x + 0.02 * (40.0 * x).sin()));
        let wave = Candidate::simple("wave", Side::Both, 1.0, column(|x| (40.0 * x).sin()));
        let known = Sums::new(&white, Vec::new()).known((&list, &[4.0, 4.0]), &[&slope, &wave]);
        let sure = |k: &Known| k.expected == Expected::Fixed && k.relative_error == k.by_noise;
        assert!(known.iter().all(sure), "{known:?}");
        let beside: Vec<Vec<&String>> = known.iter().map(|k| k.beside.keys().collect()).collect();
        assert_eq!((beside[0].len(), &beside[1][..]), (0, &[&"slope".to_owned()][..]), "{known:?}");
    }
}
