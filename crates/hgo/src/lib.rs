#![doc = include_str!("../README.md")]

mod fibre;
mod kinematics;
mod law;
mod offers;
pub mod published;
mod tangent;
pub mod uniaxial;

pub use fibre::{FAMILIES, fibre_direction, fibre_fictitious_stress, fibre_response, fibre_strain};
pub use law::{
    D, FIBRE_ONSET, FibreInvariants, GAMMA, Hgo, K1, K2, KAPPA, MU, PARAMETERS, bulk_modulus, compliance,
    d_of, fibre_onset, matrix_response, volumetric,
};
pub use offers::Volumetric;
pub use tangent::{fibre_tangent, volumetric_tangent};
