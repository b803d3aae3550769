//! The model and the run, resolved: defaults applied, units converted to mm, s, N, MPa, rad.

use crate::case::Location;
use params::{ParamSpec, Quantity};
use serde::Serialize;
use std::collections::BTreeMap;

/// What a file says about one parameter, internal unit. Everything may be left open.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Value {
    /// Start of an identification, or the value to simulate with; `None`: the parameter's own start.
    pub value: Option<f64>,
    /// Lower bound; `None`: the parameter's own.
    pub min: Option<f64>,
    /// Upper bound; `None`: the parameter's own.
    pub max: Option<f64>,
    /// Held fixed or freed; `None`: as the parameter's description says.
    pub fixed: Option<bool>,
}

impl Value {
    /// A bare value; bounds and freedom as the parameter's description says.
    pub fn new(value: f64) -> Self {
        Self { value: Some(value), ..Self::default() }
    }
}

/// Whether the model may use mirror symmetry.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Symmetry {
    /// Where the file allows it (default).
    #[default]
    Auto,
    /// Always the full model.
    None,
}

/// `[mesh]`
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MeshConfig {
    /// Elements along x, y, z of a uniform mesh; `None`: graded by the sizes below.
    pub divisions: Option<[usize; 3]>,
    /// Element size away from the path, mm (0.4).
    pub bulk_size: f64,
    /// Element size at the tear path, mm (0.1, or `bulk_size` if that is less).
    pub path_size: f64,
    /// Elements through the thickness (2).
    pub layers: usize,
    /// Use of mirror symmetry.
    pub symmetry: Symmetry,
}

/// `[bulk]`: the law of the tissue.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BulkConfig {
    /// Name in the registry.
    pub law: String,
    /// Every setting of the law that is not a parameter, defaults included.
    pub options: BTreeMap<String, OptionValue>,
    /// What the file says about parameters, by name without unit; internal units. What it does not mention is absent,
    /// but for parameters that are fixed at a value.
    pub parameters: BTreeMap<String, Value>,
    /// The law's parameters as it describes them, for whoever has no registry at hand.
    pub specs: Vec<ParamSpec>,
}

impl BulkConfig {
    /// What the file says about a parameter; nothing for one that it does not mention.
    pub fn value(&self, name: &str) -> Value {
        self.parameters.get(name).copied().unwrap_or_default()
    }

    /// Gives a parameter a start; bounds and freedom stay. Nothing for a name that the law does not have.
    pub fn start(&mut self, name: &str, value: f64) {
        if self.specs.iter().any(|s| s.name == name) {
            self.parameters.entry(name.to_owned()).or_default().value = Some(value);
        }
    }
}

/// How strength and toughness vary along the path.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Profile {
    /// Constant in each area (default, the paper).
    #[default]
    Piecewise,
    /// Smooth through the areas' centres.
    Smooth,
}

/// `[interface]`: the law of the tear path.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct InterfaceConfig {
    /// Name in the registry.
    pub law: String,
    /// Every setting of the law that is not a parameter, defaults included.
    pub options: BTreeMap<String, OptionValue>,
    /// Number m of equal areas along the path (1).
    pub areas: usize,
    /// Between the areas.
    pub profile: Profile,
    /// Gc, N/mm; one entry for all areas, or one per area.
    pub gc: Vec<Value>,
    /// σc, MPa; one entry for all areas, or one per area.
    pub sigma_c: Vec<Value>,
    /// The law's other parameters, the same in all areas (λ, K, shape), by name; as [`BulkConfig::parameters`].
    pub parameters: BTreeMap<String, Value>,
    /// The law's parameters as it describes them, Gc and σc first.
    pub specs: Vec<ParamSpec>,
}

impl InterfaceConfig {
    /// Gc of area `i` (from 0): its own entry, or the common one.
    pub fn gc_of(&self, i: usize) -> Value {
        entry(&self.gc, i)
    }

    /// σc of area `i` (from 0): its own entry, or the common one.
    pub fn sigma_c_of(&self, i: usize) -> Value {
        entry(&self.sigma_c, i)
    }

    /// What the file says about a parameter that all areas share; nothing for one that it does not mention.
    pub fn value(&self, name: &str) -> Value {
        self.parameters.get(name).copied().unwrap_or_default()
    }

    /// Gives a parameter that all areas share a start; bounds and freedom stay. Nothing for a name that the law does
    /// not have.
    pub fn start(&mut self, name: &str, value: f64) {
        if self.specs.iter().any(|s| s.name == name) {
            self.parameters.entry(name.to_owned()).or_default().value = Some(value);
        }
    }
}

fn entry(values: &[Value], i: usize) -> Value {
    values.get(i).or(values.first()).copied().unwrap_or_default()
}

/// A setting of an effect that is not a parameter.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum OptionValue {
    /// Yes or no.
    Bool(bool),
    /// A whole number.
    Integer(i64),
    /// A number.
    Number(f64),
    /// A word.
    Text(String),
}

impl std::fmt::Display for OptionValue {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Bool(b) => write!(f, "{b}"),
            Self::Integer(i) => write!(f, "{i}"),
            Self::Number(x) => write!(f, "{x}"),
            Self::Text(t) => write!(f, "{t}"),
        }
    }
}

/// `[effects.NAME]`
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EffectConfig {
    /// Name in the catalogue.
    pub name: String,
    /// What the file says about parameters, by name without unit; internal units. Parameters the file does
    /// not mention are absent.
    pub parameters: BTreeMap<String, Value>,
    /// The effect's parameters as its card describes them, for whoever has no catalogue at hand.
    pub specs: Vec<ParamSpec>,
    /// Every option of the effect, defaults included.
    pub options: BTreeMap<String, OptionValue>,
    /// Where the effect stands in the file.
    pub location: Location,
}

/// How the parameters are found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Mode {
    /// Bulk from the uniaxial test, then the interface with the bulk held (default, the paper); then all tests at once
    /// where effects are free that are not of the tear alone.
    #[default]
    Staged,
    /// All tests at once, from the staged start.
    Joint,
}

/// Prior of one parameter: normal, in the parameter's own (internal) unit.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Prior {
    /// Mean, internal unit.
    pub mean: f64,
    /// Standard deviation as a share of the mean.
    pub relative_sd: f64,
    /// Physical kind of the parameter.
    pub quantity: Quantity,
}

/// `[identify.priors]`
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct PriorsConfig {
    /// The literature's priors on base parameters; `None`: off to identify, on to diagnose.
    pub literature: Option<bool>,
    /// Priors given in the file, by parameter path (`bulk.mu`, `interface.gc` for all areas,
    /// `effects.compliance.c`); they replace the literature's.
    pub given: BTreeMap<String, Prior>,
    /// What the file gave for base parameters (`bulk.k1`, `interface.gc`; `None`: nothing), where the case starts at
    /// identified values instead: a start may move, what is expected of a tissue does not. No key of a file.
    #[serde(skip)]
    pub around: BTreeMap<String, Option<f64>>,
}

/// `[diagnose]`: what is believed of effects, and of what a complete model leaves of a record.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DiagnoseConfig {
    /// Scale of what a complete model leaves unexplained, share of the peak force (0.015).
    pub rest: f64,
    /// Largest rest that counts as explained in practice, share of the peak force (0.02).
    pub practice: f64,
    /// How many effects of the catalogue are expected to act (0.7).
    pub expected_effects: f64,
    /// Whether other laws of bulk and tear are candidates beside the effects (no).
    pub laws: bool,
}

impl Default for DiagnoseConfig {
    fn default() -> Self {
        Self { rest: 0.015, practice: 0.02, expected_effects: 0.7, laws: false }
    }
}

/// `[identify]`
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct IdentifyConfig {
    /// Staged or joint.
    pub mode: Mode,
    /// Stop when f changes by less than this, relative (1e-6).
    pub tolerance: f64,
    /// Most iterations (30).
    pub max_iterations: usize,
    /// Number of starts from a low-discrepancy sample; 0 or 1: only the given start (0).
    pub multi_start: usize,
    /// Priors.
    pub priors: PriorsConfig,
    /// Fit a coarser mesh first, the given one last (true).
    pub coarse_first: bool,
    /// Where the bulk of the intact strip leaves the tear unexplained, a staged search ends with all parameters on
    /// all records (true).
    pub release_bulk: bool,
}

/// What is prescribed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Control {
    /// The actuator, as a rig: at a limit point the tear jumps (default).
    #[default]
    Actuator,
    /// The equilibrium path, through snap-back.
    Path,
}

/// Integration points of the interface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Integration {
    /// 2×2 Gauss (default).
    #[default]
    Gauss,
    /// 2×2 nodal (Newton–Cotes).
    Nodal,
}

/// `[solver]`
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SolverConfig {
    /// Travel (or arc length, `control = "path"`) between answers, mm; `None`: chosen by the program.
    pub step_mm: Option<f64>,
    /// What is prescribed.
    pub control: Control,
    /// Relative residual at which a step has converged (1e-9).
    pub tolerance: f64,
    /// Newton iterations before a step is cut (25).
    pub max_iterations: usize,
    /// Integration of the interface.
    pub integration: Integration,
}

/// A figure format.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Figure {
    /// SVG.
    Svg,
    /// PDF.
    Pdf,
    /// PNG.
    Png,
}

/// `[output]`
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct OutputConfig {
    /// Noise of a synthetic record, as a share of the peak force; `None`: write none.
    pub noise: Option<f64>,
    /// Seed of the noise (0).
    pub seed: u64,
    /// Number of typical points of each curve at which fields are written; 0: none (8).
    pub fields: usize,
    /// Formats of the figures (SVG).
    pub figures: Vec<Figure>,
}
