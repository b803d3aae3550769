//! The answers of compare, diagnose and discover, in the contract's words.

use crate::averaged::Averaged;
use crate::compare::{self, Where};
use crate::cost::PhaseCost;
use crate::identify::AnalysisError;
use crate::journal::{Journal, Recent};
use crate::ladder::laws::other_laws;
use crate::ladder::{Adds, FeLadder, LadderSettings, LeftOut, NextTest, SearchOutcome, Weighed};
use crate::law_names::LawNames;
use crate::parsimony::OneStrength;
use crate::probable::{Left, PosteriorAnswer};
use crate::problem::Cancelled;
use crate::told;
use diagnose::{Finding, FittedModel, Policy, Screen, Verdict};
use input::{BulkConfig, Case, EffectConfig, InterfaceConfig};
use model::Catalogue;
use serde::Serialize;
use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Instant;

/// One effect of the screen.
#[derive(Clone, Debug, Serialize)]
pub struct ScreenRow {
    /// Name in the catalogue.
    pub effect: String,
    /// Expected fall as a share of χ².
    pub expected_fall: f64,
    /// p-value with the noise as estimated from the records, shapes paid for.
    pub p_value: f64,
    /// The same with noise as correlated as the records allow, which decides.
    pub p_conservative: f64,
    /// That, adjusted for the whole catalogue.
    pub q_value: f64,
    /// Estimated parameters by file key.
    pub estimate: BTreeMap<String, f64>,
    /// Whether a plausible amplitude would be seen.
    pub visible: bool,
    /// Standard deviations at which a plausible amplitude shows beyond the base parameters.
    pub signal_to_noise: f64,
    /// Whether it is called for.
    pub significant: bool,
    /// A short refit decides, not the derivative.
    pub refit_only: bool,
    /// Effects that these records cannot tell from it.
    pub look_alikes: Vec<String>,
    /// The finding as a sentence.
    pub sentence: String,
}

/// One step of the staircase.
#[derive(Clone, Debug, Serialize)]
pub struct LadderRow {
    /// What the search added to the base: effects, and laws in place of the file's.
    pub effects: Vec<String>,
    /// The laws of the model.
    pub laws: LawNames,
    /// Free parameters.
    pub parameters: usize,
    /// Root mean square misfit over all force points, N.
    #[serde(rename = "rms_N")]
    pub rms_n: f64,
    /// Reduced χ² with the record's noise alone.
    pub reduced_chi2: f64,
    /// The same with the model's numerical error.
    pub reduced_chi2_total: f64,
    /// Root mean square misfit of held-out segments, N.
    #[serde(rename = "held_out_rms_N")]
    pub held_out_rms_n: Option<f64>,
    /// Bayesian information criterion.
    pub bic: f64,
    /// What became of base and effect parameters at this rung.
    pub values: BTreeMap<String, f64>,
    /// The effects of the model with the form they were fitted in.
    #[serde(skip)]
    pub forms: Vec<EffectConfig>,
    /// Its law of the tissue where that is not the file's.
    #[serde(skip)]
    pub bulk: Option<BulkConfig>,
    /// Its law of the tear likewise.
    #[serde(skip)]
    pub interface: Option<InterfaceConfig>,
}

/// Answer of `fct diagnose` and `fct discover`.
#[derive(Clone, Debug, Serialize)]
pub struct DiscoverAnswer {
    /// Version of this answer's form.
    pub schema: u32,
    /// Specimen.
    pub specimen: String,
    /// Where the data come from.
    pub provenance: String,
    /// The whole catalogue at the base model, most significant first.
    pub screen: Vec<ScreenRow>,
    /// Accepted models, base first (empty for diagnose).
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub ladder: Vec<LadderRow>,
    /// Effects added in the end.
    pub found: Vec<String>,
    /// For each of `found`: itself and every effect these records cannot tell from it.
    pub groups: Vec<Vec<String>>,
    /// `nothing_missing`, `explained`, `ambiguous`, `unexplained`.
    pub verdict: String,
    /// The verdict as sentences.
    pub words: Vec<String>,
    /// How probable each set of effects is.
    pub posterior: PosteriorAnswer,
    /// What the leading model leaves, and to what it explains the records.
    #[serde(flatten)]
    pub left: Left,
    /// The tissue's values, averaged over what may be missing (discover only).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub averaged: Option<Averaged>,
    /// Where the base model fails.
    #[serde(rename = "where")]
    pub place: Vec<Where>,
    /// Models with one strength along the path, where the case has many areas (discover only).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub one_strength: Option<OneStrength>,
    /// What would separate the rivals.
    pub next_test: Option<NextTest>,
    /// Ends of records that the search left out, since no effect came near the whole (discover only).
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub left_out: Vec<LeftOut>,
    /// Forward runs.
    pub forward_runs: usize,
    /// Wall time, s.
    pub seconds: f64,
    /// What each phase took.
    pub cost: Vec<PhaseCost>,
    /// What each effect would add to the base model's forces; a table of its own in the run directory.
    #[serde(skip)]
    pub adds: Adds,
    /// The case that was searched: as given, or with weights of zero on what was left out.
    #[serde(skip)]
    pub case: Arc<Case>,
}

fn screen_rows(screen: &Screen, policy: &Policy, catalogue: &Catalogue) -> Vec<ScreenRow> {
    screen
        .findings
        .iter()
        .map(|f| in_file_units(f, catalogue))
        .map(|f| ScreenRow {
            expected_fall: f.expected_fall,
            p_value: f.p_shown(),
            p_conservative: f.p_value,
            q_value: f.q_value,
            estimate: f.amplitudes.iter().chain(&f.shape).cloned().collect(),
            visible: f.visible,
            signal_to_noise: f.snr,
            significant: f.significant,
            refit_only: f.refit_only,
            sentence: diagnose::words::finding(&f, policy),
            effect: f.effect,
            look_alikes: f.look_alikes,
        })
        .collect()
}

/// A finding as a file would give it: values in the unit of their key, neutral values added.
fn in_file_units(f: &Finding, catalogue: &Catalogue) -> Finding {
    let specs = catalogue.get(&f.effect).map(|e| e.parameters(&model::Options::new())).unwrap_or_default();
    let spec = |name: &str| specs.iter().find(|s| s.key() == name);
    let mut shown = f.clone();
    for (name, value) in &mut shown.amplitudes {
        *value = spec(name).map_or(*value, |s| s.in_file_unit(*value + s.neutral.unwrap_or(0.0)));
    }
    for (name, value) in &mut shown.shape {
        *value = spec(name).map_or(*value, |s| s.in_file_unit(*value));
    }
    shown
}

pub(crate) fn word(v: Verdict) -> &'static str {
    match v {
        Verdict::NothingMissing => "nothing_missing",
        Verdict::Explained => "explained",
        Verdict::Ambiguous => "ambiguous",
        Verdict::Unexplained => "unexplained",
    }
}

pub(crate) fn ladder_row(l: &FeLadder, r: &FittedModel) -> LadderRow {
    let fitted = l.shown(&FeLadder::key(&r.effects));
    let values = fitted.map_or_else(BTreeMap::new, |f| {
        f.free.iter().map(|&i| (f.model.parameters[i].path.clone(), f.theta[i])).collect()
    });
    let case = fitted.map(|f| &f.model.case);
    LadderRow {
        effects: r.effects.clone(),
        laws: LawNames::of(case.map_or(l.case(), |c| c)),
        parameters: r.parameters,
        rms_n: r.rms,
        reduced_chi2: r.reduced_chi2,
        reduced_chi2_total: r.reduced_chi2_total(),
        held_out_rms_n: r.held_out_rms,
        bic: r.bic,
        values,
        forms: fitted.map_or_else(Vec::new, |f| f.model.case.effects.clone()),
        bulk: case.map(|c| c.bulk.clone()).filter(|b| b.law != l.case().bulk.law),
        interface: case.map(|c| c.interface.clone()).filter(|i| i.law != l.case().interface.law),
    }
}

/// Weighs the catalogue by its derivatives at the identified model: nothing is refitted.
///
/// # Errors
/// [`AnalysisError`].
pub fn diagnose(
    case: Arc<Case>,
    catalogue: &Catalogue,
    progress: &(dyn Fn(&str) + Sync),
    cancelled: Cancelled,
    journal: &dyn Journal,
) -> Result<DiscoverAnswer, AnalysisError> {
    let start = Instant::now();
    let policy = Policy::default();
    let recent = Recent::new(journal);
    let how = LadderSettings { catalogue, policy: policy.clone(), progress, cancelled, journal: &recent };
    let mut ladder = FeLadder::weighing(case.clone(), how)?;
    let weighed = ladder.weighed_by_columns()?;
    let mut words = vec![compare::place_in_words(&compare::residuals_of(&ladder))];
    words.extend(told::probabilities(&weighed.probable));
    words.push(
        "These are probabilities by derivatives at this model: `fct discover` fits the effects before it names one.".into(),
    );
    Ok(DiscoverAnswer { ladder: Vec::new(), words, ..answer(&ladder, weighed, case, start, &policy) })
}

/// What a screen and a search say alike: the case, the screen, where the base model is off, the cost.
fn answer(
    ladder: &FeLadder,
    weighed: Weighed,
    case: Arc<Case>,
    start: Instant,
    policy: &Policy,
) -> DiscoverAnswer {
    let Weighed { discovery: d, probable, averaged } = weighed;
    DiscoverAnswer {
        schema: 1,
        specimen: case.name.clone(),
        provenance: case.provenance.clone(),
        screen: screen_rows(&d.screen, policy, ladder.catalogue()),
        ladder: d.ladder.iter().map(|r| ladder_row(ladder, r)).collect(),
        found: d.found,
        groups: d.groups,
        verdict: word(d.verdict).to_owned(),
        words: Vec::new(),
        posterior: probable.posterior,
        left: probable.left,
        averaged,
        place: compare::places(&compare::residuals_of(ladder)),
        one_strength: None,
        next_test: None,
        left_out: Vec::new(),
        forward_runs: ladder.runs(),
        seconds: start.elapsed().as_secs_f64(),
        cost: Vec::new(),
        adds: ladder.adds(&d.screen),
        case,
    }
}

/// The whole loop: fits every effect, and sets of them, and answers with their probabilities.
///
/// # Errors
/// [`AnalysisError`].
pub fn discover(
    case: Arc<Case>,
    catalogue: &Catalogue,
    progress: &(dyn Fn(&str) + Sync),
    cancelled: Cancelled,
    journal: &dyn Journal,
) -> Result<DiscoverAnswer, AnalysisError> {
    let start = Instant::now();
    let policy = Policy::default();
    let recent = Recent::new(journal);
    let how = LadderSettings { catalogue, policy: policy.clone(), progress, cancelled, journal: &recent };
    let SearchOutcome { weighed, ladder, case, left_out } = FeLadder::search(case, how)?;
    let next_test = ladder.next_test(&weighed.discovery);
    let mut words = told::words(&weighed, &other_laws(ladder.case(), catalogue));
    // Right after the verdict.
    words.splice(1..1, told::without(&left_out));
    Ok(DiscoverAnswer { words, next_test, left_out, ..answer(&ladder, weighed, case, start, &policy) })
}
