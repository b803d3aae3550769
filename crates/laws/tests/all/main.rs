//! All tests of `laws` from outside, in one program: each of its own would be linked anew.

mod bulk_laws;
mod interface_laws;
