//! Which of the base law's variants an effect decorates.

use constitutive::{Context, Law, PointLaw};
use hgo::{FibreInvariants, Hgo};
use model::Bulk;

/// The base law among its four variants, told by its answer: the fibre term must be taken off with
/// the same brackets and invariants it was put on with. The default where nothing matches.
pub fn base_law(inner: &Bulk) -> Hgo {
    let history: Vec<f64> = inner.history().iter().map(|h| h.initial).collect();
    let params: Vec<f64> = inner.parameters().iter().map(|p| p.neutral.unwrap_or(p.start)).collect();
    let answer = |law: &dyn PointLaw<9>, f: &[f64; 9]| {
        let old = if law.history().is_empty() { &[][..] } else { &history[..] };
        Law::<f64, 9>::respond(law, &Context::default(), f, &params, old, &mut old.to_vec()).force
    };
    // Shortened fibres with a change of volume: brackets and invariants both matter.
    let probes =
        [[1.1, 0.0, 0.0, 0.0, 0.8, 0.0, 0.0, 0.0, 1.2], [1.1, 0.0, 0.0, 0.0, 1.3, 0.0, 0.0, 0.0, 0.8]];
    let variants = [FibreInvariants::Isochoric, FibreInvariants::Full]
        .map(|fibre_invariants| [true, false].map(|tension_only| Hgo { tension_only, fibre_invariants }));
    variants
        .into_iter()
        .flatten()
        .find(|law| probes.iter().all(|f| answer(law, f) == answer(&**inner, f)))
        .unwrap_or_default()
}
