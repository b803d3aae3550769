//! Pure shear: a tear that runs at constant displacement gives free W h₀ per area (Rivlin & Thomas 1953).

use crate::common::run;

/// A sheet of 2 × 24 × 0.2 mm, the tear followed along its path: toughness by W h₀ over that of the file.
fn ratio(size: [usize; 3]) -> f64 {
    let (h0, width, thickness, cut, mu, gc) = (2.0, 24.0, 0.2, 6.0, 0.03, 0.01);
    let sheet = |kind: &str, cut: f64, to: f64, control: &str| {
        format!(
            "name = \"sheet\"\n[geometry]\nlength_mm = {h0}\nwidth_mm = {width}\nthickness_mm = {thickness}\ncut_mm = {cut}\n\
             [[tests]]\nkind = \"{kind}\"\nprotocol = [{{ to_mm = {to}, rate_mm_per_s = 0.1 }}]\n\
             [mesh]\ndivisions = {size:?}\n[bulk]\nlaw = \"neo_hooke\"\nmu_MPa = {mu}\nbulk_modulus_MPa = 30.0\n\
             [interface]\ngc_N_per_mm = {gc}\nsigma_c_MPa = 0.04\n[solver]\nstep_mm = 0.05\ncontrol = \"{control}\"\n"
        )
    };
    let torn = run(&sheet("pure_shear", cut, 4.0, "path"));
    // While the front is far from both edges the displacement stands.
    let far = |x: f64| x > cut + 2.0 * h0 && x < width - 3.0 * h0;
    let steady: Vec<f64> =
        torn.tear_front.iter().zip(&torn.displacement).filter(|(x, _)| far(**x)).map(|(_, u)| *u).collect();
    let mean = steady.iter().sum::<f64>() / steady.len() as f64;
    // Energy of the intact sheet between its clamps at that displacement; the edges free a little: wide against narrow.
    let work = |wide: f64| {
        let text =
            sheet("uniaxial", 0.0, mean, "actuator").replace("width_mm = 24", &format!("width_mm = {wide}"));
        let t = run(&text);
        (1..t.force.len())
            .map(|i| 0.5 * (t.force[i] + t.force[i - 1]) * (t.displacement[i] - t.displacement[i - 1]))
            .sum::<f64>()
    };
    // The same number of elements: sizes differ between the two, which a homogeneous middle does not see.
    let per_length = (work(24.0) - work(12.0)) / 12.0;
    let spread = steady.iter().fold(0.0f64, |m, u| m.max((u / mean - 1.0).abs()));
    println!(
        "u = {mean:.4} mm, ± {spread:.4}, over {} steps, W h0 = {:.6}",
        steady.len(),
        per_length / thickness
    );
    per_length / thickness / gc
}

#[test]
fn a_running_tear_gives_free_the_energy_ahead_of_it() {
    let found = ratio([96, 8, 1]);
    println!("Gc by W h0 over Gc: {found:.4}");
    assert!((found - 1.0).abs() < 0.01, "{found}");
}
