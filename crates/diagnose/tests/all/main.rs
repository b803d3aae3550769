//! All tests of `diagnose` from outside, in one program: each of its own would be linked anew.

mod atlas_worked;
mod calibration;
mod noise_level;
mod noise_worked;
mod screen_worked;
mod segmenting;
mod sentences;
mod tables;
