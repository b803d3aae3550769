//! All tests of `hgo` from outside, in one program: each of its own would be linked anew.

mod closed_form;
mod common;
mod consistency;
mod fibres;
mod parts;
