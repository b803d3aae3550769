//! From whatever a testing machine wrote to a record: `time_s,displacement_mm,force_N`.
//!
//! [`import`] finds encoding, delimiter, decimal mark, table, columns and units of a text or workbook, converts to
//! mm, s, N, lists the faults of the rows, and thins long tests out on demand. **Nothing is guessed in silence**: what the file
//! does not settle is a [`Question`] with the flag that settles it, and everything that was done is in the
//! [`Import`]. Signs and offsets are proposed, never changed unasked.
//!
//! ```
//! use records::{Choices, Geometry, ImportError};
//! use std::path::Path;
//!
//! let german = b"Zeit;Weg;Kraft\ns;mm;kN\n0,0;0,000;0,0001\n0,5;0,025;0,0012\n1,0;0,050;0,0025\n";
//! let mut geometry = Geometry::default();
//! let read = records::import_bytes(Path::new("a.csv"), german.to_vec(), &Choices::new(), &mut geometry)?;
//! assert_eq!(read.tests[0].full.force, [0.1, 1.2, 2.5]);
//!
//! let no_unit = b"Time [s],Extension [mm],Load\n0,0,0.1\n1,0.05,1.2\n2,0.1,2.5\n";
//! let open = records::import_bytes(Path::new("b.csv"), no_unit.to_vec(), &Choices::new(), &mut geometry);
//! let ImportError::Undecided { questions, .. } = open.unwrap_err() else { panic!() };
//! assert_eq!((questions[0].flag.as_str(), questions[0].options[0].value.as_str()), ("units", "force=N"));
//! # Ok::<(), ImportError>(())
//! ```

mod axes;
mod bytes;
pub mod choices;
mod clock;
mod columns;
mod dialects;
mod encoding;
mod error;
mod faults;
mod geometry;
mod header;
mod import;
mod inspect;
mod layout;
mod noise;
mod number;
mod output;
mod path;
mod physics;
mod reduce;
mod rows;
mod settle;
mod sniff;
mod source;
mod table;
mod test;
mod text;
mod trouble;
pub mod units;
pub mod words;
mod workbook;

pub use bytes::{LARGEST_TEXT, LARGEST_WORKBOOK};
pub use choices::{Choices, FaultKind, Flip, Restart};
pub use columns::Understood;
pub use error::{Choice, Fault, ImportError, Question, quoted, visible};
pub use faults::Found;
pub use geometry::Geometry;
pub use header::HeaderEntry;
pub use import::{Import, Reading, Test, import, import_bytes};
pub use output::specimen;
pub use reduce::Reduction;
pub use rows::Rows;
pub use settle::Proposal;

/// The example of the README is compiled and run.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
