//! `fct compare`: how far an identified model is off, and where.

use super::identify::identify;
use crate::outcome::{Failure, Outcome};
use crate::session::Session;
use ::report::answer::CompareAnswer;
use ::report::terminal;
use std::path::{Path, PathBuf};

/// Arguments of `fct compare`.
#[derive(Clone, Debug, clap::Args)]
pub struct Arguments {
    /// A run directory of `fct identify` or `fct discover`; a specimen or a config is identified first
    #[arg(value_name = "RUN")]
    pub run: PathBuf,
}

/// Compares the identified model with its records, as they stand in the run directory.
///
/// # Errors
/// Bad input, a directory that holds no identification; a file that cannot be identified.
pub fn run(arguments: &Arguments, session: &Session) -> Result<Outcome, Failure> {
    let place = if arguments.run.is_dir() {
        last_fitted_model(&arguments.run)
    } else {
        let case = session.fitted_case(&arguments.run)?;
        let place = session.place("identify", &case);
        identify(&case, &place, session, &session.progress(&case.name), &analysis::Meter::new(true))?.stored?
    };
    let run = session.stored(&place)?;
    let found = run.identify().ok_or_else(|| {
        Failure::usage(format!(
            "fct: {}: expected a finished run of `fct identify` or `fct discover`",
            place.display()
        ))
    })?;
    let curves = run.curves()?;
    let answer = CompareAnswer::new(&found, &curves);
    Outcome::new(&answer, terminal::compare(&answer, &found, &curves, session.style()))
}

/// Of a search the model that it chose; any other directory itself.
pub fn last_fitted_model(place: &Path) -> PathBuf {
    let fitted_model = |k: usize| place.join("rungs").join(k.to_string());
    (0..).map(fitted_model).take_while(|p| p.is_dir()).last().unwrap_or_else(|| place.to_owned())
}
