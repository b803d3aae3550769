#![doc = include_str!("../README.md")]

pub mod bulk;
mod entry;
pub mod interface;
mod registry;
pub mod text;

pub use entry::{BulkLaw, InterfaceLaw, LawCard, LawEntry, Settings};
pub use registry::{Laws, registry};
