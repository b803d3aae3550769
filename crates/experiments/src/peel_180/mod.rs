#![doc = include_str!("README.md")]

use crate::{Experiment, Held, Sample, Setting, SupportFault, Supports, peeled_sheet, split_strip};
use fem::Waypoint;
use input::{ExperimentCard, Geometry, Test};
use mesh::{Mesh, MeshError, Strip};
use std::f64::consts::PI;

/// Usual share of the bonded length that is peeled.
const PEELED: f64 = 0.5;
/// Usual stretch of the arm.
const STRETCH: f64 = 1.2;
/// Radius of the fold about which the arm is turned, over its thickness.
const FOLD: f64 = 1.0;
/// Turns of the end face by which the arm is folded.
const TURNS: usize = 24;

static CARD: ExperimentCard = ExperimentCard {
    objection,
    ..peeled_sheet(
        "peel_180",
        "A sheet is glued to a plate by its lower face; its upper arm, folded back by 180°, is pulled along it.",
        farthest,
    )
};

/// One arm folded back and pulled along the sheet.
#[derive(Clone, Copy, Debug, Default)]
pub struct Peel180;

impl Experiment for Peel180 {
    fn card(&self) -> &'static ExperimentCard {
        &CARD
    }

    fn sample(&self) -> Option<Sample> {
        Some(Sample {
            specimen: include_str!("sample/specimen.toml"),
            config: include_str!("sample/config.toml"),
            records: &[("peel.csv", include_str!("sample/peel.csv"))],
        })
    }

    fn strip(&self, setting: &Setting<'_>) -> Result<Strip, MeshError> {
        split_strip(setting, false)
    }

    fn supports(&self, mesh: &Mesh, test: &Test) -> Result<Supports, SupportFault> {
        let mut held = Held::at_mirrors(mesh, test)?;
        for &n in held.set("bottom")? {
            (0..3).for_each(|c| held.hold(n, c, 0.0));
        }
        for (n, [x, y]) in folded(mesh, PI)? {
            held.mount(n, 0, 1.0, x);
            held.mount(n, 1, 0.0, y);
            held.hold(n, 2, 0.0);
        }
        Ok(held.done())
    }

    fn one_face_turns(&self) -> bool {
        true
    }

    fn waypoints(&self, mesh: &Mesh) -> Result<Vec<Waypoint>, SupportFault> {
        let at = |turn: usize| -> Result<Waypoint, SupportFault> {
            let face = folded(mesh, PI * turn as f64 / TURNS as f64)?;
            Ok(face.into_iter().flat_map(|(n, [x, y])| [(3 * n, x), (3 * n + 1, y)]).collect())
        };
        (1..TURNS).map(at).collect()
    }
}

/// Nodes of the arm's end face, and their displacement along x and y when the arm is rolled up by `angle`, about a fold
/// that begins where the cut ends.
fn folded(mesh: &Mesh, angle: f64) -> Result<Vec<(usize, [f64; 2])>, SupportFault> {
    let set = |name: &str| mesh.set(name).ok_or_else(|| SupportFault { set: name.to_owned() });
    let (face, upper) = (set("left")?, set("path_upper")?);
    let arm: Vec<usize> =
        face.iter().copied().filter(|n| mesh.nodes[*n][1] > mesh.path_y || upper.contains(n)).collect();
    let top = arm.iter().fold(mesh.path_y, |m, &n| m.max(mesh.nodes[n][1]));
    let radius = FOLD * (top - mesh.path_y);
    let (sin, cos) = angle.sin_cos();
    let straight = mesh.cut - radius * angle;
    let middle = 0.5 * (top + mesh.path_y);
    let to = |n: &usize| {
        let [x, y, _] = mesh.nodes[*n];
        // From the middle of the arm's thickness, upwards as it lay.
        let off = y - middle;
        let end = mesh.cut - radius * sin - straight * cos + off * sin;
        let height = middle + radius * (1.0 - cos) + straight * sin + off * cos;
        (*n, [end - x, height - y])
    };
    Ok(arm.iter().map(to).collect())
}

/// Thickness of the arm, mm.
fn arm(g: &Geometry) -> f64 {
    g.thickness - g.path_y.unwrap_or(0.5 * g.thickness)
}

fn objection(g: &Geometry) -> Option<(&'static str, String)> {
    let least = (PI * FOLD + 1.0) * arm(g);
    (g.cut < least).then(|| {
        let why = format!(
            "folds the arm back; expected a cut of at least {least:.3} mm for an arm as thick as this"
        );
        ("cut", why)
    })
}

fn farthest(g: &Geometry) -> f64 {
    let fold = PI * FOLD * arm(g);
    fold + (STRETCH - 1.0) * g.cut + (1.0 + STRETCH) * PEELED * (g.length - g.cut)
}
