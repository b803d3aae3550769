//! All tests of `diagnose` from outside, in one program: each of its own would be linked anew.

mod atlas_by_hand;
mod calibration;
mod discovering;
mod grouping;
mod noise_by_hand;
mod noise_level;
mod rules;
mod screen_by_hand;
mod segmenting;
mod sentences;
mod tables;
mod toy_ladder;
