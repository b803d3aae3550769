//! Every bulk law of the registry through one battery, and each against its closed forms.

use constitutive::{Context, Law, PointLaw, tangent_by_jets_9, tensor, testing};
use input::{LawRegistry, LawSite, OptionValue};
use laws::{BulkLaw, Settings};
use params::ParamSpec;
use proptest::prelude::*;
use std::sync::Arc;

type Params = Vec<f64>;

/// Every law under every word or number that its settings allow.
fn variants() -> Vec<(String, Arc<dyn PointLaw<9>>)> {
    let registry = laws::registry();
    let mut all = Vec::new();
    for law in registry.all_bulk() {
        let name = law.card().name;
        for settings in combinations(law) {
            all.push((format!("{name} {settings:?}"), law.law(&settings)));
        }
    }
    all
}

fn combinations(law: &BulkLaw) -> Vec<Settings> {
    let mut all = vec![Settings::new()];
    for option in law.options() {
        let values: Vec<OptionValue> = match option.kind {
            input::OptionKind::Bool => vec![OptionValue::Bool(true), OptionValue::Bool(false)],
            input::OptionKind::Integer { min, max } => (min..=max).map(OptionValue::Integer).collect(),
            input::OptionKind::Choice(words) => words.into_iter().map(OptionValue::Text).collect(),
            _ => continue,
        };
        let with = |s: &Settings, v: &OptionValue| {
            let mut s = s.clone();
            s.insert(option.name.clone(), v.clone());
            s
        };
        all = all.iter().flat_map(|s| values.iter().map(|v| with(s, v)).collect::<Vec<_>>()).collect();
    }
    all
}

/// Ordinary values: the starts, moved by factors near one; D such that the volume matters too. Stiffening is held low
/// enough for the exponentials over the deformations below.
fn values(specs: &[ParamSpec], factors: &[f64]) -> Params {
    let of = |(spec, factor): (&ParamSpec, &f64)| {
        let v = spec.start * factor;
        match spec.name.as_ref() {
            "d" => 2.0 * v,
            "fibre_onset" => 0.0,
            "kappa" => v.min(0.33),
            name if name.starts_with('b') || name.starts_with("k2") => 0.2 * v.min(8.0),
            _ => v,
        }
    };
    specs.iter().zip(factors.iter().cycle()).map(of).collect()
}

/// F = Q diag(λ) R with principal stretches from 0.75 to 1.5.
fn deformations() -> impl Strategy<Value = [f64; 9]> {
    let angle = || -3.1f64..3.1;
    let rotation = move || (angle(), angle(), angle()).prop_map(|(a, b, c)| testing::rotation(a, b, c));
    // Pairs and triples of equal stretches among them.
    let stretch =
        prop_oneof![Just([1.2, 1.2, 0.8]), Just([1.3, 1.3, 1.3]), [0.75f64..1.5, 0.75..1.5, 0.75..1.5]];
    (rotation(), stretch, rotation()).prop_map(|(q, [a, b, c], r)| {
        tensor::mul(&q, &tensor::mul(&[a, 0.0, 0.0, 0.0, b, 0.0, 0.0, 0.0, c], &r))
    })
}

fn factors() -> impl Strategy<Value = Vec<f64>> {
    proptest::collection::vec(0.6f64..1.6, 7)
}

fn largest<'a>(x: impl IntoIterator<Item = &'a f64>) -> f64 {
    x.into_iter().fold(1e-300, |m: f64, x| m.max(x.abs()))
}

/// Whether a fibre family switches on or off within a small step of F: there the tangent jumps.
fn near_a_switch(law: &dyn PointLaw<9>, f: &[f64; 9], p: &Params) -> bool {
    let families = law.offers().bulk.map(|b| b.fibres).unwrap_or_default();
    let moved = |i: usize, h: f64| {
        let mut f = *f;
        f[i] += h;
        f
    };
    families.iter().any(|family| {
        let active = |f: &[f64; 9]| constitutive::part_response(&family.response, f, p).energy > 0.0;
        let here = active(f);
        (0..9).any(|i| active(&moved(i, 1e-3)) != here || active(&moved(i, -1e-3)) != here)
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, ..ProptestConfig::default() })]

    #[test]
    fn the_analytic_tangent_is_that_of_the_jets(f in deformations(), x in factors()) {
        for (name, law) in variants() {
            let p = values(&law.parameters(), &x);
            let jets = tangent_by_jets_9(&*law, &Context::default(), &f, &p, &[], &mut []);
            let error = testing::analytic_tangent_error(&*law, &Context::default(), &f, &p, &[], jets);
            prop_assert!(error.expect("every law has one") < 1e-11, "{}: {:?}", name, error);
        }
    }

    #[test]
    fn stress_is_the_slope_of_the_energy_and_the_tangent_that_of_the_stress(f in deformations(), x in factors()) {
        for (name, law) in variants() {
            let p = values(&law.parameters(), &x);
            let (force, a) = tangent_by_jets_9(&*law, &Context::default(), &f, &p, &[], &mut []);
            let stiffness = largest(a.iter().flatten());
            let h = 1e-6;
            for i in 0..9 {
                let (mut up, mut down) = (f, f);
                up[i] += h;
                down[i] -= h;
                let energy = |f: &[f64; 9]| testing::respond(&*law, &Context::default(), f, &p, &[]).1;
                let slope = (energy(&up) - energy(&down)) / (2.0 * h);
                prop_assert!((slope - force[i]).abs() < 1e-8 * stiffness, "{} {}: {} {}", name, i, slope, force[i]);
            }
            if near_a_switch(&*law, &f, &p) {
                continue;
            }
            let error = testing::tangent_error_9(&*law, &Context::default(), &f, &p, &[], 1e-6);
            prop_assert!(error < 2e-6, "{}: {}", name, error);
            for (i, j) in (0..9).flat_map(|i| (0..i).map(move |j| (i, j))) {
                prop_assert!((a[i][j] - a[j][i]).abs() < 1e-11 * stiffness, "{} is not symmetric", name);
            }
        }
    }

    #[test]
    fn a_rotation_of_the_strip_turns_the_stress(f in deformations(), x in factors(), a in -3.0f64..3.0, b in -3.0f64..3.0) {
        let q = testing::rotation(a, b, 0.4);
        for (name, law) in variants() {
            let p = values(&law.parameters(), &x);
            let ctx = Context::default();
            let (_, tangent) = tangent_by_jets_9(&*law, &ctx, &f, &p, &[], &mut []);
            let (force, _, _) = testing::respond(&*law, &ctx, &f, &p, &[]);
            let (turned, _, _) = testing::respond(&*law, &ctx, &tensor::mul(&q, &f), &p, &[]);
            let expected = tensor::mul(&q, &force);
            let scale = largest(tangent.iter().flatten());
            for i in 0..9 {
                prop_assert!((turned[i] - expected[i]).abs() < 1e-12 * scale, "{}", name);
            }
            let tau = tensor::kirchhoff(&force, &f);
            prop_assert!((tau[1] - tau[3]).abs().max((tau[2] - tau[6]).abs()) < 1e-12 * scale, "{}", name);
        }
    }

    #[test]
    fn parameters_have_their_slopes(f in deformations(), x in factors()) {
        for (name, law) in variants() {
            let p = values(&law.parameters(), &x);
            if near_a_switch(&*law, &f, &p) {
                continue;
            }
            // One by one: a slope near zero beside a large one is rounding of the difference.
            let (_, a) = tangent_by_jets_9(&*law, &Context::default(), &f, &p, &[], &mut []);
            for k in 0..p.len() {
                let mut jets: Vec<constitutive::Jet<1>> =
                    p.iter().map(|&v| constitutive::Jet::constant(v)).collect();
                jets[k].eps[0] = 1.0;
                let exact = Law::<constitutive::Jet<1>, 9>::respond(
                    &*law, &Context::default(), &f.map(constitutive::Jet::constant), &jets, &[], &mut []);
                let h = 1e-5 * p[k].abs().max(1e-3);
                let at = |d: f64| {
                    let mut p = p.clone();
                    p[k] += d;
                    testing::respond(&*law, &Context::default(), &f, &p, &[]).0
                };
                let (up, down) = (at(h), at(-h));
                let noise = 1e-12 * largest(a.iter().flatten()) / h;
                for i in 0..9 {
                    let difference = (up[i] - down[i]) / (2.0 * h);
                    let size = largest(exact.force.iter().map(|x| &x.eps[0]));
                    let error = (exact.force[i].eps[0] - difference).abs();
                    prop_assert!(error < 1e-5 * size + noise, "{} parameter {}: {}", name, k, error);
                }
            }
        }
    }

    /// The parts that a law offers are parts: the volume's has no shear stiffness, and without it and the fibres an
    /// isotropic matrix is left.
    #[test]
    fn what_is_left_without_fibres_and_volume_is_isochoric(f in deformations(), x in factors(), s in 0.9f64..1.1) {
        for (name, law) in variants() {
            let p = values(&law.parameters(), &x);
            let parts = law.offers().bulk.expect("a bulk law says what it consists of");
            if !parts.rest_is_isochoric {
                continue;
            }
            let volume = parts.volumetric.expect("every law of the registry splits");
            let rest = |f: &[f64; 9]| {
                let whole = testing::respond(&*law, &Context::default(), f, &p, &[]).1;
                whole - constitutive::part_response(&volume, f, &p).energy
            };
            let (a, b) = (rest(&f), rest(&f.map(|v| v * s)));
            prop_assert!((a - b).abs() < 1e-11 * (1.0 + a.abs()), "{}: {} {}", name, a, b);
            for family in &parts.fibres {
                let part = |f: &[f64; 9]| constitutive::part_response(&family.isochoric, f, &p);
                let error = (part(&f).energy - part(&f.map(|v| v * s)).energy).abs();
                prop_assert!(error < 1e-11 * (1.0 + part(&f).energy), "{}", name);
            }
        }
    }
}

#[test]
fn the_reference_is_free_of_stress() {
    for (name, law) in variants() {
        let p = values(&law.parameters(), &[1.0]);
        let (force, energy, _) =
            testing::respond(&*law, &Context::default(), &tensor::identity::<f64>(), &p, &[]);
        assert_eq!((force, energy), ([0.0; 9], 0.0), "{name}");
    }
}

#[test]
fn what_is_out_of_domain_is_seen_not_thrown() {
    for (name, law) in variants() {
        let p = values(&law.parameters(), &[1.0]);
        for f in [[0.0; 9], [f64::NAN; 9], [-1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]] {
            let (force, _, _) = testing::respond(&*law, &Context::default(), &f, &p, &[]);
            assert!(force.iter().any(|x| !x.is_finite()), "{name} {f:?}: {force:?}");
            let answer = law.analytic_tangent(&Context::default(), &f, &p, &[], &mut []);
            assert!(answer.is_none_or(|(p, _)| p.iter().any(|x| !x.is_finite())), "{name}");
        }
    }
}

#[test]
fn every_law_says_what_a_file_and_a_search_need() {
    for (name, law) in variants() {
        let specs = law.parameters();
        for s in &specs {
            assert!(
                s.lower <= s.start && s.start <= s.upper && !s.description.is_empty(),
                "{name} {}",
                s.name
            );
            let (low, high) = s.admissible.unwrap_or((s.lower, s.upper));
            assert!(low <= s.start && s.start <= high, "{name} {}", s.name);
            assert!(s.internal || s.transform.forward(s.start).is_finite(), "{name} {}", s.name);
            assert!(s.fixed || s.expected.is_some() || s.name.starts_with("alpha"), "{name} {}", s.name);
        }
        let starts =
            law.offers().bulk.and_then(|b| b.starts).expect("every law of the registry offers starts");
        assert_eq!(starts.template.len(), specs.len(), "{name}");
        assert!(starts.axes.iter().all(|(i, n)| *i < specs.len() && *n > 0), "{name}");
        assert!(law.history().is_empty() && !law.rate_dependent(), "{name}");
    }
    let names = laws::registry().law_names(LawSite::Bulk);
    assert_eq!(names[0], "hgo", "the default");
}

// ---- Closed forms: incompressible, K0 = 10⁶ MPa ----------------------------------------------

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
