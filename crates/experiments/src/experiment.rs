//! What an experiment is to the model.

use fem::{Prescribed, Reaction, Waypoint};
use input::{Case, ExperimentCard, Test};
use mesh::{Mesh, MeshError, Strip};

/// Per degree of freedom (3 per node): free, or how it moves with the grip.
pub type Supports = Vec<Option<Prescribed>>;

/// A mesh that lacks a set of nodes which the supports need.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SupportFault {
    /// Name of the set.
    pub set: String,
}

/// What an experiment may look at when it says what is meshed.
#[derive(Clone, Copy, Debug)]
pub struct Setting<'a> {
    /// The whole case: other tests of the piece, element sizes.
    pub case: &'a Case,
    /// The test.
    pub test: &'a Test,
    /// Whether laws and effects allow a model of half the height.
    pub half_height: bool,
    /// Whether the planes of the piece are planes of symmetry of the tissue.
    pub mirrors: bool,
    /// Every element cut into this many along each axis.
    pub split: usize,
    /// Element sizes multiplied by this.
    pub coarsen: f64,
}

/// A folder that runs as it is: what `fct new --experiment` writes.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// The specimen file; `NAME` stands for its name.
    pub specimen: &'static str,
    /// The config; `NAME` stands for its name.
    pub config: &'static str,
    /// Name and text of each record. Synthetic, and said so in it.
    pub records: &'static [(&'static str, &'static str)],
}

/// An experiment: a card, and how the piece is meshed and held.
pub trait Experiment: Send + Sync {
    /// What it says of itself.
    fn card(&self) -> &'static ExperimentCard;

    /// A sample of it, where it has one.
    fn sample(&self) -> Option<Sample> {
        None
    }

    /// What is meshed: x along the tear, y across it, extents in mm.
    ///
    /// # Errors
    /// What cannot be meshed.
    fn strip(&self, setting: &Setting<'_>) -> Result<Strip, MeshError>;

    /// Which displacements are held, and which follow the grip. The force of the test is the reaction that is
    /// work-conjugate to the grip's displacement, of the whole piece.
    ///
    /// # Errors
    /// [`SupportFault`] for a mesh without the nodes that are to be held.
    fn supports(&self, mesh: &Mesh, test: &Test) -> Result<Supports, SupportFault>;

    /// The forces that are measured, where they are not the work-conjugate one: along y, then along x.
    fn reactions(&self, mesh: &Mesh) -> Vec<Reaction> {
        let _ = mesh;
        Vec::new()
    }

    /// Whether the lower face of the tear keeps its direction while the upper one may be folded back over it: openings are
    /// then split by the normal of the lower face, else by that of the mid-surface.
    fn one_face_turns(&self) -> bool {
        false
    }

    /// Where the held faces pass by while the piece is mounted, where it is turned farther than Newton's method finds in
    /// one step.
    ///
    /// # Errors
    /// [`SupportFault`].
    fn waypoints(&self, mesh: &Mesh) -> Result<Vec<Waypoint>, SupportFault> {
        let _ = mesh;
        Ok(Vec::new())
    }
}
