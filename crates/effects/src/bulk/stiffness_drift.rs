//! Stiffness that changes with the clock: drying, temperature, decay of the preparation.

use crate::decorator::{Call, Decoration, Tangent, decorate};
use constitutive::{Energy, Law, PointLaw, Response, Scalar};
use model::{Action, Card, Effect, Options, Piece, Scales, Screening, Sided, Site};
use params::{ParamSpec, Quantity};
use std::sync::Arc;

static CARD: Card = Card {
    name: "stiffness_drift",
    site: Site::Bulk,
    rank: 40,
    summary: "The tissue stiffens (drying) or softens (warming, decay) in the course of the \
              session, whatever is done to it.",
    law: "P → (1 + c t) P, t = clock of the piece through its tests, rests excluded; below \
          1 + c t = 0.1 the factor runs out smoothly and stays positive",
    reference: "rig practice: bath temperature and hydration of soft-tissue specimens",
    shows_in: &["load", "hold", "cycle k"],
    look_alikes: &["drift"],
    separated_by: "a return to small force late in the session: sensor drift shifts the zero, stiffness drift leaves it",
    ordinary: "c of 5 % over the longest test: tissue that dries or swells in its bath",
    excludes: &[],
    needs: &[],
    screening: Screening::Score(Sided::Both),
    negative_control: false,
    breaks_half_height: false,
};

/// Bulk stress times (1 + c t).
#[derive(Clone, Copy, Debug, Default)]
pub struct StiffnessDrift;

fn own_parameters() -> Vec<ParamSpec> {
    vec![
        ParamSpec::new(
            "c",
            "c",
            Quantity::Rate,
            (-0.05, 0.05),
            1e-4,
            "relative change of stiffness per second",
        )
        .neutral(0.0),
    ]
}

impl Effect for StiffnessDrift {
    fn card(&self) -> &Card {
        &CARD
    }

    fn parameters(&self, _options: &Options) -> Vec<ParamSpec> {
        own_parameters()
    }

    fn shapes(&self, _scales: &Scales) -> Vec<Vec<f64>> {
        vec![vec![0.0]]
    }

    fn start(&self, scales: &Scales) -> Vec<f64> {
        vec![(0.05 / scales.duration).min(0.05)]
    }

    fn act(&self, _options: &Options, _piece: &Piece) -> Action {
        Action::Bulk(Box::new(|inner| Arc::new(decorate(inner, Ageing))))
    }
}

struct Ageing;

const FACTOR: usize = 0;
const ENERGY: usize = 1;
const PARAMETRIC: usize = 2;

/// Least value of 1 + c t that is taken as it stands.
const FLOOR: f64 = 0.1;

/// 1 + c t, continued below [`FLOOR`] by an exponential with the same value and slope: a softening
/// tissue keeps a positive stiffness however long the session.
fn factor<S: Scalar>(c: S, time: f64) -> S {
    let f = c * time + 1.0;
    if f.value() >= FLOOR { f } else { ((f - FLOOR) / FLOOR).exp() * FLOOR }
}

impl Decoration<9> for Ageing {
    const NAME: &'static str = "stiffness_drift";

    fn parameters(&self) -> Vec<ParamSpec> {
        own_parameters()
    }

    /// Factor and inner energy at the last step, and ∫Ψ d(factor): the energy that the change of
    /// stiffness put in without any external work.
    fn history(&self) -> Vec<(String, f64)> {
        vec![("factor".into(), 1.0), ("energy".into(), 0.0), ("parametric_work".into(), 0.0)]
    }

    fn rate_dependent(&self) -> bool {
        true
    }

    fn respond<S: Scalar>(&self, call: &Call<'_, S, 9>, inner_new: &mut [S], new: &mut [S]) -> Response<S, 9>
    where
        dyn PointLaw<9>: Law<S, 9>,
    {
        let mut r = call.inner(inner_new);
        let f = factor(call.own[0], call.ctx.time);
        new[FACTOR] = f;
        new[ENERGY] = r.energy;
        new[PARAMETRIC] = call.old[PARAMETRIC] + (r.energy + call.old[ENERGY]) * 0.5 * (f - call.old[FACTOR]);
        r.force = r.force.map(|p| p * f);
        r.energy = r.energy * f;
        r
    }

    /// The parametric work is neither stored by loading nor lost: it is in the history, and the
    /// ledger's own column.
    fn energies(&self, call: &Call<'_, f64, 9>, inner_new: &[f64], new: &[f64]) -> Energy {
        let inner = call.inner_energies(call.gradient, call.base, inner_new);
        Energy { stored: inner.stored * new[FACTOR], dissipated: inner.dissipated * new[FACTOR] }
    }

    fn analytic_tangent(
        &self,
        call: &Call<'_, f64, 9>,
        inner_new: &mut [f64],
        new: &mut [f64],
    ) -> Option<Tangent<9>> {
        let (mut p, mut a) = call.inner_tangent(call.gradient, call.base, inner_new)?;
        let energy = call.inner(inner_new).energy;
        let f = factor(call.own[0], call.ctx.time);
        new.copy_from_slice(&[
            f,
            energy,
            call.old[PARAMETRIC] + (energy + call.old[ENERGY]) * 0.5 * (f - call.old[FACTOR]),
        ]);
        p.iter_mut().chain(a.as_flattened_mut()).for_each(|x| *x *= f);
        Some((p, a))
    }
}
