//! Laws of the tissue: F in, first Piola stress out.

mod four_fiber;
mod hgo;
mod holzapfel_ogden;
pub mod invariants;
mod neo_hooke;
mod ogden;
mod sym;
mod yeoh;

pub use four_fiber::FourFiber;
pub use hgo::HolzapfelGasserOgden;
pub use holzapfel_ogden::HolzapfelOgden;
pub use neo_hooke::NeoHooke;
pub use ogden::Ogden;
pub use yeoh::Yeoh;

pub use ::hgo::{compliance, fibre_onset};
