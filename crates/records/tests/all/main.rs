//! All tests of `records` from outside, in one program: each of its own would be linked anew.

mod common;
mod dialects;
mod measures;
mod open;
mod reduction;
mod round_trip;
mod settled;
