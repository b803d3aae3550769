#![doc = include_str!("../README.md")]

mod count;
mod error;
mod grid;
mod lines;
mod mesh;
mod ordering;
mod outline;
mod quality;
mod strip;

pub use count::{Count, Fill, count, fill};
pub use error::MeshError;
pub use grid::strip;
pub use mesh::{Interface, Mesh, area_of};
pub use ordering::nested_dissection;
pub use outline::{Outline, Profile};
pub use quality::{Quality, quality};
pub use strip::{MOST_ELEMENTS, Sizing, Strip, refine};
