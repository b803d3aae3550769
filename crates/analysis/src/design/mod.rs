//! Before the test: which protocol would show what, on a strip of this geometry with a tissue of about this kind.

mod engine;
mod equal_areas;
mod full;
mod guess;
mod known;
mod look;
mod mesh_error;
mod program;
#[cfg(test)]
mod repeats;
mod table;

pub use engine::Foresight;
pub use full::Confirmed;
pub use known::{Expected, Known};
pub use look::first_look;
pub(crate) use look::foresight_of_records;

use crate::condensed;
use crate::identify::AnalysisError;
use crate::problem::Cancelled;
use diagnose::{Foreseen, Policy};
use engine::LOOK;
use full::Full;
use guess::with_guess;
use input::{Case, Leg};
use model::Catalogue;
use program::PROGRAMS;
use serde::Serialize;
use std::sync::Arc;
use table::Table;

/// Power that is enough.
const ENOUGH: f64 = 0.9;

/// What is asked.
#[derive(Clone, Debug, Default)]
pub struct DesignRequest {
    /// Longest time of all tests together, s.
    pub budget_s: f64,
    /// Noise of the load cell, N; none: the file's, else a share of the peak.
    pub noise_n: Option<f64>,
    /// Range of the load cell, N.
    pub range_n: Option<f64>,
    /// Two effects to be told apart.
    pub rivals: Option<[String; 2]>,
    /// Effects that the full model is asked about, in the proposed protocol.
    pub full: Asked,
}

/// Effects that the full model is asked about: their power at a plausible size, and the sizes of some powers.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Asked {
    /// None: the linear look is the answer.
    #[default]
    None,
    /// These.
    Named(Vec<String>),
    /// All that rise above the noise by the linear look.
    All,
}

impl Asked {
    fn has(&self, f: &Foreseen) -> bool {
        match self {
            Self::None => false,
            Self::Named(names) => names.contains(&f.effect),
            Self::All => full::worth_asking(f),
        }
    }

    fn names(&self) -> &[String] {
        match self {
            Self::Named(names) => names,
            Self::None | Self::All => &[],
        }
    }
}

/// A protocol that was weighed: by a linear look at the model, and the proposed one by the full model too.
#[derive(Clone, Debug, Serialize)]
pub struct RatedProtocol {
    /// Name.
    pub name: String,
    /// What is done.
    pub words: String,
    /// All tests together, s.
    pub seconds: f64,
    /// Legs of each test.
    pub protocols: Vec<(String, Vec<Leg>)>,
    /// With the load cell alone.
    pub force: Foresight,
    /// With cameras on edges, width and tear.
    pub camera: Foresight,
    /// Load cell alone by the full model: the effects that were asked for.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub full: Vec<Confirmed>,
    /// Power that tells the rivals apart: load cell alone, with cameras.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rivals_power: Option<[f64; 2]>,
}

/// Something added to the best protocol to tell rivals apart.
#[derive(Clone, Debug, Serialize)]
pub struct Variant {
    /// In words.
    pub proposal: String,
    /// How much longer the tests get, s.
    pub seconds: f64,
    /// Power, load cell alone.
    pub power: f64,
}

/// The answer.
#[derive(Clone, Debug, Serialize)]
pub struct DesignAnswer {
    /// Protocols within the budget, the best first.
    pub protocols: Vec<RatedProtocol>,
    /// Protocols that no rate and no hold brings within the budget, or that could not be computed: name, why.
    pub left_out: Vec<(String, String)>,
    /// Expected largest force of each test, N.
    #[serde(rename = "peaks_N")]
    pub peaks_n: Vec<(String, f64)>,
    /// Noise that was assumed for each test, N.
    #[serde(rename = "noise_N")]
    pub noise_n: Vec<(String, f64)>,
    /// Additions that tell the rivals apart, the strongest first.
    pub variants: Vec<Variant>,
    /// Things to mind.
    pub remarks: Vec<String>,
}

/// Weighs protocols for the tests of a case.
///
/// # Errors
/// [`AnalysisError`] where no model can be made, rivals are not in the catalogue, or no protocol keeps to the budget.
pub fn design(
    case: &Arc<Case>,
    catalogue: &Catalogue,
    request: &DesignRequest,
    progress: &(dyn Fn(&str) + Sync),
    cancelled: Cancelled,
) -> Result<DesignAnswer, AnalysisError> {
    if let Some(missing) =
        request.rivals.iter().flatten().chain(request.full.names()).find(|r| catalogue.get(r).is_none())
    {
        let text = format!("`{missing}` is not in the catalogue; `fct effects` lists it");
        return Err(AnalysisError::Case(text));
    }
    let guess = Arc::new(with_guess(&condensed(case), catalogue)?);
    let table = Table { case: guess, catalogue, cancelled, policy: Policy::default(), steps: LOOK };
    progress("how far a pull goes, and how large its force gets");
    let (pulls, peaks) = table.pulls()?;
    let noise = table.noise(&peaks, request.noise_n);
    let (mut weighed, mut left_out) = (Vec::new(), Vec::new());
    for p in PROGRAMS {
        progress(&format!("{}: what it would show", p.words));
        let Some(legs) = p.within(&pulls, request.budget_s) else {
            left_out.push((p.name.to_owned(), "takes longer than the budget at any rate".to_owned()));
            continue;
        };
        match table.weigh(p, &legs, &noise, request) {
            Ok(w) => weighed.push((w, legs)),
            Err(e) if cancelled.stops() => return Err(e),
            Err(e) => left_out.push((p.name.to_owned(), e.to_string())),
        }
    }
    if weighed.is_empty() {
        let why: Vec<String> = left_out.iter().map(|(n, w)| format!("{n}: {w}")).collect();
        return Err(AnalysisError::Case(format!("no protocol could be weighed: {}", why.join("; "))));
    }
    weighed.sort_by(|(a, _), (b, _)| worth(b).total_cmp(&worth(a)).then(a.seconds.total_cmp(&b.seconds)));
    let variants = match &request.rivals {
        Some(rivals) => {
            progress("what added to it would tell the rivals apart");
            table.variants(&weighed[0].1, &noise, rivals)?
        }
        None => Vec::new(),
    };
    if request.full != Asked::None {
        weighed[0].0.full = confirmed(&table, &weighed[0], &noise, &request.full, progress)?;
    }
    Ok(DesignAnswer {
        remarks: table.remarks(&peaks, &noise, request),
        protocols: weighed.into_iter().map(|w| w.0).collect(),
        left_out,
        peaks_n: table.named(&peaks),
        noise_n: table.named(&noise),
        variants,
    })
}

/// Rivals first, then effects that are seen, then half-seen ones.
fn worth(w: &RatedProtocol) -> f64 {
    let seen =
        |f: &[Foreseen]| f.iter().map(|e| if e.power >= ENOUGH { 1.0 } else { 0.5 * e.power }).sum::<f64>();
    100.0 * w.rivals_power.map_or(0.0, |p| (10.0 * p[0]).round()) + seen(&w.force.effects)
}

/// What the full model says of a protocol's effects.
fn confirmed(
    table: &Table,
    (rated, legs): &(RatedProtocol, Vec<Vec<Leg>>),
    noise: &[f64],
    asked: &Asked,
    progress: &(dyn Fn(&str) + Sync),
) -> Result<Vec<Confirmed>, AnalysisError> {
    let full = Full::new(table, legs, noise)?;
    let effects: Vec<Foreseen> = full.foreseen()?.into_iter().filter(|f| asked.has(f)).collect();
    let mut out = Vec::new();
    for (k, f) in effects.iter().enumerate() {
        progress(&format!("{}, full model: {} ({} of {})", rated.words, f.effect, k + 1, effects.len()));
        out.push(full.confirmed(f)?);
    }
    out.sort_by(|a, b| b.power.total_cmp(&a.power));
    Ok(out)
}
