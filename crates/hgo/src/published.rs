//! Published parameter sets, in internal units and in the order of [`crate::Hgo`]'s parameters.

use crate::d_of;

/// Gasser, Ogden & Holzapfel (2006), J. R. Soc. Interface 3:15–35, 10.1098/rsif.2005.0073: iliac
/// adventitia. The matrix energy there is (c/2)(Ī1 − 3), so c is our μ, and C10 = c/2 in Abaqus.
pub mod gasser_ogden_holzapfel_2006 {
    /// c = μ, MPa.
    pub const MU: f64 = 7.64e-3;
    /// k1, MPa.
    pub const K1: f64 = 0.9966;
    /// k2.
    pub const K2: f64 = 524.6;
    /// γ, degrees from the circumferential direction.
    pub const GAMMA_DEGREES: f64 = 49.98;
    /// The three dispersions of its strip tests.
    pub const KAPPA: [f64; 3] = [0.0, 0.226, 1.0 / 3.0];
    /// Strip: length (along the load), width, thickness, mm. Its end faces stay plane and rigid.
    pub const STRIP: [f64; 3] = [10.0, 3.0, 0.5];
}

/// The 2006 adventitia with dispersion `kappa` and an initial bulk modulus of `bulk_modulus` MPa
/// (the source is incompressible).
pub fn adventitia_2006(kappa: f64, bulk_modulus: f64) -> [f64; crate::PARAMETERS] {
    use gasser_ogden_holzapfel_2006 as goh;
    [goh::MU, goh::K1, goh::K2, goh::GAMMA_DEGREES.to_radians(), kappa, d_of(bulk_modulus), 0.0]
}
