//! Cards of the families of experiments: an experiment takes that of its family and says what is its own.

use crate::{
    any_piece, from_area, no_balance, nothing, over_the_torn_area, plateau_balance, plateau_estimate,
};
use input::{Ends, ExperimentCard, Geometry, Grips, Layout};

/// How far a test usually goes on a piece, mm.
type Farthest = fn(&Geometry) -> f64;

/// An intact sheet, pulled in its plane between two clamps that hold its end faces whole.
pub const fn intact_sheet(name: &'static str, summary: &'static str, farthest: Farthest) -> ExperimentCard {
    ExperimentCard {
        name,
        summary,
        layout: Layout::Sheet,
        tears: false,
        whole_section: true,
        free_strip: false,
        two_axes: false,
        channels: &["grip_displacement"],
        ends: &[Ends::Clamped],
        grips: &[Grips::Ends],
        clamped_faces: true,
        shaped: true,
        objection: any_piece,
        farthest,
        estimate: nothing,
        balance: no_balance,
    }
}

/// The same with a cut, which is torn through: the record's area tells the toughness.
pub const fn torn_sheet(name: &'static str, summary: &'static str, farthest: Farthest) -> ExperimentCard {
    ExperimentCard {
        tears: true,
        channels: &["grip_displacement", "tear_front"],
        estimate: from_area,
        balance: over_the_torn_area,
        ..intact_sheet(name, summary, farthest)
    }
}

/// A sheet that is split in its plane, by its arms: the plateau tells the toughness. Only a rectangle of one thickness.
pub const fn peeled_sheet(name: &'static str, summary: &'static str, farthest: Farthest) -> ExperimentCard {
    ExperimentCard {
        layout: Layout::Split,
        whole_section: false,
        clamped_faces: false,
        shaped: false,
        estimate: plateau_estimate,
        balance: plateau_balance,
        ..torn_sheet(name, summary, farthest)
    }
}
