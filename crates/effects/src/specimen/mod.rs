//! Effects of the piece itself: its geometry and how long it is at zero displacement.

mod cut_length;
mod prestretch;
mod thickness_taper;

pub use cut_length::CutLength;
pub use prestretch::Prestretch;
pub use thickness_taper::ThicknessTaper;
