//! Laws of the tear path: opening in, traction out, with the largest opening as memory.

mod bilinear;
mod exponential;
mod ppr;
mod trapezoidal;

pub use bilinear::Bilinear;
pub use exponential::Exponential;
pub use ppr::Ppr;
pub use trapezoidal::Trapezoidal;
