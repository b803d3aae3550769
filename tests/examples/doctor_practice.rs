//! What the doctor promises of the practice records, beside what the search then found. The doctor speaks of a plausible
//! size; where the truth's parameter is the effect's own amplitude, it is asked about the size that is in the record:
//! `cargo run --release -p workspace-tests --example doctor_practice -- ../shared/practice`
//!
//! Truths are those of each case's `truth.json`, answers of the search those of the table in docs/verification.md.

use analysis::doctor;
use diagnose::{Policy, Shown};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::sync::Arc;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = std::env::args().nth(1).ok_or("name the folder of the practice records")?;
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/verification.md");
    let answers = std::fs::read_to_string(docs)?;
    let (_, answers) = answers.split_once("## Practice records").ok_or("no table of answers")?;
    let mut cases: Vec<PathBuf> =
        std::fs::read_dir(&folder)?.filter_map(|e| e.ok()).map(|e| e.path()).filter(|p| p.is_dir()).collect();
    cases.sort();
    println!("| case | truth's signal | doctor: plausible size | size of the truth | says | `discover` |");
    println!("|---|---|---|---|---|---|");
    let mut apart = 0;
    for case in cases {
        let row = Row::of(&case, answers)?;
        println!("{}", row.line());
        apart += usize::from(!row.agrees());
    }
    println!("\n{apart} disagree");
    Ok(())
}

/// One case.
struct Row {
    name: String,
    effect: Option<String>,
    /// What no base parameter imitates over the noise, by the program that made the records.
    signal: Option<f64>,
    /// The doctor's signal at a plausible size; at the truth's, where that is known in its terms; and its word there.
    doctor: Option<(f64, Option<f64>, Shown)>,
    /// What the search answered.
    answer: String,
}

impl Row {
    fn of(case: &Path, answers: &str) -> Result<Self, Box<dyn std::error::Error>> {
        let truth: Value = serde_json::from_str(&std::fs::read_to_string(case.join("truth.json"))?)?;
        let name = truth["name"].as_str().unwrap_or_default().trim_start_matches("practice-").to_owned();
        let effect = truth["effects"][0].as_str().filter(|e| *e != "none").map(str::to_owned);
        let catalogue = effects::catalogue();
        let read = Arc::new(input::read_case(&case.join("config.toml"), &catalogue)?);
        let shows = doctor(&read, &catalogue, true, &|| false);
        let foresight = shows.shows.ok_or_else(|| shows.shows_not.unwrap_or_default())?;
        let found = effect.as_ref().and_then(|e| foresight.effects.iter().find(|f| f.effect == *e));
        let number = format!("| {} ", &name[..2]);
        let answer = answers.lines().find(|l| l.starts_with(&number)).and_then(|l| l.split(" | ").nth(2));
        Ok(Self {
            doctor: found.map(|f| {
                let own = amount(&truth, &f.effect).map(|a| f.snr * a / f.plausible);
                (f.snr, own, own.map_or(f.shown, |snr| f.at(snr, &Policy::default())))
            }),
            signal: truth["what_no_base_parameter_imitates_over_noise"].as_f64(),
            answer: answer.unwrap_or("not in docs/verification.md").trim().to_owned(),
            name,
            effect,
        })
    }

    /// Whether the search named the truth, alone or in a group.
    fn named(&self) -> bool {
        let verdict = self.answer.starts_with("`explained`") || self.answer.starts_with("`ambiguous`");
        verdict && self.effect.as_ref().is_some_and(|e| self.answer.contains(e.as_str()))
    }

    /// The doctor promised what the search found, and did not what it could not.
    fn agrees(&self) -> bool {
        self.doctor.is_none_or(|(_, _, shown)| match shown {
            Shown::Shown => self.named(),
            Shown::Hidden => !self.named(),
            Shown::Faint => true,
        })
    }

    fn line(&self) -> String {
        let signal = self.signal.map_or("–".into(), |s| format!("{s:.1}"));
        let doctor = self.doctor.map_or("– | – | –".into(), |(snr, own, shown)| {
            let own = own.map_or("–".into(), |s| format!("{s:.1}"));
            format!("{snr:.1} | {own} | {}", shown.word())
        });
        let apart = if self.agrees() { "" } else { " **apart**" };
        format!("| {} | {signal} | {doctor} | {}{apart} |", self.name, self.answer)
    }
}

/// The amplitude that is in a record, in the catalogue's terms.
fn amount(truth: &Value, effect: &str) -> Option<f64> {
    let of = |key: &str| truth["effect_parameters"][effect][key].as_f64().map(f64::abs);
    match effect {
        "compliance" => of("k_rig").map(|k| 1.0 / k),
        "slack" => of("u0"),
        "drift" => of("rate_N_per_s"),
        "rate_dependent_strength" => of("c"),
        "bridging" => of("sigma_b"),
        "thickness_taper" => of("a"),
        "mullins" => of("r").map(|r| 1.0 / r),
        "grip_slip" => of("h").map(|h| 1.0 / h),
        _ => None,
    }
}
