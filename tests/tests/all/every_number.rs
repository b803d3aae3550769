//! Every number that a file may hold, as the table of keys and the catalogue know them, at values that nobody means: it
//! ends in a fault with file and line, or in a model; and a sample of what is accepted in a run that ends.
//! `FCT_ALL=1` runs all of it.

use input::{Case, Key, Kind, LawSite, keys, keys_of_law};
use model::cost::Purpose;
use model::{Discretisation, Model};
use std::collections::BTreeMap;
use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

const SILLY: [&str; 14] = [
    "1e-300", "1e-160", "1e-154", "1e-30", "1e30", "1e154", "1e300", "-1", "-1e300", "0", "-0.0", "nan",
    "inf", "-inf",
];

/// Longest time of a file's way to a model, and of a run.
const SOON: Duration = Duration::from_secs(20);
const RUN: Duration = Duration::from_secs(60);

/// The lines of a case by section; a key that is set anew takes the place of the one that is there.
struct File(BTreeMap<String, Vec<String>>);

impl File {
    fn new() -> Self {
        let mut sections = BTreeMap::new();
        let mut add = |name: &str, lines: &[&str]| {
            sections.insert(name.to_owned(), lines.iter().map(|l| (*l).to_owned()).collect::<Vec<_>>());
        };
        add("geometry", &["length_mm = 8.0", "width_mm = 6.0", "thickness_mm = 0.8", "cut_mm = 1.5"]);
        add("tests", &["kind = \"tearing\"", "data = \"record.csv\""]);
        add("mesh", &["divisions = [4, 4, 1]"]);
        add("bulk", &["mu_kPa = 6.0", "k1_kPa = 700.0", "k2 = 15.0", "gamma_deg = 42.0", "kappa = 0.22"]);
        add("interface", &["gc_N_per_mm = 0.15", "sigma_c_MPa = 0.08"]);
        add("solver", &["step_mm = 0.5"]);
        add("identify", &["max_iterations = 2"]);
        Self(sections)
    }

    /// Sets a key, under any unit the only one of its name.
    fn set(mut self, section: &str, key: &Key, value: &str) -> Self {
        let lines = self.0.entry(section.to_owned()).or_default();
        let spellings = key.spellings();
        lines.retain(|l| !spellings.iter().any(|(s, _)| l.split(' ').next() == Some(s)));
        if ["bulk_size", "path_size", "layers"].contains(&key.name.as_ref()) {
            lines.retain(|l| !l.starts_with("divisions"));
        }
        lines.push(format!("{} = {value}", key.spelling()));
        self
    }

    fn text(&self) -> String {
        let mut out = String::from("name = \"strip\"\n");
        for (section, lines) in &self.0 {
            let title = if section == "tests" { "[[tests]]".to_owned() } else { format!("[{section}]") };
            out.push_str(&format!("{title}\n{}\n", lines.join("\n")));
        }
        out
    }
}

/// A record of the strip, pulled until it is torn, with a little noise that is the same every time.
fn record() -> String {
    let mut out = String::from("time_s,displacement_mm,force_N\n");
    for i in 0..60 {
        let u = 0.1 * f64::from(i);
        let noise = 1e-3 * f64::from((i * 7919) % 13 - 6) / 6.0;
        out.push_str(&format!(
            "{i},{u},{}\n",
            0.25 * (u / 3.0).powi(2) * (-(u / 3.5).powi(6)).exp() + noise * f64::from(i.min(1))
        ));
    }
    out
}

/// Every key with a number, with all that may be written for it.
fn files() -> Vec<(String, String)> {
    let mut out = Vec::new();
    let catalogue = effects::catalogue();
    let of_laws = [(LawSite::Bulk, "hgo"), (LawSite::Interface, "exponential")];
    let of_laws = of_laws.map(|(site, law)| keys_of_law(&catalogue, site, law));
    for key in keys().iter().chain(of_laws.iter().flatten()) {
        let section = key.section.to_string();
        for text in values(&key.kind) {
            if section == "tests.protocol" {
                out.extend(legs(key, &text));
            } else if section == "tests.weights" {
                out.push(weight(key, &text));
            } else {
                let file = File::new().set(&section, key, &text);
                out.push((format!("[{section}] {} = {text}", key.spelling()), file.text()));
            }
        }
    }
    for effect in catalogue.iter() {
        let name = effect.card().name;
        for spec in effect.parameters(&model::Options::new()) {
            for value in SILLY {
                let text = format!("{}[effects.{name}]\n{} = {value}\n", File::new().text(), spec.key());
                out.push((format!("[effects.{name}] {} = {value}", spec.key()), text));
            }
        }
    }
    out
}

fn values(kind: &Kind) -> Vec<String> {
    let plain = || SILLY.iter().map(|v| (*v).to_owned());
    match kind {
        Kind::Number { .. } => plain().collect(),
        Kind::Integer { max, .. } | Kind::Count { max } => {
            let whole = ["0", "-1", "9223372036854775807", "-9223372036854775808"].map(str::to_owned);
            plain().chain(whole).chain([max.to_string()]).collect()
        }
        Kind::Divisions => [
            "[0, 4, 1]",
            "[20000, 1, 1]",
            "[1, 20000, 1]",
            "[200, 200, 20]",
            "[-1, 2, 2]",
            "[1e300, 2, 2]",
            "[1, 1, 1]",
        ]
        .map(str::to_owned)
        .to_vec(),
        Kind::Parameter { .. } => plain()
            .chain(SILLY.iter().flat_map(|v| ["min", "max", "start"].map(|k| format!("{{ {k} = {v} }}"))))
            .collect(),
        _ => Vec::new(),
    }
}

/// A protocol with a number of a leg replaced.
fn legs(key: &Key, value: &str) -> Vec<(String, String)> {
    let leg = |name: &str, usual: &str| if key.name == name { value.to_owned() } else { usual.to_owned() };
    let text = format!(
        "protocol = [{{ to_mm = {}, rate_mm_per_s = {} }}, {{ hold_s = {} }}]",
        leg("to", "0.5"),
        leg("rate", "0.05"),
        leg("hold", "5.0")
    );
    let mut file = File::new();
    let tests = file.0.entry("tests".to_owned()).or_default();
    tests.retain(|l| !l.starts_with("data"));
    tests.push(text);
    vec![(format!("[tests.protocol] {} = {value}", key.name), file.text())]
}

/// A stretch of a record with a number replaced.
fn weight(key: &Key, value: &str) -> (String, String) {
    let of = |name: &str, usual: &str| if key.name == name { value.to_owned() } else { usual.to_owned() };
    let text = format!(
        "weights = [{{ from_s = {}, to_s = {}, weight = {} }}]",
        of("from", "1.0"),
        of("to", "2.0"),
        of("weight", "0.5")
    );
    let mut file = File::new();
    file.0.entry("tests".to_owned()).or_default().push(text);
    (format!("[tests.weights] {} = {value}", key.name), file.text())
}

/// The case and its model, or what is said instead, which must name file and line.
fn model_of(folder: &Path, what: &str, text: &str) -> Option<Arc<Case>> {
    let file = folder.join("case.toml");
    fs::write(&file, text).expect("written");
    let catalogue = effects::catalogue();
    let case = match input::read_case(&file, &catalogue) {
        Ok(case) => Arc::new(case),
        Err(faults) => {
            for fault in faults.0 {
                assert!(fault.line.is_some(), "{what}: no line in\n{fault}");
            }
            return None;
        }
    };
    match Model::checked(case.clone(), &catalogue, Discretisation::default(), Purpose::Fit) {
        Ok(_) => Some(case),
        Err(fault) => {
            let told = fault.to_string();
            assert!(told.contains("case.toml:") && told.contains("error"), "{what}: no place in\n{told}");
            None
        }
    }
}

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("record.csv"), record()).expect("written");
    folder
}

#[test]
fn every_number_ends_in_a_fault_with_a_place_or_in_a_model() {
    let folder = folder();
    let files = files();
    assert!(files.len() > 1000, "only {} files", files.len());
    let (mut accepted, mut wrong) = (0, Vec::new());
    for (what, text) in &files {
        let begun = Instant::now();
        match catch_unwind(AssertUnwindSafe(|| model_of(folder.path(), what, text))) {
            Ok(case) => accepted += usize::from(case.is_some()),
            Err(e) => {
                wrong.push(e.downcast_ref::<String>().cloned().unwrap_or_else(|| format!("{what}: panicked")))
            }
        }
        if begun.elapsed() > SOON {
            wrong.push(format!("{what}: {:?}", begun.elapsed()));
        }
    }
    println!("{} files, {accepted} of them accepted", files.len());
    assert!(wrong.is_empty(), "{} of {}:\n{}", wrong.len(), files.len(), wrong.join("\n"));
}

/// Runs one accepted case; a run that cannot go on says so, and that is an end too.
fn ends(case: &Arc<Case>, identified: bool) -> Result<(), String> {
    let catalogue = effects::catalogue();
    let begun = Instant::now();
    let late = || begun.elapsed() > RUN;
    let done = catch_unwind(AssertUnwindSafe(|| {
        if identified {
            let control =
                analysis::Control { progress: &|_| {}, cancelled: &late, journal: &analysis::NoJournal };
            drop(analysis::identify(case.clone(), &catalogue, &control));
        } else {
            let control = analysis::SimulateControl { progress: &|_, _| {}, cancelled: &late };
            drop(analysis::simulate(case.clone(), &catalogue, &control));
        }
    }));
    match done {
        Err(_) => Err("panicked".to_owned()),
        Ok(()) if late() => Err("did not end".to_owned()),
        Ok(()) => Ok(()),
    }
}

#[test]
fn what_is_accepted_can_be_run() {
    let folder = folder();
    let all = std::env::var_os("FCT_ALL").is_some();
    let (every, identify) = if all { (1, 3) } else { (17, 5) };
    let mut wrong = Vec::new();
    let mut accepted = 0;
    for (what, text) in files() {
        let Ok(Some(case)) = catch_unwind(AssertUnwindSafe(|| model_of(folder.path(), &what, &text))) else {
            continue;
        };
        accepted += 1;
        if accepted % every != 0 {
            continue;
        }
        let recorded = case.tests.iter().any(|t| t.record.is_some());
        let identified = recorded && (accepted / every) % identify == 0;
        if let Err(why) = ends(&case, identified) {
            wrong.push(format!("{what}: {why} ({})", if identified { "identify" } else { "simulate" }));
        }
    }
    assert!(wrong.is_empty(), "{} of {accepted}:\n{}", wrong.len(), wrong.join("\n"));
}

/// The noise levels of the issue, and the least that is accepted.
#[test]
fn a_noise_level_that_no_record_has_is_refused_and_the_least_one_is_fitted() {
    let folder = folder();
    let with = |sd: &str| {
        File::new().set("tests", keys().iter().find(|k| k.name == "force_sd").expect("the key"), sd).text()
    };
    for sd in ["1e-160", "1e-154", "1e-9", "1e8"] {
        assert!(model_of(folder.path(), sd, &with(sd)).is_none(), "{sd} is accepted");
    }
    let case = model_of(folder.path(), "2e-6", &with("2e-6")).expect("accepted");
    ends(&case, true).expect("an end");
}
