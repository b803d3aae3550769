//! All tests of `workbench` from outside, in one program: each of its own would be linked anew.
#![allow(missing_docs)]

mod attacks;
mod crowd;
mod running;
mod work;
