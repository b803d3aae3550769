//! Channels of a biaxial test: which axis a column's name means.

use crate::words::{Role, fits, fold};

/// An axis of the sheet: x is the width, y the length.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Axis {
    X,
    Y,
}

impl Role {
    /// The axis of a channel of a test with two, and what the channel is called but for it.
    pub(crate) fn on_axis(self) -> Option<(Axis, Self)> {
        match self {
            Self::Displacement | Self::Strain | Self::Stretch | Self::Force | Self::Stress => {
                Some((Axis::Y, self))
            }
            Self::DisplacementX => Some((Axis::X, Self::Displacement)),
            Self::ForceX => Some((Axis::X, Self::Force)),
            _ => None,
        }
    }
}

/// How well a column's name says that it is a channel of a test with two axes: as [`fits`], and along its axis. A name
/// without an axis may be the one along y.
pub(crate) fn fits_on_axis(name: &str, role: Role) -> u8 {
    let Some((axis, channel)) = role.on_axis() else { return fits(name, role) };
    let folded = fold(name);
    let said = match folded.as_str() {
        "fx" | "ux" | "dx" => Some(Axis::X),
        "fy" | "uy" | "dy" => Some(Axis::Y),
        words if words.split(' ').any(|w| w == "x") => Some(Axis::X),
        words if words.split(' ').any(|w| w == "y") => Some(Axis::Y),
        _ => None,
    };
    if said.unwrap_or(Axis::Y) != axis {
        return 0;
    }
    // Of two names along y, the one that says so is meant.
    let sure = |score: u8| if said.is_none() { score.min(1) } else { score };
    match (folded.as_str(), channel) {
        ("fx" | "fy", Role::Force) | ("ux" | "uy" | "dx" | "dy", Role::Displacement) => 3,
        _ => sure(fits(name, channel)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_are_told_by_names() {
        for (name, role, score) in [
            ("XForce", Role::ForceX, 2),
            ("XForce", Role::Force, 0),
            ("YForce", Role::Force, 2),
            ("YForce", Role::ForceX, 0),
            ("Force", Role::Force, 1),
            ("Fx", Role::ForceX, 3),
            ("Fy", Role::Force, 3),
            ("displacement_x", Role::DisplacementX, 2),
            ("Displacement Y", Role::Displacement, 2),
            ("Time", Role::ForceX, 0),
        ] {
            assert_eq!(fits_on_axis(name, role), score, "{name}");
        }
    }
}
