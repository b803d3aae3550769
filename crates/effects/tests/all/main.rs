//! All tests of `effects` from outside, in one program: each of its own would be linked anew.

mod battery;
mod composing;
mod decorators;
mod other_laws;
mod physics;
mod rig_and_cards;
mod tangents;
