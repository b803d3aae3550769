//! All tests of `analysis` from outside, in one program: each of its own would be linked anew.

mod camera_front;
mod columns;
mod condensing;
mod doctor;
mod foreseen;
mod history_carry_over;
mod interrupted;
mod intervals;
mod load_steps;
mod neutral;
mod promised;
mod rate_dependent_holds;
mod recovered;
mod sampling;
mod small;
mod torn_end;
mod wrong_starts;
