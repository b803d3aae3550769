//! From a file to a model that can run: no number in a config, however silly, may bring the way down. It ends in a
//! message or in a model, soon, and in little memory. `FCT_CASES` sets how many files are tried.

use model::cost::{Cost, Purpose};
use model::{Discretisation, Model};
use proptest::prelude::*;
use std::fs;
use std::sync::Arc;
use std::time::{Duration, Instant};

const CONFIG: &str = r#"
name = "strip"
[geometry]
length_mm = 4.0
width_mm = 3.0
thickness_mm = 0.8
cut_mm = 1.0
outline_mm = [[0.0, 0.0, 3.0], [2.0, 0.1, 2.9], [4.0, 0.0, 3.0]]
[[tests]]
kind = "uniaxial"
protocol = [{ to_mm = 0.5, rate_mm_per_s = 0.05 }, { hold_s = 30.0 }, { to_mm = 0.0, rate_mm_per_s = 0.5 }]
[[tests]]
kind = "tearing"
protocol = [{ to_mm = 1.0, rate_mm_per_s = 0.05 }]
[mesh]
bulk_size_mm = 0.8
path_size_mm = 0.3
layers = 2
[bulk]
mu_kPa = 6.0
k1_kPa = 700.0
k2 = 15.0
gamma_deg = 42.0
kappa = 0.22
bulk_modulus_MPa = 20.0
[interface]
areas = 3
gc_N_per_mm = [0.1, 0.2, 0.15]
sigma_c_MPa = 0.08
[solver]
step_mm = 0.1
[effects.viscoelastic]
g = 0.2
tau_s = 10.0
[effects.compliance]
c_mm_per_N = 0.05
[effects.misalignment]
theta_deg = 1.0
"#;

/// Numbers that nobody means, and some that somebody may.
const SILLY: &[&str] = &[
    "0",
    "0.0",
    "-0.0",
    "-1",
    "1",
    "2",
    "1e-308",
    "1e-12",
    "0.5",
    "0.999999999",
    "1e3",
    "1e9",
    "1e308",
    "-1e308",
    "inf",
    "-inf",
    "nan",
    "9223372036854775807",
    "-9223372036854775808",
    "100000",
    "4.9e-324",
    "90.0",
    "1e-3",
    "[]",
    "[1, 2]",
    "\"a\"",
    "true",
];

/// Byte ranges of the numbers in the config.
fn numbers() -> Vec<std::ops::Range<usize>> {
    let mut out: Vec<std::ops::Range<usize>> = Vec::new();
    let bytes = CONFIG.as_bytes();
    let number = |b: u8| b.is_ascii_digit() || b == b'.';
    let mut at = 0;
    while at < bytes.len() {
        let end = at + bytes[at..].iter().take_while(|b| number(**b)).count();
        if end > at && matches!(bytes[at - 1], b' ' | b'[') {
            out.push(at..end);
        }
        at = end.max(at + 1);
    }
    out
}

/// The config with some numbers replaced.
fn spoiled() -> impl Strategy<Value = String> {
    let sites = numbers();
    let one = (0..sites.len(), 0..SILLY.len(), -3.0..3.0_f64, any::<bool>());
    proptest::collection::vec(one, 1..4).prop_map(move |mut changes| {
        changes.sort_by_key(|c| std::cmp::Reverse(c.0));
        changes.dedup_by_key(|c| c.0);
        let mut text = CONFIG.to_owned();
        for (site, silly, power, scale) in changes {
            let old: f64 = CONFIG[sites[site].clone()].parse().unwrap_or(1.0);
            let new = if scale { format!("{:?}", old * 10_f64.powf(power)) } else { SILLY[silly].to_owned() };
            text.replace_range(sites[site].clone(), &new);
        }
        text
    })
}

/// The model of a file and the memory that a run of it is said to need, bytes; or what is said instead.
fn model_of(text: &str) -> Result<(Model, f64), String> {
    thread_local! {
        static FOLDER: tempfile::TempDir = tempfile::tempdir().expect("a folder");
    }
    let catalogue = effects::catalogue();
    let case = FOLDER.with(|folder| {
        let path = folder.path().join("s.toml");
        fs::write(&path, text).expect("written");
        input::read_case(&path, &catalogue).map_err(|e| e.to_string())
    })?;
    let case = Arc::new(case);
    let (how, purpose) = (Discretisation::default(), Purpose::Simulation);
    let model = Model::checked(case.clone(), &catalogue, how, purpose).map_err(|e| e.to_string())?;
    let cost = Cost::of(&case, &catalogue, how).map_err(|e| e.to_string())?;
    Ok((model, cost.need(purpose).bytes))
}

/// Lets the peak of the memory begin anew; whether the system can.
fn forget_peak() -> bool {
    fs::write("/proc/self/clear_refs", "5").is_ok()
}

/// Largest resident memory of this process since [`forget_peak`], bytes; `None` where the system does not tell.
fn peak_memory() -> Option<u64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|l| l.strip_prefix("VmHWM:"))?;
    Some(1024 * line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()?)
}

fn cases() -> u32 {
    std::env::var("FCT_CASES").ok().and_then(|n| n.parse().ok()).unwrap_or(300)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: cases(), ..ProptestConfig::default() })]

    #[test]
    fn silly_numbers_end_in_a_message_or_a_model(text in spoiled()) {
        let started = Instant::now();
        let since = forget_peak();
        let mut most = 1e9;
        match model_of(&text) {
            Ok((model, need)) => {
                most = f64::max(most, need);
                let theta = model.theta();
                prop_assert!(theta.iter().all(|v| v.is_finite()), "{theta:?}");
            }
            Err(why) => prop_assert!(!why.is_empty() && why.lines().count() < 300, "{why}"),
        }
        prop_assert!(started.elapsed() < Duration::from_secs(20), "{:?}", started.elapsed());
        if let Some(bytes) = peak_memory().filter(|_| since) {
            prop_assert!((bytes as f64) < most, "{bytes} bytes, {most:.1e} expected at most");
        }
    }
}

#[test]
fn what_is_spoiled_here_is_right_before() {
    assert!(numbers().len() > 25);
    assert!(model_of(CONFIG).is_ok(), "{:?}", model_of(CONFIG).err());
}
