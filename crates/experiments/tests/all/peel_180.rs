//! 180° peel: Gc = (F/b) (1 + λ) − h W(λ) with F/(b h) = dW/dλ (Kendall 1975), neo-Hookean arm.

use crate::common::{energy, fault, run, stretch_at};

/// Width of the strip and thickness of the arm, mm.
const B: f64 = 4.0;
const H: f64 = 1.0;
/// Shear modulus, MPa, and toughness, N/mm.
const MU: f64 = 0.03;
const GC: f64 = 0.04;

fn text(cut: f64, length: f64, size: f64, over: usize, to: f64) -> String {
    let divisions = [(length / size).round() as usize, over, 2];
    format!(
        "name = \"peel\"\n[geometry]\nlength_mm = {length}\nwidth_mm = {B}\nthickness_mm = {}\ncut_mm = {cut}\n\
         [[tests]]\nkind = \"peel_180\"\nprotocol = [{{ to_mm = {to}, rate_mm_per_s = 0.1 }}]\n\
         [mesh]\ndivisions = {divisions:?}\n\
         [bulk]\nlaw = \"neo_hooke\"\nmu_MPa = {MU}\nbulk_modulus_MPa = 30.0\n\
         [interface]\ngc_N_per_mm = {GC}\nsigma_c_MPa = 0.03\n[solver]\nstep_mm = 0.25\n",
        2.0 * H
    )
}

/// Toughness by the closed form from a plateau's force.
fn toughness(force: f64) -> f64 {
    let stretch = stretch_at(MU, force / (B * H));
    force / B * (1.0 + stretch) - H * energy(MU, stretch)
}

/// Mean force over the last 3 mm of the tear, and the largest departure from it.
fn plateau(text: &str, length: f64) -> (f64, f64) {
    let test = run(text);
    let end = test.tear_front[test.tear_front.len() - 1];
    assert!(end > 8.0 && end < length - 3.0, "the front stands at {end} mm");
    assert!(test.force[0].abs() < 0.1 * test.force[test.force.len() - 1], "folded: {} N", test.force[0]);
    let rows = test.tear_front.iter().zip(&test.force).filter(|(x, _)| **x > end - 3.0);
    let late: Vec<f64> = rows.map(|(_, f)| *f).collect();
    let mean = late.iter().sum::<f64>() / late.len() as f64;
    (mean, late.iter().fold(0.0f64, |m, f| m.max((f / mean - 1.0).abs())))
}

#[test]
fn a_steady_180_degree_peel_gives_the_toughness() {
    let (force, scatter) = plateau(&text(6.0, 20.0, 0.5, 4, 24.0), 20.0);
    let found = toughness(force);
    println!("F = {force:.5} N, ± {scatter:.4}, Gc = {found:.5} N/mm, {:+.3} %", 100.0 * (found / GC - 1.0));
    assert!((found / GC - 1.0).abs() < 0.01, "{found}");
}

#[test]
fn a_cut_too_short_for_the_fold_is_an_error_of_the_file() {
    let message = fault(&text(2.0, 20.0, 0.5, 4, 24.0));
    assert!(
        message.contains("cut_mm") && message.contains("peel_180") && message.contains("4.142"),
        "{message}"
    );
}
