#![doc = include_str!("../README.md")]

pub mod bulk;
pub mod card_text;
mod catalogue;
pub mod decorator;
pub mod interface;
mod lists;
pub mod load_train;
mod numeric;
pub mod sensor;
mod settings;
pub mod specimen;

pub use catalogue::catalogue;
