//! Effects between actuator and tissue.

mod backlash;
mod compliance;
mod grip_slip;
mod misalignment;
mod slack;

pub use backlash::Backlash;
pub use compliance::Compliance;
pub use grip_slip::GripSlip;
pub use misalignment::Misalignment;
pub use slack::Slack;
