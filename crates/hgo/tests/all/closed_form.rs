//! Incompressible uniaxial tension in closed form, against the law with a large bulk modulus.

use crate::common;

use common::*;
use hgo::{D, GAMMA, Hgo, K1, K2, KAPPA, MU, d_of, published, uniaxial};

const STIFF: f64 = 1e6;

fn parameters(gamma_degrees: f64, kappa: f64) -> Params {
    [7.64e-3, 0.9966, 52.46, gamma_degrees.to_radians(), kappa, d_of(STIFF), 0.0]
}

/// w'(E) = k1 E exp(k2 E²), zero for E ≤ 0.
fn fibre_slope(p: &Params, e: f64) -> f64 {
    let e = e.max(0.0);
    p[K1] * e * (p[K2] * e * e).exp()
}

fn check(p: &Params, closed: impl Fn(f64) -> f64) {
    let stretches: Vec<f64> = (0..=20).map(|i| 0.95 + 0.015 * i as f64).collect();
    for state in uniaxial::curve(&Hgo::default(), p, &stretches).unwrap() {
        let exact = closed(state.stretch);
        let error = (state.nominal_stress - exact).abs();
        // What compressibility leaves: a volume strain P/K, times the stiffness.
        let tolerance = 1e-6 + 2.0 * state.modulus / STIFF;
        assert!(error < tolerance * exact.abs().max(1e-3), "{state:?} {exact}");
    }
}

/// κ = 1/3: Ψ of I1 alone, P = 2 (λ − λ⁻²) ∂Ψ/∂I1 with E = (I1 − 3)/3.
#[test]
fn isotropic_dispersion() {
    let p = parameters(30.0, 1.0 / 3.0);
    check(&p, |l| {
        let i1 = l * l + 2.0 / l;
        2.0 * (l - l.powi(-2)) * (0.5 * p[MU] + 2.0 / 3.0 * fibre_slope(&p, (i1 - 3.0) / 3.0))
    });
}

/// γ = 0, any κ: transversely isotropic about the load, λx = λz = λ^(−1/2), so that
/// P = dΨ/dλ along the path with dE/dλ = κ (2λ − 2/λ²) + (1 − 3κ) 2λ.
#[test]
fn fibres_along_the_load() {
    for kappa in [0.0, 0.1, 0.226] {
        let p = parameters(0.0, kappa);
        check(&p, |l| {
            let e = kappa * (l * l + 2.0 / l) + (1.0 - 3.0 * kappa) * l * l - 1.0;
            let slope = kappa * 2.0 * (l - l.powi(-2)) + (1.0 - 3.0 * kappa) * 2.0 * l;
            p[MU] * (l - l.powi(-2)) + 2.0 * fibre_slope(&p, e) * slope
        });
    }
}

/// κ = 0, γ symmetric: λz = 1/(λ λx), E = λx² sin²γ + λ² cos²γ − 1, with λx from
/// ∂Ψ/∂λx = μ (λx − 1/(λ² λx³)) + 4 w'(E) λx sin²γ = 0 by bisection (monotone in λx), and
/// P = ∂Ψ/∂λ = μ (λ − 1/(λx² λ³)) + 4 w'(E) λ cos²γ.
#[test]
fn aligned_fibres_at_an_angle() {
    for degrees in [20.0, 45.0, 49.98, 65.0] {
        let p = parameters(degrees, 0.0);
        let (s2, c2) = (p[GAMMA].sin().powi(2), p[GAMMA].cos().powi(2));
        check(&p, |l| {
            let slope = |x: f64| fibre_slope(&p, x * x * s2 + l * l * c2 - 1.0);
            let side = |x: f64| p[MU] * (x - 1.0 / (l * l * x.powi(3))) + 4.0 * slope(x) * x * s2;
            let (mut low, mut high) = (0.05, 2.0);
            for _ in 0..200 {
                let middle = 0.5 * (low + high);
                if side(middle) < 0.0 { low = middle } else { high = middle }
            }
            let x = 0.5 * (low + high);
            p[MU] * (l - 1.0 / (x * x * l.powi(3))) + 4.0 * slope(x) * l * c2
        });
    }
}

#[test]
fn the_modulus_is_the_slope_of_the_curve() {
    let mut p = parameters(49.98, 0.226);
    p[D] = 0.1;
    let law = Hgo::default();
    for stretch in [1.02, 1.1, 1.2] {
        let h = 1e-6;
        let at = |l: f64| uniaxial::at(&law, &p, l).unwrap();
        let fd = (at(stretch + h).nominal_stress - at(stretch - h).nominal_stress) / (2.0 * h);
        assert!((at(stretch).modulus / fd - 1.0).abs() < 1e-6);
        let work = (at(stretch + h).energy - at(stretch - h).energy) / (2.0 * h);
        assert!((at(stretch).nominal_stress / work - 1.0).abs() < 1e-6);
    }
}

/// The published parameters run for the three published dispersions, and dispersion stiffens the
/// early part of the curve: the strip of 2006 stretches most for κ = 0.
#[test]
fn adventitia_2006_stiffens_with_dispersion() {
    let stress = |kappa: f64| {
        let p = published::adventitia_2006(kappa, 20.0);
        uniaxial::at(&Hgo::default(), &p, 1.1).unwrap().nominal_stress
    };
    let [a, b, c] = published::gasser_ogden_holzapfel_2006::KAPPA.map(stress);
    assert!(a < b && b < c, "{a} {b} {c}");
}

#[test]
fn a_curve_that_cannot_go_on_says_where() {
    let mut p = parameters(0.0, 0.0);
    p[K2] = 1000.0;
    let error = uniaxial::curve(&Hgo::default(), &p, &[1.1, 4.0]).unwrap_err();
    let uniaxial::Error::NoEquilibrium { reached, wanted } = error;
    assert!(reached >= 1.1 && wanted <= 4.0 && reached < wanted, "{error}");
    p[KAPPA] = 0.1;
    assert!(uniaxial::at(&Hgo::default(), &p, f64::NAN).is_err());
}
