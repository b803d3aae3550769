//! The power that a design promises is the share of noisy records on which the screen calls the effect.
//!
//! A repeat has nothing of the promise but its size: noise is drawn on the record that the effect makes, the base is
//! fitted to the sum, the columns of the catalogue are computed where that fit ends, and the screen decides. The promise
//! takes the columns and the misfit of the fit without noise; asked of the same draws, it errs by what that leaves out,
//! and luck in the draws does not count.

use super::engine::LOOK;
use super::full::{Confirmed, Full};
use super::table::Table;
use super::{DesignAnswer, DesignRequest, design};
use crate::identify::AnalysisError;
use diagnose::tails::{normal_isf, normal_sf};
use diagnose::{Foreseen, Policy, Screen};
use input::Case;
use inverse::Random;
use std::sync::Arc;

/// The strip of the paper's third specimen with the means of its tables; a mesh as coarse as the tear admits.
const STRIP: &str = r#"
name = "FCT3"
[geometry]
length_mm = 10.0
width_mm = 5.0
thickness_mm = 0.7
cut_mm = 0.8
[[tests]]
kind = "uniaxial"
protocol = [{ to_mm = 1.0, rate_mm_per_s = 0.05 }]
[[tests]]
kind = "tearing"
protocol = [{ to_mm = 3.4, rate_mm_per_s = 0.05 }]
[mesh]
divisions = [5, 8, 1]
[bulk]
mu_kPa = 5.1
k1_kPa = 938.8
k2 = 20.09
gamma_deg = 38.53
kappa = 0.23
[interface]
gc_N_per_mm = 0.104
sigma_c_MPa = 0.067
"#;

/// Power whose size is repeated: there a promise has most to lose.
const WANTED: f64 = 0.5;
/// Largest difference of a promise from its repeats.
const WITHIN: f64 = 0.1;

/// A promise, and how many of as many draws were called: by its own rule, and by a repeat.
struct Repeated {
    effect: String,
    /// As a share of the plausible size.
    size: f64,
    promised: f64,
    draws: usize,
    ruled: usize,
    called: usize,
}

/// Hands the full model in the protocol that `design` proposes for the strip, and what was proposed.
fn with_proposal<T>(then: impl Fn(&Full, &DesignAnswer) -> T) -> T {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("c.toml");
    std::fs::write(&file, STRIP).expect("written");
    let catalogue = effects::catalogue();
    let case: Arc<Case> = Arc::new(input::read_case(&file, &catalogue).expect("a good file"));
    let request = DesignRequest { budget_s: 1800.0, ..DesignRequest::default() };
    let answer = design(&case, &catalogue, &request, &|_| {}, &|| false).expect("a design");
    let proposed = &answer.protocols[0];
    println!("proposed: {} ({:.0} s)", proposed.words, proposed.seconds);
    let go = || false;
    let table = Table { case, catalogue: &catalogue, cancelled: &go, policy: Policy::default(), steps: LOOK };
    let legs: Vec<_> = proposed.protocols.iter().map(|p| p.1.clone()).collect();
    let noise: Vec<f64> = answer.noise_n.iter().map(|n| n.1).collect();
    then(&Full::new(&table, &legs, &noise).expect("a look"), &answer)
}

/// Repeats of an effect at the tried size whose power is nearest to one half.
fn repeated(full: &Full, f: &Foreseen, asked: &Confirmed, draws: usize) -> Option<Repeated> {
    let far = |t: &&(f64, f64)| (t.1 - WANTED).abs();
    let (size, promised) = asked.tried.iter().min_by(|a, b| far(a).total_cmp(&far(b))).copied()?;
    let [ruled, called] = calls(full, f, asked, size, draws).expect("runs");
    Some(Repeated { effect: f.effect.clone(), size: size / f.plausible, promised, draws, ruled, called })
}

/// How many draws are called by the promise's rule, and by repeats.
fn calls(
    full: &Full,
    f: &Foreseen,
    asked: &Confirmed,
    size: f64,
    draws: usize,
) -> Result<[usize; 2], AnalysisError> {
    let truth = full.truth(f, size)?;
    let noiseless = full.refitted(&truth, &full.starts(&asked.fitted, size))?;
    let start = [noiseless.base().1.to_vec()];
    let calls = |s: &Screen| usize::from(s.finding(&f.effect).is_some_and(|f| f.significant));
    let mut random = Random::new(31);
    let mut out = [0; 2];
    for _ in 0..draws {
        let record = &truth + full.noise(&mut random);
        out[0] += calls(&noiseless.with_record(&record).screened()?);
        out[1] += calls(&full.refitted(&record, &start)?.screened()?);
    }
    Ok(out)
}

/// Power of the linear look at a share of the plausible size.
fn linear(f: &Foreseen, share: f64) -> f64 {
    let critical = f.least.map_or(f64::INFINITY, |least| f.snr * least / f.plausible + normal_isf(0.9));
    normal_sf(critical - share * f.snr)
}

fn print(r: &Repeated, f: &Foreseen, asked: &Confirmed) {
    let percent = |p: f64| format!("{:.0} %", 100.0 * p);
    let plausible = [f.power, asked.power].map(percent).join(" | ");
    let at_size = [linear(f, r.size), r.promised].map(percent).join(" | ");
    println!(
        "| {} | {plausible} | {:.3} | {at_size} | {} | {} of {} |",
        r.effect, r.size, r.ruled, r.called, r.draws
    );
}

/// Share of the draws by which repeats differ from the promise's rule.
fn difference(r: &Repeated) -> f64 {
    (r.called as f64 - r.ruled as f64) / r.draws as f64
}

#[test]
#[ignore = "slow: run by `just slow`"]
fn noisy_repeats_confirm_the_promised_power() {
    with_proposal(|full, _| {
        let foreseen = full.foreseen().expect("a foresight");
        let f = foreseen.iter().find(|f| f.effect == "mullins").expect("in the catalogue");
        let asked = full.confirmed(f).expect("asked");
        let r = repeated(full, f, &asked, 20).expect("a size");
        print(&r, f, &asked);
        assert!((0.4..0.6).contains(&r.promised), "no size has a power near one half: {:?}", asked.tried);
        assert!(difference(&r).abs() <= WITHIN, "{} and {} of {}", r.ruled, r.called, r.draws);
    });
}

/// How many draws: `FCT_REPEATS`, or thirty.
fn draws() -> usize {
    std::env::var("FCT_REPEATS").ok().and_then(|n| n.parse().ok()).unwrap_or(30)
}

/// `just design-power`
#[test]
#[ignore = "many repeats, minutes: run by `just design-power`"]
fn noisy_repeats_of_many_effects() {
    let names =
        ["viscoelastic", "mullins", "compliance", "slack", "grip_slip", "drift", "bridging", "prestretch"];
    println!(
        "| effect | linear, plausible | full, plausible | size | linear | promised | its rule | repeats |"
    );
    let repeats = with_proposal(|full, _| {
        let foreseen = full.foreseen().expect("a foresight");
        let mut out = Vec::new();
        for f in foreseen.iter().filter(|f| names.contains(&f.effect.as_str())) {
            let asked = full.confirmed(f).expect("asked");
            let r = repeated(full, f, &asked, draws());
            r.iter().for_each(|r| print(r, f, &asked));
            asked.not.iter().for_each(|why| println!("{}: {why}", f.effect));
            out.extend(r);
        }
        out
    });
    assert_eq!(repeats.len(), names.len());
    for r in &repeats {
        assert!(difference(r).abs() <= WITHIN, "{}: {:+.2}", r.effect, difference(r));
    }
}

/// Without an effect: the parameters scatter as the proposal says, and the screen calls hardly anything.
#[test]
#[ignore = "many repeats, minutes: run by `just design-power`"]
fn noisy_repeats_scatter_as_promised() {
    with_proposal(|full, answer| {
        let draws = draws();
        let (truth, start) = full.without();
        let mut random = Random::new(32);
        let mut fits = Vec::new();
        let mut called = 0;
        for _ in 0..draws {
            let fit = full
                .refitted(&(&truth + full.noise(&mut random)), std::slice::from_ref(&start))
                .expect("a fit");
            called += usize::from(fit.screened().expect("a screen").findings.iter().any(|f| f.significant));
            fits.push(fit.base().1.to_vec());
        }
        println!("something is called in {called} of {draws}");
        assert!(called <= draws / 10, "{called} of {draws}");
        println!("| parameter | promised | scatter |");
        for (k, known) in answer.protocols[0].force.parameters.iter().enumerate() {
            let mean = fits.iter().map(|t| t[k]).sum::<f64>() / draws as f64;
            let square = fits.iter().map(|t| (t[k] - mean).powi(2)).sum::<f64>() / (draws - 1) as f64;
            let (promised, found) = (known.relative_error, square.sqrt() / known.value);
            println!("| {} | {:.2} % | {:.2} % |", known.path, 100.0 * promised, 100.0 * found);
            // Thirty draws tell a scatter to 13 %.
            assert!((0.6..1.4).contains(&(found / promised)), "{}: {promised}, {found}", known.path);
        }
    });
}
