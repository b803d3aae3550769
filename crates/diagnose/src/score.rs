//! The score (Lagrange multiplier) test over a catalogue, without refitting.
//!
//! With whitened misfit r, base jacobian J and an effect's column s at its neutral value:
//! s⊥ = s − J(JᵀJ)⁻¹Jᵀs, â = s⊥ᵀr/s⊥ᵀs⊥, expected fall of χ² (s⊥ᵀr)²/s⊥ᵀs⊥, visibility |s⊥|/|s|
//! (Rao 1948; Buse 1982; "modification index", Sörbom 1989). Priors are rows of r and J; columns of parameters
//! at a bound are left out.

use crate::pairs::{Pair, pairs};
use crate::ratio::ratio;
use crate::statistic::{Fall, statistic};
use crate::sup::Family;
use crate::tails::benjamini_hochberg;
use crate::{Candidate, Policy, Side};
use inverse::{Whitened, orthonormal};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use serde::Serialize;
use thiserror::Error;

/// What the screen says about one effect.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Finding {
    /// Name in the catalogue.
    pub effect: String,
    /// Estimated deviation of each amplitude from neutral.
    pub amplitudes: Vec<(String, f64)>,
    /// Standard error of each, base parameters free.
    pub std_errors: Vec<f64>,
    /// Shape parameters of the best shape.
    pub shape: Vec<(String, f64)>,
    /// Index of the best shape in the grid.
    pub shape_index: usize,
    /// Expected fall of χ² within the limits of the amplitudes ([`crate::Amplitude::admitted`]).
    pub fall: f64,
    /// The same as a share of χ².
    pub expected_fall: f64,
    /// p-value, shapes paid for.
    pub p_value: f64,
    /// The same with the noise as estimated, where `p_value` assumes the conservative noise ([`Screen::beside`]): this one is uniform
    /// where nothing is missing, the other decides.
    pub p_estimated: Option<f64>,
    /// Plain Bonferroni bound of the p-value, as a check.
    pub p_bonferroni: f64,
    /// p-value adjusted for the whole catalogue (Benjamini–Hochberg).
    pub q_value: f64,
    /// |s⊥|/|s|: what of the effect no base parameter can imitate.
    pub visibility: f64,
    /// |s⊥ a| for the plausible amplitude: standard deviations at which the record would see it.
    pub snr: f64,
    /// Whether a plausible amplitude would be seen at all (in any shape of the grid).
    pub visible: bool,
    /// Significant by the policy's false-discovery rate and least fall, and visible by derivative.
    pub significant: bool,
    /// Effects that these records cannot tell from this one.
    pub look_alikes: Vec<String>,
    /// The derivative does not tell; a short refit decides.
    pub refit_only: bool,
}

/// The whole catalogue against one misfit.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Screen {
    /// Most significant first.
    pub findings: Vec<Finding>,
    /// Every pair of effects, largest joint fall first.
    pub pairs: Vec<Pair>,
    /// χ² before, priors included.
    pub chi2: f64,
    /// Rows minus rank of the base jacobian.
    pub freedom: usize,
}

impl Finding {
    /// The p-value to show: with the noise as estimated, where that was asked.
    pub fn p_shown(&self) -> f64 {
        self.p_estimated.unwrap_or(self.p_value)
    }
}

impl Screen {
    /// Takes the p-values of `estimated`, the same screen with the noise as estimated from the records, beside its own.
    pub fn beside(&mut self, estimated: &Screen) {
        for f in &mut self.findings {
            f.p_estimated = estimated.finding(&f.effect).map(|e| e.p_value);
        }
    }

    /// What was found about one effect.
    pub fn finding(&self, effect: &str) -> Option<&Finding> {
        self.findings.iter().find(|f| f.effect == effect)
    }

    /// The pair of two effects, in either order.
    pub fn pair(&self, a: &str, b: &str) -> Option<&Pair> {
        self.pairs.iter().find(|p| (p.a == a && p.b == b) || (p.a == b && p.b == a))
    }
}

/// Why a screen could not be made.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum ScreenError {
    /// Rows or columns disagree.
    #[error("effect {effect}: {fault}")]
    Shape {
        /// Name of the effect, or `(misfit)`.
        effect: String,
        /// What does not fit.
        fault: String,
    },
}

/// One effect after projection; internal to the screen.
pub(crate) struct Projected<'a> {
    pub candidate: &'a Candidate,
    pub sides: Vec<Side>,
    /// s⊥ of each shape, m × k.
    pub shapes: Vec<DMatrix<f64>>,
    /// |s⊥|/|s| of each shape.
    pub visibility: Vec<f64>,
    /// Fall of each shape.
    pub falls: Vec<Fall>,
    /// Index of the best shape.
    pub best: usize,
}

impl Projected<'_> {
    pub fn fall(&self) -> f64 {
        self.falls.get(self.best).map_or(0.0, |f| f.fall)
    }

    /// |s⊥ a| for the plausible amplitudes in shape `i`.
    pub fn snr(&self, i: usize) -> f64 {
        let a = DVector::from_iterator(
            self.sides.len(),
            self.candidate.amplitudes.iter().map(|a| a.plausible.abs()),
        );
        self.shapes.get(i).map_or(0.0, |s| (s * a).norm())
    }
}

/// Screens raw candidates (columns of full length n) against a whitened, linearised problem.
/// `at_bound` says which base parameters leave the jacobian.
///
/// # Errors
/// [`ScreenError`] when lengths disagree or a column holds a number that is not finite.
pub fn screen(
    white: &Whitened,
    at_bound: &[bool],
    candidates: &[Candidate],
    points: usize,
    policy: &Policy,
) -> Result<Screen, ScreenError> {
    lengths(candidates, points)?;
    let whitened: Vec<Candidate> = candidates.iter().map(|c| c.whiten(white)).collect();
    let base = white.without(at_bound);
    score(&base.r, &base.jacobian, &whitened, policy)
}

/// The same on whitened numbers: misfit `r` (m), base jacobian (m × q), candidates with m rows.
///
/// # Errors
/// [`ScreenError`] when lengths disagree or a number is not finite.
pub fn score(
    r: &DVector<f64>,
    jacobian: &DMatrix<f64>,
    candidates: &[Candidate],
    policy: &Policy,
) -> Result<Screen, ScreenError> {
    check(r, jacobian, candidates)?;
    let q = orthonormal(jacobian);
    let left = r - &q * q.tr_mul(r);
    let projected: Vec<Projected> = candidates.par_iter().map(|c| project(c, &q, &left, policy)).collect();
    let chi2 = r.norm_squared();
    let mut findings: Vec<Finding> = projected.par_iter().map(|p| finding(p, chi2, policy)).collect();
    let tested: Vec<usize> = (0..findings.len()).filter(|&i| !projected[i].shapes.is_empty()).collect();
    let p: Vec<f64> = tested.iter().map(|&i| findings[i].p_value).collect();
    for (&i, q) in tested.iter().zip(benjamini_hochberg(&p)) {
        let f = &mut findings[i];
        f.q_value = q;
        f.significant = q <= policy.fdr && f.fall >= policy.min_fall && f.visibility >= policy.min_visibility;
    }
    let pairs = pairs(&projected, &left, policy);
    for pair in &pairs {
        if pair.alike {
            for (a, b) in [(&pair.a, &pair.b), (&pair.b, &pair.a)] {
                if let Some(f) = findings.iter_mut().find(|f| &f.effect == a) {
                    f.look_alikes.push(b.clone());
                }
            }
        }
    }
    findings.sort_by(|a, b| {
        a.p_value.total_cmp(&b.p_value).then(b.fall.total_cmp(&a.fall)).then(a.effect.cmp(&b.effect))
    });
    let freedom = r.len().saturating_sub(q.ncols());
    Ok(Screen { findings, pairs, chi2, freedom })
}

/// A candidate, and what each of its shapes does that no base parameter imitates.
pub(crate) type Shapes<'a> = (&'a Candidate, Vec<DMatrix<f64>>);

/// What each candidate's shapes leave after the base jacobian took what it can imitate, whitened.
pub(crate) fn projected<'a>(
    white: &Whitened,
    at_bound: &[bool],
    candidates: &'a [Candidate],
    points: usize,
    policy: &Policy,
) -> Result<Vec<Shapes<'a>>, ScreenError> {
    lengths(candidates, points)?;
    let whitened: Vec<Candidate> = candidates.par_iter().map(|c| c.whiten(white)).collect();
    let base = white.without(at_bound);
    check(&base.r, &base.jacobian, &whitened)?;
    let q = orthonormal(&base.jacobian);
    let left = DVector::zeros(base.r.len());
    let shapes: Vec<Vec<DMatrix<f64>>> =
        whitened.par_iter().map(|c| project(c, &q, &left, policy).shapes).collect();
    Ok(candidates.iter().zip(shapes).collect())
}

fn lengths(candidates: &[Candidate], points: usize) -> Result<(), ScreenError> {
    for c in candidates {
        if let Some(s) = c.shapes.iter().find(|s| s.columns.nrows() != points) {
            return Err(ScreenError::Shape {
                effect: c.effect.clone(),
                fault: format!("a column of {} for {points} points", s.columns.nrows()),
            });
        }
    }
    Ok(())
}

fn check(r: &DVector<f64>, jacobian: &DMatrix<f64>, candidates: &[Candidate]) -> Result<(), ScreenError> {
    let fault = |effect: &str, fault: String| Err(ScreenError::Shape { effect: effect.to_owned(), fault });
    if r.iter().chain(jacobian.iter()).any(|v| !v.is_finite()) {
        return fault("(misfit)", "misfit or jacobian holds a number that is not finite".into());
    }
    if jacobian.nrows() != r.len() {
        return fault("(misfit)", format!("{} misfits for {} jacobian rows", r.len(), jacobian.nrows()));
    }
    for c in candidates {
        if c.amplitudes.is_empty() {
            return fault(&c.effect, "no amplitude".into());
        }
        for s in &c.shapes {
            if s.columns.shape() != (r.len(), c.amplitudes.len()) {
                let (m, k) = s.columns.shape();
                let want = (r.len(), c.amplitudes.len());
                return fault(&c.effect, format!("columns of {m} by {k}, expected {} by {}", want.0, want.1));
            }
            if s.columns.iter().any(|v| !v.is_finite()) {
                return fault(&c.effect, "a column holds a number that is not finite".into());
            }
        }
    }
    Ok(())
}

fn project<'a>(
    candidate: &'a Candidate,
    q: &DMatrix<f64>,
    left: &DVector<f64>,
    policy: &Policy,
) -> Projected<'a> {
    let sides: Vec<Side> = candidate.amplitudes.iter().map(|a| a.side).collect();
    let (mut shapes, mut visibility, mut falls) = (Vec::new(), Vec::new(), Vec::new());
    for shape in &candidate.shapes {
        let s = &shape.columns;
        let mut out = s.clone();
        // Once more for what rounding leaves.
        for _ in 0..2 {
            out -= q * q.tr_mul(&out);
        }
        let seen = ratio(out.norm(), s.norm());
        if seen < policy.min_visibility {
            out.fill(0.0);
        }
        falls.push(statistic(&out.tr_mul(&out), &out.tr_mul(left), &sides));
        visibility.push(seen);
        shapes.push(out);
    }
    let best = (0..falls.len())
        .max_by(|&a, &b| {
            let key = |i: usize| falls[i].fall;
            key(a).total_cmp(&key(b)).then(visibility[a].total_cmp(&visibility[b])).then(b.cmp(&a))
        })
        .unwrap_or(0);
    Projected { candidate, sides, shapes, visibility, falls, best }
}

fn finding(p: &Projected, chi2: f64, policy: &Policy) -> Finding {
    let c = p.candidate;
    let names = c.amplitudes.iter().map(|a| a.name.clone());
    let live: Vec<DMatrix<f64>> = p.shapes.iter().filter(|s| s.norm() > 0.0).cloned().collect();
    let family = Family { shapes: &live, sides: &p.sides };
    let none = vec![0.0; c.amplitudes.len()];
    let within = p.falls.get(p.best).map(|f| f.within(&c.amplitudes));
    let fall = within.as_ref().map_or(0.0, |f| f.fall);
    let snr_any = (0..p.shapes.len()).map(|i| p.snr(i)).fold(0.0, f64::max);
    Finding {
        effect: c.effect.clone(),
        amplitudes: names.zip(within.map_or(none, |f| f.amplitudes)).collect(),
        std_errors: p.shapes.get(p.best).map_or(Vec::new(), std_errors),
        shape: c.shapes.get(p.best).map_or(Vec::new(), |s| s.parameters.clone()),
        shape_index: p.best,
        fall,
        expected_fall: ratio(fall, chi2),
        p_value: if live.is_empty() { 1.0 } else { family.p_value(p.fall(), policy) },
        p_estimated: None,
        p_bonferroni: if live.is_empty() { 1.0 } else { family.bonferroni(p.fall()) },
        q_value: 1.0,
        visibility: p.visibility.get(p.best).copied().unwrap_or(0.0),
        snr: p.snr(p.best),
        visible: snr_any >= policy.visible_snr,
        significant: false,
        look_alikes: Vec::new(),
        refit_only: c.refit_only,
    }
}

/// Standard errors of amplitudes, √diag(G⁻¹); 1e150 where nothing is known.
fn std_errors(s: &DMatrix<f64>) -> Vec<f64> {
    let gram = s.tr_mul(s);
    match gram.clone().cholesky() {
        Some(c) => c.inverse().diagonal().iter().map(|v| v.max(0.0).sqrt()).collect(),
        None => gram.diagonal().iter().map(|g| (1.0 / g.sqrt()).min(1e150)).collect(),
    }
}
