//! The paper's law; crate `cohesive` has it.

use crate::entry::{LawCard, LawEntry, Settings};
use constitutive::PointLaw;
use std::sync::Arc;

static CARD: LawCard = LawCard {
    name: "exponential",
    summary: "Traction rises to σc at δc and dies out exponentially: bridging collagen that fails one fibre after \
              another.",
    equation: "t = e σc (δ/δc) exp(−δ/δc),  δc = Gc/(e σc);  secant unloading below δmax",
    reference: "Ortiz & Pandolfi 1999, Int. J. Numer. Methods Eng. 44, 1267–1282, \
                doi:10.1002/(SICI)1097-0207(19990330)44:9<1267::AID-NME486>3.0.CO;2-7",
};

/// The irreversible exponential law.
#[derive(Clone, Copy, Debug, Default)]
pub struct Exponential;

impl LawEntry<3> for Exponential {
    fn card(&self) -> &LawCard {
        &CARD
    }

    fn law(&self, _settings: &Settings) -> Arc<dyn PointLaw<3>> {
        Arc::new(cohesive::Cohesive)
    }
}
