//! How well base parameters would be known: by noise, with the error of the mesh, and beside an effect.

use diagnose::Candidate;
use inverse::{Free, Identifiability, Whitened};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use serde::Serialize;

/// A parameter is known when its standard error is below this share of it.
const KNOWN: f64 = 0.35;

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
    /// Whether that is a measurement and not a guess.
    pub known: bool,
    /// Effects that the records show at a plausible size, or may, and beside which it would no longer be known.
    pub open_beside: Vec<String>,
}

/// Of each parameter the less known of two, with the first's value and what opens either.
pub(super) fn less_known(first: Vec<Known>, second: Vec<Known>) -> Vec<Known> {
    let of = |(a, b): (Known, Known)| {
        let known = a.known && b.known;
        let mut open_beside = if known { [a.open_beside, b.open_beside].concat() } else { Vec::new() };
        open_beside.sort();
        open_beside.dedup();
        Known {
            relative_error: a.relative_error.max(b.relative_error),
            by_noise: a.by_noise.max(b.by_noise),
            known,
            open_beside,
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
        let learned = Identifiability::default().prior_shrink;
        let one = |(k, f): (usize, &Free)| {
            let relative = |sd: f64| (f.transform.slope(theta[k]) * sd / theta[k]).abs();
            let known = |sd: f64| relative(sd) <= KNOWN && f.prior.is_none_or(|p| sd < learned * p.sd);
            let opens = |(_, sds): &(&&Candidate, &Vec<f64>)| known(alone[k]) && !known(sds[k]);
            Known {
                path: f.path.clone(),
                value: theta[k],
                relative_error: relative(alone[k]),
                by_noise: relative(by_noise[k]),
                known: known(alone[k]),
                open_beside: effects
                    .iter()
                    .zip(&beside)
                    .filter(opens)
                    .map(|(c, _)| c.effect.clone())
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
        let at = |relative_error: f64, known: bool, beside: &str| Known {
            path: "a".into(),
            value: relative_error,
            relative_error,
            by_noise: 0.5 * relative_error,
            known,
            open_beside: vec![beside.to_owned()],
        };
        let first = vec![at(0.1, true, "slack"), at(0.1, true, "slack")];
        let both = less_known(first, vec![at(0.2, true, "drift"), at(0.9, false, "drift")]);
        assert_eq!((both[0].value, both[0].relative_error, both[0].by_noise), (0.1, 0.2, 0.1));
        assert_eq!(both[0].open_beside, ["drift", "slack"]);
        assert!(both[0].known && !both[1].known && both[1].open_beside.is_empty());
    }

    /// What an effect imitates is open beside it, and what it does not stays known.
    #[test]
    fn an_effect_opens_what_it_imitates() {
        let (list, white) = line();
        let slope = Candidate::simple("slope", Side::Both, 1.0, column(|x| x + 0.02 * (40.0 * x).sin()));
        let wave = Candidate::simple("wave", Side::Both, 1.0, column(|x| (40.0 * x).sin()));
        let known = Sums::new(&white, Vec::new()).known((&list, &[4.0, 4.0]), &[&slope, &wave]);
        assert!(known.iter().all(|k| k.known && k.relative_error == k.by_noise), "{known:?}");
        assert_eq!((known[0].open_beside.len(), &known[1].open_beside[..]), (0, &["slope".to_owned()][..]));
    }
}
