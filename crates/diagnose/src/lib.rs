#![doc = include_str!("../README.md")]

mod candidate;
mod chance;
mod foresee;
mod ladder;
mod pairs;
mod policy;
mod protocol;
mod ratio;
mod score;
mod statistic;
mod sup;
mod verdict;

pub mod atlas;
pub mod dependence;
pub mod holdout;
pub mod noise;
pub mod power;
pub mod segments;
pub mod tails;
pub mod words;

pub use candidate::{Amplitude, Candidate, ShapeColumns, Side};
pub use chance::{Chance, chances};
pub use foresee::{Foreseen, Shown, foresee};
pub use ladder::{FittedModel, Hints, MESH_ERROR_ONLY, weights};
pub use noise::{NoiseError, NoiseEstimate};
pub use pairs::{Pair, separation};
pub use policy::Policy;
pub use score::{Finding, Screen, ScreenError, score, screen};
pub use segments::{RecordKind, Segment, SegmentKind};
pub use verdict::{Discovery, Verdict};
