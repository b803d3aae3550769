//! All tests of `input` from outside, in one program: each of its own would be linked anew.

mod common;
mod editing;
mod messages;
mod reading;
mod robust;
