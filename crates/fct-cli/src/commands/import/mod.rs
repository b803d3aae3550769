//! `fct import`: from whatever a testing machine wrote to a record beside a specimen file.

mod arguments;
mod ask;
mod tell;
mod write;

pub use arguments::Arguments;

use crate::outcome::{Failure, Outcome};
use crate::session::{Session, file_name};
use ::report::answer::SCHEMA;
use input::TestKind;
use records::{Choices, Fault, Geometry, Import, ImportError, Question, quoted};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// Reads the files, asks what they leave open, writes records, pictures, specimen and log.
///
/// # Errors
/// What is no record, what must be decided (not on a terminal) or mended; a file that would be overwritten.
pub fn run(arguments: &Arguments, session: &Session) -> Result<Outcome, Failure> {
    let mut choices = arguments.choices().map_err(|e| Failure::usage(format!("fct import: {e}")))?;
    let mut geometry = match &arguments.geometry {
        Some(file) => {
            input::check_geometry(file)?;
            Geometry::read(file).map_err(failed)?
        }
        None => Geometry::default(),
    };
    let kinds =
        arguments.kinds(&session.catalogue).map_err(|e| Failure::usage(format!("fct import: {e}")))?;
    let (mut read, mut errors, mut answered) = (Vec::new(), Vec::new(), Vec::new());
    for (k, file) in arguments.files.iter().enumerate() {
        let two_axes = kinds.of(k, file).0.two_axes;
        match one(file, &Choices { two_axes, ..choices.clone() }, &mut geometry, session, &mut answered) {
            Ok(import) => read.push(import),
            Err(error) => errors.push(error),
        }
        choices.two_axes |= two_axes;
    }
    if !errors.is_empty() {
        return Err(all_failed(errors));
    }
    let folder = session.common.out.clone().unwrap_or_else(|| default_folder(&arguments.files));
    let kinds_said = named(&mut read, &kinds);
    let name = geometry.name.as_deref().map(as_name).unwrap_or_else(|| {
        std::path::absolute(&folder)
            .ok()
            .and_then(|p| p.file_name().map(|n| n.to_string_lossy().into_owned()))
            .unwrap_or_else(|| "specimen".into())
    });
    let plan = write::plan(&folder, &name, &geometry, &read, session)?;
    let answer = answer(&folder, &name, &geometry, &read, &plan, &choices, &answered);
    plan.write(&answer)?;
    let text = tell::text(&folder, &geometry, &read, &plan, &kinds_said, &answered);
    Outcome::new(&answer, text)
}

/// A specimen's name as a header has it, made one that files and folders can have.
fn as_name(said: &str) -> String {
    let bad = |c: char| if c.is_control() || "/\\:*?\"<>|".contains(c) { '-' } else { c };
    let name: String = said.chars().take(100).map(bad).collect();
    let name = name.trim();
    if input::name_fault(name).is_none() { name.to_owned() } else { "specimen".to_owned() }
}

/// One file; on a terminal what is open is asked until it is settled, one question at a time: an answer may settle
/// others.
fn one(
    file: &Path,
    choices: &Choices,
    geometry: &mut Geometry,
    session: &Session,
    answered: &mut Vec<String>,
) -> Result<Import, ImportError> {
    let mut choices = choices.clone();
    let mut last: Option<Answer> = None;
    loop {
        // A failed reading leaves what is known of the geometry as it was.
        let mut known = geometry.clone();
        let error = match records::import(file, &choices, &mut known) {
            Ok(import) => {
                *geometry = known;
                answered.extend(last.map(|a| a.flag()));
                return Ok(import);
            }
            Err(error) if ask::can(session) => error,
            Err(error) => return Err(error),
        };
        let question = match (&error, last.take()) {
            (ImportError::Undecided { questions, .. }, answer) => {
                answered.extend(answer.map(|a| a.flag()));
                questions.first().cloned()
            }
            // The answer does not fit the file: the same again.
            (ImportError::Faulty { faults, .. }, Some(answer)) if answer.is_blamed(faults) => {
                session.say(&error.to_string());
                choices = answer.before;
                Some(answer.question)
            }
            _ => None,
        };
        let Some(question) = question else { return Err(error) };
        let before = choices.clone();
        let Some(value) = ask::one(file, &question, &mut choices, session) else { return Err(error) };
        last = Some(Answer { before, question, value });
    }
}

/// The answer to a question, and what was decided before it.
struct Answer {
    before: Choices,
    question: Question,
    value: String,
}

impl Answer {
    /// As it is typed into a shell.
    fn flag(&self) -> String {
        format!("--{} {}", self.question.flag, quoted(&self.value))
    }

    /// Whether faults are those of its flag.
    fn is_blamed(&self, faults: &[Fault]) -> bool {
        let flag = format!("--{} ", self.question.flag);
        faults.iter().any(|f| f.message.starts_with(&flag))
    }
}

/// The folder that is made: the first file's name without its ending.
fn default_folder(files: &[PathBuf]) -> PathBuf {
    let stem = files.first().and_then(|f| f.file_stem()).map(|s| s.to_string_lossy().into_owned());
    PathBuf::from(file_name(&stem.unwrap_or_default()))
}

/// Names tests by their kind, repeats with a number; says where the kind was taken for granted.
fn named(read: &mut [Import], kinds: &arguments::Kinds) -> Vec<String> {
    let mut used: Vec<TestKind> = Vec::new();
    let mut said = Vec::new();
    for (k, import) in read.iter_mut().enumerate() {
        let (kind, why) = kinds.of(k, &import.file);
        said.extend(why);
        for test in &mut import.tests {
            test.kind = kind.word().to_owned();
            let count = used.iter().filter(|u| **u == kind).count();
            used.push(kind);
            test.name = if count == 0 { test.kind.clone() } else { format!("{}-{}", kind.word(), count + 1) };
        }
    }
    said
}

fn answer(
    folder: &Path,
    name: &str,
    geometry: &Geometry,
    read: &[Import],
    plan: &write::Plan,
    choices: &Choices,
    answered: &[String],
) -> Value {
    let tests: Vec<Value> = read
        .iter()
        .flat_map(|i| i.tests.iter().map(move |t| (i, t)))
        .map(|(i, t)| {
            let full = t.reduced.as_ref().map(|_| folder.join("full").join(format!("{}.csv", t.name)));
            json!({
                "name": t.name, "kind": t.kind, "from": i.file, "data": folder.join(format!("{}.csv", t.name)),
                "full": full, "rows": t.full.row.len(),
                "points": t.reduced.as_ref().unwrap_or(&t.full).row.len(),
                "force_sd_N": t.force_sd_of_points.unwrap_or(t.force_sd_of_rows),
            })
        })
        .collect();
    json!({
        "schema": SCHEMA, "specimen": name, "specimen_file": folder.join("specimen.toml"), "geometry": geometry,
        "geometry_complete": geometry.is_complete(), "tests": tests, "files": read, "choices": choices,
        "answers": answered, "written": plan.paths(), "version": env!("CARGO_PKG_VERSION"),
    })
}

fn failed(error: ImportError) -> Failure {
    all_failed(vec![error])
}

/// All errors of all files in one message; as JSON with questions and faults apart.
fn all_failed(errors: Vec<ImportError>) -> Failure {
    let message = errors.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n");
    let mut failure = Failure::usage(message.clone());
    let list: Vec<Value> = errors
        .iter()
        .map(|e| match e {
            ImportError::NotARecord { path, reason } => json!({ "file": path, "reason": reason }),
            ImportError::Undecided { path, questions } => json!({ "file": path, "questions": questions }),
            ImportError::Faulty { path, faults } => json!({ "file": path, "faults": faults }),
        })
        .collect();
    failure.json = json!({ "schema": SCHEMA, "error": { "code": 2, "reason": message, "files": list } });
    failure
}
