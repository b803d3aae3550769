//! A study: a table of specimens, the models that each is fitted with, how often. Faults of one row are that row's; those
//! of the rest are the study's.

mod rows;

use crate::diagnostics::{Diagnostic, Diagnostics, Report, Sink};
use crate::read::LARGEST_TOML;
use crate::text::{SourceFile, short, visible};
use std::path::{Path, PathBuf};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Most repeats of a fit.
const REPEATS: i64 = 100_000;

/// What a task does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Task {
    /// The inverse analysis (default).
    #[default]
    Identify,
    /// The search for missing effects.
    Discover,
}

impl Task {
    /// The word used in files.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Identify => "identify",
            Self::Discover => "discover",
        }
    }
}

/// One model of a study.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct StudyModel {
    /// Its name in every table.
    pub name: String,
    /// The config it stands in, without a specimen; `None`: what each specimen's own file says.
    pub config: Option<PathBuf>,
    /// Effects added with the values of their cards.
    pub effects: Vec<String>,
    /// What is done with it.
    pub task: Task,
}

/// One specimen of a study.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Row {
    /// Number in its table, from 1.
    pub number: usize,
    /// The specimen, or a config.
    pub file: PathBuf,
    /// What it is compared by; empty where nothing is said.
    pub group: String,
    /// Whose tissue it is; empty where nothing is said.
    pub donor: String,
    /// Why it is in no mean.
    pub exclude: Option<String>,
}

/// A study as its file says.
#[derive(Clone, Debug, PartialEq)]
pub struct Study {
    /// Its name.
    pub name: String,
    /// The file.
    pub file: PathBuf,
    /// Where tasks and results go.
    pub folder: PathBuf,
    /// The specimens; a row that cannot be read has its faults.
    pub rows: Vec<Result<Row, Diagnostics>>,
    /// The models, at least one.
    pub models: Vec<StudyModel>,
    /// Refits of each model to records with their misfit drawn anew (0).
    pub bootstrap: usize,
    /// Seed of those (0).
    pub seed: u64,
}

/// Reads a study.
///
/// # Errors
/// Everything that is wrong with it as a whole, at once. What is wrong with a row of its table stands in that row.
pub fn read_study(path: &Path) -> Result<Study, Diagnostics> {
    let file = SourceFile::read(path, LARGEST_TOML, "a study (TOML)").map_err(|d| Diagnostics(vec![*d]))?;
    let sink = Sink::default();
    let (document, errors) = DeTable::parse_recoverable(&file.text);
    for error in errors.iter().take(10) {
        let text = format!("not valid TOML: {}", visible(error.message()));
        sink.push(Report::error(text).at(&file, error.span().unwrap_or(0..0)));
    }
    let reader = Reader { file: &file, sink: &sink };
    let study = if errors.is_empty() { Some(reader.study(document.get_ref())) } else { None };
    match study {
        Some(study) if !sink.has_errors() => Ok(study),
        _ => Err(Diagnostics(sink.into_sorted())),
    }
}

/// A table with the keys that it may have.
struct Reader<'a> {
    file: &'a SourceFile,
    sink: &'a Sink,
}

type Item<'a> = Spanned<DeValue<'a>>;

impl Reader<'_> {
    fn study(&self, top: &DeTable) -> Study {
        const KEYS: [&str; 6] = ["name", "folder", "table", "specimens", "models", "repeats"];
        self.known(top, &KEYS, "a study");
        let path = &self.file.path;
        let stem = path.file_stem().map_or("study".into(), |s| s.to_string_lossy().into_owned());
        let name = self.text(top, "name").filter(|n| !n.is_empty()).unwrap_or_else(|| stem.clone());
        let folder = self.text(top, "folder").unwrap_or_else(|| format!("{stem}-study"));
        let repeats = self.table(top, "repeats");
        if let Some(r) = repeats {
            self.known(r, &["bootstrap", "seed"], "[repeats]");
        }
        let count = |key| {
            repeats
                .map_or(0, |r| self.integer(r, key))
                .clamp(0, if key == "seed" { i64::MAX } else { REPEATS })
        };
        Study {
            name,
            file: path.clone(),
            folder: self.beside(&folder),
            rows: self.rows(top),
            models: self.models(top),
            bootstrap: usize::try_from(count("bootstrap")).unwrap_or(0),
            seed: u64::try_from(count("seed")).unwrap_or(0),
        }
    }

    fn rows(&self, top: &DeTable) -> Vec<Result<Row, Diagnostics>> {
        let rows = match (top.get("table"), top.get("specimens")) {
            (Some(_), Some(here)) => {
                self.fault(here, "specimens", "`specimens` stands beside `table`; expected one or the other");
                return Vec::new();
            }
            (Some(at), None) => self.csv(top, at),
            (None, Some(here)) => self.listed(here),
            (None, None) => {
                let help = "table = \"specimens.csv\" with the columns file, group, donor, exclude; or [[specimens]]";
                self.sink.push(Report::error("no specimens are given").help(help).about(&self.file.path));
                return Vec::new();
            }
        };
        if rows.is_empty() && !self.sink.has_errors() {
            self.sink.push(Report::error("the table of specimens is empty").about(&self.file.path));
        }
        rows
    }

    fn models(&self, top: &DeTable) -> Vec<StudyModel> {
        let mut models: Vec<StudyModel> = Vec::new();
        for item in self.list(top, "models") {
            let DeValue::Table(table) = item.get_ref() else {
                self.fault(item, "models", "expected [[models]] with `name`");
                continue;
            };
            self.known(table, &["name", "config", "effects", "task"], "[[models]]");
            let model = self.model(table, models.len());
            if models.iter().any(|m| m.name == model.name) {
                self.fault(item, "name", &format!("two models have the name `{}`", short(&model.name)));
            }
            models.push(model);
        }
        if models.is_empty() {
            models.push(StudyModel { name: "model".into(), ..StudyModel::default() });
        }
        models
    }

    fn model(&self, table: &DeTable, before: usize) -> StudyModel {
        let task = match (self.text(table, "task").as_deref(), table.get("task")) {
            (Some("discover"), _) => Task::Discover,
            (Some("identify") | None, _) => Task::Identify,
            (Some(other), at) => {
                let text = format!("unknown task `{}`; expected \"identify\" or \"discover\"", short(other));
                at.into_iter().for_each(|at| self.fault(at, "task", &text));
                Task::Identify
            }
        };
        let effects = self.list(table, "effects").iter().filter_map(|e| match e.get_ref() {
            DeValue::String(name) if is_bare(name) => Some(name.clone().into_owned()),
            _ => {
                self.fault(e, "effects", "expected names of effects (`fct effects` lists them)");
                None
            }
        });
        StudyModel {
            name: self.text(table, "name").unwrap_or_else(|| format!("model {}", before + 1)),
            config: self.text(table, "config").map(|c| self.beside(&c)),
            effects: effects.collect(),
            task,
        }
    }

    fn beside(&self, given: &str) -> PathBuf {
        self.file.path.parent().unwrap_or(Path::new("")).join(given)
    }

    /// Keys that mean nothing are faults.
    fn known(&self, table: &DeTable, keys: &[&str], what: &str) {
        for (key, _) in table.iter().filter(|(k, _)| !keys.contains(&k.get_ref().as_ref())) {
            let name = short(key.get_ref());
            let near = keys
                .iter()
                .max_by(|a, b| strsim::jaro_winkler(a, &name).total_cmp(&strsim::jaro_winkler(b, &name)));
            let near = near.filter(|n| strsim::jaro_winkler(n, &name) > 0.75);
            let mean =
                near.map_or(format!("expected {}", keys.join(", ")), |n| format!("did you mean `{n}`?"));
            let report = Report::error(format!("unknown key `{name}` in {what}; {mean}")).key(name);
            self.sink.push(report.at(self.file, key.span()));
        }
    }

    fn text(&self, table: &DeTable, key: &str) -> Option<String> {
        let item = table.get(key)?;
        match item.get_ref() {
            DeValue::String(text) => Some(text.clone().into_owned()),
            _ => {
                self.fault(item, key, &format!("`{key}` expects a text in quotes"));
                None
            }
        }
    }

    fn integer(&self, table: &DeTable, key: &str) -> i64 {
        let Some(item) = table.get(key) else { return 0 };
        let whole = match item.get_ref() {
            DeValue::Integer(i) => i64::from_str_radix(i.as_str(), i.radix()).ok(),
            _ => None,
        };
        let most = if key == "seed" { i64::MAX } else { REPEATS };
        whole.filter(|n| (0..=most).contains(n)).unwrap_or_else(|| {
            self.fault(item, key, &format!("`{key}` expects a whole number from 0 to {most}"));
            0
        })
    }

    fn table<'t>(&self, table: &'t DeTable<'t>, key: &str) -> Option<&'t DeTable<'t>> {
        let item = table.get(key)?;
        match item.get_ref() {
            DeValue::Table(inner) => Some(inner),
            _ => {
                self.fault(item, key, &format!("`{key}` expects the table [{key}]"));
                None
            }
        }
    }

    fn list<'t>(&self, table: &'t DeTable<'t>, key: &str) -> &'t [Item<'t>] {
        match table.get(key).map(|item| (item, item.get_ref())) {
            None => &[],
            Some((_, DeValue::Array(items))) => items,
            Some((item, _)) => {
                self.fault(item, key, &format!("`{key}` expects a list"));
                &[]
            }
        }
    }

    fn fault(&self, at: &Item, key: &str, message: &str) {
        self.sink.push(self.report(at, key, message));
    }

    fn report(&self, at: &Item, key: &str, message: &str) -> Diagnostic {
        Report::error(message).key(key).at(self.file, at.span())
    }
}

/// A name that a TOML table may have without quotes.
fn is_bare(name: &str) -> bool {
    !name.is_empty() && name.chars().all(|c| c.is_ascii_alphanumeric() || "_-".contains(c))
}
