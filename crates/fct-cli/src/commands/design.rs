//! `fct design`: before the test, which protocol would show what.

use crate::outcome::{Failure, Outcome};
use crate::session::Session;
use analysis::{Asked, DesignRequest, design};
use serde_json::json;
use std::path::PathBuf;

/// Arguments of `fct design`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Examples:\n  fct design strip.toml --budget 30min\n  fct design strip.toml --rivals \
                        viscoelastic,lag --noise-N 0.005"
)]
pub struct Arguments {
    /// A specimen or a config: the geometry, a guess of the tissue, the kinds of tests
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    /// Longest time of all tests together: 90s, 30min, 2h
    #[arg(long, value_name = "TIME", default_value = "30min", value_parser = seconds)]
    pub budget: f64,
    /// Two effects to be told apart
    #[arg(long, value_name = "A,B", value_delimiter = ',')]
    pub rivals: Vec<String>,
    /// Noise of the load cell, standard deviation in N; default: the file's force_sd_N, its record's, or 0.5 % of the peak
    #[arg(long = "noise-N", value_name = "N", value_parser = positive)]
    pub noise_n: Option<f64>,
    /// Range of the load cell, N
    #[arg(long = "range-N", value_name = "N", value_parser = positive)]
    pub range_n: Option<f64>,
    /// Effects, or `all`, that the full model is asked about in the proposed protocol: minutes for each
    #[arg(long, value_name = "EFFECT,…", value_delimiter = ',')]
    pub full: Vec<String>,
}

/// A number above 0.
fn positive(text: &str) -> Result<f64, String> {
    let number = text.parse::<f64>().ok().filter(|x| x.is_finite() && *x > 0.0);
    number.ok_or_else(|| "expected a number above 0".to_owned())
}

/// A time with its unit, in s.
fn seconds(text: &str) -> Result<f64, String> {
    let units = [("min", 60.0), ("h", 3600.0), ("s", 1.0)];
    let of = |(unit, factor): (&str, f64)| Some((text.trim().strip_suffix(unit)?, factor));
    let found = units.into_iter().find_map(of);
    let (number, factor) = found.ok_or("expected a time with its unit, as 90s, 30min or 2h")?;
    Ok(factor * positive(number.trim())?)
}

/// What `--full` asks for.
fn asked(names: &[String]) -> Asked {
    match names {
        [] => Asked::None,
        [all] if all.trim() == "all" => Asked::All,
        names => Asked::Named(names.iter().map(|n| n.trim().to_owned()).collect()),
    }
}

/// Weighs protocols.
///
/// # Errors
/// A file that is no case, rivals that are not two effects, no protocol within the budget.
pub fn run(arguments: &Arguments, session: &Session) -> Result<Outcome, Failure> {
    let case = session.case(&arguments.file)?;
    let rivals = match arguments.rivals.as_slice() {
        [] => None,
        [a, b] if a != b => Some([a.trim().to_owned(), b.trim().to_owned()]),
        other => {
            let text = format!(
                "fct: --rivals names {}; expected two effects, as --rivals viscoelastic,lag",
                other.len()
            );
            return Err(Failure::usage(text));
        }
    };
    let request = DesignRequest {
        budget_s: arguments.budget,
        noise_n: arguments.noise_n,
        range_n: arguments.range_n,
        rivals: rivals.clone(),
        full: asked(&arguments.full),
    };
    let progress = |text: &str| session.say(text);
    let cancelled = || session.cancelled();
    let answer = design(&case, &session.catalogue, &request, &progress, &cancelled)?;
    let json = json!({
        "schema": ::report::answer::SCHEMA, "specimen": case.name, "budget_s": arguments.budget,
        "rivals": rivals, "design": answer,
    });
    Outcome::new(&json, ::report::terminal::design(&answer, session.style()))
}

#[cfg(test)]
mod tests {
    use super::{positive, seconds};

    #[test]
    fn a_time_needs_its_unit() {
        assert_eq!((seconds("90s"), seconds("30min"), seconds("2 h")), (Ok(90.0), Ok(1800.0), Ok(7200.0)));
        for bad in ["30", "min", "-3min", "1e999h", "NaN s", ""] {
            assert!(seconds(bad).is_err(), "{bad}");
        }
        assert!(positive("0").is_err() && positive("0.1").is_ok());
    }
}
