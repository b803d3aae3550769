//! Point laws with memory, written once over a scalar.
//!
//! A **point law** takes a gradient and the old history and gives the conjugate force, the stored
//! energy and the new history: bulk F → P (9 components, row-major), interface opening → traction
//! (3: normal, two tangential), load train force → elongation (1). A law is pure: parameters are
//! an argument, nothing is kept inside.
//!
//! Written over [`Scalar`], the same lines give equilibrium (`f64`), the tangent (`Jet<9>`,
//! `Jet<3>`) and exact derivatives with respect to parameters and through history (`Jet<8>`).
//! [`PointLaw`] is the object-safe closed list of those scalars, so that laws can be composed at
//! run time, from a file.

mod jet;
mod law;
mod offers;
mod part;
mod scalar;
pub mod spectral;
pub mod tensor;
pub mod testing;

pub use jet::Jet;
pub use law::{
    Context, Describe, Energy, HistorySpec, Law, PointLaw, Response, WIDTH, history_tangent_9,
    tangent_by_jets_1, tangent_by_jets_3, tangent_by_jets_9,
};
pub use offers::{BulkParts, Capability, Cohesion, FibreFamily, Offers, Part, StartGrid};
pub use part::{BulkPart, part, part_response, part_tangent};
pub use scalar::{Over, Scalar};
