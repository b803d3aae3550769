//! All tests of `evidence` from outside, in one program: each of its own would be linked anew.

mod analytic;
mod calibration;
mod frontier;
mod limits;
mod rest;
mod toys;
