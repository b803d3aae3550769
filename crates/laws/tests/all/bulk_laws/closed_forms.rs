//! Each law against its closed forms: incompressible, K0 = 10⁶ MPa.

use super::Params;
use constitutive::{Context, PointLaw, tensor, testing};
use input::OptionValue;
use std::sync::Arc;

const STIFF_D: f64 = 2e-6;

fn law(name: &str, settings: &[(&str, OptionValue)]) -> Arc<dyn PointLaw<9>> {
    let settings = settings.iter().map(|(n, v)| ((*n).to_owned(), v.clone())).collect();
    laws::registry().bulk(name).expect("in the registry").law(&settings)
}

/// Stress of a diagonal F = (λx, λy, λz) at constant volume, with the pressure that frees z: (P_xx, P_yy).
fn plane(law: &dyn PointLaw<9>, p: &Params, x: f64, y: f64) -> (f64, f64) {
    let z = 1.0 / (x * y);
    let f = [x, 0.0, 0.0, 0.0, y, 0.0, 0.0, 0.0, z];
    let (s, _, _) = testing::respond(law, &Context::default(), &f, p, &[]);
    (s[0] - s[8] * z / x, s[4] - s[8] * z / y)
}

/// P_yy in uniaxial tension along y: the width is free too.
fn uniaxial(law: &dyn PointLaw<9>, p: &Params, stretch: f64) -> f64 {
    let (mut low, mut high) = (0.3, 1.2);
    for _ in 0..200 {
        let x = 0.5 * (low + high);
        if plane(law, p, x, stretch).0 > 0.0 { high = x } else { low = x }
    }
    plane(law, p, 0.5 * (low + high), stretch).1
}

/// Cauchy shear stress σ_xy of F = I + g e_x⊗e_y.
fn shear(law: &dyn PointLaw<9>, p: &Params, g: f64) -> f64 {
    let f = [1.0, g, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
    let (s, _, _) = testing::respond(law, &Context::default(), &f, p, &[]);
    tensor::kirchhoff(&s, &f)[1]
}

fn held(what: &str, found: f64, exact: f64, worst: &mut f64) {
    let error = (found - exact).abs() / exact.abs();
    assert!(error < 1e-3, "{what}: {found} {exact}");
    *worst = worst.max(error);
}

/// A closed form by stretch, or by shear.
type Form<'a> = &'a dyn Fn(f64) -> f64;

/// Compares a law with its dΨ/dI1-type closed forms and prints the worst error.
fn closed(name: &str, law: &dyn PointLaw<9>, p: &Params, forms: (Form, Form, Form)) {
    let mut worst = 0.0;
    for stretch in [1.05, 1.15, 1.3, 1.5] {
        held(&format!("{name} uniaxial {stretch}"), uniaxial(law, p, stretch), forms.0(stretch), &mut worst);
        let found = plane(law, p, stretch, stretch).1;
        held(&format!("{name} equibiaxial {stretch}"), found, forms.1(stretch), &mut worst);
        let g = stretch - 1.0;
        held(&format!("{name} shear {g}"), shear(law, p, g), forms.2(g), &mut worst);
    }
    println!("{name}: uniaxial, equibiaxial, simple shear within {worst:.1e}");
}

/// For Ψ(I1): P = 2 (λ − λ⁻²) Ψ′, P = 2 (λ − λ⁻⁵) Ψ′, τ = 2 g Ψ′ (Treloar 1975; Holzapfel 2000, sec. 6.5).
fn of_i1(name: &str, law: &dyn PointLaw<9>, p: &Params, slope: &dyn Fn(f64) -> f64) {
    let uniaxial = |l: f64| 2.0 * (l - l.powi(-2)) * slope(l * l + 2.0 / l - 3.0);
    let biaxial = |l: f64| 2.0 * (l - l.powi(-5)) * slope(2.0 * l * l + l.powi(-4) - 3.0);
    let shear = |g: f64| 2.0 * g * slope(g * g);
    closed(name, law, p, (&uniaxial, &biaxial, &shear));
}

#[test]
fn neo_hooke_closed_forms() {
    let law = law("neo_hooke", &[]);
    of_i1("neo_hooke", &*law, &vec![0.03, STIFF_D], &|_| 0.015);
}

#[test]
fn yeoh_closed_forms() {
    let law = law("yeoh", &[]);
    of_i1("yeoh", &*law, &vec![0.01, 0.004, 0.02, STIFF_D], &|e| 0.01 + 0.008 * e + 0.06 * e * e);
}

/// P = Σ 2μ/α (λ^(α−1) − λ^(−α/2−1)); equibiaxial λ^(α−1) − λ^(−2α−1); simple shear by the principal stretches
/// λ − 1/λ = g: τ = Σ 2μ/α (λ^α − λ^−α)/(λ + 1/λ) (Ogden 1972). Treloar's three terms.
#[test]
fn ogden_closed_forms() {
    // μ α of the source: 6.3·1.3, 0.1·2.0, 0.012·5.0 (10⁵ Pa); half of that here.
    let terms = [(0.4095, 1.3), (0.01, -2.0), (0.003, 5.0)];
    for count in 1..=3usize {
        let law = law("ogden", &[("terms", OptionValue::Integer(count as i64))]);
        let mut p: Params = terms[..count].iter().flat_map(|t| [t.0, t.1]).collect();
        p.push(STIFF_D);
        let sum =
            |f: &dyn Fn(f64) -> f64| terms[..count].iter().map(|(m, a)| 2.0 * m / a * f(*a)).sum::<f64>();
        let uniaxial = |l: f64| sum(&|a| l.powf(a - 1.0) - l.powf(-0.5 * a - 1.0));
        let biaxial = |l: f64| sum(&|a| l.powf(a - 1.0) - l.powf(-2.0 * a - 1.0));
        let shear = |g: f64| {
            let l = 0.5 * (g + (g * g + 4.0).sqrt());
            sum(&|a| (l.powf(a) - l.powf(-a)) / (l + 1.0 / l))
        };
        closed(&format!("ogden, {count} terms"), &*law, &p, (&uniaxial, &biaxial, &shear));
    }
}

/// α = 2 is neo-Hooke.
#[test]
fn ogden_of_power_two_is_neo_hooke() {
    let (a, b) = (law("ogden", &[]), law("neo_hooke", &[]));
    let f = [1.1, 0.2, 0.0, -0.1, 1.2, 0.1, 0.05, 0.0, 0.9];
    let of = |law: &dyn PointLaw<9>, p: &[f64]| testing::respond(law, &Context::default(), &f, p, &[]).0;
    for (x, y) in of(&*a, &[0.03, 2.0, 0.1]).iter().zip(of(&*b, &[0.03, 0.1])) {
        assert!((x - y).abs() < 1e-14, "{x} {y}");
    }
}

/// w′ = k1 E exp(k2 E²) for E > 0.
fn fibre(k1: f64, k2: f64, e: f64) -> f64 {
    let e = e.max(0.0);
    k1 * e * (k2 * e * e).exp()
}

/// With fibres at ±γ, along x and along y, in the plane: P_yy = ∂Ψ/∂λy at free z, the width's stretch by bisection of
/// ∂Ψ/∂λx; equibiaxial in closed form; shear in the plane of the fibres: σ_xy = μ g + Σ 2 w′(E_f) (F a)_x (F a)_y.
#[test]
fn four_fiber_closed_forms() {
    let law = law("four_fiber", &[]);
    let (mu, k1, k2, degrees, kx, cx, ky, cy) = (0.01, 0.05, 2.0, 40.0f64, 0.02, 1.5, 0.04, 1.0);
    let p = vec![mu, k1, k2, degrees.to_radians(), kx, cx, ky, cy, STIFF_D, 0.0];
    let (s, c) = degrees.to_radians().sin_cos();
    let slopes = |x: f64, y: f64| {
        let diagonal = fibre(k1, k2, x * x * s * s + y * y * c * c - 1.0);
        let (across, along) = (fibre(kx, cx, x * x - 1.0), fibre(ky, cy, y * y - 1.0));
        let z = 1.0 / (x * y);
        (
            mu * (x - z * z / x) + 4.0 * diagonal * x * s * s + 2.0 * across * x,
            mu * (y - z * z / y) + 4.0 * diagonal * y * c * c + 2.0 * along * y,
        )
    };
    let uniaxial = |l: f64| {
        let (mut low, mut high) = (0.3, 1.2);
        for _ in 0..200 {
            let x = 0.5 * (low + high);
            if slopes(x, l).0 > 0.0 { high = x } else { low = x }
        }
        slopes(0.5 * (low + high), l).1
    };
    let shear = |g: f64| {
        let one = |x: f64, y: f64, k: f64, b: f64| {
            let (u, v) = (x + g * y, y);
            2.0 * fibre(k, b, u * u + v * v - 1.0) * u * v
        };
        mu * g + one(s, c, k1, k2) + one(-s, c, k1, k2) + one(1.0, 0.0, kx, cx) + one(0.0, 1.0, ky, cy)
    };
    closed("four_fiber", &*law, &p, (&uniaxial, &|l| slopes(l, l).1, &shear));
}

/// Without axial and circumferential fibres it is HGO with aligned fibres.
#[test]
fn four_fiber_with_two_families_is_hgo() {
    let (four, two) = (law("four_fiber", &[]), law("hgo", &[]));
    let f = [1.1, 0.2, 0.0, -0.1, 1.2, 0.1, 0.05, 0.0, 0.9];
    let of = |law: &dyn PointLaw<9>, p: &[f64]| testing::respond(law, &Context::default(), &f, p, &[]).0;
    let a = of(&*four, &[0.01, 0.4, 3.0, 0.7, 0.0, 1.0, 0.0, 1.0, 0.1, 0.0]);
    let b = of(&*two, &[0.01, 0.4, 3.0, 0.7, 0.0, 0.1, 0.0]);
    for (x, y) in a.iter().zip(b) {
        assert!((x - y).abs() < 1e-13, "{x} {y}");
    }
}

/// Tension with the width by bisection; in shear F = I + g e_x⊗e_y the matrix, the family along y (I4 − 1 = g²) and
/// the coupling (I8 = g) carry.
#[test]
fn holzapfel_ogden_closed_forms() {
    for across in [false, true] {
        let word = OptionValue::Text(if across { "tear" } else { "load" }.into());
        let law = law("holzapfel_ogden", &[("fibres", word)]);
        let (a, b, af, bf, a_s, bs, afs, bfs) = (5.9e-4, 2.0, 1.8e-2, 1.6, 2.5e-3, 1.1, 2.2e-3, 1.2);
        let p = vec![a, b, af, bf, a_s, bs, afs, bfs, STIFF_D, 0.0];
        let ((kx, cx), (ky, cy)) = if across { ((af, bf), (a_s, bs)) } else { ((a_s, bs), (af, bf)) };
        let matrix = |e: f64| 0.5 * a * (b * e).exp();
        let slopes = |x: f64, y: f64| {
            let z = 1.0 / (x * y);
            let m = matrix(x * x + y * y + z * z - 3.0);
            (
                2.0 * m * (x - z * z / x) + 2.0 * fibre(kx, cx, x * x - 1.0) * x,
                2.0 * m * (y - z * z / y) + 2.0 * fibre(ky, cy, y * y - 1.0) * y,
            )
        };
        let uniaxial = |l: f64| {
            let (mut low, mut high) = (0.3, 1.2);
            for _ in 0..200 {
                let x = 0.5 * (low + high);
                if slopes(x, l).0 > 0.0 { high = x } else { low = x }
            }
            slopes(0.5 * (low + high), l).1
        };
        // F = I + g e_x⊗e_y: I1 − 3 = I4y − 1 = g², I8 = g; b_xy = g.
        let shear = |g: f64| {
            let along = 2.0 * fibre(ky, cy, g * g) * g;
            2.0 * matrix(g * g) * g + along + afs * g * (bfs * g * g).exp()
        };
        closed("holzapfel_ogden", &*law, &p, (&uniaxial, &|l| slopes(l, l).1, &shear));
    }
}
