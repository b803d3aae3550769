//! The channels a record may hold.

use input::Record;

/// Which measured channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Channel {
    /// Load cell, N.
    Force,
    /// Camera: change of distance between the clamped edges, mm.
    GripDisplacement,
    /// Camera: tear front, mm.
    TearFront,
    /// Camera: change of width, mm.
    WidthChange,
    /// Load cell of the second axis, N.
    ForceX,
}

impl Channel {
    /// All, force first.
    pub const ALL: [Self; 5] =
        [Self::Force, Self::GripDisplacement, Self::TearFront, Self::WidthChange, Self::ForceX];

    /// Word in block names.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Force => "force",
            Self::GripDisplacement => "grip_displacement",
            Self::TearFront => "tear_front",
            Self::WidthChange => "width_change",
            Self::ForceX => "force_x",
        }
    }

    /// Unit of its numbers.
    pub const fn unit(self) -> &'static str {
        match self {
            Self::Force | Self::ForceX => "N",
            Self::GripDisplacement | Self::TearFront | Self::WidthChange => "mm",
        }
    }

    /// The channel's numbers in a record: (row, value) where measured.
    pub fn of(self, record: &Record) -> Vec<(usize, f64)> {
        let some = |c: &Option<Vec<Option<f64>>>| -> Vec<(usize, f64)> {
            c.iter().flatten().enumerate().filter_map(|(i, v)| v.map(|v| (i, v))).collect()
        };
        match self {
            Self::Force => record.force.iter().copied().enumerate().collect(),
            Self::GripDisplacement => some(&record.grip_displacement),
            Self::TearFront => some(&record.tear_front),
            Self::WidthChange => some(&record.width_change),
            Self::ForceX => some(&record.force_x),
        }
    }
}
