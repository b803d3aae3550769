//! Evidence against closed forms, dense matrices and brute-force quadrature.

use crate::toys;

use evidence::special::{ln_half_line, ln_sum_exp};
use evidence::{Belief, Evidence, Kernel, Record, RestForm, RestPrior, RestSize, View};
use inverse::NoiseModel;
use nalgebra::{DMatrix, DVector};
use toys::*;

const N: usize = 24;
const PEAK: f64 = 3.0;

fn two_normal() -> Vec<evidence::Parameter> {
    vec![parameter("a", Belief::normal(0.01, 0.2), false), parameter("b", Belief::normal(-0.02, 0.1), true)]
}

/// Covariance of a linear model's prediction and the mean misfit, from the beliefs.
fn prior_part(kinds: &[usize], parameters: &[evidence::Parameter]) -> (DMatrix<f64>, DVector<f64>) {
    let (mut c, mut mean) = (DMatrix::zeros(N, N), DVector::zeros(N));
    for (&k, p) in kinds.iter().zip(parameters) {
        let h = column(k, N, PEAK);
        c += &h * h.transpose() * p.belief.sd.powi(2);
        mean += h * p.belief.mean;
    }
    (c, mean)
}

#[test]
fn without_a_rest_it_is_the_linear_gaussian_closed_form() {
    for ar1 in [0.0, 0.5] {
        let r = misfit(N, 0.04, 1);
        let record = record(&data(&r, NoiseModel::ar1(0.04, ar1)), PEAK);
        let model = linear(r.clone(), &[0, 2], two_normal(), PEAK);
        let got = Evidence::of(&record, &model, &no_rest(), Kernel::Plain).expect("evidence");
        let (c, mean) = prior_part(&[0, 2], &model.parameters);
        let want = ln_normal(&(r - mean), &(c + dense_noise(N, 0.04, ar1)));
        assert!((got.ln_z - want).abs() < 1e-9, "{} {want}", got.ln_z);
    }
}

/// ∫ over τ, υ on a fine grid of the dense closed form, for a complete model's rest and for one with a cause outside.
fn brute(r: &DVector<f64>, prior: &RestPrior, c: &DMatrix<f64>, sd: f64) -> [f64; 2] {
    let s = line(N);
    let unit = |smooth: bool, length: f64, form: RestForm| {
        let size = if smooth {
            RestSize { tau: 1.0, smooth_length: length, form, ..RestSize::NONE }
        } else {
            RestSize { upsilon: 1.0, jerk_length: length, form, ..RestSize::NONE }
        };
        dense_rest(&s, &size) * PEAK.powi(2)
    };
    let half = |x: f64, scale: f64| {
        0.5 * 2.0 / (scale * std::f64::consts::TAU.sqrt()) * (-0.5 * (x / scale).powi(2)).exp()
    };
    let outside = |x: f64, scale: f64| {
        let z = (x / (4.0 * scale)).ln() / 0.8;
        (-0.5 * z * z).exp() / (x * 0.8 * std::f64::consts::TAU.sqrt())
    };
    let step = 0.1;
    let sizes: Vec<f64> = (0..124).map(|i| (-12.0 + step * f64::from(i)).exp()).collect();
    let noise = dense_noise(N, sd, 0.0);
    let (mut own, mut other) = (Vec::new(), Vec::new());
    let density = |tau: f64, upsilon: f64| {
        let part = |x: f64, scale: f64| {
            if x > 0.0 { (x * step * half(x, scale), x * step * outside(x, scale)) } else { (0.5, 0.0) }
        };
        let ((t, far_t), (u, far_u)) = (part(tau, prior.smooth), part(upsilon, prior.jerk));
        (t * u, 0.5 * (far_t * u + t * far_u))
    };
    let with_zero: Vec<f64> = std::iter::once(0.0).chain(sizes).collect();
    let even = 1.0 - prior.proportional - prior.per_leg;
    let forms = [
        (RestForm::Even, even),
        (RestForm::Proportional, prior.proportional),
        (RestForm::PerLeg, prior.per_leg),
    ];
    let forms = forms.into_iter().filter(|f| f.1 > 0.0);
    let shapes = forms.flat_map(|f| prior.smooth_lengths.iter().map(move |l| (f, *l)));
    for ((form, m1), (length, m2)) in shapes {
        let (smooth, mass) = (unit(true, length, form), m1 * m2);
        let jerk = unit(false, prior.jerk_lengths[0].0, form);
        for &tau in &with_zero {
            for &upsilon in &with_zero {
                let (d, e) = density(tau, upsilon);
                if d.max(e) < 1e-9 {
                    continue;
                }
                let total = c + &noise + &smooth * tau.powi(2) + &jerk * upsilon.powi(2);
                let z = ln_normal(r, &total) + mass.ln();
                own.push(z + d.ln());
                other.push(z + e.ln());
            }
        }
    }
    [ln_sum_exp(own), ln_sum_exp(other)]
}

#[test]
fn with_a_rest_it_is_the_brute_force_integral() {
    let waves = [0.0, 0.05, 0.4].into_iter().enumerate();
    let forms = [[0.0, 0.0], [0.5, 0.25], [1.0, 0.0], [0.0, 1.0]];
    for ((k, wave), [proportional, per_leg]) in waves.flat_map(|w| forms.map(|f| (w, f))) {
        let prior = RestPrior { proportional, per_leg, ..RestPrior::default() };
        let r = misfit(N, 0.03, k as u64) + column(3, N, wave) - column(5, N, 0.5 * wave);
        let record = pulled(&r, NoiseModel::white(0.03), PEAK);
        let model = linear(r.clone(), &[0, 1], two_normal(), PEAK);
        let got = Evidence::of(&record, &model, &prior, Kernel::Plain).expect("evidence");
        let (c, mean) = prior_part(&[0, 1], &model.parameters);
        let [own, other] = brute(&(r - mean), &prior, &c, 0.03);
        // Where a cause outside is believed e¹² times sooner, the sizes are laid for that one alone.
        let counts = own > other - 12.0;
        assert!(
            !counts || (got.ln_z - own).abs() < 0.02,
            "{wave} {proportional} {per_leg}: {} {own}",
            got.ln_z
        );
        assert!((got.ln_z_else - other).abs() < 0.05, "{wave}: {} {other}", got.ln_z_else);
    }
}

#[test]
fn signed_amplitudes_are_integrated_over_their_side() {
    for (seed, sd) in [(1, 0.02), (2, 0.3), (3, 3.0)] {
        let r = misfit(N, 0.04, seed);
        let record = record(&data(&r, NoiseModel::white(0.04)), PEAK);
        let noise = dense_noise(N, 0.04, 0.0);
        let h = column(3, N, PEAK);
        for belief in
            [Belief::above(0.0, sd), Belief::below(0.0, sd), Belief::normal(0.1, sd).within(-0.01, 0.3)]
        {
            let model = linear(r.clone(), &[3], vec![parameter("a", belief, true)], PEAK);
            let got = Evidence::of(&record, &model, &no_rest(), Kernel::Plain).expect("evidence").ln_z;
            let steps = 40_000;
            let (low, high) = (belief.lower.max(-0.5), belief.upper.min(0.5));
            let width = (high - low) / f64::from(steps);
            let (mut sum, mut mass) = (Vec::new(), 0.0);
            let chol = noise.clone().cholesky().expect("positive");
            let (hh, hr) = (h.dot(&chol.solve(&h)), h.dot(&chol.solve(&r)));
            let zero = ln_normal(&r, &noise);
            for i in 0..steps {
                let a = low + width * (f64::from(i) + 0.5);
                let z = (a - belief.mean) / sd;
                sum.push(zero + hr * a - 0.5 * hh * a * a - 0.5 * z * z);
            }
            // The belief's own mass within its bounds, on its own scale.
            let (from, to) =
                (belief.lower.max(belief.mean - 9.0 * sd), belief.upper.min(belief.mean + 9.0 * sd));
            let dx = (to - from) / f64::from(steps);
            for i in 0..steps {
                let z = (from + dx * (f64::from(i) + 0.5) - belief.mean) / sd;
                mass += dx * (-0.5 * z * z).exp();
            }
            let want = ln_sum_exp(sum) + width.ln() - f64::ln(mass);
            assert!((got - want).abs() < 1e-4, "{belief:?}: {got} {want}");
        }
    }
}

/// At an active bound the general formula is the design's factor √(π/2h) erfcx(g/√(2h)).
#[test]
fn an_active_bound_has_its_exact_factor() {
    let r = -column(3, N, 0.3) + misfit(N, 0.04, 4);
    let record = record(&data(&r, NoiseModel::white(0.04)), PEAK);
    let sd: f64 = 0.5;
    let model = linear(r.clone(), &[3], vec![parameter("a", Belief::above(0.0, sd), true)], PEAK);
    let got = Evidence::of(&record, &model, &no_rest(), Kernel::Plain).expect("evidence").ln_z;
    let h = column(3, N, PEAK);
    let curvature = h.norm_squared() / 0.04f64.powi(2) + sd.powi(-2);
    let slope = -h.dot(&r) / 0.04f64.powi(2);
    assert!(slope > 10.0, "the bound must be active");
    let front = (2.0 / (sd * std::f64::consts::TAU.sqrt())).ln();
    let want = ln_normal(&r, &dense_noise(N, 0.04, 0.0)) + front + ln_half_line(slope, curvature);
    assert!((got - want).abs() < 1e-9, "{got} {want}");
}

#[test]
fn the_mesh_has_a_fitted_scale_and_is_never_larger_than_the_rest() {
    let r = misfit(N, 0.04, 6);
    let e = column(1, N, 0.03);
    let noise = NoiseModel::white(0.04).with_nuisance(e.clone());
    let with = record(&data(&r, noise), PEAK);
    let model = linear(r.clone(), &[0], vec![parameter("a", Belief::normal(0.0, 0.2), false)], PEAK);
    let got = Evidence::of(&with, &model, &no_rest(), Kernel::Plain).expect("evidence").ln_z;
    let (c, _) = prior_part(&[0], &model.parameters);
    let at =
        |scale: f64| ln_normal(&r, &(&c + dense_noise(N, 0.04, 0.0) + &e * e.transpose() * scale * scale));
    let fine: Vec<f64> = (0..1000).map(|i| at((f64::from(i) + 0.5) / 1000.0)).collect();
    let want = ln_sum_exp(fine) - 1000f64.ln();
    assert!((got - want).abs() < 0.02, "{got} {want}");
    // A hundredfold column is cut down to 1.5 % of the peak, whatever its size.
    let z = |factor: f64| {
        let record = record(&data(&r, NoiseModel::white(0.04).with_nuisance(&e * factor)), PEAK);
        Evidence::of(&record, &model, &no_rest(), Kernel::Plain).expect("evidence").ln_z
    };
    assert!((z(100.0) - z(1000.0)).abs() < 1e-9 && (z(100.0) - z(1.0)).abs() > 0.1);
}

/// With a level estimated with ν degrees of freedom the density has Student's tails.
#[test]
fn an_estimated_noise_level_is_integrated_over() {
    let r = misfit(N, 0.055, 8);
    let noise = NoiseModel { freedom: 30.0, ..NoiseModel::white(0.04) };
    let model = linear(r.clone(), &[0], vec![parameter("a", Belief::normal(0.0, 0.2), false)], PEAK);
    let got = Evidence::of(&record(&data(&r, noise), PEAK), &model, &no_rest(), Kernel::Plain)
        .expect("evidence")
        .ln_z;
    let sd = (0.5f64 / 30.0).sqrt();
    let (c, _) = prior_part(&[0], &model.parameters);
    let (steps, width) = (2000, 8.0 * sd / 2000.0);
    let sum: Vec<f64> = (0..steps)
        .map(|i| {
            let x = width * (f64::from(i) + 0.5) - 4.0 * sd;
            let weight = (width / (sd * std::f64::consts::TAU.sqrt())).ln() - 0.5 * (x / sd).powi(2);
            weight + ln_normal(&r, &(&c + dense_noise(N, 0.04 * x.exp(), 0.0)))
        })
        .collect();
    assert!((got - ln_sum_exp(sum.clone())).abs() < 0.02, "{got} {}", ln_sum_exp(sum));
}

#[test]
fn plumlees_kernel_is_the_dense_one() {
    let r = misfit(N, 0.05, 9);
    let record = pulled(&r, NoiseModel::ar1(0.04, 0.3), PEAK);
    // One size alone: a prior whose mass sits at one length, and an evidence by nodes compared node by node.
    let prior = RestPrior { smooth_lengths: vec![(0.2, 1.0)], ..RestPrior::default() };
    let model = linear(r.clone(), &[0, 2], two_normal(), PEAK);
    let at = |size: RestSize| {
        let h = DMatrix::from_columns(&[column(0, N, 1.0), column(2, N, 1.0)]);
        let k = dense_rest(&line(N), &size);
        let m = h.tr_mul(&(&k * &h)).try_inverse().expect("independent");
        let orthogonal = (&k - &k * &h * m * h.transpose() * &k) * PEAK.powi(2);
        let (c, mean) = prior_part(&[0, 2], &model.parameters);
        ln_normal(&(&r - mean), &(c + dense_noise(N, 0.04, 0.3) + orthogonal))
    };
    let forms = [RestForm::Even, RestForm::Proportional, RestForm::PerLeg];
    for (tau, form) in [0.002, 0.02, 0.2].into_iter().flat_map(|t| forms.map(|f| (t, f))) {
        let size = RestSize { tau, form, ..RestSize::NONE };
        let got = Evidence::at_size(&record, &model, size, Kernel::Orthogonal).expect("evidence");
        let want = at(size);
        assert!((got - want).abs() < 1e-6, "{tau}: {got} {want}");
    }
    let plain = Evidence::of(&record, &model, &prior, Kernel::Plain).expect("evidence").ln_z;
    let other = Evidence::of(&record, &model, &prior, Kernel::Orthogonal).expect("evidence").ln_z;
    assert!(plain.is_finite() && other.is_finite() && (plain - other).abs() > 1e-3);
}

#[test]
fn other_priors_are_asked_without_new_integrals() {
    let prior = RestPrior::default();
    for wave in [0.0, 0.05, 0.3] {
        let r = misfit(N, 0.03, 3) + column(3, N, wave);
        let record = record(&data(&r, NoiseModel::white(0.03)), PEAK);
        let wide = |factor: f64| {
            let mut p = vec![
                parameter("a", Belief::normal(0.01, 0.2), false),
                parameter("b", Belief::above(0.0, 0.1), true),
            ];
            p[1].belief.sd *= factor;
            linear(r.clone(), &[0, 4], p, PEAK)
        };
        let evidence = Evidence::of(&record, &wide(1.0), &prior, Kernel::Plain).expect("evidence");
        for (amplitude, size) in [(2.0, 1.0), (0.5, 1.0), (1.0, 2.0), (1.0, 0.5)] {
            let rest = prior.scaled(size);
            let [own, other] = evidence.under(&View { rest: &rest, amplitude });
            let anew = Evidence::of(&record, &wide(amplitude), &rest, Kernel::Plain).expect("evidence");
            assert!((own - anew.ln_z).abs() < 0.05, "{wave} {amplitude} {size}: {own} {}", anew.ln_z);
            assert!(
                (other - anew.ln_z_else).abs() < 0.1,
                "{wave} {amplitude} {size}: {other} {}",
                anew.ln_z_else
            );
        }
    }
}

#[test]
fn faults_are_named() {
    let r = misfit(N, 0.03, 3);
    let good = data(&r, NoiseModel::white(0.03));
    let place = |s: Vec<f64>, peak: f64| evidence::Place { test: "pull".into(), s, leg: Vec::new(), peak };
    let say =
        |places: &[evidence::Place]| Record::new(&good, places, 0.015).expect_err("a fault").to_string();
    assert_eq!(say(&[]), "places: 0 entries, expected 1");
    assert_eq!(say(&[place(line(3), 1.0)]), "path of pull: 3 entries, expected 24");
    assert_eq!(say(&[place(line(N), 0.0)]), "peak of pull is 0; expected a positive number");
    let mut all_held_out = good.clone();
    all_held_out.held_out = vec![true; N];
    let hidden = Record::new(&all_held_out, &[place(line(N), 1.0)], 0.015);
    assert_eq!(hidden.expect_err("a fault").to_string(), "no point takes part");
    let model = linear(misfit(5, 0.03, 3), &[], Vec::new(), PEAK);
    let fault = Evidence::of(&record(&good, PEAK), &model, &no_rest(), Kernel::Plain).expect_err("a fault");
    assert_eq!(fault.to_string(), "misfit: 5 entries, expected 24");
}
