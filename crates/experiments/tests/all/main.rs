//! Experiments against the closed forms of their steady states.

mod biaxial;
mod biaxial_mesh;
mod biaxial_protocols;
mod common;
mod peel;
mod peel_180;
mod shear;
