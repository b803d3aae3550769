//! The answer of `fct identify`.

use super::parts::{ByEnergy, ParameterAnswer, PublishedSummary, StageEnd, StageHistory, TestFit, Trial};
use super::remarks::{by_energy, held_at_limits, mesh_dominated, remarks, weighed};
use super::{EnergyAnswer, PathMean, SCHEMA, finite};
use crate::published::Published;
use analysis::{HistoryEntry, Identified, LawNames, Left, PhaseCost, SimulatedTest};
use indexmap::IndexMap;
use inverse::Quality;
use model::Channel;
use serde::{Deserialize, Serialize};

/// A finished identification.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct IdentifyAnswer {
    /// Layout version.
    pub schema: u32,
    /// Name of the specimen.
    pub specimen: String,
    /// Where the specimen's data come from.
    pub provenance: String,
    /// Effects in the model.
    pub effects: Vec<String>,
    /// Laws of the model; unknown of runs of earlier versions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub laws: Option<LawNames>,
    /// Every free parameter.
    pub parameters: Vec<ParameterAnswer>,
    /// Means of what varies along the tear path, by name (`gc`, `sigma_c`), where the records fix them.
    #[serde(default, skip_serializing_if = "IndexMap::is_empty")]
    pub path_means: IndexMap<String, PathMean>,
    /// Fit of each test's force, by test.
    pub tests: IndexMap<String, TestFit>,
    /// Fit of the camera channels, by `test.channel`; misfits in mm.
    #[serde(default, skip_serializing_if = "IndexMap::is_empty")]
    pub channels: IndexMap<String, TestFit>,
    /// What the model leaves unexplained, share of the peak force, and to what the records are explained.
    #[serde(flatten, default, skip_serializing_if = "Option::is_none")]
    pub left: Option<Left>,
    /// Root mean square misfit over all force points, N.
    pub rms_N: f64,
    /// χ² per degree of freedom with the record's noise alone.
    pub reduced_chi2: f64,
    /// The same with the model's numerical error.
    pub reduced_chi2_total: f64,
    /// Whether the model explains the records (judged by `reduced_chi2_total`).
    pub explained: bool,
    /// Rms misfit of whole segments that were held out, to first order, N.
    #[serde(default)]
    pub held_out_rms_N: Option<f64>,
    /// Bayesian information criterion.
    pub bic: Option<f64>,
    /// Accepted steps of the search, the most of any stage.
    pub iterations: usize,
    /// Model runs, coarse ones included.
    pub forward_runs: usize,
    /// Wall-clock time, s.
    pub seconds: f64,
    /// What each phase took.
    #[serde(default)]
    pub cost: Vec<PhaseCost>,
    /// Why the search ended, stage by stage.
    pub stopped_because: String,
    /// The same as data.
    pub stages: Vec<StageEnd>,
    /// What the records hardly fix, in words.
    pub sloppy: Vec<String>,
    /// Correlations of the parameters, in their order.
    pub correlations: Vec<Vec<Option<f64>>>,
    /// Every run of the search.
    pub history: Vec<StageHistory>,
    /// Published values beside the identified ones, where the specimen has some.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub published: Option<PublishedSummary>,
    /// Meshes too coarse, intervals that are mostly the mesh's error, steps too large.
    #[serde(default)]
    pub remarks: Vec<String>,
    /// How several starts agreed, where there were several.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub starts: Option<String>,
}

impl IdentifyAnswer {
    /// The answer of a finished identification; `replayed`: the fitted model's runs with energies.
    pub fn new(
        done: &Identified,
        replayed: &[SimulatedTest],
        published: Option<&Published>,
        seconds: f64,
    ) -> Self {
        let case = &done.model.case;
        let parameters = parameters(done, published);
        let (tests, channels) = fits(done, replayed);
        let force: Vec<&TestFit> = tests.values().collect();
        let points: usize = force.iter().map(|t| t.points).sum();
        let squares: f64 = force.iter().map(|t| t.objective).sum();
        let stages: Vec<StageEnd> = done
            .stopped
            .iter()
            .map(|(s, reason, converged)| StageEnd {
                stage: s.word().into(),
                reason: reason.clone(),
                converged: *converged,
            })
            .collect();
        let limits = held_at_limits(&done.model.parameters).into_iter();
        let dominated = mesh_dominated(&done.mesh_dominated, &tests);
        let weighed = weighed(case).into_iter();
        let remarks = weighed.chain(limits).chain(dominated).chain(remarks(replayed)).collect();
        let mut answer = Self {
            schema: SCHEMA,
            specimen: case.name.clone(),
            provenance: case.provenance.clone(),
            effects: done.model.effects(),
            laws: Some(LawNames::of(case)),
            published: published.map(|p| summary(p, &parameters)),
            parameters,
            path_means: IndexMap::new(),
            tests,
            channels,
            left: done.left.clone(),
            rms_N: (squares / points.max(1) as f64).sqrt(),
            reduced_chi2: done.quality.reduced_chi2,
            reduced_chi2_total: done.quality.reduced_chi2_total,
            explained: explained(&done.quality),
            held_out_rms_N: done.held_out().and_then(|h| finite(h.rms)),
            bic: finite(done.quality.bic),
            iterations: done.iterations,
            forward_runs: done.forward_runs,
            seconds,
            cost: Vec::new(),
            stopped_because: sentence(&stages),
            stages,
            sloppy: done.uncertainty.sloppy_directions(),
            correlations: correlations(done),
            remarks,
            history: histories(&done.history),
            starts: done.starts.clone(),
        };
        answer.path_means = answer.means_along_path();
        answer.remarks.extend(answer.beside());
        answer
    }

    /// Those of the remarks that say nothing against the answer: the toughness by the energy of each record.
    pub fn beside(&self) -> Vec<String> {
        by_energy(&self.tests, self.path_means.get("gc"))
    }
}

/// The rule of the diagnosis: χ² at most 1.2, or what the sampling spread allows.
fn explained(q: &Quality) -> bool {
    let policy = diagnose::Policy::default();
    let spread = 1.0 + policy.explained_sigmas * (2.0 / q.freedom.max(1.0)).sqrt();
    q.reduced_chi2_total <= policy.explained_chi2.max(spread)
}

fn sentence(stages: &[StageEnd]) -> String {
    stages.iter().map(|s| format!("{}: {}", s.stage, s.reason)).collect::<Vec<_>>().join(" ")
}

fn parameters(done: &Identified, published: Option<&Published>) -> Vec<ParameterAnswer> {
    let mut out = Vec::new();
    let areas = done.model.case.interface.areas;
    for (&i, e) in done.free.iter().zip(&done.uncertainty.estimates) {
        if done.model.is_hidden(i) {
            continue;
        }
        let spec = &done.model.parameters[i].spec;
        let value = published.and_then(|p| p.value(&e.path, spec, areas));
        let own = value.filter(|at| !at.averaged).map(|at| at.value);
        let inside = own.map(|v| e.interval_95[0] <= v && v <= e.interval_95[1]);
        out.push(ParameterAnswer {
            path: e.path.clone(),
            value: e.value,
            unit: spec.quantity.unit().into(),
            std_error: e.std_error.and_then(finite),
            interval_95: e.interval_95.map(finite),
            interval_95_if_right: e.interval_95_if_right.map(finite),
            at_bound: e.at_bound,
            identifiable: e.identifiable,
            published: value.map(|at| at.value),
            published_averaged: value.is_some_and(|at| at.averaged),
            published_in_interval: inside,
        });
    }
    out
}

fn summary(p: &Published, parameters: &[ParameterAnswer]) -> PublishedSummary {
    let inside: Vec<bool> =
        parameters.iter().filter(|p| p.identifiable).filter_map(|p| p.published_in_interval).collect();
    PublishedSummary {
        source: p.source.clone(),
        notes: p.notes.clone(),
        compared: inside.len(),
        inside: inside.iter().filter(|i| **i).count(),
        averaged: parameters.iter().filter(|p| p.published_averaged).count(),
    }
}

type Fits = IndexMap<String, TestFit>;

fn fits(done: &Identified, replayed: &[SimulatedTest]) -> (Fits, Fits) {
    let (mut tests, mut channels) = (Fits::new(), Fits::new());
    let blocks = done.measured.data.blocks.iter().zip(&done.measured.slots).zip(&done.quality.blocks);
    for ((block, slot), quality) in blocks {
        let error = done.numerical_error.rows(block.range.start, block.range.len());
        let force = slot.channel == Channel::Force;
        let name = &done.model.tests[slot.test].test.name;
        let energy = replayed.iter().find(|t| force && t.name == *name).map(EnergyAnswer::new);
        let test = &done.model.tests[slot.test].test;
        let record = test.record.as_ref().filter(|_| force);
        let balance = record.and_then(|r| (test.kind.balance)(&done.model.case.geometry, r));
        let fit = TestFit {
            rms_N: quality.rms,
            noise_N: quality.noise,
            reduced_chi2: quality.reduced_chi2,
            reduced_chi2_total: quality.reduced_chi2_total,
            objective: quality.objective,
            points: quality.points,
            numerical_error_N: error.norm() / (error.len().max(1) as f64).sqrt(),
            peak_N: block.measured.iter().fold(0.0, |m, v| m.max(v.abs())),
            energy,
            gc_by_energy: balance.map(|b| ByEnergy { gc_N_per_mm: b.gc, how: b.how.to_owned() }),
        };
        if force {
            tests.insert(name.clone(), fit)
        } else {
            channels.insert(block.name.clone(), fit)
        };
    }
    (tests, channels)
}

fn correlations(done: &Identified) -> Vec<Vec<Option<f64>>> {
    let shown: Vec<usize> = (0..done.free.len()).filter(|&k| !done.model.is_hidden(done.free[k])).collect();
    let c = &done.uncertainty.correlation;
    shown.iter().map(|&i| shown.iter().map(|&j| finite(c[(i, j)])).collect()).collect()
}

/// Runs grouped by stage, mesh and parameters, in order.
pub(crate) fn histories(entries: &[HistoryEntry]) -> Vec<StageHistory> {
    let mut out: Vec<StageHistory> = Vec::new();
    for e in entries {
        let trial = Trial {
            iteration: e.iterate.iteration,
            f: e.iterate.f.and_then(finite),
            accepted: e.iterate.accepted,
            theta: e.iterate.theta.clone(),
        };
        let stage = e.stage.word();
        match out.last_mut() {
            // A stage begins with its iteration 0.
            Some(h)
                if h.stage == stage && h.coarse == e.coarse && h.paths == e.paths && trial.iteration > 0 =>
            {
                h.runs.push(trial);
            }
            _ => out.push(StageHistory {
                stage: stage.into(),
                coarse: e.coarse,
                paths: e.paths.clone(),
                runs: vec![trial],
            }),
        }
    }
    out
}
