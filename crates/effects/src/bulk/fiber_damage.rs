//! Fibres that lose stiffness for good once their energy passes a threshold.

use super::fibres_of;
use super::tangent::{add, add_square};
use crate::decorator::{Call, Decoration, Memory, Tangent, decorate};
use crate::numeric::{add_scaled, plus};
use constitutive::{Capability, Energy, Law, Part, PointLaw, Response, Scalar, part_response, part_tangent};
use model::{Action, Card, Effect, Options, Piece, Scales, Screening, Sided, Site};
use params::{ParamSpec, Quantity};
use std::sync::Arc;

const A: usize = 0;
const PSI0: usize = 1;
const SCALE: usize = 2;

static CARD: Card = Card {
    name: "fiber_damage",
    site: Site::Bulk,
    rank: 10,
    summary: "Collagen fibres fail one by one beyond an energy threshold: the fibre stress is lost \
              for good, on further loading too.",
    law: "P = P_vol + P_matrix + Σ_f (1 − d_f) P_f,  d_f = a (1 − exp(−⟨Ψ_f,max − Ψ0⟩/s)), \
          Ψ_f,max = largest undamaged energy of the family",
    reference: "Balzani, Schröder & Gross 2006, Acta Biomater. 2, 609–618 (damage on the fibre term of arterial tissue)",
    shows_in: &["load", "peak", "unload", "reload"],
    look_alikes: &[],
    separated_by: "cycles of growing amplitude in the intact strip: damage bends the envelope itself, Mullins leaves it",
    ordinary: "a = 0.2: a fifth of the fibres' stress lost",
    excludes: &[],
    needs: &[],
    screening: Screening::Score(Sided::Positive),
    negative_control: false,
    breaks_half_height: false,
};

/// Damage of each fibre family beyond an energy threshold.
#[derive(Clone, Copy, Debug, Default)]
pub struct FiberDamage;

fn own_parameters() -> Vec<ParamSpec> {
    use Quantity::{Dimensionless, EnergyDensity};
    vec![
        ParamSpec::new("a", "a", Dimensionless, (0.0, 0.95), 0.2, "largest share of fibre stress lost")
            .neutral(0.0),
        ParamSpec::new("psi0", "Ψ0", EnergyDensity, (0.0, 10.0), 1e-3, "fibre energy at which damage begins"),
        ParamSpec::new("scale", "s", EnergyDensity, (1e-8, 10.0), 1e-3, "energy over which it saturates"),
    ]
}

impl Effect for FiberDamage {
    fn card(&self) -> &Card {
        &CARD
    }

    fn parameters(&self, _options: &Options) -> Vec<ParamSpec> {
        own_parameters()
    }

    fn asks(&self, _options: &Options) -> Vec<Capability> {
        vec![Capability::Fibres]
    }

    fn shapes(&self, scales: &Scales) -> Vec<Vec<f64>> {
        // A family holds about half the energy; early and late onset, abrupt and gradual.
        let e = 0.5 * scales.energy;
        [(0.0, 0.3), (0.25, 0.3), (0.25, 1.0), (0.6, 0.3)]
            .map(|(onset, scale)| vec![0.0, (onset * e).min(10.0), (scale * e).clamp(1e-8, 10.0)])
            .to_vec()
    }

    fn start(&self, scales: &Scales) -> Vec<f64> {
        let e = 0.5 * scales.energy;
        vec![0.2, (0.25 * e).min(10.0), (0.5 * e).clamp(1e-8, 10.0)]
    }

    fn act(&self, _options: &Options, _piece: &Piece) -> Action {
        Action::Bulk(Box::new(|inner| {
            let fibres = fibres_of(&inner).into_iter().map(|f| f.response).collect();
            Arc::new(decorate(inner, Damage { fibres }))
        }))
    }
}

struct Damage {
    /// The families of the base law, with the brackets and invariants it puts them on with.
    fibres: Vec<Part>,
}

/// d_f as a function of the largest energy of the family.
fn damage<S: Scalar>(own: &[S], psi_max: S) -> S {
    -(own[A] * (-((psi_max - own[PSI0]).positive_part() / own[SCALE])).exp_m1())
}

/// ∫ Ψ d(d_f) up to Ψmax.
fn lost(own: &[f64], psi_max: f64) -> f64 {
    let (start, s) = (own[PSI0], own[SCALE]);
    let x = (psi_max - start).max(0.0);
    // Ψ0 + s − (Ψmax + s) e^(−x/s), in terms that do not cancel for small x.
    own[A] * (-(start + s) * (-x / s).exp_m1() - x * (-x / s).exp())
}

impl Decoration<9> for Damage {
    const NAME: &'static str = "fiber_damage";

    fn parameters(&self) -> Vec<ParamSpec> {
        own_parameters()
    }

    fn history(&self) -> Vec<(String, f64)> {
        (1..=self.fibres.len()).map(|f| (format!("psi_max_{f}"), 0.0)).collect()
    }

    fn respond<S: Scalar>(&self, call: &Call<'_, S, 9>, inner_new: &mut [S], new: &mut [S]) -> Response<S, 9>
    where
        dyn PointLaw<9>: Law<S, 9>,
    {
        let mut r = call.inner(inner_new);
        for (family, (psi_max, old)) in self.fibres.iter().zip(new.iter_mut().zip(call.old)) {
            let fibre = part_response(family, call.gradient, call.base);
            *psi_max = fibre.energy.max_of(*old);
            let d = -damage(call.own, *psi_max);
            add_scaled(&mut r.force, d, &fibre.force);
            r.energy = plus(r.energy, d * fibre.energy);
        }
        r
    }

    fn analytic_tangent(
        &self,
        call: &Call<'_, f64, 9>,
        inner_new: &mut [f64],
        new: &mut [f64],
    ) -> Option<Tangent<9>> {
        let mut sum = call.inner_tangent(call.gradient, call.base, inner_new)?;
        for (family, (psi_max, old)) in self.fibres.iter().zip(new.iter_mut().zip(call.old)) {
            let psi = part_response(family, call.gradient, call.base).energy;
            *psi_max = psi.max_of(*old);
            if *psi_max <= call.own[PSI0] {
                continue;
            }
            let fibre = part_tangent(family, call.gradient, call.base);
            add(&mut sum, -damage(call.own, *psi_max), &fibre);
            if psi >= *old {
                let rate = call.own[A] / call.own[SCALE] * (-(psi - call.own[PSI0]) / call.own[SCALE]).exp();
                add_square(&mut sum.1, -rate, &fibre.0);
            }
        }
        Some(sum)
    }

    /// The largest energy grows with the energy, by the family's stress, or stays.
    fn history_tangent(&self, call: &Call<'_, f64, 9>, inner: Memory<'_, 9>, own: Memory<'_, 9>) -> bool {
        for (f, family) in self.fibres.iter().enumerate() {
            let fibre = part_response(family, call.gradient, call.base);
            own.new[f] = fibre.energy.max_of(call.old[f]);
            own.rows[f] = if fibre.energy >= call.old[f] { fibre.force } else { [0.0; 9] };
        }
        call.inner_history_tangent(inner)
    }

    fn energies(&self, call: &Call<'_, f64, 9>, inner_new: &[f64], new: &[f64]) -> Energy {
        let mut e = call.inner_energies(call.gradient, call.base, inner_new);
        for (family, &psi_max) in self.fibres.iter().zip(new) {
            let psi = part_response(family, call.gradient, call.base).energy;
            e.stored -= damage(call.own, psi_max) * psi;
            e.dissipated += lost(call.own, psi_max);
        }
        e
    }
}
