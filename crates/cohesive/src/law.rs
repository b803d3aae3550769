//! The interface law: opening in, traction out, with the largest opening as memory.

use crate::envelope::{damage, delta_c, dissipated, effective_opening, secant_stiffness};
use constitutive::{Cohesion, Context, Describe, Energy, HistorySpec, Law, Offers, Response, Scalar};
use params::{ParamSpec, Quantity};
use std::f64::consts::E;
use std::sync::Arc;

/// Index of Gc, fracture energy, N/mm.
pub const GC: usize = 0;
/// Index of σc, strength, MPa.
pub const SIGMA_C: usize = 1;
/// Index of λ, weight of the tangential opening.
pub const LAMBDA: usize = 2;
/// Index of K, penalty stiffness against interpenetration, N/mm³.
pub const PENALTY: usize = 3;
/// Number of parameters.
pub const PARAMETERS: usize = 4;

/// Index of δmax, the largest effective opening so far, mm, in the history.
pub const DELTA_MAX: usize = 0;

/// The irreversible exponential cohesive law (paper eqs. 4–7; Ortiz & Pandolfi 1999).
///
/// ```text
/// δ = sqrt(⟨δn⟩² + λ² δs²)            T = (t/δ)(⟨δn⟩ n + λ² δs),   T_n = K δn where δn < 0
/// t = e σc (δ/δc) exp(−δ/δc)          loading: δ ≥ δmax
/// t = (t_max/δmax) δ                  unloading and reloading: δ < δmax
/// ```
///
/// Parameters: [`GC`], [`SIGMA_C`], [`LAMBDA`], [`PENALTY`]. Gradient: opening [δn, δs1, δs2] in
/// the local frame, mm. Force: traction [tn, ts1, ts2], MPa. Energy: what unloading gives back,
/// ½ t δ (+ ½ K δn² in closing), N/mm. History: [`DELTA_MAX`].
///
/// The paper's two conditions overlap as printed; here loading needs δ ≥ δmax, everything else
/// runs on the secant through the origin. At the tie δ = δmax the point is loading. Both branches
/// are the secant stiffness of the envelope at max(δ, δmax) times the opening, so the derivative
/// through the history needs no case of its own.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Cohesive;

impl<S: Scalar> Law<S, 3> for Cohesive {
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
        let secant = secant_stiffness(delta_max, params[GC], params[SIGMA_C]);
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

/// Gc, σc, λ, K: with these every interface law's parameter list begins, and every interface law's history with δmax.
/// Gc and σc have one value per area of the tear path.
pub fn common_parameters() -> Vec<ParamSpec> {
    use Quantity::{Dimensionless, FractureEnergy, InterfaceStiffness, Stress};
    let about = "stiffness K against interpenetration; fixed unless freed";
    // What is expected: the paper's Table 2 and its section 6.
    vec![
        ParamSpec::new(
            "gc",
            "Gc",
            FractureEnergy,
            (1e-6, 1e3),
            0.23,
            "fracture energy Gc: one value, or a list with one per area",
        )
        .admissible(1e-9, 1e5)
        .expected(0.4, 1.2),
        ParamSpec::new(
            "sigma_c",
            "σc",
            Stress,
            (1e-6, 1e4),
            0.2,
            "strength σc: one value, or a list with one per area",
        )
        .admissible(1e-9, 1e6)
        .expected(0.2, 1.2),
        ParamSpec::new(
            "lambda",
            "λ",
            Dimensionless,
            (0.0, 10.0),
            1.0,
            "weight λ of sliding; fixed unless freed",
        )
        .admissible(0.0, 1e3)
        .fixed(),
        ParamSpec::new("penalty", "K", InterfaceStiffness, (1e-6, 1e9), 10.0, about)
            .admissible(1e-9, 1e9)
            .fixed(),
    ]
}

impl Cohesion for Cohesive {
    fn delta_c(&self, params: &[f64]) -> (f64, [f64; 2]) {
        let (gc, sigma_c) = (params[GC], params[SIGMA_C]);
        (gc / (E * sigma_c), [1.0 / (E * sigma_c), -gc / (E * sigma_c * sigma_c)])
    }

    fn damage(&self, delta_max: f64, params: &[f64]) -> f64 {
        damage(delta_max, params[GC], params[SIGMA_C])
    }

    /// 4 e⁻³ = 0.199.
    fn softening_end(&self, _params: &[f64]) -> f64 {
        4.0
    }

    fn is_exponential(&self) -> bool {
        true
    }
}

impl Describe<3> for Cohesive {
    fn parameters(&self) -> Vec<ParamSpec> {
        common_parameters()
    }

    fn history(&self) -> Vec<HistorySpec> {
        vec![HistorySpec { name: "delta_max".into(), initial: 0.0 }]
    }

    fn rate_dependent(&self) -> bool {
        false
    }

    fn offers(&self) -> Offers {
        Offers { bulk: None, cohesion: Some(Arc::new(*self)) }
    }

    /// Stored: what unloading gives back. Dissipated: φ(δmax) − ½ t_max δmax, N/mm. This is less
    /// than d·Gc, which still contains the recoverable ½ t_max δmax.
    fn energies(
        &self,
        ctx: &Context,
        gradient: &[f64; 3],
        params: &[f64],
        _old: &[f64],
        new: &[f64],
    ) -> Energy {
        let stored = self.respond(ctx, gradient, params, new, &mut [0.0]).energy;
        Energy { stored, dissipated: dissipated(new[DELTA_MAX], params[GC], params[SIGMA_C]) }
    }

    /// With k the secant stiffness and v = (⟨δn⟩, λ² δs): k diag(1, λ², λ²), and while loading
    /// − k v⊗v/(δ δc), since dk/dδ = −k/δc and ∂δ/∂opening = v/δ.
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
        let secant = secant_stiffness(delta_max, params[GC], params[SIGMA_C]);
        let normal = if n < 0.0 { params[PENALTY] } else { secant };
        let tangential = secant * square;

        let mut a = [[normal, 0.0, 0.0], [0.0, tangential, 0.0], [0.0, 0.0, tangential]];
        if loading && delta > 0.0 {
            let v = [n.max(0.0), square * s, square * t];
            let softening = secant / (delta * delta_c(params[GC], params[SIGMA_C]));
            for i in 0..3 {
                for j in 0..3 {
                    a[i][j] -= softening * v[i] * v[j];
                }
            }
        }
        Some(([normal * n, tangential * s, tangential * t], a))
    }
}
