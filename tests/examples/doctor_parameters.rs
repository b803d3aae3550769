//! Which parameters the doctor promises of the practice records, beside what the search's answer knows of them and the truth:
//! `cargo run --release -p workspace-tests --example doctor_parameters -- ../shared/practice RUNS`, RUNS holding a run
//! directory of `fct discover` or `fct identify` for each case, named as it.

use analysis::{Expected, doctor};
use serde_json::Value;
use std::error::Error;
use std::path::{Path, PathBuf};
use std::sync::Arc;

fn main() -> Result<(), Box<dyn Error>> {
    let mut args = std::env::args().skip(1);
    let folder = args.next().ok_or("name the folder of the practice records")?;
    let runs = PathBuf::from(args.next().ok_or("name the folder of the run directories")?);
    let mut cases: Vec<PathBuf> =
        std::fs::read_dir(&folder)?.filter_map(|e| e.ok()).map(|e| e.path()).filter(|p| p.is_dir()).collect();
    cases.sort();
    println!(
        "| case | fixed, by `check` | of these identifiable in the answer | may be fixed | of these identifiable | open | \
         of these open | error found over promised, in the middle | truth inside, of the fixed |"
    );
    println!("|---|---|---|---|---|---|---|---|---|");
    let mut all = Counts::default();
    for case in cases {
        let name = case.file_name().unwrap_or_default().to_string_lossy().into_owned();
        if !runs.join(&name).is_dir() {
            println!("| {name} | no run | | | | | | |");
            continue;
        }
        let counts = Counts::of(&case, &runs.join(&name))?;
        println!("{}", counts.line(name.trim_start_matches("practice-")));
        all.add(counts);
    }
    println!("{}", all.line("all"));
    let within = all.ratios.iter().filter(|r| (1.0 / 3.0..=3.0).contains(*r)).count();
    println!("\nWithin a factor of three of the standard error found: {within} of {}.", all.ratios.len());
    Ok(())
}

/// What was promised, and what became of it.
#[derive(Default)]
struct Counts {
    /// Parameters of each promise, and how many of them are identifiable.
    promised: [[usize; 2]; 3],
    compared: usize,
    inside: usize,
    /// Standard errors found over those promised.
    ratios: Vec<f64>,
}

impl Counts {
    fn of(case: &Path, run: &Path) -> Result<Self, Box<dyn Error>> {
        let catalogue = effects::catalogue();
        let read = Arc::new(input::read_case(&case.join("config.toml"), &catalogue)?);
        let shows = doctor(&read, &catalogue, true, &|| false);
        let foresight = shows.shows.ok_or_else(|| shows.shows_not.unwrap_or_default())?;
        let truth = json(&case.join("truth.json"))?;
        let answer = answers_page(run)?;
        let list = answer["parameters"].as_array().ok_or("no parameters")?;
        let mut counts = Self::default();
        for promised in &foresight.parameters {
            let Some(found) = list.iter().find(|p| p["path"] == promised.path.as_str()) else { continue };
            let with = answer["effects"].as_array().into_iter().flatten().filter_map(Value::as_str);
            let expected = promised.expected_beside(with);
            let [all, identifiable] = &mut counts.promised[expected as usize];
            *all += 1;
            *identifiable += usize::from(found["identifiable"] == true);
            if let (Some(error), Some(value)) = (found["std_error"].as_f64(), found["value"].as_f64()) {
                counts.ratios.push((error / value).abs() / promised.relative_error);
            }
            if expected != Expected::Fixed {
                continue;
            }
            let end = |k: usize| found["interval_95"][k].as_f64();
            let true_value = hidden(&truth, read.interface.areas, &promised.path);
            if let (Some(low), Some(high), Some(true_value)) = (end(0), end(1), true_value) {
                counts.compared += 1;
                counts.inside += usize::from((low..=high).contains(&true_value));
            }
        }
        Ok(counts)
    }

    fn add(&mut self, other: Self) {
        for (all, one) in self.promised.iter_mut().flatten().zip(other.promised.iter().flatten()) {
            *all += one;
        }
        self.compared += other.compared;
        self.inside += other.inside;
        self.ratios.extend(other.ratios);
    }

    fn line(&self, name: &str) -> String {
        let mut sorted = self.ratios.clone();
        sorted.sort_by(f64::total_cmp);
        let middle = sorted.get(sorted.len() / 2).map_or("–".into(), |r| format!("{r:.2}"));
        let [[fixed, known], [uncertain, uncertain_known], [open, open_known]] = self.promised;
        let Self { compared, inside, .. } = self;
        format!(
            "| {name} | {fixed} | {known} | {uncertain} | {uncertain_known} | {open} | {} | {middle} | {inside} of \
             {compared} |",
            open - open_known
        )
    }
}

fn json(file: &Path) -> Result<Value, Box<dyn Error>> {
    let text = std::fs::read_to_string(file).map_err(|e| format!("{}: {e}", file.display()))?;
    Ok(serde_json::from_str(&text)?)
}

/// The answer's page: the last model of a search, else an identification.
fn answers_page(run: &Path) -> Result<Value, Box<dyn Error>> {
    let count = (0..).take_while(|k| run.join(format!("rungs/{k}")).is_dir()).count();
    let page =
        count.checked_sub(1).map_or("summary.json".into(), |last| format!("rungs/{last}/summary.json"));
    json(&run.join(page))
}

/// A base parameter of the truth, in the program's units. Areas are those of the truth where there are as many as in the file.
fn hidden(truth: &Value, areas: usize, path: &str) -> Option<f64> {
    let name = path.rsplit('.').next()?;
    let Some(k) = path.split(['[', ']']).nth(1).and_then(|k| k.parse::<usize>().ok()) else {
        let bulk = &truth["bulk"];
        return if name == "gamma" {
            bulk["gamma_deg"].as_f64().map(f64::to_radians)
        } else {
            bulk[name].as_f64()
        };
    };
    let all = truth["areas_Gc_N_per_mm_sigma_c_MPa"].as_array().filter(|all| all.len() == areas)?;
    all.get(k.checked_sub(1)?)?[usize::from(name == "sigma_c")].as_f64()
}
