//! Effects on what the load cell reads.

mod drift;
mod gain;
mod inertia;
mod lag;
mod self_weight;

pub use drift::Drift;
pub use gain::Gain;
pub use inertia::Inertia;
pub use lag::Lag;
pub use self_weight::SelfWeight;
