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

/// Powers whose sizes are repeated.
const WANTED: [f64; 2] = [0.5, 0.8];
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

/// Repeats of an effect at the tried sizes whose powers are nearest to the wanted ones.
fn repeated(full: &Full, f: &Foreseen, asked: &Confirmed, wanted: &[f64], draws: usize) -> Vec<Repeated> {
    let nearest = |p: &f64| {
        let far = |t: &&(f64, f64)| (t.1 - p).abs();
        asked.tried.iter().min_by(|a, b| far(a).total_cmp(&far(b))).copied()
    };
    let of = |(size, promised): (f64, f64)| {
        let [ruled, called] = calls(full, f, asked, size, draws).expect("runs");
        Repeated { effect: f.effect.clone(), size: size / f.plausible, promised, draws, ruled, called }
    };
    wanted.iter().filter_map(nearest).map(of).collect()
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

fn print(r: &Repeated, f: &Foreseen, asked: &Confirmed) {
    println!(
        "| {} | {:.0} % | {:.0} % | {:.3} | {:.0} % | {} | {} of {} |",
        r.effect,
        100.0 * f.power,
        100.0 * asked.power,
        r.size,
        100.0 * r.promised,
        r.ruled,
        r.called,
        r.draws
    );
}

/// Share by which repeats differ from the promise's rule, over all sizes of an effect.
fn difference(of: &[Repeated]) -> f64 {
    let sum = |count: fn(&Repeated) -> usize| of.iter().map(count).sum::<usize>() as f64;
    (sum(|r| r.called) - sum(|r| r.ruled)) / sum(|r| r.draws)
}

#[test]
fn noisy_repeats_confirm_the_promised_power() {
    with_proposal(|full, _| {
        let foreseen = full.foreseen().expect("a foresight");
        let f = foreseen.iter().find(|f| f.effect == "mullins").expect("in the catalogue");
        let asked = full.confirmed(f).expect("asked");
        let of = repeated(full, f, &asked, &WANTED[..1], 20);
        of.iter().for_each(|r| print(r, f, &asked));
        let [r] = of.as_slice() else { panic!("one size, not {}", of.len()) };
        assert!((0.4..0.6).contains(&r.promised), "no size has a power near one half: {:?}", asked.tried);
        assert!(difference(&of).abs() <= WITHIN, "{} and {} of {}", r.ruled, r.called, r.draws);
    });
}

/// `just design-power`
#[test]
#[ignore = "many repeats: minutes"]
fn noisy_repeats_of_many_effects() {
    let names =
        ["viscoelastic", "mullins", "compliance", "slack", "grip_slip", "drift", "bridging", "prestretch"];
    println!("| effect | linear, plausible | full, plausible | size | promised | its rule | repeats |");
    let differences = with_proposal(|full, _| {
        let foreseen = full.foreseen().expect("a foresight");
        let mut out = Vec::new();
        for f in foreseen.iter().filter(|f| names.contains(&f.effect.as_str())) {
            let asked = full.confirmed(f).expect("asked");
            let of = repeated(full, f, &asked, &WANTED, 50);
            of.iter().for_each(|r| print(r, f, &asked));
            out.push((f.effect.clone(), asked.not, difference(&of)));
        }
        out
    });
    assert_eq!(differences.len(), names.len());
    for (effect, not, d) in &differences {
        println!("{effect}: {:+.0} points {}", 100.0 * d, not.as_deref().unwrap_or_default());
    }
    for (effect, _, d) in &differences {
        assert!(d.abs() <= WITHIN, "{effect}: {d:+.2}");
    }
}

/// Without an effect: the parameters scatter as the proposal says, and the screen calls hardly anything.
#[test]
#[ignore = "many repeats: minutes"]
fn noisy_repeats_scatter_as_promised() {
    with_proposal(|full, answer| {
        let draws = 60;
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
            println!("| {} | {:.1} % | {:.1} % |", known.path, 100.0 * promised, 100.0 * found);
        }
    });
}
