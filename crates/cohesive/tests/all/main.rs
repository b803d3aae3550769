//! All tests of `cohesive` from outside, in one program: each of its own would be linked anew.

mod common;
mod consistency;
mod own_curve;
mod work;
