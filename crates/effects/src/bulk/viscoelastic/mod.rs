//! Stress that relaxes: Maxwell branches or a continuous spectrum, on the isochoric stress or on the fibres alone.

mod driving;
mod maxwell;
mod times;
mod weights;

use super::{fibres_of, volumetric_of};
use crate::decorator::decorate;
use crate::settings::{choice, integer, spread, word};
use constitutive::Capability;
use input::{OptionKind, OptionSpec, OptionValue};
use maxwell::Maxwell;
use model::{Action, Card, Effect, Options, Piece, Scales, Screening, Sided, Site};
use params::ParamSpec;
use std::sync::Arc;
use times::{TAU_BOUNDS, Times};

const MOST_BRANCHES: i64 = 4;

static CARD: Card = Card {
    name: "viscoelastic",
    site: Site::Bulk,
    rank: 30,
    summary: "Stress relaxes while the tissue is held and rises with the rate of stretching. The \
              base parameters are the long-term (slow) response.",
    law: "S = S_inner + J^(−2/3) Dev ΣH_i,  Ḣ_i + H_i/τ_i = g_i d(J^(2/3) S_iso)/dt,  \
          S_iso = 2nd Piola stress of the inner law at J^(−1/3) F,  Dev A = A − ⅓ (A : C) C⁻¹;  \
          relaxing = \"fibres\": driven by 2 ∂Ψ_fibres/∂C̄ instead;  relaxation = \"spectrum\": g_i e^(−t/τ_i) become \
          C [E1(t/τ2) − E1(t/τ1)], within 1e-3 of C ln(τ2/τ1) over four decades",
    reference: "Simo 1987, Comput. Methods Appl. Mech. Eng. 60, doi:10.1016/0045-7825(87)90107-1; \
                Holzapfel & Gasser 2001, Comput. Methods Appl. Mech. Eng. 190; spectrum: Fung 1993, Biomechanics; Puso & Weiss 1998, \
                J. Biomech. Eng. 120",
    shows_in: &["hold", "rate change", "unload", "reload"],
    look_alikes: &["lag"],
    separated_by: "a hold of several τ at constant displacement: a late sensor settles within its delay, tissue relaxes on",
    ordinary: "g = 0.2: a fifth of the long-term stress relaxes",
    excludes: &[],
    // Loops of unloading show it without a pause, but not well.
    needs: &["pause or two rates"],
    screening: Screening::Score(Sided::Positive),
    negative_control: false,
    breaks_half_height: false,
};

/// One to four Maxwell branches on the isochoric stress, or a continuous spectrum.
#[derive(Clone, Copy, Debug, Default)]
pub struct Viscoelastic;

/// What the option `relaxing` may say.
const ALL: &str = "all";
const FIBRES: &str = "fibres";

/// What the option `relaxation` may say.
const BRANCHES: &str = "branches";
const SPECTRUM: &str = "spectrum";

fn times(options: &Options) -> Times {
    if word(options, "relaxation", BRANCHES) == SPECTRUM {
        return Times::Spectrum;
    }
    Times::Branches(integer(options, "branches", 1).clamp(1, MOST_BRANCHES) as usize)
}

fn settings(branches: i64, relaxing: &str) -> Options {
    Options::from([
        ("branches".to_owned(), OptionValue::Integer(branches)),
        ("relaxing".to_owned(), OptionValue::Text(relaxing.to_owned())),
    ])
}

impl Effect for Viscoelastic {
    fn card(&self) -> &Card {
        &CARD
    }

    fn parameters(&self, options: &Options) -> Vec<ParamSpec> {
        times(options).parameters()
    }

    fn options(&self) -> Vec<OptionSpec> {
        vec![
            OptionSpec {
                name: "branches".into(),
                kind: OptionKind::Integer { min: 1, max: MOST_BRANCHES },
                default: Some(OptionValue::Integer(1)),
                description: "number of relaxation branches; the second is g2, tau2, and so on".into(),
            },
            choice(
                "relaxation",
                &[BRANCHES, SPECTRUM],
                "branches with a time each, or a continuous spectrum between tau1 and tau2 (`branches` has no meaning then)",
            ),
            choice("relaxing", &[ALL, FIBRES], "the whole isochoric stress relaxes, or the fibres' alone"),
        ]
    }

    fn asks(&self, options: &Options) -> Vec<Capability> {
        let fibres = word(options, "relaxing", ALL) == FIBRES;
        vec![if fibres { Capability::Fibres } else { Capability::VolumetricSplit }]
    }

    /// The fibres alone, whose stress no matrix tempers; or two branches a decade apart around the
    /// one that was found: tissue hardly relaxes with one time; or a spectrum of two decades around it.
    fn richer(&self, options: &Options, values: &[f64]) -> Vec<(Options, Vec<f64>)> {
        let relaxing = word(options, "relaxing", ALL);
        let mut forms = Vec::new();
        let Times::Branches(branches) = times(options) else { return forms };
        if relaxing == ALL {
            forms.push((settings(branches as i64, FIBRES), values.to_vec()));
        }
        if let [g, tau] = *values {
            let within = |tau: f64| tau.clamp(TAU_BOUNDS.0, TAU_BOUNDS.1);
            forms.push((settings(2, relaxing), vec![0.5 * g, within(tau / 3.0), 0.5 * g, within(3.0 * tau)]));
            let mut spectrum = settings(1, relaxing);
            spectrum.insert("relaxation".to_owned(), OptionValue::Text(SPECTRUM.to_owned()));
            let (short, long) = (within(0.1 * tau), within(10.0 * tau));
            forms.push((spectrum, vec![(g / (long / short).ln()).min(2.0), short, long]));
        }
        forms
    }

    fn shapes(&self, scales: &Scales) -> Vec<Vec<f64>> {
        // What a record can tell lies between two samples and the whole test.
        let low = (2.0 * scales.sampling).max(scales.duration / 300.0);
        spread(low, scales.duration, 6)
            .into_iter()
            .map(|tau| vec![0.0, tau.clamp(TAU_BOUNDS.0, TAU_BOUNDS.1)])
            .collect()
    }

    fn start(&self, scales: &Scales) -> Vec<f64> {
        vec![0.2, (scales.duration / 15.0).clamp(TAU_BOUNDS.0, TAU_BOUNDS.1)]
    }

    fn act(&self, options: &Options, _piece: &Piece) -> Action {
        let times = times(options);
        let fibres_alone = word(options, "relaxing", ALL) == FIBRES;
        Action::Bulk(Box::new(move |inner| {
            let parts = inner.offers().bulk;
            let maxwell = Maxwell {
                times,
                fibres: fibres_alone.then(|| fibres_of(&inner)),
                volume_matters: !fibres_alone && parts.as_ref().is_some_and(|p| !p.rest_is_isochoric),
                matrix_modulus: parts.map_or(|_| 0.0, |p| p.matrix_modulus),
                volumetric: volumetric_of(&inner),
            };
            Arc::new(decorate(inner, maxwell))
        }))
    }
}
