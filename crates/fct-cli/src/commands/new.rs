//! `fct new`: a scaffold that runs.

use crate::outcome::{Failure, Outcome};
use crate::session::Session;
use ::report::answer::SCHEMA;
use ::report::{quoted_path, write_atomic};
use serde_json::json;
use std::path::{Path, PathBuf};

/// Arguments of `fct new`.
#[derive(Clone, Debug, clap::Args)]
pub struct Arguments {
    /// Name of the specimen, and of the folder that is made
    #[arg(value_name = "NAME")]
    pub name: String,

    /// The experiment that the sample is of: t_peel, peel_180 or biaxial; uniaxial, tearing, or left out: an intact and a cut strip
    #[arg(long, value_name = "NAME")]
    pub experiment: Option<String>,
}

const SPECIMEN: &str = include_str!("../../scaffold/specimen.toml");
const CONFIG: &str = include_str!("../../scaffold/config.toml");
const UNIAXIAL: &str = include_str!("../../scaffold/uniaxial.csv");
const TEARING: &str = include_str!("../../scaffold/tearing.csv");

/// Experiments of the ordinary scaffold.
const STRIPS: [&str; 2] = ["uniaxial", "tearing"];

/// Makes the folder with specimen, config and sample records.
///
/// # Errors
/// If the name is no name of a folder, or something stands there.
pub fn run(arguments: &Arguments, session: &Session) -> Result<Outcome, Failure> {
    let name = &arguments.name;
    if name.is_empty() || crate::session::file_name(name) != *name {
        return Err(Failure::usage(format!(
            "fct: `{name}` is no name for a folder; use letters, digits, - and _"
        )));
    }
    let folder = session.common.out.clone().unwrap_or_else(|| PathBuf::from(name));
    if folder.exists() {
        return Err(Failure::usage(format!(
            "fct: {}: this exists already; nothing was changed",
            folder.display()
        )));
    }
    // The strips of the ordinary scaffold are those of the first two.
    if let Some(experiment) = arguments.experiment.as_deref().filter(|e| !STRIPS.contains(e)) {
        return sample_of(experiment, name, &folder, session);
    }
    let config = format!("{name}.toml");
    let files = [
        ("specimen.toml", SPECIMEN.replace("NAME", name)),
        (config.as_str(), CONFIG.replace("NAME", name)),
        ("uniaxial.csv", UNIAXIAL.to_owned()),
        ("tearing.csv", TEARING.to_owned()),
        ("raw/uniaxial_RawData_1.csv", raw(name, UNIAXIAL)),
        ("raw/tearing_RawData_1.csv", raw(name, TEARING)),
    ];
    let made =
        |e| ::report::ReportError::Io { path: folder.join("raw"), action: "create the directory", source: e };
    std::fs::create_dir_all(folder.join("raw")).map_err(made)?;
    let (paths, list) = write(&folder, &files)?;
    let config = folder.join(&config);
    let text = format!(
        "written:\n{list}\nThe records are synthetic samples: put yours in their place, and your dimensions into\n\
         specimen.toml. It runs as it is:\n  fct check {c}\n  fct identify {c}\n\
         raw/ holds the same records as an Instron's program writes them; so are yours read:\n  \
         fct import {r}/uniaxial_RawData_1.csv --out {i}\n",
        c = quoted_path(&config),
        r = quoted_path(&folder.join("raw")),
        i = quoted_path(&folder.join("imported"))
    );
    Outcome::new(&json!({ "schema": SCHEMA, "files": paths }), text)
}

/// The sample of one experiment.
fn sample_of(experiment: &str, name: &str, folder: &Path, session: &Session) -> Result<Outcome, Failure> {
    let all = session.catalogue.experiments();
    let Some(sample) = all.get(experiment).and_then(|e| e.sample()) else {
        let has = |name: &&str| STRIPS.contains(name) || all.get(name).is_some_and(|e| e.sample().is_some());
        let names: Vec<&str> = all.iter().map(|e| e.card().name).filter(has).collect();
        return Err(Failure::usage(format!(
            "fct: there is no sample of `{experiment}`; expected {}",
            names.join(", ")
        )));
    };
    let config = format!("{name}.toml");
    let mut files = vec![
        ("specimen.toml", sample.specimen.replace("NAME", name)),
        (config.as_str(), sample.config.replace("NAME", name)),
    ];
    files.extend(sample.records.iter().map(|(file, text)| (*file, (*text).to_owned())));
    let (paths, list) = write(folder, &files)?;
    let config = quoted_path(&folder.join(&config)).to_string();
    let text = format!(
        "written:\n{list}\nThe record is a synthetic sample: put yours in its place, and your dimensions into \
         specimen.toml.\nIt runs as it is:\n  fct check {config}\n  fct identify {config}\n"
    );
    Outcome::new(&json!({ "schema": SCHEMA, "files": paths }), text)
}

/// Writes files of a new folder: their paths, and a list of them.
fn write(folder: &Path, files: &[(&str, String)]) -> Result<(Vec<PathBuf>, String), Failure> {
    let made =
        |e| ::report::ReportError::Io { path: folder.to_owned(), action: "create the directory", source: e };
    std::fs::create_dir_all(folder).map_err(made)?;
    let mut paths = Vec::new();
    for (file, content) in files {
        let path = folder.join(file);
        write_atomic(&path, content.as_bytes())?;
        paths.push(path);
    }
    let list = paths.iter().map(|p| format!("  {}\n", p.display())).collect();
    Ok((paths, list))
}

/// A record as Instron's Bluehill exports it: what is known of the specimen, names, units, numbers.
fn raw(name: &str, record: &str) -> String {
    let header = format!(
        "Text Inputs : Specimen label,\"{name}\"\nText Inputs : Note,\"synthetic sample, computed by fct\"\n\
         General : Start Date,13/11/2025 5:14 PM\nDimension : Length,8.0,mm\nDimension : Width,6.0,mm\n\
         Dimension : Thickness,0.8,mm\nDimension : Notch,1.5,mm\nNumber Inputs : Rate 1,3.00,mm/min\n\n\
         Time,Extension,Load\n(sec),(mm),(N)\n"
    );
    let rows = record.lines().filter(|l| l.starts_with(|c: char| c.is_ascii_digit()));
    rows.fold(header, |text, row| text + row + "\n")
}
