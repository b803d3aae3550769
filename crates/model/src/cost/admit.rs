//! Whether a case fits: into the memory of the machine, into a life's patience, its areas onto its elements.

use super::{Cost, Purpose, available_bytes};
use crate::build::{BuildError, Discretisation, Model, at_key};
use crate::catalogue::Catalogue;
use input::{Case, locate};
use std::sync::Arc;

/// Memory beyond which nothing is begun, whatever the machine has, bytes.
pub const MOST_BYTES: f64 = 256e9;
/// Time of a single run beyond which nothing is begun, s: a hundred hours.
pub const MOST_SECONDS: f64 = 3.6e5;
/// How much coarser a mesh is in each try for one that fits.
const COARSER: f64 = 1.25;
/// Tries.
const TRIES: i32 = 40;

/// What there is: bytes and seconds.
#[derive(Clone, Copy)]
struct Limits {
    bytes: f64,
    seconds: f64,
}

impl Limits {
    fn here() -> Self {
        Self { bytes: available_bytes().map_or(MOST_BYTES, |b| b.min(MOST_BYTES)), seconds: MOST_SECONDS }
    }

    fn admit(self, cost: &Cost, purpose: Purpose) -> bool {
        let need = cost.need(purpose);
        need.bytes <= self.bytes && need.seconds <= self.seconds
    }
}

impl Model {
    /// The model of a case as a user gave it: refused, before anything is meshed, where it fits into no memory and no
    /// time, or has more areas than elements to tell them apart.
    ///
    /// # Errors
    /// [`BuildError`] naming the key, its place, and what would fit.
    pub fn checked(
        case: Arc<Case>,
        catalogue: &Catalogue,
        how: Discretisation,
        purpose: Purpose,
    ) -> Result<Self, BuildError> {
        let cost = Cost::of(&case, catalogue, how)?;
        areas(&case, &cost)?;
        let limits = Limits::here();
        if !limits.admit(&cost, purpose) {
            return Err(BuildError::TooLarge(too_large(&case, catalogue, how, purpose, &cost, limits)));
        }
        Self::new(case, catalogue, how)
    }
}

/// More areas than elements along the path: some have no element of their own.
fn areas(case: &Case, cost: &Cost) -> Result<(), BuildError> {
    let (areas, Some(ahead)) = (case.interface.areas, cost.ahead) else { return Ok(()) };
    if areas <= ahead {
        return Ok(());
    }
    let finer = mesh_key(case);
    let place = at_key(case, "interface", "areas");
    Err(BuildError::TooLarge(format!(
        "{place}`areas` = {areas}, but the mesh has {ahead} elements along the tear path; expected an element for each area\n   = \
         help: set `areas` to {ahead} or fewer in [interface], or make the mesh finer by `{finer}` in [mesh]"
    )))
}

/// The key that sets the number of elements.
fn mesh_key(case: &Case) -> &'static str {
    if case.mesh.divisions.is_some() { "divisions" } else { "path_size_mm" }
}

fn too_large(
    case: &Arc<Case>,
    catalogue: &Catalogue,
    how: Discretisation,
    purpose: Purpose,
    cost: &Cost,
    limits: Limits,
) -> String {
    let fits =
        |c: Case| Cost::of(&Arc::new(c), catalogue, how).is_ok_and(|cost| limits.admit(&cost, purpose));
    // Where it is the number of answers that does it, the mesh is not to blame.
    let by_steps = case.solver.step_mm.is_some() && {
        let mut c = (**case).clone();
        c.solver.step_mm = None;
        fits(c)
    };
    let tries = (1..=TRIES).map(|k| COARSER.powi(k));
    let (section, key, would) = if by_steps {
        let step = case.solver.step_mm.unwrap_or_default();
        let found = tries.map(|f| step * f * f * f).find(|&s| {
            let mut c = (**case).clone();
            c.solver.step_mm = Some(s);
            fits(c)
        });
        ("solver", "step", found.map(|s| format!("`step_mm = {}`", short(s))))
    } else {
        let coarser = tries.map(|f| coarser(case, f)).find(|c| fits(c.clone()));
        (
            "mesh",
            if case.mesh.divisions.is_some() { "divisions" } else { given(case) },
            coarser.map(|c| sizes(&c)),
        )
    };
    let place = at_key(case, section, key);
    let need = cost.need(purpose);
    let what = match purpose {
        Purpose::Simulation => "a run of this model".to_owned(),
        Purpose::Fit => format!("a run of this model with derivatives by {} parameters", cost.free),
    };
    let help = would.map_or_else(
        || "nothing near it fits: a smaller strip, or fewer tests or parameters".to_owned(),
        |would| format!("{would} would fit"),
    );
    format!(
        "{place}{what} needs about {} and {}; this machine has {} to give, and no run may take more than {}\n   = help: {help}",
        bytes(need.bytes),
        duration(need.seconds),
        bytes(limits.bytes),
        duration(limits.seconds)
    )
}

/// The size that the file gives, else the one that counts.
fn given(case: &Case) -> &'static str {
    let stands = |key| locate(case, "mesh", key).is_some_and(|l| l.line > 0);
    if !stands("path_size") && stands("bulk_size") { "bulk_size" } else { "path_size" }
}

fn coarser(case: &Case, factor: f64) -> Case {
    let mut c = case.clone();
    match &mut c.mesh.divisions {
        Some([x, y, z]) => {
            let fewer = |n: usize| ((n as f64 / factor).ceil() as usize).max(1);
            (*x, *y, *z) = (fewer(*x), fewer(*y).next_multiple_of(2), fewer(*z));
        }
        None => {
            c.mesh.path_size *= factor;
            c.mesh.bulk_size = c.mesh.bulk_size.max(c.mesh.path_size);
        }
    }
    c
}

fn sizes(case: &Case) -> String {
    match case.mesh.divisions {
        Some(d) => format!("`divisions = {d:?}`"),
        None => {
            let (path, bulk) = (short(case.mesh.path_size), short(case.mesh.bulk_size));
            format!("`path_size_mm = {path}` with `bulk_size_mm = {bulk}`")
        }
    }
}

/// Two significant digits, rounded up.
fn short(x: f64) -> String {
    let unit = 10f64.powf(x.abs().log10().floor() - 1.0);
    let rounded = (x / unit).ceil() * unit;
    format!("{}", format!("{rounded:.3e}").parse::<f64>().unwrap_or(rounded))
}

/// `1.2 GB`
pub fn bytes(b: f64) -> String {
    match b {
        b if b >= 1e12 => format!("{:.1} TB", b / 1e12),
        b if b >= 1e9 => format!("{:.1} GB", b / 1e9),
        b => format!("{:.0} MB", (b / 1e6).max(1.0)),
    }
}

/// `3 min`
pub fn duration(s: f64) -> String {
    match s {
        s if s >= 2.0 * 86_400.0 => format!("{:.0} days", s / 86_400.0),
        s if s >= 2.0 * 3600.0 => format!("{:.0} h", s / 3600.0),
        s if s >= 90.0 => format!("{:.0} min", s / 60.0),
        s => format!("{:.0} s", s.max(1.0)),
    }
}
