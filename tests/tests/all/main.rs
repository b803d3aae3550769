//! All tests of `workspace-tests` from outside, in one program: each of its own would be linked anew.

mod config_to_model;
mod crate_graph;
mod documents;
mod every_law;
mod every_number;
mod licences;
mod words;
