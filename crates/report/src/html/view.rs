//! What a page shows, gathered from run directories: the rungs of a ladder, the diagnosis, pictures.

use super::sliders::Response;
use crate::answer::IdentifyAnswer;
use crate::law_columns::default_laws;
use crate::peek::list;
use crate::runs::StoredRun;
use crate::shell::quoted_path;
use crate::{Curve, ReportError};
use analysis::LawNames;
use serde_json::Value;
use std::path::Path;

/// Ancestors that a page follows: a longer chain is a loop of the user's making.
const ANCESTORS: usize = 12;

/// One model of the ladder: its answer and its curves.
pub struct FittedModel {
    /// Effects in the model.
    pub answer: IdentifyAnswer,
    /// Its curves.
    pub curves: Vec<Curve>,
    /// Pictures of the strip, by test; empty where none were stored.
    pub pictures: Vec<(String, String)>,
    /// Derivatives of the forces; empty where none were stored.
    pub response: Response,
    /// Its run directory, as a shell takes it.
    pub run: String,
    /// Rms, χ² and BIC as the search judged them; `None` outside a search.
    pub judged: Option<Value>,
    /// What it has beside the base of its ladder: other laws, effects.
    pub parts: Vec<String>,
}

/// Everything a page shows.
pub struct View {
    /// The run that the page is of.
    pub run: StoredRun,
    /// The ladder, base first; a single identification is a ladder of one.
    pub fitted_models: Vec<FittedModel>,
    /// The rung shown first.
    pub shown: usize,
    /// Answer of `fct discover` or `fct diagnose`.
    pub diagnosis: Option<Value>,
}

impl FittedModel {
    /// A rung from the run directory of an identification.
    ///
    /// # Errors
    /// If its curves or pictures are damaged.
    pub fn of(run: &StoredRun, files: &Path) -> Result<Option<Self>, ReportError> {
        let Some(answer) = run.identify() else { return Ok(None) };
        let at = run.in_folder(files);
        let pictures = pictures(&at, answer.tests.keys())?;
        let (response, run) = (Response::of(&at)?, quoted_path(&run.path));
        let (curves, parts) = (at.curves()?, answer.effects.clone());
        Ok(Some(Self { pictures, curves, response, run, answer, judged: None, parts }))
    }

    /// The same on a ladder whose base has these laws.
    fn beside(mut self, base: Option<&LawNames>) -> Self {
        if let Some(row) = &self.judged {
            self.parts = list(row, "effects");
        }
        if let (Some(own), Some(base)) = (&self.answer.laws, base) {
            self.parts = own.parts(base, &self.parts);
        }
        self
    }

    /// The model in words: what it has beside the base, laws that are not the base's and effects.
    pub fn name(&self) -> String {
        if self.parts.is_empty() { "base model".into() } else { self.parts.join(" + ") }
    }

    /// Reduced χ² with numerical error: the search's own where there was one.
    pub fn chi2(&self) -> f64 {
        self.number("reduced_chi2_total").unwrap_or(self.answer.reduced_chi2_total)
    }

    /// Reduced χ² with the record's noise alone, where it is large and with the mesh's error is not: that hides what is left.
    pub fn explained_with_mesh_error(&self) -> Option<f64> {
        let chi2 = self.number("reduced_chi2").unwrap_or(self.answer.reduced_chi2);
        (chi2 > diagnose::MESH_ERROR_ONLY && self.answer.explained).then_some(chi2)
    }

    /// Reduced χ² of the curves and tables shown, where the search judged its own, corrected, run otherwise by more than
    /// a quarter.
    pub fn on_the_file_s_mesh(&self) -> Option<f64> {
        let (own, judged) = (self.answer.reduced_chi2_total, self.number("reduced_chi2_total")?);
        ((own / judged).ln().abs() > 0.22).then_some(own)
    }

    /// Rms misfit over all force points, N.
    pub fn rms(&self) -> f64 {
        self.number("rms_N").unwrap_or(self.answer.rms_N)
    }

    /// Bayesian information criterion.
    pub fn bic(&self) -> Option<f64> {
        self.number("bic").or(self.answer.bic)
    }

    /// Rms misfit of held-out segments, N.
    pub fn held_out(&self) -> Option<f64> {
        self.number("held_out_rms_N").or(self.answer.held_out_rms_N)
    }

    fn number(&self, key: &str) -> Option<f64> {
        self.judged.as_ref()?.get(key)?.as_f64()
    }

    /// Noise over all force points, N: what the rms of a true model would be.
    pub fn noise(&self) -> f64 {
        let (mut sum, mut points) = (0.0, 0);
        for t in self.answer.tests.values() {
            sum += t.noise_N.powi(2) * t.points as f64;
            points += t.points;
        }
        (sum / f64::from(points.max(1) as u32)).sqrt()
    }
}

/// Each rung with what it has beside a base of these laws.
fn beside(base: Option<LawNames>, fitted_models: Vec<FittedModel>) -> Vec<FittedModel> {
    fitted_models.into_iter().map(|r| r.beside(base.as_ref())).collect()
}

/// The pictures of the strip that a run stored, by test.
///
/// # Errors
/// If one of them is damaged.
pub(super) fn pictures<'a>(
    run: &StoredRun,
    tests: impl Iterator<Item = &'a String>,
) -> Result<Vec<(String, String)>, ReportError> {
    let file = |t: &String| format!("figures/{t}-S22.svg");
    tests.filter(|t| run.holds(&file(t))).map(|t| Ok((t.clone(), run.text(&file(t))?))).collect()
}

impl View {
    /// The view of one run; `files`: where its files are (while it is written, not its final place).
    ///
    /// # Errors
    /// If a file of the run, or of one that it was derived from, is damaged.
    pub fn of(run: &StoredRun, files: &Path) -> Result<Self, ReportError> {
        let mut fitted_models: Vec<FittedModel> =
            match (run.info.command.as_str(), FittedModel::of(run, files)?) {
                ("discover", _) => searched(run, files)?,
                (_, Some(own)) => {
                    // An ancestor that cannot be read any more is no step of the staircase.
                    let chain = ancestors(run);
                    chain
                        .iter()
                        .filter_map(|a| FittedModel::of(a, &a.path).ok().flatten())
                        .chain([own])
                        .collect()
                }
                // An unfinished run: its ancestors are not what was asked for.
                (_, None) => Vec::new(),
            };
        let base = fitted_models.first().and_then(|r| r.answer.laws.clone());
        fitted_models = beside(base, fitted_models);
        let shown = fitted_models.len().saturating_sub(1);
        if let Some(last) = fitted_models.last_mut()
            && last.pictures.is_empty()
        {
            last.pictures = FittedModel::of(run, files)?.map(|r| r.pictures).unwrap_or_default();
        }
        let diagnosis = if run.info.command == "discover" {
            Some(run.answer.clone())
        } else {
            // What was missing in an ancestor is what this run was made to show.
            match run.in_folder(files).diagnosis()? {
                Some(own) => Some(own),
                None => ancestors(run).into_iter().find_map(|a| a.diagnosis().ok().flatten()),
            }
        };
        Ok(Self { run: run.clone(), fitted_models, shown, diagnosis })
    }

    /// A ladder over several runs of one specimen, ordered as `fct ladder` orders them.
    ///
    /// # Errors
    /// If one of them is no finished identification or of another specimen.
    pub fn of_runs(runs: &[StoredRun]) -> Result<Self, ReportError> {
        let not = |run: &StoredRun, reason: &str| ReportError::NotARun {
            path: run.path.clone(),
            reason: reason.to_owned(),
        };
        let first = runs.first().ok_or_else(|| ReportError::NotARun {
            path: Default::default(),
            reason: "no run directory was named".into(),
        })?;
        let mut fitted_models = Vec::new();
        for run in runs {
            let fitted_model = FittedModel::of(run, &run.path)?
                .ok_or_else(|| not(run, "expected a finished run of `fct identify`"))?;
            if run.answer.get("specimen") != first.answer.get("specimen") {
                return Err(not(run, "this run is of another specimen than the first"));
            }
            fitted_models.push((fitted_model, run));
        }
        fitted_models.sort_by(|(a, _), (b, _)| {
            (a.answer.effects.len().cmp(&b.answer.effects.len())).then(b.rms().total_cmp(&a.rms()))
        });
        let run = fitted_models.last().map_or(first, |r| r.1).clone();
        let base = fitted_models.first().map_or(first, |r| r.1);
        let diagnosis = base.diagnosis()?;
        let shown = fitted_models.len().saturating_sub(1);
        // The first of them need not be what the others were made from: laws are named as `fct ladder` names them.
        let fitted_models = beside(Some(default_laws()), fitted_models.into_iter().map(|r| r.0).collect());
        Ok(Self { run, fitted_models, shown, diagnosis })
    }

    /// The rung shown first.
    pub fn current(&self) -> Option<&FittedModel> {
        self.fitted_models.get(self.shown)
    }
}

/// The rungs that `fct discover` stored, with the search's own judgement of each.
fn searched(run: &StoredRun, files: &Path) -> Result<Vec<FittedModel>, ReportError> {
    let rows = run.answer.get("ladder").and_then(Value::as_array).cloned().unwrap_or_default();
    let mut fitted_models = Vec::new();
    for (k, row) in rows.into_iter().enumerate() {
        let place = files.join("rungs").join(k.to_string());
        // A rung that could not be computed was not stored.
        if place.is_dir()
            && let Some(fitted_model) = FittedModel::of(&StoredRun::read(&place)?, &place)?
        {
            let own = quoted_path(&run.path.join("rungs").join(k.to_string()));
            fitted_models.push(FittedModel { judged: Some(row), run: own, ..fitted_model });
        }
    }
    Ok(fitted_models)
}

/// The runs that this one was derived from (`fct add` keeps the parent), oldest first.
fn ancestors(run: &StoredRun) -> Vec<StoredRun> {
    let mut out: Vec<StoredRun> = Vec::new();
    let mut input = run.input.clone();
    while out.len() < ANCESTORS {
        let Some(parent) = parent_of(&input) else { break };
        let seen = out.iter().any(|r| r.path == Path::new(&parent)) || run.path == Path::new(&parent);
        let Ok(found) = StoredRun::read(Path::new(&parent)) else { break };
        if seen || found.answer.get("specimen") != run.answer.get("specimen") {
            break;
        }
        input = found.input.clone();
        out.push(found);
    }
    out.reverse();
    out
}

fn parent_of(input: &str) -> Option<String> {
    let table: toml::Table = input.parse().ok()?;
    Some(table.get("parent")?.as_str()?.to_owned())
}
