//! Softening on unloading and reloading below the largest energy reached.

use super::tangent::{add, add_square, isochoric_tangent};
use super::{isochoric, volumetric_of};
use crate::decorator::{Call, Decoration, Memory, Tangent, decorate};
use crate::numeric::{add_scaled, erf_integral, plus};
use constitutive::{Capability, Energy, Law, Part, PointLaw, Response, Scalar};
use model::{Action, Card, Effect, Options, Piece, Scales, Screening, Sided, Site};
use params::{ParamSpec, Quantity, Transform};
use std::f64::consts::FRAC_2_SQRT_PI;
use std::sync::Arc;

const A: usize = 0;
const M: usize = 1;
const BETA: usize = 2;

static CARD: Card = Card {
    name: "mullins",
    site: Site::Bulk,
    rank: 20,
    summary: "Tissue that was stretched before is softer below the stretch it has seen: unloading \
              and reloading run under the first loading curve.",
    law: "P = P_vol + η P_iso,  η = 1 − a erf((Ψmax − Ψ)/(m + β Ψmax)),  Ψ = isochoric energy, \
          Ψmax = the largest so far;  a = 1/r of Ogden & Roxburgh",
    reference: "Ogden & Roxburgh 1999, Proc. R. Soc. A 455, doi:10.1098/rspa.1999.0431; β as in Abaqus",
    shows_in: &["unload", "reload", "cycle k"],
    look_alikes: &[],
    separated_by: "an unloading with reloading beyond the old maximum: the reloading curve rejoins the first one there",
    ordinary: "a = 0.2: reloading carries a fifth less",
    excludes: &[],
    // A second test of the same piece shows it without unloading segments, and so does the tissue
    // behind a tear.
    needs: &[],
    screening: Screening::Score(Sided::Positive),
    negative_control: false,
    breaks_half_height: false,
};

/// Pseudo-elastic softening after Ogden & Roxburgh.
#[derive(Clone, Copy, Debug, Default)]
pub struct Mullins;

/// Least share of Ψmax over which a search lets softening set in: one percent of the stretch. Less is a step of the stress
/// at each turn, which no record resolves and Newton's method crosses in many small steps, if at all.
const GRADUAL: f64 = 0.02;

fn own_parameters() -> Vec<ParamSpec> {
    use Quantity::{Dimensionless, EnergyDensity};
    vec![
        ParamSpec::new("a", "a", Dimensionless, (0.0, 0.95), 0.2, "largest loss of isochoric stress, 1/r")
            .neutral(0.0),
        ParamSpec::new(
            "m",
            "m",
            EnergyDensity,
            (1e-8, 1.0),
            1e-4,
            "energy distance over which softening sets in",
        ),
        ParamSpec::new(
            "beta",
            "β",
            Dimensionless,
            (GRADUAL, 5.0),
            0.2,
            "share of Ψmax in that distance; a file may give less, down to 0",
        )
        .admissible(0.0, 5.0)
        .transform(Transform::Identity),
    ]
}

impl Effect for Mullins {
    fn card(&self) -> &Card {
        &CARD
    }

    fn parameters(&self, _options: &Options) -> Vec<ParamSpec> {
        own_parameters()
    }

    fn asks(&self, _options: &Options) -> Vec<Capability> {
        vec![Capability::VolumetricSplit]
    }

    fn shapes(&self, scales: &Scales) -> Vec<Vec<f64>> {
        // Abrupt softening to one spread over the whole energy range, at a distance of its own or
        // in proportion to the energy reached.
        [(0.003, GRADUAL), (0.03, GRADUAL), (0.3, GRADUAL), (0.001, 0.2), (0.001, 1.0)]
            .map(|(share, beta)| vec![0.0, in_bounds(share * scales.energy), beta])
            .to_vec()
    }

    fn start(&self, scales: &Scales) -> Vec<f64> {
        vec![0.2, in_bounds(0.02 * scales.energy), 0.2]
    }

    fn act(&self, _options: &Options, _piece: &Piece) -> Action {
        Action::Bulk(Box::new(|inner| {
            let volumetric = volumetric_of(&inner);
            Arc::new(decorate(inner, Softening { volumetric }))
        }))
    }
}

fn in_bounds(m: f64) -> f64 {
    m.clamp(1e-8, 1.0)
}

struct Softening {
    volumetric: Option<Part>,
}

/// Width of the error function and η − 1.
fn reduction<S: Scalar>(own: &[S], psi: S, psi_max: S) -> (S, S) {
    let width = own[M] + own[BETA] * psi_max;
    (width, -(own[A] * ((psi_max - psi) / width).erf()))
}

/// −∫₀^Ψ (1 − η) dΨ at fixed Ψmax: what softening takes from the energy that comes back.
fn energy_change<S: Scalar>(own: &[S], psi: S, psi_max: S) -> S {
    let width = own[M] + own[BETA] * psi_max;
    let (whole, left) = (erf_integral(psi_max / width), erf_integral((psi_max - psi) / width));
    -(own[A] * width * (whole - left))
}

impl Decoration<9> for Softening {
    const NAME: &'static str = "mullins";

    fn parameters(&self) -> Vec<ParamSpec> {
        own_parameters()
    }

    fn history(&self) -> Vec<(String, f64)> {
        vec![("psi_max".into(), 0.0)]
    }

    fn respond<S: Scalar>(&self, call: &Call<'_, S, 9>, inner_new: &mut [S], new: &mut [S]) -> Response<S, 9>
    where
        dyn PointLaw<9>: Law<S, 9>,
    {
        let mut r = call.inner(inner_new);
        let iso = isochoric(self.volumetric.as_ref(), call.gradient, call.base, &r);
        // On the loading branch Ψmax is Ψ itself, so that η = 1 together with its derivatives.
        let psi_max = iso.energy.max_of(call.old[0]);
        new[0] = psi_max;
        let (_, change) = reduction(call.own, iso.energy, psi_max);
        add_scaled(&mut r.force, change, &iso.force);
        r.energy = plus(r.energy, energy_change(call.own, iso.energy, psi_max));
        r
    }

    /// Only over a law without memory: there P_iso is the gradient of Ψ.
    fn analytic_tangent(
        &self,
        call: &Call<'_, f64, 9>,
        inner_new: &mut [f64],
        new: &mut [f64],
    ) -> Option<Tangent<9>> {
        if !call.inner_old.is_empty() {
            return None;
        }
        let psi =
            isochoric(self.volumetric.as_ref(), call.gradient, call.base, &call.inner(inner_new)).energy;
        let mut sum = call.inner_tangent(call.gradient, call.base, inner_new)?;
        new[0] = psi.max_of(call.old[0]);
        if psi < new[0] {
            let iso = isochoric_tangent(self.volumetric.as_ref(), call.gradient, call.base, &sum);
            let (width, change) = reduction(call.own, psi, new[0]);
            let x = (new[0] - psi) / width;
            add(&mut sum, change, &iso);
            add_square(&mut sum.1, call.own[A] * FRAC_2_SQRT_PI * (-x * x).exp() / width, &iso.0);
        }
        Some(sum)
    }

    /// The largest energy grows with the energy, by its stress, or stays; over a law without memory, as above.
    fn history_tangent(&self, call: &Call<'_, f64, 9>, inner: Memory<'_, 9>, own: Memory<'_, 9>) -> bool {
        if !call.inner_old.is_empty() {
            return false;
        }
        let iso = isochoric(self.volumetric.as_ref(), call.gradient, call.base, &call.inner(inner.new));
        own.new[0] = iso.energy.max_of(call.old[0]);
        own.rows[0] = if iso.energy >= call.old[0] { iso.force } else { [0.0; 9] };
        true
    }

    /// Lost: a w ∫₀^(Ψmax/w) erf, a function of Ψmax alone.
    fn energies(&self, call: &Call<'_, f64, 9>, inner_new: &[f64], new: &[f64]) -> Energy {
        let inner = call.inner_energies(call.gradient, call.base, inner_new);
        let response = call.inner_probe(call.gradient, inner_new);
        let psi = isochoric(self.volumetric.as_ref(), call.gradient, call.base, &response).energy;
        Energy {
            stored: inner.stored + energy_change(call.own, psi, new[0]),
            dissipated: inner.dissipated - energy_change(call.own, new[0], new[0]),
        }
    }
}
