//! The registry of experiments: how a piece is meshed, held and pulled; one folder and one line each.
//!
//! An experiment's **card** ([`input::ExperimentCard`]) says what it offers: whether anything tears, which channels it
//! measures, how the piece lies, what the record tells without finite elements. Every [`input::Test`] carries the card of
//! its kind, and whoever needs to know something of a test asks the card. What the model needs beyond is the trait
//! [`Experiment`]: the strip that is meshed, and the supports.
//!
//! ```
//! let experiments = experiments::registry();
//! let tearing = experiments.get("tearing").map(|e| e.card());
//! assert!(tearing.is_some_and(|card| card.tears && card.measures("tear_front")));
//! ```

mod biaxial;
mod cards;
mod estimate;
mod experiment;
mod flat;
mod peel;
mod peel_180;
mod pure_shear;
mod registry;
mod supports;
mod t_peel;
mod tearing;
mod uniaxial;

pub use biaxial::Biaxial;
pub use cards::{intact_sheet, peeled_sheet, torn_sheet};
pub use estimate::{any_piece, from_area, no_balance, nothing, over_the_torn_area};
pub use experiment::{Experiment, Sample, Setting, SupportFault, Supports};
pub use flat::flat_strip;
pub use peel::{plateau_balance, plateau_estimate, split_strip};
pub use peel_180::Peel180;
pub use pure_shear::PureShear;
pub use registry::{Experiments, registry};
pub use supports::{Held, across_the_ends, at_the_grips, at_the_mouth};
pub use t_peel::TPeel;
pub use tearing::Tearing;
pub use uniaxial::Uniaxial;
