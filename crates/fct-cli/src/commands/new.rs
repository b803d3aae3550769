//! `fct new`: a scaffold that runs.

use crate::outcome::{Failure, Outcome};
use crate::session::Session;
use ::report::answer::SCHEMA;
use ::report::{quoted_path, write_atomic};
use serde_json::json;
use std::path::PathBuf;

/// Arguments of `fct new`.
#[derive(Clone, Debug, clap::Args)]
pub struct Arguments {
    /// Name of the specimen, and of the folder that is made
    #[arg(value_name = "NAME")]
    pub name: String,
}

const SPECIMEN: &str = include_str!("../../scaffold/specimen.toml");
const CONFIG: &str = include_str!("../../scaffold/config.toml");
const UNIAXIAL: &str = include_str!("../../scaffold/uniaxial.csv");
const TEARING: &str = include_str!("../../scaffold/tearing.csv");

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
    let made =
        |e| ::report::ReportError::Io { path: folder.clone(), action: "create the directory", source: e };
    std::fs::create_dir_all(&folder).map_err(made)?;
    let config = format!("{name}.toml");
    let files = [
        ("specimen.toml", SPECIMEN.replace("NAME", name)),
        (config.as_str(), CONFIG.replace("NAME", name)),
        ("uniaxial.csv", UNIAXIAL.to_owned()),
        ("tearing.csv", TEARING.to_owned()),
    ];
    let mut paths = Vec::new();
    for (file, content) in files {
        let path = folder.join(file);
        write_atomic(&path, content.as_bytes())?;
        paths.push(path);
    }
    let list: String = paths.iter().map(|p| format!("  {}\n", p.display())).collect();
    let config = folder.join(&config);
    let text = format!(
        "written:\n{list}\nThe records are synthetic samples: put yours in their place, and your dimensions into\n\
         specimen.toml. It runs as it is:\n  fct check {c}\n  fct identify {c}\n",
        c = quoted_path(&config)
    );
    Outcome::new(&json!({ "schema": SCHEMA, "files": paths }), text)
}
