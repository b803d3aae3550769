//! Stress that relaxes: Maxwell branches on the isochoric stress, or on the fibres alone.

mod maxwell;

use super::base::base_law;
use crate::decorator::decorate;
use crate::settings::{choice, integer, spread, word};
use hgo::{FibreInvariants, Hgo};
use input::{OptionKind, OptionSpec, OptionValue};
use maxwell::Maxwell;
use model::{Action, Card, Effect, Options, Piece, Scales, Screening, Sided, Site};
use params::{ParamSpec, Quantity};
use std::sync::Arc;

const TAU_BOUNDS: (f64, f64) = (1e-2, 1e5);
const MOST_BRANCHES: i64 = 4;

static CARD: Card = Card {
    name: "viscoelastic",
    site: Site::Bulk,
    rank: 30,
    summary: "Stress relaxes while the tissue is held and rises with the rate of stretching. The \
              base parameters are the long-term (slow) response.",
    law: "S = S_inner + J^(−2/3) Dev ΣH_i,  Ḣ_i + H_i/τ_i = g_i d(J^(2/3) S_iso)/dt,  \
          S_iso = 2nd Piola stress of the inner law at J^(−1/3) F,  Dev A = A − ⅓ (A : C) C⁻¹;  \
          relaxing = \"fibres\": driven by 2 ∂Ψ_fibres/∂C̄ instead",
    reference: "Simo 1987, Comput. Methods Appl. Mech. Eng. 60, doi:10.1016/0045-7825(87)90107-1; \
                Holzapfel & Gasser 2001, Comput. Methods Appl. Mech. Eng. 190",
    shows_in: &["hold", "rate change", "unload", "reload"],
    look_alikes: &["lag"],
    separated_by: "a hold of several τ at constant displacement: a late sensor settles within its delay, tissue relaxes on",
    excludes: &[],
    // Loops of unloading show it without a pause, but not well.
    needs: &["pause or two rates"],
    screening: Screening::Score(Sided::Positive),
    negative_control: false,
    breaks_half_height: false,
};

/// One to four Maxwell branches on the isochoric stress.
#[derive(Clone, Copy, Debug, Default)]
pub struct Viscoelastic;

/// What the option `relaxing` may say.
const ALL: &str = "all";
const FIBRES: &str = "fibres";

fn branches(options: &Options) -> usize {
    integer(options, "branches", 1).clamp(1, MOST_BRANCHES) as usize
}

fn settings(branches: i64, relaxing: &str) -> Options {
    Options::from([
        ("branches".to_owned(), OptionValue::Integer(branches)),
        ("relaxing".to_owned(), OptionValue::Text(relaxing.to_owned())),
    ])
}

fn own_parameters(branches: usize) -> Vec<ParamSpec> {
    let tau = |start| {
        ParamSpec::new("tau", "τ", Quantity::Time, TAU_BOUNDS, start, "relaxation time of the branch")
    };
    let g = || {
        ParamSpec::new(
            "g",
            "g",
            Quantity::Dimensionless,
            (0.0, 5.0),
            0.2,
            "instantaneous over long-term stress, less one",
        )
        .neutral(0.0)
    };
    (0..branches)
        .flat_map(|b| {
            let mut pair = [g(), tau(10f64.powi(b as i32 + 1))];
            if b > 0 {
                for p in &mut pair {
                    p.name = format!("{}{}", p.name, b + 1).into();
                    p.symbol = format!("{}{}", p.symbol, ['₂', '₃', '₄'][b - 1]).into();
                }
            }
            pair
        })
        .collect()
}

impl Effect for Viscoelastic {
    fn card(&self) -> &Card {
        &CARD
    }

    fn parameters(&self, options: &Options) -> Vec<ParamSpec> {
        own_parameters(branches(options))
    }

    fn options(&self) -> Vec<OptionSpec> {
        vec![
            OptionSpec {
                name: "branches".into(),
                kind: OptionKind::Integer { min: 1, max: MOST_BRANCHES },
                default: Some(OptionValue::Integer(1)),
                description: "number of relaxation branches; the second is g2, tau2, and so on".into(),
            },
            choice("relaxing", &[ALL, FIBRES], "the whole isochoric stress relaxes, or the fibres' alone"),
        ]
    }

    /// The fibres alone, whose stress no matrix tempers; or two branches a decade apart around the
    /// one that was found: tissue hardly relaxes with one time.
    fn richer(&self, options: &Options, values: &[f64]) -> Vec<(Options, Vec<f64>)> {
        let relaxing = word(options, "relaxing", ALL);
        let mut forms = Vec::new();
        if relaxing == ALL {
            forms.push((settings(branches(options) as i64, FIBRES), values.to_vec()));
        }
        if let [g, tau] = *values {
            let within = |tau: f64| tau.clamp(TAU_BOUNDS.0, TAU_BOUNDS.1);
            forms.push((settings(2, relaxing), vec![0.5 * g, within(tau / 3.0), 0.5 * g, within(3.0 * tau)]));
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
        let branches = branches(options);
        let fibres_alone = word(options, "relaxing", ALL) == FIBRES;
        Action::Bulk(Box::new(move |inner| {
            let base = base_law(&inner);
            let isochoric = Hgo { fibre_invariants: FibreInvariants::Isochoric, ..base };
            let fibres = fibres_alone.then_some(isochoric);
            let volume_matters = !fibres_alone && base.fibre_invariants == FibreInvariants::Full;
            Arc::new(decorate(inner, Maxwell { branches, fibres, volume_matters }))
        }))
    }
}
