//! The only reader of files: specimens and configurations (TOML), records and profiles (CSV).
#![warn(missing_docs)]

mod case;
mod config;
mod csv;
mod diagnostics;
pub mod edit;
mod keys;
mod read;
mod registry;
mod schema;
mod text;
mod units;
mod write;

pub use case::{Case, Ends, Geometry, Grips, Leg, Location, Record, Test, TestKind};
pub use config::{
    BulkConfig, Control, EffectConfig, FibreInvariants, Figure, HoldOut, IdentifyConfig, Integration,
    InterfaceConfig, MeshConfig, Mode, OptionValue, OutputConfig, Prior, PriorsConfig, Profile, SolverConfig,
    Symmetry, Value,
};
pub use diagnostics::{Diagnostic, Diagnostics, Excerpt, Severity};
pub use keys::{Fallback, Key, Kind, Limits, keys};
pub use read::read_case;
pub use registry::{EffectRegistry, NoEffects, OptionKind, OptionSpec};
pub use schema::json_schema;
pub use write::{resolved_toml, resolved_toml_with};
