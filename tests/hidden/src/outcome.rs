//! The answer to one case, and how it compares with the truth.

use crate::files::Truth;
use crate::imitate::{self, Imitated};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// One effect of the screen at the base model.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct ScreenRow {
    /// Effect.
    pub effect: String,
    /// Predicted fall of χ².
    pub fall: f64,
    /// p-value adjusted for the catalogue.
    pub q_value: f64,
    /// Standard deviations of a plausible amplitude beyond the base.
    pub snr: f64,
    /// Called for.
    pub significant: bool,
    /// A short refit decides.
    pub refit_only: bool,
    /// Look-alikes.
    pub look_alikes: Vec<String>,
}

/// One fitted model.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Step {
    /// Effects.
    pub effects: Vec<String>,
    /// χ² with numerical error and priors: what was minimised.
    pub objective: f64,
    /// Reduced χ², numerical error included.
    pub reduced_chi2_total: f64,
    /// Bayesian information criterion.
    pub bic: f64,
    /// Root mean square misfit of the forces, N.
    #[serde(rename = "rms_N")]
    pub rms_n: f64,
    /// Reduced χ² of what was held out.
    pub held_out_chi2: Option<f64>,
    /// p-value of left-over structure.
    pub structure_p: f64,
    /// Mean fracture energy of the areas, N/mm.
    pub gc: f64,
    /// Whether it counts as explained.
    pub explained: bool,
    /// Fitted values of its free parameters.
    #[serde(default)]
    pub values: BTreeMap<String, f64>,
}

/// What an answer states.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Stated {
    /// Probability that each effect acts.
    pub effects: BTreeMap<String, f64>,
    /// That nothing is missing.
    pub nothing: f64,
    /// That something is that the catalogue does not hold.
    pub something_else: f64,
    /// Rest of the leading model, share of the peak.
    pub rest: f64,
    /// Mean Gc of the base model along the path with its 95 % interval, which allows for what that model misses, N/mm; `None`:
    /// these records do not fix it.
    pub base_gc: Option<[f64; 3]>,
    /// The same averaged over what may be missing, each set with its share of the posterior.
    #[serde(default)]
    pub averaged_gc: Option<[f64; 3]>,
}

/// How a case ended.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum End {
    /// With an answer.
    Answered,
    /// Stopped by the time limit; the answer is what stood then.
    TimeLimit,
    /// Not at all.
    Failed(String),
}

/// The answer to one case.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Outcome {
    /// What was hidden.
    pub truth: Truth,
    /// How it ended.
    pub end: End,
    /// `nothing_missing`, `explained`, `ambiguous`, `unexplained`; empty without an answer.
    pub verdict: String,
    /// Effects added in the end.
    pub found: Vec<String>,
    /// For each of them: itself and its rivals.
    pub groups: Vec<Vec<String>>,
    /// The screen at the base model, most significant first.
    pub screen: Vec<ScreenRow>,
    /// Accepted models, base first.
    pub ladder: Vec<Step>,
    /// Every model that was fitted.
    pub tried: Vec<Step>,
    /// Sets that could not be fitted.
    pub failed: Vec<(Vec<String>, String)>,
    /// Its probabilities; `None` without an answer.
    pub stated: Option<Stated>,
    /// Forward runs.
    pub forward_runs: usize,
    /// Wall time, s.
    pub seconds: f64,
    /// What is left of what is hidden when the model without it has tried to take its place; `None`: not measured.
    #[serde(skip)]
    pub imitated: Option<Imitated>,
}

/// How an answer stands to the truth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Grade {
    /// The truth and nothing else, by name or in its stated group.
    Right,
    /// The truth, and more.
    Extra,
    /// Some of what is hidden, and nothing wrong.
    Part,
    /// No name was given.
    Abstained,
    /// A name that is not among what is hidden, in no group with it.
    Wrong,
    /// No answer.
    None,
}

impl Outcome {
    /// Whether `effect` is one of the effects found, or in the group of one.
    pub fn names(&self, effect: &str) -> bool {
        self.groups.iter().any(|g| g.iter().any(|e| e == effect))
    }

    /// The grade of the answer.
    pub fn grade(&self) -> Grade {
        let hidden = &self.truth.effects;
        // The time limit may have come before any answer.
        if self.verdict.is_empty() {
            return Grade::None;
        }
        if let Some(foreign) = self.truth.foreign() {
            return self.grade_of_kinds(foreign.accepted());
        }
        if self.found.is_empty() {
            return if hidden.is_empty() { Grade::Right } else { Grade::Abstained };
        }
        let named = hidden.iter().filter(|e| self.names(e)).count();
        let strange = self.groups.iter().filter(|g| !g.iter().any(|e| hidden.contains(e))).count();
        match (named, strange) {
            (0, _) => Grade::Wrong,
            (n, 0) if n == hidden.len() => Grade::Right,
            (n, _) if n == hidden.len() => Grade::Extra,
            (_, 0) => Grade::Part,
            _ => Grade::Wrong,
        }
    }

    /// The grade of an answer to a law of other people: its kind is one of these names, or there is none to name.
    fn grade_of_kinds(&self, accepted: &[&str]) -> Grade {
        let kind = |g: &&Vec<String>| g.iter().any(|e| accepted.contains(&e.as_str()));
        match (self.groups.len(), self.groups.iter().filter(kind).count()) {
            (0, _) if accepted.is_empty() => Grade::Right,
            (0, _) => Grade::Abstained,
            (all, of_it) if of_it == all => Grade::Right,
            (_, 0) => Grade::Wrong,
            _ => Grade::Extra,
        }
    }

    /// Whether what was hidden is in the first group of the answer.
    pub fn first(&self) -> bool {
        self.groups.first().is_some_and(|g| g.iter().any(|e| self.truth.effects.contains(e)))
    }

    /// Whether what was hidden is in any group of the answer, or in the first three places of the screen or their
    /// look-alikes.
    pub fn among_first_three(&self) -> bool {
        let hidden = |e: &String| self.truth.effects.contains(e);
        self.groups.iter().flatten().any(hidden)
            || self.screen.iter().take(3).any(|r| hidden(&r.effect) || r.look_alikes.iter().any(hidden))
    }

    /// Place of an effect in the screen, from 1.
    pub fn place(&self, effect: &str) -> Option<usize> {
        self.screen.iter().position(|r| r.effect == effect).map(|i| i + 1)
    }

    /// A fitted model by its effects.
    pub fn step(&self, effects: &[String]) -> Option<&Step> {
        let same =
            |s: &&Step| s.effects.len() == effects.len() && effects.iter().all(|e| s.effects.contains(e));
        self.tried.iter().find(same)
    }

    /// Whether the record can see all that is hidden: by imitation, or by the tangent's estimate where that was not
    /// measured.
    pub fn visible(&self) -> bool {
        self.imitated.as_ref().map_or(self.truth.visible(), imitate::visible)
    }

    /// Whether one effect of the catalogue is hidden, and the record can see it.
    pub fn is_visible_single(&self) -> bool {
        self.truth.effects.len() == 1 && self.truth.is_known() && self.visible()
    }

    /// Whether the answer says that the record is not explained, or that it cannot tell.
    pub fn is_honest(&self) -> bool {
        self.verdict == "unexplained" || self.verdict == "ambiguous"
    }

    /// What can be seen of one hidden effect, over the noise.
    pub fn signal(&self, effect: &str) -> f64 {
        let tangent = self.truth.each_over_noise.get(effect).copied().unwrap_or(0.0);
        self.imitated.as_ref().and_then(|i| i.get(effect)).map_or(tangent, |l| l.after)
    }

    /// Predicted and actual fall of the objective when the first accepted effect was added alone.
    pub fn falls(&self) -> Option<(f64, f64)> {
        let (base, first) = (self.ladder.first()?, self.ladder.get(1)?);
        let [effect] = first.effects.as_slice() else { return None };
        let predicted = self.screen.iter().find(|r| &r.effect == effect)?.fall;
        Some((predicted, base.objective - first.objective))
    }

    /// Relative error of the mean Gc at the base model and at the last accepted one.
    pub fn gc_bias(&self) -> Option<(f64, f64)> {
        let of = |s: &Step| s.gc / self.truth.gc() - 1.0;
        Some((of(self.ladder.first()?), of(self.ladder.last()?)))
    }
}
