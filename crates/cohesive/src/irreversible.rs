//! The irreversible law over any curve of traction against opening: what a new interface law is made of.

use crate::envelope::effective_opening;
use crate::law::{DELTA_MAX, GC, LAMBDA, PENALTY, SIGMA_C, common_parameters};
use constitutive::{Cohesion, Context, Describe, Energy, HistorySpec, Jet, Law, Offers, Response, Scalar};
use params::ParamSpec;
use std::sync::Arc;

/// Share of the strength at which the softening zone ends.
const SPENT: f64 = 0.2;

/// Openings over δc beyond which no curve is followed.
const FARTHEST: f64 = 1e6;

/// A curve of effective traction against effective opening, t(δ), on monotonic loading.
///
/// Parameters are the whole list of [`Irreversible`]: Gc, σc, λ, K, then [`Curve::shape`]. The secant t/δ must not rise
/// with δ (unloading along it would give back more than was put in), and ∫₀^∞ t dδ must be Gc.
pub trait Curve: Clone + Send + Sync + 'static {
    /// Parameters of the shape, dimensionless as a rule; they stand behind Gc, σc, λ, K.
    fn shape(&self) -> Vec<ParamSpec>;

    /// Secant stiffness t(δ)/δ, N/mm³; at δ = 0 its limit.
    fn secant<S: Scalar>(&self, delta: S, params: &[S]) -> S;

    /// Work per area up to δ, ∫₀^δ t, N/mm.
    fn work<S: Scalar>(&self, delta: S, params: &[S]) -> S;

    /// Opening δc at which the traction first reaches σc, mm.
    fn delta_c<S: Scalar>(&self, params: &[S]) -> S;
}

/// An irreversible cohesive law: [`Curve`] while the opening grows, its secant through the origin below δmax.
///
/// ```text
/// δ = sqrt(⟨δn⟩² + λ² δs²)            T = (t/δ)(⟨δn⟩ n + λ² δs),   T_n = K δn where δn < 0
/// t = t(δ)                            loading: δ ≥ δmax
/// t = (t_max/δmax) δ                  unloading and reloading: δ < δmax
/// ```
///
/// Gradient, force, energy and history are those of [`crate::Cohesive`], which is the same over the exponential curve.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Irreversible<C>(pub C);

impl<S: Scalar, C: Curve> Law<S, 3> for Irreversible<C> {
    #[inline]
    fn respond(
        &self,
        _ctx: &Context,
        gradient: &[S; 3],
        params: &[S],
        old: &[S],
        new: &mut [S],
    ) -> Response<S, 3> {
        let lambda = params[LAMBDA];
        let delta = effective_opening(gradient, lambda);
        let delta_max = delta.max_of(old[DELTA_MAX]);
        new[DELTA_MAX] = delta_max;
        let secant = self.0.secant(delta_max, params);
        let [n, s, t] = *gradient;
        let tangential = secant * (lambda * lambda);
        // At δn = 0 the opening side: there the interface starts with its own stiffness, not K.
        let closing = n.value() < 0.0;
        let normal = if closing { params[PENALTY] } else { secant } * n;
        let mut energy = secant * delta * delta * 0.5;
        if closing {
            energy += normal * n * 0.5;
        }
        Response { force: [normal, tangential * s, tangential * t], energy }
    }
}

impl<C: Curve> Describe<3> for Irreversible<C> {
    fn parameters(&self) -> Vec<ParamSpec> {
        let mut all = common_parameters();
        all.extend(self.0.shape());
        all
    }

    fn history(&self) -> Vec<HistorySpec> {
        vec![HistorySpec { name: "delta_max".into(), initial: 0.0 }]
    }

    fn rate_dependent(&self) -> bool {
        false
    }

    /// Stored: what unloading gives back. Dissipated: ∫₀^δmax t − ½ t_max δmax, N/mm.
    fn energies(
        &self,
        ctx: &Context,
        gradient: &[f64; 3],
        params: &[f64],
        _old: &[f64],
        new: &[f64],
    ) -> Energy {
        let stored = self.respond(ctx, gradient, params, new, &mut [0.0]).energy;
        let delta_max = new[DELTA_MAX];
        let recoverable = 0.5 * self.0.secant(delta_max, params) * delta_max * delta_max;
        Energy { stored, dissipated: self.0.work(delta_max, params) - recoverable }
    }

    /// With k the secant stiffness and v = (⟨δn⟩, λ² δs): k diag(1, λ², λ²), and while loading k′ v⊗v/δ, since
    /// ∂δ/∂opening = v/δ.
    fn analytic_tangent(
        &self,
        _ctx: &Context,
        gradient: &[f64; 3],
        params: &[f64],
        old: &[f64],
        new: &mut [f64],
    ) -> Option<([f64; 3], [[f64; 3]; 3])> {
        let [n, s, t] = *gradient;
        let square = params[LAMBDA] * params[LAMBDA];
        let delta = effective_opening(gradient, params[LAMBDA]);
        let loading = delta >= old[DELTA_MAX];
        let delta_max = if loading { delta } else { old[DELTA_MAX] };
        new[DELTA_MAX] = delta_max;
        let (secant, slope) = self.secant_and_slope(delta_max, params);
        let normal = if n < 0.0 { params[PENALTY] } else { secant };
        let tangential = secant * square;
        let mut a = [[normal, 0.0, 0.0], [0.0, tangential, 0.0], [0.0, 0.0, tangential]];
        if loading && delta > 0.0 {
            let v = [n.max(0.0), square * s, square * t];
            for i in 0..3 {
                for j in 0..3 {
                    a[i][j] += slope / delta * v[i] * v[j];
                }
            }
        }
        Some(([normal * n, tangential * s, tangential * t], a))
    }

    fn offers(&self) -> Offers {
        Offers { bulk: None, cohesion: Some(Arc::new(self.clone())) }
    }
}

impl<C: Curve> Irreversible<C> {
    /// Secant stiffness and its derivative by the opening.
    fn secant_and_slope(&self, delta: f64, params: &[f64]) -> (f64, f64) {
        let jets: Vec<Jet<1>> = params.iter().map(|&p| Jet::constant(p)).collect();
        let k = self.0.secant(Jet::<1>::variable(delta, 0), &jets);
        (k.re, k.eps[0])
    }
}

impl<C: Curve> Cohesion for Irreversible<C> {
    fn delta_c(&self, params: &[f64]) -> (f64, [f64; 2]) {
        let seeded: Vec<Jet<3>> = params
            .iter()
            .enumerate()
            .map(|(i, &p)| match i {
                GC => Jet::variable(p, 0),
                SIGMA_C => Jet::variable(p, 1),
                _ => Jet::constant(p),
            })
            .collect();
        let delta = self.0.delta_c(&seeded);
        (delta.re, [delta.eps[0], delta.eps[1]])
    }

    fn damage(&self, delta_max: f64, params: &[f64]) -> f64 {
        (self.0.work(delta_max, params) / params[GC]).clamp(0.0, 1.0)
    }

    /// By bisection on the fall of the curve.
    fn softening_end(&self, params: &[f64]) -> f64 {
        let peak = self.0.delta_c(params);
        let left = |x: f64| self.0.secant(x * peak, params) * x * peak / params[SIGMA_C];
        let mut high = 2.0;
        while left(high) > SPENT && high < FARTHEST {
            high *= 2.0;
        }
        let mut low = 1.0;
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if left(middle) > SPENT { low = middle } else { high = middle }
        }
        high
    }
}
