//! All tests of `evidence` from outside, in one program: each of its own would be linked anew.

mod by_hand;
mod calibration;
mod limits;
mod toys;
