//! The answer does not depend on how many rows a record has, nor on the noise of its displacement.

// Records are of its own.
#[allow(dead_code)]
use crate::small;

use analysis::{Control, Identified, SimulateControl, identify, simulate};
use cpu_time::ProcessTime;
use input::Case;
use inverse::Random;
use std::fmt::Write as _;
use std::path::Path;
use std::sync::Arc;

const MODEL: &str = r#"
[mesh]
divisions = [5, 8, 1]
[bulk]
mu_kPa = 20.0
k1_kPa = 400.0
k2 = { value = 2.0, fixed = true }
gamma_deg = { value = 40.0, fixed = true }
kappa = { value = 0.2, fixed = true }
[interface]
gc_N_per_mm = 0.05
sigma_c_MPa = 0.1
"#;
const PULL: &str =
    "{ to_mm = 0.7, rate_mm_per_s = 0.05 }, { hold_s = 30.0 }, { to_mm = 0.3, rate_mm_per_s = 0.05 }";

fn read(folder: &Path, text: &str) -> Case {
    let file = folder.join("case.toml");
    std::fs::write(&file, text).expect("written");
    input::read_case(&file, &effects::catalogue()).unwrap_or_else(|e| panic!("{e}"))
}

/// Answers of the model: time, displacement and force of both tests.
fn truth(folder: &Path) -> Vec<Vec<[f64; 3]>> {
    let strip = small::STRIP
        .replace(
            "data = \"uniaxial.csv\"",
            &format!("protocol = [{PULL}, {{ to_mm = 1.0, rate_mm_per_s = 0.05 }}]"),
        )
        .replace(
            "data = \"tearing.csv\"",
            &format!("protocol = [{PULL}, {{ to_mm = 2.0, rate_mm_per_s = 0.05 }}]"),
        );
    let case = read(folder, &format!("{strip}{MODEL}[solver]\nstep_mm = 0.01\n"));
    let control = SimulateControl { progress: &|_, _| {}, cancelled: &|| false };
    let run = simulate(Arc::new(case), &effects::catalogue(), &control).expect("a run");
    let rows = |t: &analysis::SimulatedTest| {
        // What the solver needed besides has no time of its own.
        let asked = |i: &usize| t.run.steps[*i].target.is_some();
        (0..t.time.len()).filter(asked).map(|i| [t.time[i], t.displacement[i], t.force[i]]).collect()
    };
    run.tests.iter().map(rows).collect()
}

/// A record of the truth with `n` rows, errors of the force that 400 rows would have, noise of the displacement, mm.
fn write(file: &Path, truth: &[[f64; 3]], n: usize, jitter: f64, sd: f64) {
    let at = |list: &[[f64; 3]], t: f64| {
        let i = list.partition_point(|r| r[0] < t).clamp(1, list.len() - 1);
        let (a, b) = (list[i - 1], list[i]);
        let s = ((t - a[0]) / (b[0] - a[0])).clamp(0.0, 1.0);
        [a[1] + s * (b[1] - a[1]), a[2] + s * (b[2] - a[2])]
    };
    let end = truth[truth.len() - 1][0];
    let mut random = Random::new(8);
    let errors: Vec<[f64; 3]> =
        (0..400).map(|i| [end * f64::from(i) / 399.0, 0.0, sd * random.normal()]).collect();
    let mut csv = String::from("time_s,displacement_mm,force_N\n");
    for i in 0..n {
        let t = end * i as f64 / (n - 1) as f64;
        let [u, f] = at(truth, t);
        let shake = if i == 0 { 0.0 } else { jitter * random.normal() };
        let _ = writeln!(csv, "{t:.9},{:.9},{:.9}", u + shake, f + at(&errors, t)[1]);
    }
    std::fs::write(file, csv).expect("written");
}

fn identified(folder: &Path, truth: &[Vec<[f64; 3]>], n: usize, jitter: f64) -> Identified {
    for (rows, file) in truth.iter().zip(["uniaxial.csv", "tearing.csv"]) {
        write(&folder.join(file), rows, n, jitter, 0.001);
    }
    let strip = small::STRIP.replace("force_sd_N = 0.001", "");
    let clock = ProcessTime::now();
    let case = Arc::new(read(folder, &format!("{strip}{MODEL}")));
    let reading = clock.elapsed().as_secs_f64();
    let control = Control { progress: &|_| {}, cancelled: &|| false, journal: &analysis::NoJournal };
    let found = identify(case, &effects::catalogue(), &control).unwrap_or_else(|e| panic!("{n} rows: {e}"));
    let all = clock.elapsed().as_secs_f64();
    println!(
        "{n} rows, jitter {jitter}: {all:.2} CPU s, {reading:.2} of them to read; {} runs",
        found.forward_runs
    );
    found
}

/// The same values, about the same intervals, no more runs and steps.
fn same(clean: &Identified, long: &Identified, what: &str) {
    for (a, b) in clean.measured.data.blocks.iter().zip(&long.measured.data.blocks) {
        let n = |b: &inverse::Block| format!("sd {:.2e}, correlation {:.2}", b.noise.sd, b.noise.ar1);
        println!("{what} {}: {} points, {}; clean {}, {}", a.name, b.range.len(), n(b), a.range.len(), n(a));
    }
    for (a, b) in clean.uncertainty.estimates.iter().zip(&long.uncertainty.estimates) {
        let width = a.interval_95[1] - a.interval_95[0];
        let shift = (a.value - b.value).abs() / width;
        println!("{what} {}: {} {}, shift {shift:.3} of the interval", a.path, a.value, b.value);
        assert!(shift < 0.1, "{what} {}", a.path);
        let ratio = (b.interval_95[1] - b.interval_95[0]) / width;
        println!("{what} {}: intervals {ratio:.2} of the clean", a.path);
        assert!((0.8..1.25).contains(&ratio), "{what} {}: {ratio}", a.path);
    }
    let runs = |i: &Identified| i.forward_runs as f64;
    assert!(runs(long) < 1.6 * runs(clean) + 8.0, "{what}: {} runs for {}", runs(long), runs(clean));
    let points = |i: &Identified| i.measured.data.points();
    assert!(points(long) < 1200, "{what}: {} points", points(long));
    let targets = |i: &Identified, t: usize| i.model.plan(t, &i.options).targets.len();
    for t in 0..2 {
        assert!(
            targets(long, t).abs_diff(targets(clean, t)) <= 3,
            "{what}: {} steps for {}",
            targets(long, t),
            targets(clean, t)
        );
    }
}

#[test]
#[ignore = "slow: run by `just slow`"]
fn rows_and_jitter_change_neither_values_nor_cost() {
    let folder = tempfile::tempdir().expect("a folder");
    let truth = truth(folder.path());
    let clean = identified(folder.path(), &truth, 400, 0.0);
    for (n, jitter) in [(400, 2e-4), (20_000, 2e-4)] {
        let long = identified(folder.path(), &truth, n, jitter);
        same(&clean, &long, &format!("{n} rows, jitter {jitter} mm"));
    }
}

/// `just long-records`
#[test]
#[ignore = "long records, about a minute: run by `just long-records`"]
fn twenty_thousand_to_a_million_rows() {
    let folder = tempfile::tempdir().expect("a folder");
    let truth = truth(folder.path());
    let clean = identified(folder.path(), &truth, 400, 0.0);
    for n in [20_000, 200_000, 1_000_000] {
        let long = identified(folder.path(), &truth, n, 2e-4);
        same(&clean, &long, &format!("{n} rows"));
    }
}
