//! A tear that weakens with every reloading below its largest opening.

use super::{effective_traction, scale};
use crate::decorator::{Call, Decoration, decorate};
use cohesive::{DELTA_MAX, GC, LAMBDA, PENALTY, SIGMA_C, delta_c, effective_opening};
use constitutive::{Energy, Law, PointLaw, Response, Scalar};
use model::{Action, Card, Effect, Options, Piece, Scales, Screening, Sided, Site};
use params::{ParamSpec, Quantity};
use std::sync::Arc;

static CARD: Card = Card {
    name: "fatigue",
    site: Site::Interface,
    rank: 40,
    summary: "Each reloading of the tear zone below its largest opening damages it further: cycles \
              soften a tear that a monotonic pull would not.",
    law: "t → (1 − D) t,  Ḋ = a ⟨δ̇⟩/δc · (1 − D) t/σc on reloading (δ < δmax),  D ≤ 0.99",
    reference: "Roe & Siegmund 2003, Eng. Fract. Mech. 70, 209–232 (irreversible cohesive zone for fatigue)",
    shows_in: &["reload", "cycle k"],
    look_alikes: &[],
    separated_by: "several cycles of equal amplitude in the tearing test",
    ordinary: "a = 0.2: a fifth of the strength lost in each full reloading; from the first cycles on visible, \
               not yet a break",
    excludes: &[],
    needs: &["tearing", "unloading"],
    screening: Screening::Score(Sided::Positive),
    negative_control: false,
    breaks_half_height: false,
};

/// Damage of the tear path by reloading.
#[derive(Clone, Copy, Debug, Default)]
pub struct Fatigue;

fn own_parameters() -> Vec<ParamSpec> {
    vec![
        ParamSpec::new(
            "a",
            "a",
            Quantity::Dimensionless,
            (0.0, 20.0),
            0.2,
            "damage per reloading by δc at full strength",
        )
        .neutral(0.0),
    ]
}

impl Effect for Fatigue {
    fn card(&self) -> &Card {
        &CARD
    }

    fn parameters(&self, _options: &Options) -> Vec<ParamSpec> {
        own_parameters()
    }

    fn shapes(&self, _scales: &Scales) -> Vec<Vec<f64>> {
        vec![vec![0.0]]
    }

    fn start(&self, _scales: &Scales) -> Vec<f64> {
        vec![0.2]
    }

    fn act(&self, _options: &Options, _piece: &Piece) -> Action {
        Action::Interface(Box::new(|inner| Arc::new(decorate(inner, Cyclic))))
    }
}

struct Cyclic;

const LOG_LOSS: usize = 0;
const DELTA: usize = 1;
const TRACTION: usize = 2;
const DEFICIT: usize = 3;

/// −ln(1 − D) at the largest damage, D = 0.99.
const FULL: f64 = 4.605_170_185_988_091;

/// ∫ t dδ over the part of the step that reloads below the old δmax, of the law without fatigue.
fn reloading_work<S: Scalar>(call: &Call<'_, S, 3>, inner_new: &[S], delta: S, traction: S) -> S
where
    dyn PointLaw<3>: Law<S, 3>,
{
    let (start, limit) = (call.old[DELTA], call.inner_old[DELTA_MAX]);
    let end = if delta.value() <= limit.value() { delta } else { limit };
    if end.value() <= start.value() {
        return S::zero();
    }
    let at_end = if delta.value() <= limit.value() {
        traction
    } else {
        // The step runs past δmax onto the envelope: reloading ended at δmax, in the same direction.
        let there = call.gradient.map(|d| d * (limit / delta));
        let force = call.inner_at(&there, call.base, &mut inner_new.to_vec()).force;
        effective_traction(&force, &there, limit)
    };
    (at_end + call.old[TRACTION]) * 0.5 * (end - start)
}

impl Decoration<3> for Cyclic {
    const NAME: &'static str = "fatigue";

    fn parameters(&self) -> Vec<ParamSpec> {
        own_parameters()
    }

    /// −ln(1 − D), effective opening, traction without fatigue, and ∫ D t dδ: the work that the
    /// undamaged law would have taken and this one does not.
    fn history(&self) -> Vec<(String, f64)> {
        ["log_loss", "delta", "traction", "deficit"].map(|n| (n.to_owned(), 0.0)).to_vec()
    }

    fn respond<S: Scalar>(&self, call: &Call<'_, S, 3>, inner_new: &mut [S], new: &mut [S]) -> Response<S, 3>
    where
        dyn PointLaw<3>: Law<S, 3>,
    {
        let mut r = call.inner(inner_new);
        let delta = effective_opening(call.gradient, call.base[LAMBDA]);
        let traction = effective_traction(&r.force, call.gradient, delta);
        let work = reloading_work(call, inner_new, delta, traction);
        // Ḋ/(1 − D) integrated: D stays below 1 however large the step.
        let unit = call.base[SIGMA_C] * delta_c(call.base[GC], call.base[SIGMA_C]);
        let grown = call.old[LOG_LOSS] + call.own[0] * work / unit;
        let loss = if grown.value() < FULL { grown } else { S::from(FULL) };
        let lost_share = |l: S| -(-l).exp_m1();
        new[LOG_LOSS] = loss;
        new[DELTA] = delta;
        new[TRACTION] = traction;
        new[DEFICIT] = call.old[DEFICIT]
            + (lost_share(loss) + lost_share(call.old[LOG_LOSS]))
                * (traction + call.old[TRACTION])
                * 0.25
                * (delta - call.old[DELTA]);
        scale(&mut r, call.gradient, call.base[PENALTY], (-loss).exp());
        r
    }

    fn energies(&self, call: &Call<'_, f64, 3>, inner_new: &[f64], new: &[f64]) -> Energy {
        let inner = call.inner_energies(call.gradient, call.base, inner_new);
        let d = -(-new[LOG_LOSS]).exp_m1();
        let n = call.gradient[0].min(0.0);
        let gone = d * (inner.stored - 0.5 * call.base[PENALTY] * n * n);
        Energy { stored: inner.stored - gone, dissipated: inner.dissipated + gone - new[DEFICIT] }
    }
}
