//! Strength and fracture energy that vary along the tear beyond the given areas.

use crate::decorator::{Call, Decoration, Tangent, decorate, with_changed};
use crate::settings::{choice, word};
use cohesive::{GC, SIGMA_C};
use constitutive::{Context, Energy, Law, PointLaw, Response, Scalar};
use input::OptionSpec;
use model::{Action, Card, Effect, Options, Piece, Scales, Screening, Sided, Site};
use params::{ParamSpec, Quantity};
use std::f64::consts::TAU;
use std::sync::Arc;

const A: usize = 0;
const SHARE: usize = 1;

static CARD: Card = Card {
    name: "heterogeneity",
    site: Site::Interface,
    rank: 90,
    summary: "Strength and fracture energy change along the tear path beyond the areas the model \
              was given: the cap is not the same tissue everywhere.",
    law: "σc(s) → σc (1 + a ξ(s)),  Gc(s) → Gc (1 + a r ξ(s)),  s = place along the path (0 at the cut, 1 at the far edge), \
          ξ = 2s − 1 (field = \"linear\") or ξ = −cos 2πs (field = \"bump\")",
    reference: "the paper's table 2: strengths of one specimen's areas differ several times over",
    shows_in: &["onset", "peak", "plateau", "tail"],
    look_alikes: &["bridging", "thickness_taper", "rate_dependent_strength"],
    separated_by: "a camera on the tear (tear_front_mm), and more areas in the model",
    ordinary: "a = 20 %: strength along the path varies by a fifth",
    excludes: &[],
    needs: &["tearing"],
    screening: Screening::Score(Sided::Both),
    negative_control: false,
    breaks_half_height: false,
};

/// A field of strength and fracture energy along the path.
#[derive(Clone, Copy, Debug, Default)]
pub struct Heterogeneity;

fn own_parameters() -> Vec<ParamSpec> {
    use Quantity::Dimensionless;
    vec![
        ParamSpec::new(
            "a",
            "a",
            Dimensionless,
            (-0.9, 0.9),
            0.2,
            "relative change of strength along the path",
        )
        .neutral(0.0),
        // One amplitude for both is the simplest reading: δc stays the same along the path.
        ParamSpec::new("gc_share", "r", Dimensionless, (-1.0, 1.0), 1.0, "change of Gc over change of σc")
            .fixed(),
    ]
}

impl Effect for Heterogeneity {
    fn card(&self) -> &Card {
        &CARD
    }

    fn parameters(&self, _options: &Options) -> Vec<ParamSpec> {
        own_parameters()
    }

    fn options(&self) -> Vec<OptionSpec> {
        vec![choice("field", &["linear", "bump"], "shape of the field along the path")]
    }

    fn shapes(&self, _scales: &Scales) -> Vec<Vec<f64>> {
        vec![vec![0.0, 1.0], vec![0.0, 0.0]]
    }

    fn start(&self, _scales: &Scales) -> Vec<f64> {
        vec![0.2, 1.0]
    }

    fn act(&self, options: &Options, _piece: &Piece) -> Action {
        let bump = word(options, "field", "linear") == "bump";
        Action::Interface(Box::new(move |inner| Arc::new(decorate(inner, Field { bump }))))
    }
}

/// The outermost decorator of the tear path: everything inside sees the strength of its place.
struct Field {
    bump: bool,
}

impl Field {
    /// ξ(s), between −1 and 1.
    fn at(&self, ctx: &Context) -> f64 {
        let s = ctx.path_position.clamp(0.0, 1.0);
        if self.bump { -(TAU * s).cos() } else { 2.0 * s - 1.0 }
    }

    fn shifted<S: Scalar, R>(&self, call: &Call<'_, S, 3>, f: impl FnOnce(&[S]) -> R) -> R {
        let xi = self.at(call.ctx);
        let change = call.own[A] * xi;
        let alter = |p: &mut [S]| {
            p[SIGMA_C] = p[SIGMA_C] * (change + 1.0);
            p[GC] = p[GC] * (change * call.own[SHARE] + 1.0);
        };
        with_changed(call.base, alter, f)
    }
}

impl Decoration<3> for Field {
    const NAME: &'static str = "heterogeneity";

    fn parameters(&self) -> Vec<ParamSpec> {
        own_parameters()
    }

    fn respond<S: Scalar>(&self, call: &Call<'_, S, 3>, inner_new: &mut [S], _new: &mut [S]) -> Response<S, 3>
    where
        dyn PointLaw<3>: Law<S, 3>,
    {
        self.shifted(call, |p| call.inner_at(call.gradient, p, inner_new))
    }

    fn energies(&self, call: &Call<'_, f64, 3>, inner_new: &[f64], _new: &[f64]) -> Energy {
        self.shifted(call, |p| call.inner_energies(call.gradient, p, inner_new))
    }

    fn analytic_tangent(
        &self,
        call: &Call<'_, f64, 3>,
        inner_new: &mut [f64],
        _new: &mut [f64],
    ) -> Option<Tangent<3>> {
        self.shifted(call, |p| call.inner_tangent(call.gradient, p, inner_new))
    }
}
