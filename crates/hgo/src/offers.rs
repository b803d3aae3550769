//! What the law offers: its volumetric part, its two families, where a search may start.

use crate::fibre::{FAMILIES, fibre_fictitious_stress, fibre_response};
use crate::law::{D, FIBRE_ONSET, FibreInvariants, GAMMA, Hgo, K1, K2, KAPPA, MU, volumetric};
use crate::tangent::{fibre_tangent, volumetric_tangent};
use constitutive::{BulkPart, BulkParts, FibreFamily, Offers, Response, Scalar, StartGrid, part};

/// The volumetric part U = (1/D)((J² − 1)/2 − ln J) of a law whose parameter list has D at this index.
#[derive(Clone, Copy, Debug)]
pub struct Volumetric {
    /// Index of D.
    pub d: usize,
}

impl BulkPart for Volumetric {
    #[inline]
    fn respond<S: Scalar>(&self, gradient: &[S; 9], params: &[S]) -> Response<S, 9> {
        volumetric(gradient, params[self.d])
    }

    fn tangent(&self, gradient: &[f64; 9], params: &[f64]) -> Option<([f64; 9], [[f64; 9]; 9])> {
        Some(volumetric_tangent(gradient, params[self.d]))
    }
}

/// One family with the brackets and invariants of a law.
struct OneFamily {
    law: Hgo,
    family: usize,
}

impl BulkPart for OneFamily {
    #[inline]
    fn respond<S: Scalar>(&self, gradient: &[S; 9], params: &[S]) -> Response<S, 9> {
        fibre_response(&self.law, gradient, params, self.family)
    }

    fn tangent(&self, gradient: &[f64; 9], params: &[f64]) -> Option<([f64; 9], [[f64; 9]; 9])> {
        Some(fibre_tangent(&self.law, gradient, params, self.family))
    }
}

/// 2 ∂Ψ_f/∂C̄ of one family.
struct Fictitious(OneFamily);

impl BulkPart for Fictitious {
    #[inline]
    fn respond<S: Scalar>(&self, gradient: &[S; 9], params: &[S]) -> Response<S, 9> {
        let OneFamily { law, family } = &self.0;
        let [xx, yy, zz, xy, yz, xz] = fibre_fictitious_stress(law, gradient, params, *family);
        let energy = fibre_response(law, gradient, params, *family).energy;
        Response { force: [xx, xy, xz, xy, yy, yz, xz, yz, zz], energy }
    }
}

/// How far apart in γ the optima of one uniaxial curve are, rad.
const APART: f64 = 0.10;

impl Hgo {
    pub(crate) fn offered(self) -> Offers {
        let isochoric = Hgo { fibre_invariants: FibreInvariants::Isochoric, ..self };
        let family = |family: usize| FibreFamily {
            response: part(OneFamily { law: self, family }),
            fictitious: part(Fictitious(OneFamily { law: isochoric, family })),
            isochoric: part(OneFamily { law: isochoric, family }),
        };
        let mut template = vec![0.0; crate::PARAMETERS];
        template[D] = 1.0;
        let starts = StartGrid {
            template,
            axes: vec![(MU, 5), (K1, 3), (K2, 6), (GAMMA, 14), (KAPPA, 6)],
            scaled: vec![MU, K1],
            size: K1,
            apart: Some((GAMMA, APART)),
        };
        let bulk = BulkParts {
            volumetric: Some(part(Volumetric { d: D })),
            rest_is_isochoric: self.fibre_invariants == FibreInvariants::Isochoric,
            fibres: (0..FAMILIES).map(family).collect(),
            fibre_onset: Some(FIBRE_ONSET),
            matrix_modulus: |params| params[MU],
            starts: Some(starts),
            mirrors: true,
        };
        Offers { bulk: Some(bulk), cohesion: None }
    }
}
