//! Laws of other people: of what is hidden the catalogue holds the kind, but not the formula. An answer is right where it names the
//! kind.

mod damage;
mod noise;
mod relaxation;
mod softening;

pub use noise::load_cell;

use crate::amplitude::{Parameters, Sizes};
use crate::draw::{about_one, between};
use effects::decorator::decorate;
use inverse::Random;
use model::{Action, Card, Effect, Options, Piece, Scales, Screening, Sided, Site};
use params::ParamSpec;
use std::sync::Arc;

/// What is hidden.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Foreign {
    /// Relaxation by a power of time: G(t) = 1 + g (1 + t/τ)^(−α), one law over many decades.
    PowerLaw,
    /// Damage of the whole isochoric stress by the norm of the energy (Simo's), with a rational law of its growth.
    EnergyNorm,
    /// Softening along half a cosine in place of an exponential.
    Cosine,
    /// Nothing, but the noise of a load cell: white, flicker (1/f) and mains.
    LoadCell,
}

impl Foreign {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::PowerLaw, Self::EnergyNorm, Self::Cosine, Self::LoadCell];

    /// Name in the truth and in tables.
    pub const fn word(self) -> &'static str {
        match self {
            Self::PowerLaw => "foreign:power_law_relaxation",
            Self::EnergyNorm => "foreign:energy_norm_damage",
            Self::Cosine => "foreign:cosine_softening",
            Self::LoadCell => "foreign:load_cell_noise",
        }
    }

    /// Of a word of a truth.
    pub fn of(word: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|f| f.word() == word)
    }

    /// Effects of the catalogue that are of the same kind.
    pub const fn accepted(self) -> &'static [&'static str] {
        match self {
            Self::PowerLaw => &["viscoelastic"],
            // The catalogue splits the kind: what softens for good, and what softens below the largest energy.
            Self::EnergyNorm => &["fiber_damage", "mullins"],
            Self::Cosine => &["law_shape"],
            Self::LoadCell => &[],
        }
    }

    /// Name of its law in the generator's catalogue; `None`: it has none.
    pub const fn law(self) -> Option<&'static str> {
        match self {
            Self::PowerLaw => Some(RELAXATION.name),
            Self::EnergyNorm => Some(DAMAGE.name),
            Self::Cosine => Some(SOFTENING.name),
            Self::LoadCell => None,
        }
    }

    /// Draws its parameters.
    pub fn parameters(self, strength: f64, s: &Sizes, random: &mut Random) -> Parameters {
        let a = strength * about_one(random, 0.15);
        let stretch = 1.0 + s.uniaxial.0 / s.geometry.length;
        let (_, energy) = s.tissue.fibre(stretch);
        match self {
            Self::PowerLaw => {
                vec![
                    ("g", 0.25 * a),
                    ("tau", between(random, 0.5, 2.0)),
                    ("alpha", between(random, 0.2, 0.4)),
                ]
            }
            Self::EnergyNorm => {
                let xi = (2.0 * energy).sqrt();
                vec![("a", (0.25 * a).min(0.7)), ("xi0", 0.3 * xi), ("half", between(random, 0.3, 0.8) * xi)]
            }
            Self::Cosine => vec![("share", (0.4 * a).min(1.0))],
            Self::LoadCell => vec![("a", a)],
        }
    }
}

/// A law as an effect of the generator's catalogue, never of the product's.
pub struct ForeignLaw(pub Foreign);

impl ForeignLaw {
    /// Those that are laws.
    pub fn all() -> impl Iterator<Item = Self> {
        Foreign::ALL.into_iter().filter(|f| f.law().is_some()).map(Self)
    }
}

const fn card(name: &'static str, site: Site, summary: &'static str, law: &'static str) -> Card {
    Card {
        name,
        site,
        rank: 35,
        summary,
        law,
        reference: "another family than the catalogue's; for the hidden-effect suite",
        shows_in: &[],
        look_alikes: &[],
        separated_by: "its kind of the catalogue, if at all",
        ordinary: "as the record was made",
        excludes: &[],
        needs: &[],
        screening: Screening::Score(Sided::Positive),
        negative_control: false,
        breaks_half_height: false,
    }
}

static RELAXATION: Card = card(
    "foreign_relaxation",
    Site::Bulk,
    "The isochoric stress relaxes by a power of time.",
    "S = S∞ + Dev ∫ g (1 + (t − s)/τ)^(−α) dS_iso(s)",
);
static DAMAGE: Card = card(
    "foreign_damage",
    Site::Bulk,
    "The isochoric stress is lost for good by the largest norm of its energy.",
    "P = P_vol + (1 − D) P_iso,  D = a x²/(x² + h²),  x = ⟨max √(2Ψ) − ξ0⟩",
);
static SOFTENING: Card = card(
    "foreign_softening",
    Site::Interface,
    "The tear softens in part along half a cosine.",
    "t = (1 − w) e σc (δ/δc) exp(−δ/δc) + w σc ½ (1 + cos π(δ − δ0)/(δf − δ0)),  δf = 2 Gc/σc,  δ0 = δf/10",
);

impl Effect for ForeignLaw {
    fn card(&self) -> &Card {
        match self.0 {
            Foreign::PowerLaw => &RELAXATION,
            Foreign::EnergyNorm => &DAMAGE,
            Foreign::Cosine | Foreign::LoadCell => &SOFTENING,
        }
    }

    fn parameters(&self, _options: &Options) -> Vec<ParamSpec> {
        match self.0 {
            Foreign::PowerLaw => relaxation::parameters(),
            Foreign::EnergyNorm => damage::parameters(),
            Foreign::Cosine | Foreign::LoadCell => softening::parameters(),
        }
    }

    fn shapes(&self, _scales: &Scales) -> Vec<Vec<f64>> {
        vec![self.parameters(&Options::new()).iter().map(|p| p.neutral.unwrap_or(p.start)).collect()]
    }

    fn start(&self, _scales: &Scales) -> Vec<f64> {
        self.parameters(&Options::new()).iter().map(|p| p.start).collect()
    }

    fn act(&self, _options: &Options, _piece: &Piece) -> Action {
        match self.0 {
            Foreign::PowerLaw => Action::Bulk(Box::new(|inner| {
                let volumetric = inner.offers().bulk.and_then(|b| b.volumetric);
                Arc::new(decorate(inner, relaxation::Memory { volumetric }))
            })),
            Foreign::EnergyNorm => Action::Bulk(Box::new(|inner| {
                let volumetric = inner.offers().bulk.and_then(|b| b.volumetric);
                Arc::new(decorate(inner, damage::Loss { volumetric }))
            })),
            // In place of the law inside: the base law of the case, whose parameters are the same.
            Foreign::Cosine | Foreign::LoadCell => {
                Action::Interface(Box::new(|_| Arc::new(cohesive::Irreversible(softening::Mixed))))
            }
        }
    }
}
