//! Quasi-linear relaxation by a power of time. (1 + t/τ)^(−α) = ∫ s^(α−1) e^(−s) e^(−s t/τ) ds / Γ(α) is a spectrum of exponentials,
//! summed by the trapezoidal rule in ln s.

use constitutive::{Energy, Law, Part, PointLaw, Response, Scalar, part_response, tensor};
use effects::decorator::{Call, Decoration};
use params::{ParamSpec, Quantity};
use statrs::function::gamma::gamma;

/// Exponentials of the spectrum.
const COUNT: usize = 20;

/// Distance of their rates in ln s; the fastest is e² / τ.
const STEP: f64 = 0.75;
const FASTEST: f64 = 2.0;

pub(super) fn parameters() -> Vec<ParamSpec> {
    use Quantity::{Dimensionless, Time};
    vec![
        ParamSpec::new("g", "g", Dimensionless, (0.0, 5.0), 0.2, "share of the stress that relaxes")
            .neutral(0.0),
        ParamSpec::new("tau", "τ", Time, (1e-3, 1e4), 1.0, "time at which the power begins"),
        ParamSpec::new("alpha", "α", Dimensionless, (0.05, 1.0), 0.3, "power"),
    ]
}

/// Shares and rates (1/s) of the exponentials; the slowest has what the sum leaves of 1.
fn spectrum(tau: f64, alpha: f64) -> [(f64, f64); COUNT] {
    let mut all = [(0.0, 0.0); COUNT];
    let mut left = 1.0;
    for (k, (share, rate)) in all.iter_mut().enumerate() {
        let x = FASTEST - STEP * k as f64;
        *share = STEP * (alpha * x - x.exp()).exp() / gamma(alpha);
        *rate = x.exp() / tau;
        left -= *share;
    }
    all[COUNT - 1].0 += left;
    all
}

/// History: the stress of each exponential, then the stress that they follow, nine components each.
pub(super) struct Memory {
    pub volumetric: Option<Part>,
}

type Tensor<S> = [S; 9];

/// A − ⅓ (A : C) C⁻¹.
fn deviator<S: Scalar>(a: &Tensor<S>, c: &Tensor<S>, c_inverse: &Tensor<S>) -> Tensor<S> {
    let third = tensor::dot(a, c) / 3.0;
    std::array::from_fn(|i| a[i] - third * c_inverse[i])
}

impl Decoration<9> for Memory {
    const NAME: &'static str = "foreign_relaxation";

    fn parameters(&self) -> Vec<ParamSpec> {
        parameters()
    }

    fn history(&self) -> Vec<(String, f64)> {
        (0..=COUNT).flat_map(|b| (0..9).map(move |i| (format!("s{b}_{i}"), 0.0))).collect()
    }

    fn rate_dependent(&self) -> bool {
        true
    }

    /// Exact for a stress that is linear in time within the step. The spectrum has no derivative by τ and α: nobody fits them.
    fn respond<S: Scalar>(&self, call: &Call<'_, S, 9>, inner_new: &mut [S], new: &mut [S]) -> Response<S, 9>
    where
        dyn PointLaw<9>: Law<S, 9>,
    {
        let mut r = call.inner(inner_new);
        let f = call.gradient;
        let volume = self.volumetric.as_ref().map(|p| part_response(p, f, call.base).force);
        let isochoric: Tensor<S> =
            std::array::from_fn(|i| r.force[i] - volume.as_ref().map_or(S::zero(), |v| v[i]));
        let (c, root) = (tensor::right_cauchy_green(f), tensor::det(f).cbrt());
        let c_inverse = tensor::inverse(&c);
        let m = root.square().recip();
        let second = tensor::mul(&tensor::inverse(f), &isochoric);
        let followed = deviator(&second, &c, &c_inverse).map(|x| x / m);
        let mut sum = [S::zero(); 9];
        for (b, (share, rate)) in spectrum(call.own[1].value(), call.own[2].value()).into_iter().enumerate() {
            let x = rate * call.ctx.dt;
            let (left, taken) = ((-x).exp(), if x > 1e-9 { -(-x).exp_m1() / x } else { 1.0 - 0.5 * x });
            for i in 0..9 {
                let change = followed[i] - call.old[9 * COUNT + i];
                new[9 * b + i] = call.old[9 * b + i] * left + change * taken;
                sum[i] += new[9 * b + i] * share;
            }
        }
        new[9 * COUNT..9 * (COUNT + 1)].copy_from_slice(&followed);
        let added = tensor::mul(f, &deviator(&sum, &c, &c_inverse));
        for (to, a) in r.force.iter_mut().zip(added) {
            *to += a * m * call.own[0];
        }
        r
    }

    fn energies(&self, call: &Call<'_, f64, 9>, inner_new: &[f64], _new: &[f64]) -> Energy {
        call.inner_energies(call.gradient, call.base, inner_new)
    }
}

#[cfg(test)]
mod tests {
    use super::spectrum;

    #[test]
    fn the_spectrum_is_the_power_of_time() {
        for (tau, alpha) in [(0.5, 0.2), (1.0, 0.3), (2.0, 0.4)] {
            let all = spectrum(tau, alpha);
            for t in [0.0, 0.3, 1.0, 10.0, 100.0, 300.0] {
                let sum: f64 = all.iter().map(|(share, rate)| share * (-rate * t).exp()).sum();
                let power = (1.0 + t / tau).powf(-alpha);
                assert!((sum - power).abs() < 0.02, "τ {tau}, α {alpha}, t {t}: {sum} for {power}");
            }
        }
    }
}
