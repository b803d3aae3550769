//! All tests of `inverse` from outside, in one program: each of its own would be linked anew.

mod arms;
mod averages;
mod coverage;
mod fitting;
mod line;
mod mapped;
mod search_by_hand;
mod starts_and_words;
mod toys;
mod uncertainty_by_hand;
