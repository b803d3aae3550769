//! Compares with the curves of two other programs (`../shared/peers`).
use fem::*;
use mesh::{Sizing, Strip};
use std::sync::Arc;

fn read(path: &str) -> Vec<(f64, f64)> {
    std::fs::read_to_string(path).unwrap().lines().skip(1).map(|l| {
        let v: Vec<f64> = l.split(',').take(3).map(|x| x.parse().unwrap()).collect();
        (v[1], v[2])
    }).collect()
}

fn problem(div: [usize; 3], tear: bool, quarter: bool) -> Problem {
    let strip = Strip { cut: 1.0, tear, sizing: Sizing::Divisions(div), half_height: quarter, half_thickness: quarter, ..Strip::new(10.0, 4.0, 1.0) };
    let mesh = mesh::strip(&strip).unwrap();
    let body = Body::of(&mesh);
    let mut supports = vec![None; 3 * body.nodes.len()];
    let fix = |n: usize, c: usize, p: f64, s: &mut Vec<Option<Prescribed>>| s[3 * n + c] = Some(Prescribed { grip: p, mount: 0.0 });
    for &n in mesh.set("top").unwrap() { for c in 0..3 { fix(n, c, if c == 1 { if quarter {0.5} else {1.0} } else { 0.0 }, &mut supports); } }
    if quarter {
        for &n in mesh.set("mid_thickness").unwrap() { fix(n, 2, 0.0, &mut supports); }
        if !tear { for &n in mesh.set("mid_height").unwrap() { fix(n, 1, 0.0, &mut supports); } }
    } else {
        for &n in mesh.set("bottom").unwrap() { for c in 0..3 { fix(n, c, 0.0, &mut supports); } }
    }
    let path = tear.then(|| Path {
        law: Arc::new(cohesive::Cohesive),
        rule: interface::Integration::Gauss,
        params: body.cohesive.iter().map(|_| std::array::from_fn(|_| (7..11).map(Blend::one).collect())).collect(),
        position: body.cohesive.iter().map(|_| [0.5; 4]).collect(),
    });
    Problem { body: Arc::new(body), supports: Arc::new(supports), multiplicity: if quarter { 4.0 } else { 1.0 },
        bulk: Arc::new(hgo::Hgo::default()), bulk_params: (0..7).collect(), path, train: vec![], takeup: vec![], shape: vec![], mount: vec![] }
}

fn theta(k: f64, sc: f64) -> Vec<f64> {
    let dc = 0.23 / (std::f64::consts::E * sc);
    vec![0.0051, 0.9388, 20.09, 38.53f64.to_radians(), 0.23, 2.0 / k, 0.0, 0.23, sc, 1.0, 10.0 * std::f64::consts::E * sc / dc]
}

fn run(name: &str, div: [usize; 3], tear: bool, k: f64, sc: f64, quarter: bool, follow: bool) {
    let data = read(&format!("/work/shared/peers/{name}.csv"));
    let p = problem(div, tear, quarter);
    let th = theta(k, sc);
    let mut sys = System::new(&p).unwrap();
    let targets: Vec<Target> = if follow { vec![Target::new(0.0, 0.0), Target::new(8.0, 160.0)] } else { data.iter().map(|d| Target::new(d.0, 1.0)).collect() };
    let t = std::time::Instant::now();
    let o = MarchOptions { ledger: true, follow_path: follow, ..Default::default() };
    let r = march(&p, &th, &mut sys, None, &targets, &mut [], &NoObserver, o, None, &|| false);
    let el = t.elapsed().as_secs_f64();
    let peak = data.iter().map(|d| d.1).fold(0.0, f64::max);
    let mut worst = 0.0f64;
    if !follow {
        for s in &r.steps { if let Some(t) = s.target { let e = (s.force - data[t].1).abs() / if tear { peak } else { data[t].1.max(1e-12) }; if data[t].1 > 0.0 { worst = worst.max(e); } } }
    }
    let last = r.steps.last().unwrap();
    println!("{name} quarter={quarter} unknowns={} steps={} it={} {el:.2}s worst={worst:.2e} work={:.5} gap={:.2e} jumps={:?} fail={:?}", sys.unknowns, r.steps.len(), r.iterations, last.ledger.external_work, last.ledger.gap() / last.ledger.external_work, r.jumps, r.failure);
    if follow {
        let us: Vec<f64> = r.steps.iter().map(|s| s.actuator).collect();
        for i in 1..us.len() - 1 { if (us[i] - us[i - 1]) * (us[i + 1] - us[i]) < 0.0 { println!("   turn at {:.4} F={:.4}", us[i], r.steps[i].force); } }
        println!("   peak {:.5} data peak {peak:.5}", r.steps.iter().map(|s| s.force).fold(0.0, f64::max));
    }
}

fn main() {
    run("tension_8x20x2_K1", [8, 20, 2], false, 1.0, 0.1, false, false);
    run("tension_8x20x2_K10", [8, 20, 2], false, 10.0, 0.1, false, false);
    run("tension_8x20x2_K10", [8, 20, 2], false, 10.0, 0.1, true, false);
    run("tension_20x50x4_K1", [20, 50, 4], false, 1.0, 0.1, false, false);
    run("tension_20x50x4_K10", [20, 50, 4], false, 10.0, 0.1, false, false);
    run("tear_8x20x2_K1_sc0.1", [8, 20, 2], true, 1.0, 0.1, true, false);
    run("tear_8x20x2_K1_sc0.1", [8, 20, 2], true, 1.0, 0.1, false, false);
    run("tear_8x20x2_K1_sc0.2_snapback", [8, 20, 2], true, 1.0, 0.2, true, true);
    run("tear_8x20x2_K1_sc0.2_snapback", [8, 20, 2], true, 1.0, 0.2, true, false);
}
