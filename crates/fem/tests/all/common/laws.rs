//! Test laws with memory, written once over a scalar as any law is.
#![allow(dead_code)]

use constitutive::{Context, Describe, Energy, HistorySpec, Law, Response, Scalar, tensor};
use params::{ParamSpec, Quantity};

fn parameter(name: &'static str) -> ParamSpec {
    ParamSpec::new(name, name, Quantity::Dimensionless, (-1e6, 1e6), 0.0, "test")
}

fn memory(name: &'static str, initial: f64) -> HistorySpec {
    HistorySpec { name: name.into(), initial }
}

/// HGO softened by the largest energy so far: P = (1 − m (1 − exp(−W_max/w))) P₀. Parameters: the
/// seven of HGO, m, w.
pub struct Softening;

impl<S: Scalar> Law<S, 9> for Softening {
    fn respond(&self, ctx: &Context, f: &[S; 9], p: &[S], old: &[S], new: &mut [S]) -> Response<S, 9> {
        let base = hgo::Hgo::default().respond(ctx, f, &p[..7], &[], &mut []);
        let most = base.energy.max_of(old[0]);
        new[0] = most;
        let kept = S::one() - p[7] * (S::one() - (-(most / p[8])).exp());
        Response { force: base.force.map(|c| c * kept), energy: base.energy * kept }
    }
}

impl Describe<9> for Softening {
    fn parameters(&self) -> Vec<ParamSpec> {
        let mut list = Describe::<9>::parameters(&hgo::Hgo::default());
        list.extend([parameter("m"), parameter("w")]);
        list
    }
    fn history(&self) -> Vec<HistorySpec> {
        vec![memory("w_max", 0.0)]
    }
    fn rate_dependent(&self) -> bool {
        false
    }
    /// On the virgin curve d(dissipated) = dΨ₀ − d(kept Ψ₀) − … = −Ψ₀ d(kept): closed below.
    fn energies(&self, ctx: &Context, f: &[f64; 9], p: &[f64], _old: &[f64], new: &[f64]) -> Energy {
        let w0 = Law::<f64, 9>::respond(&hgo::Hgo::default(), ctx, f, &p[..7], &[], &mut []).energy;
        let x = new[0] / p[8];
        let kept = 1.0 - p[7] * (1.0 - (-x).exp());
        // ∫₀^W w (m/w₀) exp(−w/w₀) dw = m w₀ (1 − (1 + x) e⁻ˣ)
        Energy { stored: kept * w0, dissipated: p[7] * p[8] * (1.0 - (1.0 + x) * (-x).exp()) }
    }
}

/// HGO with an overstress that fades: Q ← e^{−dt/τ} Q + g e^{−dt/2τ} (S − S_old), on the second
/// Piola stress. Parameters: the seven of HGO, g, τ. History: S (9), Q (9).
pub struct Fading;

impl<S: Scalar> Law<S, 9> for Fading {
    fn respond(&self, ctx: &Context, f: &[S; 9], p: &[S], old: &[S], new: &mut [S]) -> Response<S, 9> {
        let base = hgo::Hgo::default().respond(ctx, f, &p[..7], &[], &mut []);
        let s = tensor::mul(&tensor::inverse(f), &base.force);
        let rate = p[8].recip() * (-ctx.dt);
        let (fade, half) = (rate.exp(), (rate * 0.5).exp());
        let mut over = [S::zero(); 9];
        for i in 0..9 {
            over[i] = fade * old[9 + i] + p[7] * half * (s[i] - old[i]);
            new[i] = s[i];
            new[9 + i] = over[i];
        }
        let extra = tensor::mul(f, &over);
        Response { force: std::array::from_fn(|i| base.force[i] + extra[i]), energy: base.energy }
    }
}

impl Describe<9> for Fading {
    fn parameters(&self) -> Vec<ParamSpec> {
        let mut list = Describe::<9>::parameters(&hgo::Hgo::default());
        list.extend([parameter("g"), parameter("tau")]);
        list
    }
    fn history(&self) -> Vec<HistorySpec> {
        vec![memory("q", 0.0); 18]
    }
    fn rate_dependent(&self) -> bool {
        true
    }
    fn energies(&self, _: &Context, _: &[f64; 9], _: &[f64], _: &[f64], _: &[f64]) -> Energy {
        Energy::default()
    }
}

/// Elongation C F. Parameter: C, mm/N.
pub struct Compliance;

impl<S: Scalar> Law<S, 1> for Compliance {
    fn respond(&self, _: &Context, f: &[S; 1], p: &[S], _: &[S], _: &mut [S]) -> Response<S, 1> {
        Response { force: [f[0] * p[0]], energy: f[0] * f[0] * p[0] * 0.5 }
    }
}

impl Describe<1> for Compliance {
    fn parameters(&self) -> Vec<ParamSpec> {
        vec![parameter("compliance")]
    }
    fn history(&self) -> Vec<HistorySpec> {
        vec![]
    }
    fn rate_dependent(&self) -> bool {
        false
    }
    fn energies(&self, _: &Context, _: &[f64; 1], _: &[f64], _: &[f64], _: &[f64]) -> Energy {
        Energy::default()
    }
}

/// Slip that does not come back: elongation s F_max². Parameter: s. History: F_max.
pub struct Slip;

impl<S: Scalar> Law<S, 1> for Slip {
    fn respond(&self, _: &Context, f: &[S; 1], p: &[S], old: &[S], new: &mut [S]) -> Response<S, 1> {
        let most = f[0].max_of(old[0]);
        new[0] = most;
        Response { force: [most * most * p[0]], energy: S::zero() }
    }
}

impl Describe<1> for Slip {
    fn parameters(&self) -> Vec<ParamSpec> {
        vec![parameter("slip")]
    }
    fn history(&self) -> Vec<HistorySpec> {
        vec![memory("f_max", 0.0)]
    }
    fn rate_dependent(&self) -> bool {
        false
    }
    fn energies(&self, _: &Context, _: &[f64; 1], _: &[f64], _: &[f64], _: &[f64]) -> Energy {
        Energy::default()
    }
}

/// Play: the old position held between u and u + b, taken up in the sense of loading. Parameter: b.
pub struct Play;

impl<S: Scalar> Law<S, 1> for Play {
    fn respond(&self, _: &Context, u: &[S; 1], p: &[S], old: &[S], new: &mut [S]) -> Response<S, 1> {
        new[0] = old[0].max_of(u[0]);
        if new[0].value() > (u[0] + p[0]).value() {
            new[0] = u[0] + p[0];
        }
        Response { force: [new[0]], energy: S::zero() }
    }
}

impl Describe<1> for Play {
    fn parameters(&self) -> Vec<ParamSpec> {
        vec![parameter("b")]
    }
    fn history(&self) -> Vec<HistorySpec> {
        vec![HistorySpec { name: "grip".into(), initial: 0.0 }]
    }
    fn rate_dependent(&self) -> bool {
        false
    }
    fn energies(&self, _: &Context, _: &[f64; 1], _: &[f64], _: &[f64], _: &[f64]) -> Energy {
        Energy::default()
    }
}

/// Slack that is taken up: s(u) = u − a (1 − exp(−u/b)). Parameters: a, b (a < b).
pub struct Slack;

impl<S: Scalar> Law<S, 1> for Slack {
    fn respond(&self, _: &Context, u: &[S; 1], p: &[S], _: &[S], _: &mut [S]) -> Response<S, 1> {
        let eaten = p[0] * (S::one() - (-(u[0] / p[1])).exp());
        Response { force: [u[0] - eaten], energy: S::zero() }
    }
}

impl Describe<1> for Slack {
    fn parameters(&self) -> Vec<ParamSpec> {
        vec![parameter("a"), parameter("b")]
    }
    fn history(&self) -> Vec<HistorySpec> {
        vec![]
    }
    fn rate_dependent(&self) -> bool {
        false
    }
    fn energies(&self, _: &Context, _: &[f64; 1], _: &[f64], _: &[f64], _: &[f64]) -> Energy {
        Energy::default()
    }
}
