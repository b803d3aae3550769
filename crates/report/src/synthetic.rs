//! Synthetic records: a simulation with noise, as files that every command reads.

use crate::ReportError;
use crate::answer::{SimulateAnswer, TestCurve};
use crate::curves::table;
use input::{Case, resolved_toml};
use inverse::Random;

/// A file of a synthetic specimen: name and content.
pub type SyntheticFile = (String, Vec<u8>);

/// Records with Gaussian noise, `share` of each test's peak force, and the specimen file.
///
/// # Errors
/// If a row cannot be written.
pub fn synthetic_files(
    case: &Case,
    answer: &SimulateAnswer,
    share: f64,
    seed: u64,
) -> Result<Vec<SyntheticFile>, ReportError> {
    let mut random = Random::new(seed);
    let mut out = Vec::new();
    for test in &case.tests {
        if let Some(curve) = answer.tests.get(&test.name).filter(|c| c.time_s.len() > 1) {
            out.push((format!("{}.csv", test.name), record(curve, share, &mut random)?));
        }
    }
    out.push(("specimen.toml".into(), specimen(case, answer, share, seed).into_bytes()));
    Ok(out)
}

/// A record: time must grow, so of two answers at one time (a jump) the later one stands.
fn record(curve: &TestCurve, share: f64, random: &mut Random) -> Result<Vec<u8>, ReportError> {
    let n = curve.time_s.len();
    let mut with_noise = |forces: &[f64]| -> Vec<f64> {
        let peak = peak(forces);
        forces.iter().map(|f| f + share * peak * random.normal()).collect()
    };
    let mut names = vec!["time_s", "displacement_mm", "force_N"];
    let mut columns = vec![curve.time_s.clone(), curve.displacement_mm.clone(), with_noise(&curve.force_N)];
    if !curve.force_x_N.is_empty() {
        names.extend(["displacement_x_mm", "force_x_N"]);
        columns.extend([curve.displacement_x_mm.clone(), with_noise(&curve.force_x_N)]);
    }
    let rows = (0..n).filter(|&i| i + 1 == n || curve.time_s[i + 1] > curve.time_s[i] + 1e-9);
    table(
        names.into_iter().map(str::to_owned).collect(),
        rows.map(|i| columns.iter().map(|c| neat(c[i])).collect::<Vec<_>>()),
    )
}

fn peak(forces: &[f64]) -> f64 {
    forces.iter().fold(0.0f64, |m, f| m.max(f.abs()))
}

/// Nine decimals: no instrument has more, and sums of steps keep their round numbers.
fn neat(x: f64) -> String {
    format!("{}", (x * 1e9).round() / 1e9)
}

/// The resolved specimen with records in place of protocols, and nothing of the model.
fn specimen(case: &Case, answer: &SimulateAnswer, share: f64, seed: u64) -> String {
    let version = env!("CARGO_PKG_VERSION");
    let noise = 100.0 * share;
    let mut bare = case.clone();
    bare.provenance = format!(
        "synthetic: computed by fct {version} from its own model, Gaussian noise of {noise} % of the peak force, seed {seed}"
    );
    for test in &mut bare.tests {
        test.record = None;
        test.protocol = None;
        // The noise is known here; a coarse record may be too short to estimate it from.
        let sd = |of: fn(&TestCurve) -> &Vec<f64>| {
            let sd = answer.tests.get(&test.name).map(|curve| share * peak(of(curve)));
            sd.filter(|sd| *sd > 0.0)
        };
        (test.force_sd, test.force_x_sd) = (sd(|c| &c.force_N), sd(|c| &c.force_x_N));
    }
    let whole = resolved_toml(&bare);
    let mut out = String::new();
    let mut test = bare.tests.iter();
    // What belongs to the specimen ends where the model begins.
    for line in whole.lines().take_while(|l| *l != "[mesh]") {
        out.push_str(line);
        out.push('\n');
        if line.starts_with("kind = ")
            && let Some(t) = test.next()
        {
            out.push_str(&format!("data = {:?}\n", format!("{}.csv", t.name)));
        }
    }
    out
}
