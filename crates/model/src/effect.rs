//! What an effect is: a named group of parameters with a neutral value, and where it acts.
//!
//! An effect lives in one file and enters a catalogue with one line; parsing, the screen, the
//! report and the docs read everything from its [`Card`] and its parameter list. A user's own
//! effect implements [`Effect`] outside the workspace and is as good as a built-in one.

use constitutive::{Capability, PointLaw};
use input::{OptionSpec, OptionValue, TestKind};
use params::ParamSpec;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Where an effect acts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Site {
    /// The tissue's point law.
    Bulk,
    /// The tear path's point law.
    Interface,
    /// Between actuator and tissue.
    LoadTrain,
    /// Geometry of the specimen.
    Specimen,
    /// The reading of the load cell.
    Sensor,
}

impl Site {
    /// The word used in cards and answers.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Bulk => "bulk",
            Self::Interface => "interface",
            Self::LoadTrain => "load train",
            Self::Specimen => "specimen",
            Self::Sensor => "sensor",
        }
    }
}

impl Site {
    /// Whether it is about the one load train and the one load cell of a test.
    pub const fn is_of_one_axis(self) -> bool {
        matches!(self, Self::LoadTrain | Self::Sensor)
    }
}

/// Which signs of the amplitude are physical.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sided {
    /// Amplitude ≥ neutral.
    Positive,
    /// Both.
    Both,
}

/// How an effect is tried without refitting.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Screening {
    /// Score test on the sensitivity column at the neutral value.
    Score(Sided),
    /// The response at the neutral value is not differentiable, or its first derivative vanishes:
    /// a short refit.
    Refit(Sided),
}

/// What an effect says of itself. Everything here is printed.
#[derive(Clone, Debug)]
pub struct Card {
    /// Name in files and answers.
    pub name: &'static str,
    /// Where it acts.
    pub site: Site,
    /// Order of composition on the site, smaller is nearer to the base law.
    pub rank: u32,
    /// One sentence for the newcomer.
    pub summary: &'static str,
    /// The law, in symbols of the parameters.
    pub law: &'static str,
    /// Where it comes from, with DOI where sure.
    pub reference: &'static str,
    /// Segments of a record where it shows.
    pub shows_in: &'static [&'static str],
    /// Effects that records of the paper's kind cannot tell from it.
    pub look_alikes: &'static [&'static str],
    /// The test or channel that separates it from them.
    pub separated_by: &'static str,
    /// The size of its first parameter (the amplitude) that a lab would call ordinary, and why. [`Effect::start`] gives it in
    /// numbers; a search believes the amplitude to be normal around neutral (half-normal where it has a sign) with this
    /// distance as its standard deviation.
    pub ordinary: &'static str,
    /// Effects that cannot be used together with it.
    pub excludes: &'static [&'static str],
    /// What records must hold for the effect to be visible at all: `"unloading"`, `"tearing"`, `"two tests"`; and
    /// what they need to tell it well: `"pause or two rates"`.
    pub needs: &'static [&'static str],
    /// How it is screened.
    pub screening: Screening,
    /// Kept as a negative control: never to be chosen on quasi-static records.
    pub negative_control: bool,
    /// Breaks the mirror symmetry about y = length/2 at finite amplitude.
    pub breaks_half_height: bool,
}

/// Sizes of the case that starts and shape grids are taken from.
#[derive(Clone, Copy, Debug)]
pub struct Scales {
    /// Largest force of any record, N.
    pub peak_force: f64,
    /// Largest force of the uniaxial records, N (peak_force without any).
    pub uniaxial_peak: f64,
    /// Largest actuator displacement, mm.
    pub displacement: f64,
    /// Largest actuator displacement of the uniaxial records, mm (displacement without any).
    pub uniaxial_displacement: f64,
    /// Duration of the longest test, s.
    pub duration: f64,
    /// Typical time between record points, s.
    pub sampling: f64,
    /// Largest isochoric strain energy density of the bulk, MPa (an estimate).
    pub energy: f64,
    /// Opening at peak traction δc of the middle area, mm.
    pub delta_c: f64,
    /// Strength σc of the middle area, MPa.
    pub sigma_c: f64,
    /// Typical opening rate of the tear, mm/s.
    pub opening_rate: f64,
    /// Largest fibre strain E_f of the bulk (an estimate).
    pub fibre_strain: f64,
}

/// The piece and its tests as an effect may see them.
#[derive(Clone, Copy, Debug)]
pub struct Piece {
    /// Length along the load, mm.
    pub length: f64,
    /// Width along the tear, mm.
    pub width: f64,
    /// Thickness, mm.
    pub thickness: f64,
    /// Initial cut, mm.
    pub cut: f64,
}

/// Settings of an effect that are not parameters, by name.
pub type Options = BTreeMap<String, OptionValue>;

/// A bulk law as a shared object.
pub type Bulk = Arc<dyn PointLaw<9>>;
/// An interface law as a shared object.
pub type Interface = Arc<dyn PointLaw<3>>;
/// A one-dimensional law as a shared object.
pub type Link = Arc<dyn PointLaw<1>>;

/// How an effect acts in one model. A decorator's parameters and history are inner ++ own; at the
/// neutral values the answer is the inner law's to the bit.
pub enum Action {
    /// Decorates the bulk law.
    Bulk(Box<dyn Fn(Bulk) -> Bulk>),
    /// Decorates the interface law.
    Interface(Box<dyn Fn(Interface) -> Interface>),
    /// A link of the load train: force → elongation, in series.
    Train(Link),
    /// Actuator displacement → displacement offered to train and tissue; may remember where it was, not when.
    TakeUp(Link),
    /// A displacement of the top clamp that is there before the test starts.
    Mount(Arc<dyn Mount>),
    /// A smooth movement of the nodes.
    Shape(Arc<dyn Shape>),
    /// A falsification of the force reading.
    Sensor(Arc<dyn Sensor>),
}

/// Displacement of the top clamp by mounting.
pub trait Mount: Send + Sync {
    /// Extra u_y of a clamp point at reference x (mm), and its derivative by each parameter.
    fn offset(&self, x: f64, params: &[f64]) -> (f64, Vec<f64>);
}

/// Movement of nodes.
pub trait Shape: Send + Sync {
    /// Where the node at reference `x` goes, and the derivative of that by each parameter.
    fn position(&self, x: [f64; 3], params: &[f64]) -> ([f64; 3], Vec<[f64; 3]>);
}

/// One point of a record as a sensor sees it.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// Time since the start of the test, s.
    pub time: f64,
    /// Actuator displacement, mm.
    pub displacement: f64,
    /// Actuator speed, mm/s.
    pub speed: f64,
    /// Actuator acceleration, mm/s² (zero on a ramp, a pulse at a turn).
    pub acceleration: f64,
    /// Kind of the test.
    pub kind: TestKind,
    /// Place of the test in the file, from 0.
    pub test: usize,
}

/// What a sensor makes of a force.
#[derive(Clone, Debug)]
pub struct Reading {
    /// What is recorded, N.
    pub value: f64,
    /// ∂value/∂force.
    pub slope: f64,
    /// ∂value/∂parameter.
    pub by_param: Vec<f64>,
}

/// A load cell that does not tell the truth.
pub trait Sensor: Send + Sync {
    /// How late the force is recorded, s, and the derivative by each parameter.
    fn delay(&self, params: &[f64]) -> (f64, Vec<f64>) {
        (0.0, vec![0.0; params.len()])
    }
    /// What is recorded for a true force.
    fn reading(&self, at: &Sample, force: f64, params: &[f64]) -> Reading;
}

/// A missing physical effect.
pub trait Effect: Send + Sync {
    /// What it says of itself.
    fn card(&self) -> &Card;

    /// Parameters, amplitude first; each has a neutral value or is void at the neutral amplitude.
    fn parameters(&self, options: &Options) -> Vec<ParamSpec>;

    /// Settings that are not parameters.
    fn options(&self) -> Vec<OptionSpec> {
        Vec::new()
    }

    /// Other and richer forms of the same effect, the likeliest first: their settings, and their
    /// parameters grown from a fit of this form. A search tries them where the effect helps but
    /// leaves structure; no chain of forms may come back to itself.
    fn richer(&self, options: &Options, values: &[f64]) -> Vec<(Options, Vec<f64>)> {
        let _ = (options, values);
        Vec::new()
    }

    /// What it asks of the law it acts on under these options. A law that does not offer it is refused when a file is
    /// read, and such an effect is no candidate of a search.
    fn asks(&self, options: &Options) -> Vec<Capability> {
        let _ = options;
        Vec::new()
    }

    /// Grid of parameter values on which the neutral amplitude is screened; every entry is a full
    /// parameter vector with the amplitude at its neutral value. One entry where there is no shape.
    fn shapes(&self, scales: &Scales) -> Vec<Vec<f64>>;

    /// Values from which a refit starts when the screen has no estimate, and the size of a
    /// plausible amplitude: a change that a lab would call ordinary.
    fn start(&self, scales: &Scales) -> Vec<f64>;

    /// Toughness and strength, N/mm and MPa, of a law of the tear and values of this effect, with which both together respond
    /// as with those given, where these give them each other's roles, against the card. `None` where they stand as the card
    /// means them, or cannot be exchanged.
    fn exchanged(&self, law: &str, tear: [f64; 2], own: &[f64]) -> Option<([f64; 2], Vec<f64>)> {
        let _ = (law, tear, own);
        None
    }

    /// How it acts.
    fn act(&self, options: &Options, piece: &Piece) -> Action;
}
