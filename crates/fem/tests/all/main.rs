//! All tests of `fem` from outside, in one program: each of its own would be linked anew.

mod adventitia;
#[path = "common/bricks.rs"]
mod bricks;
mod closed_forms;
mod common;
mod convergence;
mod dcb;
mod element;
mod energy;
mod fill;
mod interface_element;
#[path = "common/laws.rs"]
mod laws;
mod locking;
mod manufactured;
mod path_following;
mod peers;
mod sensitivities;
mod shared_history;
mod symmetry;
