//! All tests of `analysis` from outside, in one program: each of its own would be linked anew.

mod camera_front;
mod carried;
mod columns;
mod condensing;
mod doctor;
mod foreseen;
mod interrupted;
mod intervals;
mod neutral;
mod recovered;
mod sampling;
mod small;
mod standing;
