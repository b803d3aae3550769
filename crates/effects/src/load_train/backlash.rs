//! Play between the actuator's sensor and the clamp.

use crate::numeric::plus;
use constitutive::{Context, Describe, Energy, HistorySpec, Law, Response, Scalar};
use model::{Action, Card, Effect, Options, Piece, Scales, Screening, Sided, Site};
use params::{ParamSpec, Quantity};
use std::sync::Arc;

static CARD: Card = Card {
    name: "backlash",
    site: Site::LoadTrain,
    rank: 35,
    summary: "There is play between the actuator and the clamp: after a turn the clamp stands still until the \
              play is taken up, so that the curve comes back beside itself.",
    law: "u_grip = the old one held between u and u + b,  u the actuator's;  taken up in the sense of loading at the start",
    reference: "play operator: Visintin 1994, Differential Models of Hysteresis, doi:10.1007/978-3-662-11557-2",
    shows_in: &["unload", "reload"],
    look_alikes: &["lag"],
    separated_by: "a hold or a second rate: a late sensor settles, and its loop widens with the rate, that of play does neither; a \
                   camera on the clamped edges (grip_displacement_mm) sees it directly",
    ordinary: "b of 1 % of the travel: play of a worn spindle",
    excludes: &[],
    needs: &["unloading", "pause or two rates"],
    screening: Screening::Score(Sided::Positive),
    negative_control: false,
    breaks_half_height: false,
};

/// Dead travel at every turn.
#[derive(Clone, Copy, Debug, Default)]
pub struct Backlash;

impl Effect for Backlash {
    fn card(&self) -> &Card {
        &CARD
    }

    fn parameters(&self, _options: &Options) -> Vec<ParamSpec> {
        Describe::parameters(&Play)
    }

    fn shapes(&self, _scales: &Scales) -> Vec<Vec<f64>> {
        vec![vec![0.0]]
    }

    fn start(&self, scales: &Scales) -> Vec<f64> {
        vec![(0.01 * scales.displacement).min(10.0)]
    }

    fn act(&self, _options: &Options, _piece: &Piece) -> Action {
        Action::TakeUp(Arc::new(Play))
    }
}

struct Play;

impl<S: Scalar> Law<S, 1> for Play {
    fn respond(&self, _ctx: &Context, u: &[S; 1], params: &[S], old: &[S], new: &mut [S]) -> Response<S, 1> {
        let (pulled, pushed) = (u[0], plus(u[0], params[0]));
        new[0] = if old[0].value() == pulled.value() {
            // In touch and at rest: where it stands by the way it came.
            pulled + (old[0] - old[0].value())
        } else if old[0].value() < pulled.value() {
            pulled
        } else if old[0].value() >= pushed.value() {
            pushed
        } else {
            old[0]
        };
        Response { force: [new[0]], energy: S::zero() }
    }
}

impl Describe<1> for Play {
    fn parameters(&self) -> Vec<ParamSpec> {
        let about = "dead travel of the actuator after a turn";
        vec![ParamSpec::new("b", "b", Quantity::Length, (0.0, 10.0), 0.05, about).neutral(0.0)]
    }

    fn history(&self) -> Vec<HistorySpec> {
        vec![HistorySpec { name: "u_grip".into(), initial: 0.0 }]
    }

    fn rate_dependent(&self) -> bool {
        false
    }

    fn energies(&self, _: &Context, _: &[f64; 1], _: &[f64], _: &[f64], _: &[f64]) -> Energy {
        Energy::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use constitutive::Jet;

    /// The motion of the grip and its derivative by the play, along a motion of the actuator.
    fn motion(u: &[f64], play: f64) -> Vec<(f64, f64)> {
        let mut old = [Jet::<1>::constant(0.0)];
        u.iter()
            .map(|&u| {
                let (b, mut new) = (Jet { re: play, eps: [1.0] }, old);
                let w = Law::<Jet<1>, 1>::respond(
                    &Play,
                    &Context::default(),
                    &[Jet::constant(u)],
                    &[b],
                    &old,
                    &mut new,
                );
                old = new;
                (w.force[0].re, w.force[0].eps[0])
            })
            .collect()
    }

    #[test]
    fn the_grip_stands_still_until_the_play_is_taken_up() {
        let got = motion(&[0.0, 1.0, 0.95, 0.5, 0.5, 0.55, 0.8], 0.125);
        let want = [(0.0, 0.0), (1.0, 0.0), (1.0, 0.0), (0.625, 1.0), (0.625, 1.0), (0.625, 1.0), (0.8, 0.0)];
        assert_eq!(got, want);
    }

    /// Without play the motion is the actuator's to the bit; what a little play would do is known there: it stays through a
    /// hold.
    #[test]
    fn neutral_play_knows_its_slope() {
        let u = [0.0, 1.0, 0.5, 0.5, 0.75];
        let got = motion(&u, 0.0);
        assert!(got.iter().zip(u).all(|(g, u)| g.0.to_bits() == u.to_bits()));
        let slopes: Vec<f64> = got.iter().map(|g| g.1).collect();
        assert_eq!(slopes, [0.0, 0.0, 1.0, 1.0, 0.0]);
    }
}
