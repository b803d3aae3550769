//! The only reader of files: specimens and configurations (TOML), records and profiles (CSV).
//!
//! [`read_case`] turns a file into a [`Case`]: defaults applied, units converted to **mm, s, N, MPa, rad**,
//! ranges checked, the files it points to read. Or it gives [`Diagnostics`]: everything that is wrong with all
//! of them at once, with file, line and column, what was found and expected, and what was probably meant.
//! One table, [`keys`], drives reading, checking, documentation and [`json_schema`].
//!
//! ```
//! # let folder = tempfile::tempdir()?;
//! # let path = folder.path().join("strip.toml");
//! std::fs::write(&path, r#"
//!     [geometry]
//!     length_mm = 10.0
//!     width_mm = 6.0
//!     thickness_um = 800
//!     [[tests]]
//!     kind = "uniaxial"
//!     protocol = [{ to_mm = 2.0, rate_mm_per_s = 0.05 }]
//!     [bulk]
//!     mu_kPa = { start = 5.0, max = 50.0 }
//! "#)?;
//! let case = input::read_case(&path, &model::Catalogue::default())?;
//! assert_eq!(case.geometry.thickness, 0.8);
//! assert_eq!(case.bulk.value("mu").max, Some(0.05));
//! assert_eq!(case.tests[0].name, "uniaxial");
//!
//! std::fs::write(&path, "[bulk]\nmu_kpa = 5.0\n")?;
//! let faults = input::read_case(&path, &model::Catalogue::default()).unwrap_err().to_string();
//! assert!(faults.contains("strip.toml:2:1: error: unknown key `mu_kpa` in [bulk]; did you mean `mu_kPa`?"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod case;
mod config;
mod csv;
mod diagnostics;
pub mod edit;
mod experiment;
mod inputs;
mod keys;
mod locate;
mod read;
mod registry;
mod schema;
mod study;
mod text;
mod units;
mod write;

pub use case::{Averaged, Averages, Case, Ends, Geometry, Grips, Leg, Location, Record, Test, Weight};
pub use config::{
    BulkConfig, Control, DiagnoseConfig, EffectConfig, Figure, IdentifyConfig, Integration, InterfaceConfig,
    MeshConfig, Mode, OptionValue, OutputConfig, Prior, PriorsConfig, Profile, SolverConfig, Symmetry, Value,
};
pub use diagnostics::{Diagnostic, Diagnostics, Excerpt, Severity};
pub use experiment::{Balance, ExperimentCard, ExperimentRegistry, Layout, TestKind};
pub use inputs::{InputFile, sha256};
pub use keys::{Fallback, Key, Kind, Limits, keys};
pub use locate::locate;
pub use read::{LARGEST_TOML, Reading, check_geometry, keys_of_law, name_fault, read_case, read_case_as};
pub use registry::{EffectRegistry, LawRegistry, LawSite, OptionKind, OptionSpec};
pub use schema::json_schema;
pub use study::{Row, Study, StudyModel, Task, read_study};
pub use text::{read_text, visible};
pub use write::{resolved_toml, resolved_toml_with};
