#![doc = include_str!("README.md")]

use crate::{Experiment, Held, Setting, SupportFault, Supports};
use input::{Balance, Ends, ExperimentCard, Geometry, Grips, Layout, Record, Symmetry, Test};
use mesh::{Mesh, MeshError, Strip};

/// Usual share of the bonded length that is peeled.
const PEELED: f64 = 0.5;
/// Usual stretch of the arms.
const STRETCH: f64 = 1.2;

static CARD: ExperimentCard = ExperimentCard {
    name: "t_peel",
    summary: "A sheet split in its plane is peeled: its two arms are pulled apart, the rest hangs free.",
    layout: Layout::Split,
    tears: true,
    whole_section: false,
    free_strip: false,
    channels: &["grip_displacement", "tear_front"],
    ends: &[Ends::Clamped],
    grips: &[Grips::Ends],
    clamped_faces: false,
    shaped: false,
    farthest,
    estimate,
    balance,
};

/// A dissection test: two arms pulled apart.
#[derive(Clone, Copy, Debug, Default)]
pub struct TPeel;

impl Experiment for TPeel {
    fn card(&self) -> &'static ExperimentCard {
        &CARD
    }

    fn strip(&self, setting: &Setting<'_>) -> Result<Strip, MeshError> {
        let (case, g) = (setting.case, &setting.case.geometry);
        let [along, across, width] = Layout::Split.extents(g);
        let mut strip = Strip {
            cut: g.cut,
            path_y: g.path_y,
            tear: true,
            sizing: setting.sizing(),
            split: setting.split,
            ..Strip::new(across, along, width)
        };
        if case.mesh.symmetry == Symmetry::Auto && setting.mirrors {
            strip.half_thickness = true;
            let even = case.mesh.divisions.is_none_or(|d| d[1] % 2 == 0);
            strip.half_height = setting.half_height && even && strip.is_symmetric(1e-6 * across);
        }
        Ok(strip)
    }

    fn supports(&self, mesh: &Mesh, test: &Test) -> Result<Supports, SupportFault> {
        let mut held = Held::at_mirrors(mesh, test)?;
        let share = held.share;
        // Both faces of the tear begin at the ends of the arms: the upper one belongs to the upper arm.
        let upper_face = mesh.set("path_upper").unwrap_or_default();
        for &n in held.set("left")? {
            let upper = mesh.half_height || mesh.nodes[n][1] > mesh.path_y || upper_face.contains(&n);
            held.hold(n, 1, if upper { share } else { 0.0 });
            held.hold(n, 0, 0.0);
        }
        if !mesh.half_thickness {
            let ends = held.set("left")?;
            ends.iter().for_each(|&n| held.hold(n, 2, 0.0));
        }
        Ok(held.done())
    }
}

fn farthest(g: &Geometry) -> f64 {
    2.0 * STRETCH * (g.cut + PEELED * (g.length - g.cut))
}

/// Median force of the loading in the second half of the way, N: the plateau.
fn plateau(record: &Record) -> f64 {
    let most = record.displacement.iter().fold(0.0f64, |m, u| m.max(*u));
    let u = &record.displacement;
    let rising = |i: &usize| u[*i] > 0.5 * most && u[*i] >= u[*i - 1];
    let mut forces: Vec<f64> =
        (1..record.force.len()).filter(rising).map(|i| record.force[i].max(0.0)).collect();
    forces.sort_by(f64::total_cmp);
    forces.get(forces.len() / 2).copied().unwrap_or_default()
}

fn balance(g: &Geometry, record: &Record) -> Option<Balance> {
    let gc = 2.0 * plateau(record) / g.width;
    let how = "at least, by 2 F/b of the plateau (arms that do not stretch; stretching arms make it more)";
    (gc > 0.0).then_some(Balance { gc, how })
}

/// Toughness of arms that do not stretch, 2F/b, and a strength of the order of the stress in an arm.
fn estimate(g: &Geometry, record: &Record) -> (f64, f64) {
    let force = plateau(record);
    (2.0 * force / g.width, 4.0 * force / (g.width * g.thickness))
}
