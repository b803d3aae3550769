//! Tissue that is drawn out of its clamps.

use constitutive::{Context, Describe, Energy, HistorySpec, Law, Response, Scalar};
use model::{Action, Card, Effect, Options, Piece, Scales, Screening, Sided, Site};
use params::{ParamSpec, Quantity};
use std::sync::Arc;

const A: usize = 0;
const FS: usize = 1;

static CARD: Card = Card {
    name: "grip_slip",
    site: Site::LoadTrain,
    rank: 20,
    summary: "The tissue is drawn out of its clamps beyond a slip force, and does not go back: the \
              tissue gets less displacement than the actuator reports, for good.",
    law: "u_grip = u_actuator − a ⟨Fmax − Fs⟩,  Fmax = largest force since mounting;  a = 1/h of a slider with \
          hardening h",
    reference: "rig practice: rigid-plastic slider with hardening in series",
    shows_in: &["load", "peak", "unload", "reload"],
    look_alikes: &["permanent_set", "slack"],
    separated_by: "a camera on the clamped edges (grip_displacement_mm) sees it directly; or a remount between two tests: \
                   slip starts anew, permanent set stays",
    ordinary: "a for which a tenth of the travel is slip at the peak force: more is seen with the naked eye",
    excludes: &[],
    needs: &[],
    screening: Screening::Score(Sided::Positive),
    negative_control: false,
    breaks_half_height: false,
};

/// Irreversible slip in the clamps.
#[derive(Clone, Copy, Debug, Default)]
pub struct GripSlip;

impl Effect for GripSlip {
    fn card(&self) -> &Card {
        &CARD
    }

    fn parameters(&self, _options: &Options) -> Vec<ParamSpec> {
        Describe::parameters(&Slider)
    }

    fn shapes(&self, scales: &Scales) -> Vec<Vec<f64>> {
        // The uniaxial test may reach much smaller forces than the tear: a slip there shows too.
        let mut forces = [0.15, 0.35, 0.55, 0.75].map(|share| share * scales.peak_force).to_vec();
        if scales.uniaxial_peak < 0.8 * scales.peak_force {
            forces.extend([0.3, 0.7].map(|share| share * scales.uniaxial_peak));
        }
        forces.into_iter().map(|fs| vec![0.0, fs.min(1e4)]).collect()
    }

    fn start(&self, scales: &Scales) -> Vec<f64> {
        vec![
            (0.1 * scales.displacement / scales.peak_force).clamp(0.0, 1e3),
            (0.5 * scales.peak_force).min(1e4),
        ]
    }

    fn act(&self, _options: &Options, _piece: &Piece) -> Action {
        Action::Train(Arc::new(Slider))
    }
}

struct Slider;

impl<S: Scalar> Law<S, 1> for Slider {
    fn respond(
        &self,
        _ctx: &Context,
        force: &[S; 1],
        params: &[S],
        old: &[S],
        new: &mut [S],
    ) -> Response<S, 1> {
        new[0] = force[0].max_of(old[0]);
        let slip = params[A] * (new[0] - params[FS]).positive_part();
        // Nothing of it comes back.
        Response { force: [slip], energy: S::zero() }
    }
}

impl Describe<1> for Slider {
    fn parameters(&self) -> Vec<ParamSpec> {
        vec![
            ParamSpec::new(
                "a",
                "a",
                Quantity::Compliance,
                (0.0, 1e3),
                0.5,
                "slip per force beyond the slip force",
            )
            .neutral(0.0),
            ParamSpec::new("fs", "Fs", Quantity::Force, (0.0, 1e4), 0.1, "force at which slip begins"),
        ]
    }

    fn history(&self) -> Vec<HistorySpec> {
        vec![HistorySpec { name: "force_max".into(), initial: 0.0 }]
    }

    fn rate_dependent(&self) -> bool {
        false
    }

    /// ∫ F d(slip) = a (Fmax² − Fs²)/2.
    fn energies(&self, _: &Context, _: &[f64; 1], params: &[f64], _: &[f64], new: &[f64]) -> Energy {
        let (high, low) = (new[0].max(params[FS]), params[FS]);
        Energy { stored: 0.0, dissipated: 0.5 * params[A] * (high * high - low * low) }
    }
}
