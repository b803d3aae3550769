//! Effects that the catalogue does not hold: what a laboratory meets and nobody wrote down. All but one falsify a
//! computed record, that one is a law on the tear path.

use crate::amplitude::{Parameters, Sizes};
use crate::draw::{about_one, between};
use crate::foreign::Foreign;
use effects::decorator::{Call, Decoration, decorate};
use input::{Record, TestKind};
use inverse::Random;
use model::{Action, Card, Effect, Options, Piece, Scales, Screening, Sided, Site};
use params::{ParamSpec, Quantity};
use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::sync::Arc;

/// What is hidden.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outside {
    /// The amplifier's gain swings with time: F (1 + a sin(2πt/T + φ)).
    WanderingGain,
    /// Dry friction in the actuator's guide, behind the load cell: F ± f, turning over within a short travel.
    GuideFriction,
    /// The tear sticks and slips: on new opening the force saws about its mean.
    StickSlip,
    /// A sluggish transducer: the reading is the later, the larger the force, F(t − τ F/Fmax).
    LoadDelay,
    /// A linear suture near the mouth of the cut, which never lets go.
    Suture,
    /// The load cell's zero jumps once (a cable is touched): F + f from then on.
    ZeroJump,
    /// A layer of the strip gives way at some opening and carries nothing from then on: F (1 − a).
    LayerFailure,
}

impl Outside {
    /// All of them.
    pub const ALL: [Self; 7] = [
        Self::WanderingGain,
        Self::GuideFriction,
        Self::StickSlip,
        Self::LoadDelay,
        Self::Suture,
        Self::ZeroJump,
        Self::LayerFailure,
    ];

    /// How many of them stand before the stronger pairs in the suite; the others came later and stand after them.
    pub const FIRST: usize = 5;

    /// Name in the truth and in tables.
    pub const fn word(self) -> &'static str {
        match self {
            Self::WanderingGain => "outside:wandering_gain",
            Self::GuideFriction => "outside:guide_friction",
            Self::StickSlip => "outside:stick_slip",
            Self::LoadDelay => "outside:load_delay",
            Self::Suture => "outside:suture",
            Self::ZeroJump => "outside:zero_jump",
            Self::LayerFailure => "outside:layer_failure",
        }
    }

    /// Whether it is a law of the model rather than a falsified record.
    pub fn is_law(self) -> bool {
        self == Self::Suture
    }

    /// Of a word of a truth.
    pub fn of(word: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|o| o.word() == word)
    }

    /// Draws its parameters.
    pub fn parameters(self, strength: f64, s: &Sizes, random: &mut Random) -> Parameters {
        let a = strength * about_one(random, 0.15);
        let longest = s.duration.0.max(s.duration.1);
        match self {
            Self::WanderingGain => vec![
                ("a", 0.03 * a),
                ("period", longest / between(random, 2.0, 5.0)),
                ("phase", TAU * random.uniform()),
            ],
            Self::GuideFriction => {
                vec![("f", 0.03 * a * s.uniaxial.1), ("travel", between(random, 0.01, 0.03) * s.uniaxial.0)]
            }
            Self::StickSlip => {
                vec![("a", 0.05 * a), ("period", s.tearing.0 / between(random, 8.0, 14.0))]
            }
            Self::LoadDelay => vec![("tau", 0.8 * a), ("f_max", s.uniaxial.1.max(s.tearing.1))],
            // A stiffness per area that carries a tenth of the strength at an opening of 2 δc.
            Self::Suture => {
                vec![("k", 0.1 * a * s.tissue.mean_sigma_c() / (2.0 * s.tissue.delta_c())), ("reach", 0.12)]
            }
            Self::ZeroJump => {
                vec![("f", 0.03 * a * s.tearing.1), ("from", between(random, 0.3, 0.7) * s.duration.1)]
            }
            Self::LayerFailure => vec![("a", 0.06 * a), ("at", between(random, 0.4, 0.8) * s.tearing.0)],
        }
    }

    /// The parameters of a truth in the order of the draw.
    pub fn in_order(self, values: &BTreeMap<String, f64>) -> Parameters {
        let names: &[&'static str] = match self {
            Self::WanderingGain => &["a", "period", "phase"],
            Self::GuideFriction => &["f", "travel"],
            Self::StickSlip => &["a", "period"],
            Self::LoadDelay => &["tau", "f_max"],
            Self::Suture => &["k", "reach"],
            Self::ZeroJump => &["f", "from"],
            Self::LayerFailure => &["a", "at"],
        };
        names.iter().map(|n| (*n, values.get(*n).copied().unwrap_or(0.0))).collect()
    }

    /// What the load cell reads in place of `force`.
    pub fn falsify(self, p: &Parameters, kind: TestKind, record: &Record, force: &[f64]) -> Vec<f64> {
        let p = |i: usize| p[i].1;
        match self {
            Self::WanderingGain => record
                .time
                .iter()
                .zip(force)
                .map(|(t, f)| f * (1.0 + p(0) * (TAU * t / p(1) + p(2)).sin()))
                .collect(),
            Self::GuideFriction => friction(&record.displacement, force, p(0), p(1)),
            Self::StickSlip if kind.tears => saw(&record.displacement, force, p(0), p(1)),
            Self::LoadDelay => (0..force.len())
                .map(|i| delayed(record, force, i, p(0) * (force[i] / p(1)).max(0.0)))
                .collect(),
            Self::ZeroJump if kind.tears => {
                record.time.iter().zip(force).map(|(t, f)| if *t >= p(1) { f + p(0) } else { *f }).collect()
            }
            Self::LayerFailure if kind.tears => gives_way(&record.displacement, force, p(0), p(1)),
            _ => force.to_vec(),
        }
    }
}

/// Name of the law in the generator's catalogue of what a truth calls `word`; `None` for what falsifies records.
pub fn law_of(word: &str) -> Option<&str> {
    match (Outside::of(word), Foreign::of(word)) {
        (Some(o), _) => o.is_law().then_some(SUTURE.name),
        (_, Some(f)) => f.law(),
        _ => Some(word),
    }
}

/// From the first row on that opens further than `at`, a share of the force is gone.
fn gives_way(u: &[f64], force: &[f64], share: f64, at: f64) -> Vec<f64> {
    let first = u.iter().position(|u| *u >= at).unwrap_or(force.len());
    force.iter().enumerate().map(|(i, f)| if i < first { *f } else { f * (1.0 - share) }).collect()
}

/// Dahl's friction: within `travel` after a turn it goes over to the other sign.
fn friction(u: &[f64], force: &[f64], limit: f64, travel: f64) -> Vec<f64> {
    let mut now = 0.0;
    let mut last = u.first().copied().unwrap_or(0.0);
    u.iter()
        .zip(force)
        .map(|(&u, f)| {
            let towards = limit * (u - last).signum();
            if u != last {
                now = towards + (now - towards) * (-(u - last).abs() / travel).exp();
            }
            last = u;
            f + now
        })
        .collect()
}

/// Slow rises and sudden falls while the tear opens further than ever; in between the last state stays.
fn saw(u: &[f64], force: &[f64], share: f64, period: f64) -> Vec<f64> {
    let peak = (0..force.len()).fold(0, |m, i| if force[i] > force[m] { i } else { m });
    let onset = 0.7 * u.get(peak).copied().unwrap_or(0.0);
    let mut largest = 0.0f64;
    u.iter()
        .zip(force)
        .map(|(&u, f)| {
            largest = largest.max(u);
            let phase = ((largest - onset) / period).max(0.0).fract();
            // Rises over nine tenths of the period, falls over the last tenth; zero at its start.
            let tooth = if phase < 0.9 { phase / 0.9 } else { (1.0 - phase) / 0.1 };
            let started = ((largest - onset) / period).clamp(0.0, 1.0);
            f * (1.0 + share * started * (tooth - 0.5))
        })
        .collect()
}

/// The force `late` seconds before row `i`, linear between rows.
fn delayed(record: &Record, force: &[f64], i: usize, late: f64) -> f64 {
    let at = record.time[i] - late;
    let right = record.time.partition_point(|t| *t < at).clamp(1, force.len() - 1);
    let (t0, t1) = (record.time[right - 1], record.time[right]);
    let s = ((at - t0) / (t1 - t0)).clamp(0.0, 1.0);
    force[right - 1] + s * (force[right] - force[right - 1])
}

/// The suture as an effect of the model, so that the finite elements feel it. It is in the generator's catalogue
/// only, never in the product's.
pub struct SutureEffect;

static SUTURE: Card = Card {
    name: "outside_suture",
    site: Site::Interface,
    rank: 35,
    summary: "A suture holds the faces together near the mouth of the cut.",
    law: "t → t + k δ for s < reach",
    reference: "made up for the hidden-effect suite",
    shows_in: &[],
    look_alikes: &[],
    separated_by: "looking at it",
    ordinary: "as the record was made",
    excludes: &[],
    needs: &["tearing"],
    screening: Screening::Score(Sided::Positive),
    negative_control: false,
    breaks_half_height: false,
};

fn suture_parameters() -> Vec<ParamSpec> {
    vec![
        ParamSpec::new("k", "k", Quantity::Dimensionless, (0.0, 1e3), 0.0, "stiffness per area, N/mm³")
            .neutral(0.0),
        ParamSpec::new(
            "reach",
            "s0",
            Quantity::Dimensionless,
            (0.0, 1.0),
            0.1,
            "share of the path that is sewn",
        ),
    ]
}

impl Effect for SutureEffect {
    fn card(&self) -> &Card {
        &SUTURE
    }
    fn parameters(&self, _options: &Options) -> Vec<ParamSpec> {
        suture_parameters()
    }
    fn shapes(&self, _scales: &Scales) -> Vec<Vec<f64>> {
        vec![vec![0.0, 0.1]]
    }
    fn start(&self, _scales: &Scales) -> Vec<f64> {
        vec![0.01, 0.1]
    }
    fn act(&self, _options: &Options, _piece: &Piece) -> Action {
        Action::Interface(Box::new(|inner| Arc::new(decorate(inner, Thread))))
    }
}

struct Thread;

impl Decoration<3> for Thread {
    const NAME: &'static str = "outside_suture";

    fn parameters(&self) -> Vec<ParamSpec> {
        suture_parameters()
    }

    fn respond<S: constitutive::Scalar>(
        &self,
        call: &Call<'_, S, 3>,
        inner_new: &mut [S],
        _new: &mut [S],
    ) -> constitutive::Response<S, 3>
    where
        dyn constitutive::PointLaw<3>: constitutive::Law<S, 3>,
    {
        let mut r = call.inner(inner_new);
        if call.ctx.path_position < call.own[1].value() && call.gradient[0].value() >= 0.0 {
            r.force[0] += call.own[0] * call.gradient[0];
            r.energy += call.own[0] * call.gradient[0] * call.gradient[0] * 0.5;
        }
        r
    }

    fn energies(&self, call: &Call<'_, f64, 3>, inner_new: &[f64], _new: &[f64]) -> constitutive::Energy {
        let mut e = call.inner_energies(call.gradient, call.base, inner_new);
        if call.ctx.path_position < call.own[1] && call.gradient[0] >= 0.0 {
            e.stored += 0.5 * call.own[0] * call.gradient[0].powi(2);
        }
        e
    }
}

#[cfg(test)]
mod tests {
    use super::gives_way;

    #[test]
    fn what_gave_way_stays_gone() {
        assert_eq!(gives_way(&[0.0, 1.0, 2.0, 1.0], &[1.0; 4], 0.25, 1.5), [1.0, 1.0, 0.75, 0.75]);
    }
}
