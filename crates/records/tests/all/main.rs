//! All tests of `records` from outside, in one program: each of its own would be linked anew.

mod common;
mod dialects;
mod geometry;
mod measures;
mod open;
mod reduction;
mod round_trip;
mod settled;
