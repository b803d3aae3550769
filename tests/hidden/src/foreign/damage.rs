//! Damage by the norm of the energy: Simo 1987, doi:10.1016/0045-7825(87)90107-1, with another law of growth.

use constitutive::{Energy, Law, Part, PointLaw, Response, Scalar, part_response};
use effects::decorator::{Call, Decoration};
use params::{ParamSpec, Quantity};

pub(super) fn parameters() -> Vec<ParamSpec> {
    use Quantity::Dimensionless;
    let norm = |name: &'static str, about: &'static str| {
        ParamSpec::new(name, name, Dimensionless, (0.0, 10.0), 0.05, about)
    };
    vec![
        ParamSpec::new("a", "a", Dimensionless, (0.0, 0.95), 0.2, "largest share of isochoric stress lost")
            .neutral(0.0),
        norm("xi0", "norm √(2Ψ) at which damage begins, √MPa"),
        norm("half", "norm beyond it at which half of it is done, √MPa"),
    ]
}

/// History: the largest energy of the undamaged law.
pub(super) struct Loss {
    pub volumetric: Option<Part>,
}

/// 1 − D.
fn kept<S: Scalar>(own: &[S], psi_max: S) -> S {
    // The floor keeps the root's slope finite in virgin tissue.
    let beyond = ((psi_max * 2.0).max_of(S::from(1e-14)).sqrt() - own[1]).positive_part();
    let square = beyond.square();
    -(own[0] * square / (square + own[2].square())) + 1.0
}

impl Decoration<9> for Loss {
    const NAME: &'static str = "foreign_damage";

    fn parameters(&self) -> Vec<ParamSpec> {
        parameters()
    }

    fn history(&self) -> Vec<(String, f64)> {
        vec![("psi_max".into(), 0.0)]
    }

    fn respond<S: Scalar>(&self, call: &Call<'_, S, 9>, inner_new: &mut [S], new: &mut [S]) -> Response<S, 9>
    where
        dyn PointLaw<9>: Law<S, 9>,
    {
        let whole = call.inner(inner_new);
        let volume = self.volumetric.as_ref().map(|p| part_response(p, call.gradient, call.base));
        let of_volume = |i: usize| volume.as_ref().map_or(S::zero(), |v| v.force[i]);
        let energy_of_volume = volume.as_ref().map_or(S::zero(), |v| v.energy);
        let psi = whole.energy - energy_of_volume;
        new[0] = psi.max_of(call.old[0]);
        let kept = kept(call.own, new[0]);
        Response {
            force: std::array::from_fn(|i| of_volume(i) + kept * (whole.force[i] - of_volume(i))),
            energy: energy_of_volume + kept * psi,
        }
    }

    fn energies(&self, call: &Call<'_, f64, 9>, inner_new: &[f64], _new: &[f64]) -> Energy {
        call.inner_energies(call.gradient, call.base, inner_new)
    }
}

#[cfg(test)]
mod tests {
    use super::kept;

    #[test]
    fn half_of_the_damage_is_done_at_half() {
        let own = [0.4, 0.1, 0.2];
        assert_eq!(kept(&own, 0.0), 1.0);
        assert_eq!(kept(&own, 0.5 * 0.1 * 0.1), 1.0);
        assert!((kept(&own, 0.5 * 0.3 * 0.3) - 0.8).abs() < 1e-12);
    }
}
