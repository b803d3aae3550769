//! T-peel: Gc = 2 [(F/b) λ − h W(λ)] with F/(b h) = dW/dλ (Rivlin & Thomas 1953), neo-Hookean arms.

use crate::common::{energy, run, stress, stretch_at};

/// Width of the strip and thickness of an arm, mm.
const B: f64 = 4.0;
const H: f64 = 1.0;
/// Shear modulus, MPa, and toughness, N/mm.
const MU: f64 = 0.03;
const GC: f64 = 0.04;

struct Peel {
    arm: f64,
    length: f64,
    /// Size of elements along the tear, mm, and over the thickness of the sheet.
    size: f64,
    over: usize,
    to: f64,
    symmetry: &'static str,
}

impl Peel {
    fn text(&self) -> String {
        // Two over the width, so that half of them is half the mesh.
        let divisions = [(self.length / self.size).round() as usize, self.over, 2];
        format!(
            "name = \"peel\"\n[geometry]\nlength_mm = {}\nwidth_mm = {B}\nthickness_mm = {}\ncut_mm = {}\n\
             [[tests]]\nkind = \"t_peel\"\nprotocol = [{{ to_mm = {}, rate_mm_per_s = 0.1 }}]\n\
             [mesh]\ndivisions = {divisions:?}\nsymmetry = \"{}\"\n\
             [bulk]\nlaw = \"neo_hooke\"\nmu_MPa = {MU}\nbulk_modulus_MPa = 30.0\n\
             [interface]\ngc_N_per_mm = {GC}\nsigma_c_MPa = 0.03\n[solver]\nstep_mm = 0.25\n",
            self.length,
            2.0 * H,
            self.arm,
            self.to,
            self.symmetry
        )
    }
}

/// Mean force of the last stretch of a peel in which the front advances by this much (mm), and the largest departure.
fn plateau(p: &Peel, last: f64) -> (f64, f64) {
    let test = run(&p.text());
    let end = test.tear_front[test.tear_front.len() - 1];
    assert!(end > p.arm + 2.0 * last && end < p.length - 3.0, "the front stands at {end} mm");
    let late: Vec<f64> =
        test.tear_front.iter().zip(&test.force).filter(|(x, _)| **x > end - last).map(|(_, f)| *f).collect();
    let mean = late.iter().sum::<f64>() / late.len() as f64;
    (mean, late.iter().fold(0.0f64, |m, f| m.max((f / mean - 1.0).abs())))
}

/// Toughness by the closed form from a plateau's force.
fn toughness(force: f64) -> f64 {
    let stretch = stretch_at(MU, force / (B * H));
    2.0 * (force / B * stretch - H * energy(MU, stretch))
}

#[test]
fn the_closed_form_is_that_of_a_bar() {
    let (a, b) = (1.3, 1e-6);
    let slope = (energy(MU, a + b) - energy(MU, a - b)) / (2.0 * b);
    assert!((slope / stress(MU, a) - 1.0).abs() < 1e-8);
    assert!((stretch_at(MU, stress(MU, a)) - a).abs() < 1e-12);
}

#[test]
fn a_steady_peel_gives_the_toughness_on_a_coarse_mesh() {
    let peel = Peel { arm: 4.0, length: 18.0, size: 0.5, over: 4, to: 22.0, symmetry: "auto" };
    let (force, scatter) = plateau(&peel, 2.0);
    let found = toughness(force);
    println!(
        "coarse: F = {force:.5} N, ± {scatter:.4}, Gc = {found:.5} N/mm, {:+.3} %",
        100.0 * (found / GC - 1.0)
    );
    assert!((found / GC - 1.0).abs() < 0.01, "{found}");
}

#[test]
#[ignore = "slow: run by `just slow`"]
fn a_steady_peel_gives_the_toughness_whatever_its_length() {
    let mut forces = Vec::new();
    for (arm, to) in [(4.0, 30.0), (8.0, 40.0)] {
        let peel = Peel { arm, length: arm + 18.0, size: 0.25, over: 8, to, symmetry: "auto" };
        let (force, scatter) = plateau(&peel, 3.0);
        let found = toughness(force);
        println!(
            "arm {arm}: F = {force:.5} N, ± {scatter:.4}, Gc = {found:.5} N/mm, {:+.3} %",
            100.0 * (found / GC - 1.0)
        );
        assert!((found / GC - 1.0).abs() < 0.01, "{found}");
        forces.push(force);
    }
    assert!((forces[0] / forces[1] - 1.0).abs() < 0.002, "{forces:?}");
}

#[test]
fn half_and_whole_models_agree() {
    let of = |symmetry| {
        let peel = Peel { arm: 4.0, length: 14.0, size: 0.5, over: 4, to: 12.0, symmetry };
        run(&peel.text())
    };
    let (half, whole) = (of("auto"), of("none"));
    let at = |t: &analysis::SimulatedTest, u: f64| {
        let row = t.displacement.iter().position(|x| (x - u).abs() < 1e-9).expect("a multiple of the step");
        t.force[row]
    };
    let peak = half.force.iter().fold(0.0f64, |m, f| m.max(*f));
    let worst = (1..=48).map(|i| 0.25 * f64::from(i)).map(|u| (at(&half, u) - at(&whole, u)).abs() / peak);
    let worst = worst.fold(0.0f64, f64::max);
    println!("half against whole: {worst:.1e} of the largest force");
    assert!(worst < 1e-6, "{worst}");
}
