//! All tests of `inverse` from outside, in one program: each of its own would be linked anew.

mod asymmetric;
mod averages;
mod coverage;
mod fitting;
mod jumps;
mod large_misfit;
mod line;
mod mapped;
mod search_worked;
mod starts_and_words;
mod toys;
mod uncertainty_worked;
