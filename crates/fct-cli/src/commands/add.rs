//! `fct add`: a config with an effect added, or with another law.

use super::edit::{next, refused, source, write};
use super::effects::unknown;
use crate::outcome::{Failure, Outcome};
use crate::session::Session;
use ::report::answer::SCHEMA;
use ::report::{ReportError, StoredRun};
use analysis::keeps_meaning;
use input::edit::{add_effect, choose_law};
use input::{LawRegistry, LawSite, keys_of_law};
use model::cost::Purpose;
use model::{Discretisation, Effect, Model, Options};
use params::ParamSpec;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Arguments of `fct add`.
#[derive(Clone, Debug, clap::Args)]
pub struct Arguments {
    /// Name of the effect (`fct effects` lists them), or of a law to take the place of the file's
    #[arg(value_name = "EFFECT")]
    pub effect: String,
    /// A run directory, or a config or specimen file
    #[arg(value_name = "RUN|FILE")]
    pub file: PathBuf,
}

/// What the screen of a run found out about an effect: start values and the reason. `diagnose` leaves it beside the answer,
/// `discover` in it.
fn finding(run: &StoredRun, effect: &str) -> Result<Option<Value>, ReportError> {
    let diagnosis = run.diagnosis()?;
    Ok(diagnosis
        .iter()
        .chain([&run.answer])
        .find_map(|answer| answer["screen"].as_array()?.iter().find(|f| f["effect"] == effect).cloned()))
}

/// What is ordinary of an effect on the records of a file; nothing where it has none, or cannot be run as it is.
fn ordinary(effect: &dyn Effect, file: &Path, session: &Session) -> Vec<f64> {
    let catalogue = &session.catalogue;
    let model = input::read_case(file, catalogue).ok().and_then(|case| {
        Model::checked(Arc::new(case), catalogue, Discretisation::default(), Purpose::Fit).ok()
    });
    let recorded = model.filter(|m| m.tests.iter().any(|t| t.test.record.is_some()));
    recorded.map(|m| effect.start(&analysis::scales(&m, &m.theta()))).unwrap_or_default()
}

/// To three digits: nobody knows more of what is ordinary.
fn rounded(x: f64) -> f64 {
    format!("{x:.2e}").parse().unwrap_or(x)
}

/// Writes the config with the effect, started from the run's screen where there is one, else from what is ordinary of it on the records;
/// comments and order kept.
///
/// # Errors
/// An unknown effect, one that is there already or excluded by another, an unreadable file.
pub fn run(arguments: &Arguments, session: &Session) -> Result<Outcome, Failure> {
    if let Some(site) = session.catalogue.site_of_law(&arguments.effect) {
        return law(arguments, site, session);
    }
    let Some(effect) = session.catalogue.get(&arguments.effect) else {
        return Err(unknown("effect or law", &arguments.effect, names(session)));
    };
    let card = effect.card();
    let from = source(&arguments.file)?;
    let specs = effect.parameters(&Options::new());
    let keys: Vec<String> = specs.iter().map(|s| s.key()).collect();
    let finding = match &from.run {
        Some(run) => finding(run, card.name)?,
        None => None,
    };
    let ordinary = if finding.is_none() { ordinary(&**effect, &from.file, session) } else { Vec::new() };
    let start = |at: usize, spec: &ParamSpec, key: &str| {
        let [lower, upper, card] = [spec.lower, spec.upper, spec.start].map(|x| spec.in_file_unit(x));
        let estimated = finding.as_ref().and_then(|f| f["estimate"][key].as_f64());
        let usual = ordinary.get(at).map(|&x| rounded(spec.in_file_unit(x)));
        estimated.or(usual).filter(|x| (lower..=upper).contains(x)).unwrap_or(card)
    };
    let parameters: Vec<(&str, f64, &str)> = (specs.iter().zip(&keys).enumerate())
        .map(|(at, (s, k))| (k.as_str(), start(at, s, k), &*s.description))
        .collect();
    let sentence = finding.as_ref().and_then(|f| f["sentence"].as_str());
    let reason = sentence.map_or_else(|| format!("{}: {}", card.name, card.summary), str::to_owned);
    let text =
        add_effect(&from.text, card.name, &parameters, &reason).map_err(|e| refused(&from, &e, session))?;
    let file = write(&from, &text, &format!("+{}", card.name), session)?;
    let shown = file.display().to_string();
    let json = json!({ "schema": SCHEMA, "file": file, "effect": card.name, "parameters": keys });
    Outcome::new(&json, format!("{shown}\nnext: {}\n", next(&from, &file)))
}

/// All that can be added.
fn names(session: &Session) -> Vec<String> {
    let laws = [LawSite::Bulk, LawSite::Interface].map(|site| session.catalogue.law_names(site));
    let effects = session.catalogue.iter().map(|e| e.card().name.to_owned());
    effects.chain(laws.into_iter().flatten()).collect()
}

/// The config with another law of a site; of what it says of the old one's parameters stays what [`keeps_meaning`].
fn law(arguments: &Arguments, site: LawSite, session: &Session) -> Result<Outcome, Failure> {
    let (law, from) = (&arguments.effect, source(&arguments.file)?);
    let case = input::read_case(&from.file, &session.catalogue)?;
    let present = if site == LawSite::Bulk { &case.bulk.law } else { &case.interface.law };
    if present == law {
        let said =
            format!("fct: {}: `{law}` is the law in [{}] already", from.file.display(), site.section());
        return Err(Failure::usage(said));
    }
    let specs = session.catalogue.law_parameters(site, law, &Options::new()).unwrap_or_default();
    let names = session.catalogue.law_names(site);
    let all = names.iter().flat_map(|name| keys_of_law(&session.catalogue, site, name));
    let gone = all.map(|k| k.name.to_string()).filter(|name| !keeps_meaning(site, &specs, name));
    let gone: Vec<String> = gone.collect();
    let reason = format!("`{law}` in place of the law that was here");
    let text = choose_law(&from.text, site.section(), law, &gone, &reason)
        .map_err(|e| refused(&from, &e, session))?;
    let file = write(&from, &text, &format!("+{law}"), session)?;
    let shown = file.display().to_string();
    let json = json!({ "schema": SCHEMA, "file": file, "effect": law, "parameters": [] });
    Outcome::new(&json, format!("{shown}\nnext: {}\n", next(&from, &file)))
}
