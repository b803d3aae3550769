//! What a law offers to others beyond its answer: parts, scales, starts.
//!
//! An effect that changes a part of a law (its fibres, what it does beside the volume) asks the law for that part
//! here. A law that has no such part does not offer it, and the effect is refused before anything is computed: see
//! [`Capability`].

use crate::PointLaw;
use std::sync::Arc;

/// A part of a law as a law of its own: same gradient, **the whole law's parameter list**, no history.
pub type Part = Arc<dyn PointLaw<9>>;

/// One fibre family of a bulk law.
#[derive(Clone)]
pub struct FibreFamily {
    /// First Piola stress P_f (MPa) and energy Ψ_f (MPa) of the family, as they stand in the law's sums.
    pub response: Part,
    /// In place of the force, the fictitious second Piola stress 2 ∂Ψ_f/∂C̄ (MPa, row-major) at C̄ = J^(−2/3) C.
    pub fictitious: Part,
    /// First Piola stress and energy of the family with the invariants of C̄, whichever the law itself uses.
    pub isochoric: Part,
}

/// What a bulk law consists of.
#[derive(Clone)]
pub struct BulkParts {
    /// The part of the volume alone, U(J).
    pub volumetric: Option<Part>,
    /// Whether the rest depends on C̄ = J^(−2/3) C alone, so that its deviator does not see the volume.
    pub rest_is_isochoric: bool,
    /// The fibre families; empty where there are none.
    pub fibres: Vec<FibreFamily>,
    /// Index of the parameter from which fibre strains count; 0 there is the law as published.
    pub fibre_onset: Option<usize>,
    /// Initial shear modulus of the matrix, MPa, from the parameter list.
    pub matrix_modulus: fn(&[f64]) -> f64,
    /// Values from which a search may start.
    pub starts: Option<StartGrid>,
    /// Whether the strip's mirror planes (y and z) are planes of symmetry of the material, whatever its parameters.
    pub mirrors: bool,
}

/// Tissues that are tried on a free strip before a search: a grid over some parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct StartGrid {
    /// A whole parameter list; the grid's parameters are replaced in it.
    pub template: Vec<f64>,
    /// Parameter and number of values of each axis, evenly spaced in the parameter's own coordinate.
    pub axes: Vec<(usize, usize)>,
    /// Parameters in which all stresses are linear together: they are scaled to the record.
    pub scaled: Vec<usize>,
    /// The parameter of which a value in the file says that the tissue's stiffness is known.
    pub size: usize,
    /// A parameter in which one curve may have several optima, and how far apart they are.
    pub apart: Option<(usize, f64)>,
}

/// The scales of a cohesive law. Parameter lists are the law's own.
pub trait Cohesion: Send + Sync {
    /// Opening of the peak traction, δc (mm), and its derivatives by Gc and σc.
    fn delta_c(&self, params: &[f64]) -> (f64, [f64; 2]);

    /// Damage d ∈ [0, 1]: the work done up to the largest opening `delta_max` (mm), over Gc.
    fn damage(&self, delta_max: f64, params: &[f64]) -> f64;

    /// Where the softening zone ends, over δc: a fifth of the strength is left there.
    fn softening_end(&self, params: &[f64]) -> f64;

    /// Whether the traction follows t = e σc (δ/δc) exp(−δ/δc).
    fn is_exponential(&self) -> bool {
        false
    }
}

/// Everything a law offers. A decorator passes on what the law inside offers.
#[derive(Clone, Default)]
pub struct Offers {
    /// Of a bulk law.
    pub bulk: Option<BulkParts>,
    /// Of an interface law.
    pub cohesion: Option<Arc<dyn Cohesion>>,
}

/// Something an effect may ask of the law that it acts on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Capability {
    /// A stress that splits into the part of the volume and the rest.
    VolumetricSplit,
    /// Fibre families.
    Fibres,
    /// A fibre strain at which fibres begin to carry load.
    FibreOnset,
    /// The exponential curve of traction against opening.
    ExponentialCurve,
}

impl Capability {
    /// What a law that does not offer it lacks, in words: "law `yeoh` has no …".
    pub const fn words(self) -> &'static str {
        match self {
            Self::VolumetricSplit => "volumetric part that splits from the rest",
            Self::Fibres => "fibre families",
            Self::FibreOnset => "fibre strain from which fibres carry load",
            Self::ExponentialCurve => "exponential curve of traction against opening",
        }
    }
}

impl Capability {
    /// Whether the bulk law is asked, else the interface law.
    pub const fn is_of_bulk(self) -> bool {
        !matches!(self, Self::ExponentialCurve)
    }
}

impl Offers {
    /// Whether something is offered.
    pub fn has(&self, what: Capability) -> bool {
        let bulk = self.bulk.as_ref();
        match what {
            Capability::VolumetricSplit => bulk.is_some_and(|b| b.volumetric.is_some()),
            Capability::Fibres => bulk.is_some_and(|b| !b.fibres.is_empty()),
            Capability::FibreOnset => bulk.is_some_and(|b| b.fibre_onset.is_some()),
            Capability::ExponentialCurve => self.cohesion.as_ref().is_some_and(|c| c.is_exponential()),
        }
    }
}
