//! All tests of `campaign` from outside, in one program.

mod claims;
mod pooling;
