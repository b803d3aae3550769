//! What the reader, and all who ask a test what it offers, must know of an experiment.

use crate::case::{Ends, Geometry, Grips, Record};
use serde::{Serialize, Serializer};
use std::fmt;
use std::ops::Deref;

/// How the piece lies in the model: the tear always runs along x and opens along y.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Layout {
    /// A sheet pulled in its plane: x is the width, y the length, z the thickness.
    Sheet,
    /// A sheet split in its plane: x is the length, y the thickness, z the width.
    Split,
}

impl Layout {
    /// Extents of the piece along x, y and z of the model, mm.
    pub const fn extents(self, g: &Geometry) -> [f64; 3] {
        match self {
            Self::Sheet => [g.width, g.length, g.thickness],
            Self::Split => [g.length, g.thickness, g.width],
        }
    }

    /// The key of `[geometry]` behind each of the extents.
    pub const fn keys(self) -> [&'static str; 3] {
        match self {
            Self::Sheet => ["width", "length", "thickness"],
            Self::Split => ["length", "thickness", "width"],
        }
    }
}

/// What an experiment says of itself. Who needs to know something of a test asks this card, never its name.
#[derive(Debug)]
pub struct ExperimentCard {
    /// The word used for `kind` in files and answers.
    pub name: &'static str,
    /// One sentence for the newcomer.
    pub summary: &'static str,
    /// How the piece lies in the model.
    pub layout: Layout,
    /// Whether there is a tear path; the test then informs on the interface, else on the bulk alone.
    pub tears: bool,
    /// Whether the force over the whole cross-section is a stress that tells of the tissue, and the travel over the length a
    /// strain.
    pub whole_section: bool,
    /// Whether the piece stretches roughly as a free strip does, so that one equation gives starts for the bulk.
    pub free_strip: bool,
    /// Whether a second actuator pulls along x, and a second load cell measures there: records have `displacement_x` and
    /// `force_x`, and effects of the one load train and of the one load cell take no part.
    pub two_axes: bool,
    /// Camera channels that it measures: `grip_displacement`, `tear_front`, `width_change`.
    pub channels: &'static [&'static str],
    /// Which `ends` it can be done with, the default first.
    pub ends: &'static [Ends],
    /// Which `grips` it can be done with, the default first.
    pub grips: &'static [Grips],
    /// Whether whole end faces are held: a clamp can then be turned against the other.
    pub clamped_faces: bool,
    /// Whether pieces may have an outline and a thickness profile.
    pub shaped: bool,
    /// Why the test cannot be done on this piece: a key of `[geometry]`, and what was expected of it; `None` where it can.
    pub objection: fn(&Geometry) -> Option<(&'static str, String)>,
    /// How far such a test usually goes on this piece where nothing else is known, mm.
    pub farthest: fn(&Geometry) -> f64,
    /// Toughness (N/mm) and strength (MPa) of the order that the record asks for, without finite elements; used where
    /// `tears`.
    pub estimate: fn(&Geometry, &Record) -> (f64, f64),
    /// Toughness by the energy that the record alone shows, as a cross-check of an identified one; `None` where this record
    /// does not tell.
    pub balance: fn(&Geometry, &Record) -> Option<Balance>,
}

/// A toughness by an energy balance of the record, without finite elements.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Balance {
    /// Toughness, N/mm.
    pub gc: f64,
    /// What it is, in words that follow a number: `by the work of the record over the torn area`.
    pub how: &'static str,
}

impl ExperimentCard {
    /// Whether it measures a camera channel.
    pub fn measures(&self, channel: &str) -> bool {
        self.channels.contains(&channel)
    }
}

/// The kind of a test: an experiment's card. Two are equal if their names are.
#[derive(Clone, Copy)]
pub struct TestKind(&'static ExperimentCard);

impl TestKind {
    /// The kind of an experiment.
    pub const fn new(card: &'static ExperimentCard) -> Self {
        Self(card)
    }

    /// The word used in files.
    pub const fn word(self) -> &'static str {
        self.0.name
    }
}

impl Deref for TestKind {
    type Target = ExperimentCard;

    fn deref(&self) -> &ExperimentCard {
        self.0
    }
}

impl PartialEq for TestKind {
    fn eq(&self, other: &Self) -> bool {
        self.0.name == other.0.name
    }
}

impl Eq for TestKind {}

impl fmt::Debug for TestKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.0.name)
    }
}

impl Serialize for TestKind {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.0.name)
    }
}

/// The experiments as the reader sees them; implemented by crate `experiments`.
pub trait ExperimentRegistry {
    /// Every experiment, in the order of the handbook; never empty.
    fn kinds(&self) -> Vec<TestKind>;

    /// The experiment of this name.
    fn kind(&self, name: &str) -> Option<TestKind> {
        self.kinds().into_iter().find(|k| k.word() == name)
    }
}
