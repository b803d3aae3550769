//! All tests of `records` from outside, in one program: each of its own would be linked anew.

mod common;
mod dialects;
mod open;
mod reduction;
mod round_trip;
