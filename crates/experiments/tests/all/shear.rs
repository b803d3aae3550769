//! Pure shear: a tear that runs at constant displacement gives free what the sheet ahead of it holds (Rivlin & Thomas
//! 1953): Gc = W h₀ + φ, with the energy φ of the interface ahead, which opens under the stress there. W is that of an
//! intact sheet of the same bricks, wide against narrow: its clamps hold the thickness too, which no formula has.

use crate::common::run;

/// Distance of the clamps, width, thickness, cut, mm.
const SHEET: [f64; 4] = [4.0, 22.0, 0.2, 7.0];
/// Strength, MPa, and toughness, N/mm. The softening zone is 1 mm long, three bricks.
const SIGMA_C: f64 = 0.028;
const GC: f64 = 0.01;
const BRICKS: usize = 66;

fn text(kind: &str, bricks: usize, cut: f64, to: f64, rest: &str) -> String {
    let [h0, width, thickness, _] = SHEET;
    let width = width * bricks as f64 / BRICKS as f64;
    format!(
        "name = \"sheet\"\n[geometry]\nlength_mm = {h0}\nwidth_mm = {width}\nthickness_mm = {thickness}\ncut_mm = {cut}\n\
         [[tests]]\nkind = \"{kind}\"\nprotocol = [{{ to_mm = {to}, rate_mm_per_s = 0.1 }}]\n\
         [mesh]\ndivisions = [{bricks}, 8, 1]\n[bulk]\nlaw = \"neo_hooke\"\nmu_MPa = 0.03\nbulk_modulus_MPa = 30.0\n\
         {rest}\n[solver]\nstep_mm = 0.05\n"
    )
}

/// Displacement at which the tear runs, mm: the mean over its way far from both ends, and the largest departure.
fn steady() -> (f64, f64) {
    let [h0, width, _, cut] = SHEET;
    let interface = format!("[interface]\ngc_N_per_mm = {GC}\nsigma_c_MPa = {SIGMA_C}");
    let test = run(&(text("pure_shear", BRICKS, cut, 1.4, &interface) + "control = \"path\"\n"));
    let far = |x: f64| x > cut + h0 && x < width - 2.0 * h0;
    let all = test.tear_front.iter().copied().zip(test.displacement.iter().copied());
    let rows: Vec<(f64, f64)> = all.filter(|(x, _)| far(*x)).collect();
    assert!(rows.len() > 10, "{} steps while the front is far from both ends", rows.len());
    let way = rows[rows.len() - 1].0 - rows[0].0;
    let mean = rows.windows(2).map(|w| 0.5 * (w[0].1 + w[1].1) * (w[1].0 - w[0].0)).sum::<f64>() / way;
    (mean, rows.iter().fold(0.0f64, |m, r| m.max((r.1 / mean - 1.0).abs())))
}

/// Rows (displacement, nominal stress, energy per area of the path) of a sheet that goes on for ever.
fn ahead() -> Vec<[f64; 3]> {
    let of = |bricks: usize| run(&text("uniaxial", bricks, 0.0, 1.2, ""));
    let (wide, narrow) = (of(BRICKS), of(BRICKS / 2));
    let area = 0.5 * SHEET[1] * SHEET[2];
    let mut rows = vec![[0.0; 3]];
    for k in 1..wide.force.len() {
        let (u, stress) = (wide.displacement[k], (wide.force[k] - narrow.force[k]) / area);
        let last = rows[k - 1];
        rows.push([u, stress, last[2] + 0.5 * (stress + last[1]) * (u - last[0])]);
    }
    rows
}

/// Stress and energy at a displacement.
fn at(rows: &[[f64; 3]], u: f64) -> [f64; 2] {
    let k = rows.partition_point(|r| r[0] < u).clamp(1, rows.len() - 1);
    let share = (u - rows[k - 1][0]) / (rows[k][0] - rows[k - 1][0]);
    [1, 2].map(|c| rows[k - 1][c] + share * (rows[k][c] - rows[k - 1][c]))
}

/// Energy per area of the path that sheet and interface hold at a displacement, exponential law, P(u − δ) = T(δ).
fn held(rows: &[[f64; 3]], u: f64) -> f64 {
    let critical = GC / (std::f64::consts::E * SIGMA_C);
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..60 {
        let x: f64 = 0.5 * (low + high);
        let traction = std::f64::consts::E * SIGMA_C * x * (-x).exp();
        if traction < at(rows, u - x * critical)[0] { low = x } else { high = x }
    }
    at(rows, u - low * critical)[1] + GC * (1.0 - (1.0 + low) * (-low).exp())
}

#[test]
fn a_running_tear_gives_free_the_energy_ahead_of_it() {
    let ((u, scatter), rows) = (steady(), ahead());
    let [whole, plain] = [held(&rows, u), at(&rows, u)[1]].map(|e| e / GC);
    println!("u = {u:.4} mm, ± {scatter:.4}: held ahead {whole:.4} Gc; W h₀ of the whole u {plain:.4} Gc");
    assert!((whole - 1.0).abs() < 0.01, "{whole}");
    assert!(scatter < 0.01, "{scatter}");
}
