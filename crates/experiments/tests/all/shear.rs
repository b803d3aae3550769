//! Pure shear: a tear that runs at constant displacement gives free what the sheet ahead of it holds (Rivlin & Thomas
//! 1953): Gc = W h₀ + φ, with the energy φ of the interface ahead, which opens under the stress there.

use crate::common::run;

/// Distance of the clamps, width, thickness, cut, mm.
const SHEET: [f64; 4] = [4.0, 28.0, 0.2, 8.0];
/// Shear modulus and strength, MPa; toughness, N/mm.
const MU: f64 = 0.03;
const SIGMA_C: f64 = 0.04;
const GC: f64 = 0.01;

/// Displacement at which the tear runs, mm: the mean over its way far from both ends, and the largest departure.
fn steady(divisions: [usize; 3]) -> (f64, f64) {
    let [h0, width, thickness, cut] = SHEET;
    let test = run(&format!(
        "name = \"sheet\"\n[geometry]\nlength_mm = {h0}\nwidth_mm = {width}\nthickness_mm = {thickness}\ncut_mm = {cut}\n\
         [[tests]]\nkind = \"pure_shear\"\nprotocol = [{{ to_mm = 2.0, rate_mm_per_s = 0.1 }}]\n\
         [mesh]\ndivisions = {divisions:?}\n[bulk]\nlaw = \"neo_hooke\"\nmu_MPa = {MU}\nbulk_modulus_MPa = 30.0\n\
         [interface]\ngc_N_per_mm = {GC}\nsigma_c_MPa = {SIGMA_C}\n[solver]\nstep_mm = 0.05\ncontrol = \"path\"\n"
    ));
    let far = |x: f64| x > cut + h0 && x < width - 2.0 * h0;
    let rows: Vec<[f64; 2]> = test
        .tear_front
        .iter()
        .zip(&test.displacement)
        .filter(|(x, _)| far(**x))
        .map(|(x, u)| [*x, *u])
        .collect();
    assert!(rows.len() > 10, "{} steps while the front is far from both ends", rows.len());
    let way = rows[rows.len() - 1][0] - rows[0][0];
    let mean = rows.windows(2).map(|w| 0.5 * (w[0][1] + w[1][1]) * (w[1][0] - w[0][0])).sum::<f64>() / way;
    (mean, rows.iter().fold(0.0f64, |m, r| m.max((r[1] / mean - 1.0).abs())))
}

/// Energy per area of the torn path that the sheet ahead holds at a displacement, and W h₀ at the same as if the interface
/// did not open, N/mm: incompressible, no contraction along the clamps; P(λ) = T(δ), h₀ (λ − 1) + δ = u.
fn held(u: f64) -> [f64; 2] {
    let h0 = SHEET[0];
    let critical = GC / (std::f64::consts::E * SIGMA_C);
    let energy = |l: f64| h0 * 0.5 * MU * (l - 1.0 / l).powi(2);
    let excess = |x: f64| {
        let l = 1.0 + (u - x * critical) / h0;
        std::f64::consts::E * SIGMA_C * x * (-x).exp() - MU * (l - l.powi(-3))
    };
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if excess(middle) < 0.0 { low = middle } else { high = middle }
    }
    let x = 0.5 * (low + high);
    let interface = GC * (1.0 - (1.0 + x) * (-x).exp());
    [energy(1.0 + (u - x * critical) / h0) + interface, energy(1.0 + u / h0)]
}

#[test]
fn a_running_tear_gives_free_the_energy_ahead_of_it() {
    let (u, scatter) = steady([140, 12, 1]);
    let [whole, stiff] = held(u).map(|e| e / GC);
    println!("u = {u:.4} mm, ± {scatter:.4}: held ahead over Gc {whole:.4}; W h₀ of u over Gc {stiff:.4}");
    assert!((whole - 1.0).abs() < 0.015, "{whole}");
}
