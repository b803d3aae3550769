//! All tests of `mesh` from outside, in one program: each of its own would be linked anew.

mod ordering;
mod random;
mod shapes;
mod strip;
