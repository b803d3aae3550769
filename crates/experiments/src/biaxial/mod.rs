#![doc = include_str!("README.md")]

use crate::{Experiment, Held, Sample, Setting, SupportFault, Supports, flat_strip, intact_sheet};
use fem::Reaction;
use input::{Ends, ExperimentCard, Test};
use mesh::{Mesh, MeshError, Strip};

/// Usual strain of a sheet between two pairs of clamps.
const STRETCH: f64 = 0.25;
/// Share of an edge, in its middle, that a clamp holds.
const CLAMP: f64 = 0.6;

static CARD: ExperimentCard = ExperimentCard {
    two_axes: true,
    channels: &["force_x"],
    ends: &[Ends::Sliding, Ends::Clamped],
    clamped_faces: false,
    shaped: false,
    ..intact_sheet(
        "biaxial",
        "A sheet is stretched along both axes by two actuators, in one ratio of their displacements.",
        |g| STRETCH * g.length,
    )
};

/// A sheet stretched along both axes.
#[derive(Clone, Copy, Debug, Default)]
pub struct Biaxial;

impl Experiment for Biaxial {
    fn card(&self) -> &'static ExperimentCard {
        &CARD
    }

    fn sample(&self) -> Option<Sample> {
        Some(Sample {
            specimen: include_str!("sample/specimen.toml"),
            config: include_str!("sample/config.toml"),
            records: &[
                ("y100_x100.csv", include_str!("sample/y100_x100.csv")),
                ("y100_x75.csv", include_str!("sample/y100_x75.csv")),
                ("y75_x100.csv", include_str!("sample/y75_x100.csv")),
                ("y100_x50.csv", include_str!("sample/y100_x50.csv")),
                ("y50_x100.csv", include_str!("sample/y50_x100.csv")),
            ],
        })
    }

    fn strip(&self, setting: &Setting<'_>) -> Result<Strip, MeshError> {
        flat_strip(setting)
    }

    fn supports(&self, mesh: &Mesh, test: &Test) -> Result<Supports, SupportFault> {
        let mut held = Held::at_mirrors(mesh, test)?;
        let clamped = test.ends == Ends::Clamped;
        for (name, axis, share) in faces(mesh) {
            let grip = if axis == 0 { share * test.ratio_x } else { share };
            let (low, high) = extent(mesh, 1 - axis);
            for &n in held.set(name)? {
                let from_middle = (mesh.nodes[n][1 - axis] - 0.5 * (low + high)).abs();
                if !clamped || from_middle <= 0.5 * CLAMP * (high - low) + 1e-9 {
                    held.hold(n, axis, grip);
                    if clamped {
                        held.hold(n, 1 - axis, 0.0);
                        held.hold(n, 2, 0.0);
                    }
                }
            }
        }
        if !clamped && !mesh.half_thickness {
            let low = extent(mesh, 2).0;
            let bottom = mesh.nodes.iter().enumerate().filter(|(_, x)| (x[2] - low).abs() < 1e-12);
            bottom.for_each(|(n, _)| held.hold(n, 2, 0.0));
        }
        Ok(held.done())
    }

    fn reactions(&self, mesh: &Mesh) -> Vec<Reaction> {
        // All of a face: where nothing is held the force is nil, in equilibrium.
        let on = |name: &str, axis: usize, weight: f64| -> Reaction {
            mesh.set(name).unwrap_or_default().iter().map(|n| (3 * n + axis, weight)).collect()
        };
        // Half the height bears the whole force along y, and half of that along x.
        vec![on("top", 1, if mesh.half_height { 0.5 } else { 1.0 }), on("right", 0, 1.0)]
    }
}

/// Pulled faces: name, axis, share of the displacement along it. The middle of the sheet stays.
fn faces(mesh: &Mesh) -> Vec<(&'static str, usize, f64)> {
    let mut out = vec![("top", 1, 0.5), ("left", 0, -0.5), ("right", 0, 0.5)];
    if !mesh.half_height {
        out.push(("bottom", 1, -0.5));
    }
    out
}

/// Where the sheet begins and ends along an axis; along y the whole of it, half the height or not.
fn extent(mesh: &Mesh, axis: usize) -> (f64, f64) {
    let all = mesh.nodes.iter().map(|x| x[axis]);
    let (low, high) = all.fold((f64::MAX, f64::MIN), |(l, h), x| (l.min(x), h.max(x)));
    if axis == 1 && mesh.half_height { (2.0 * low - high, high) } else { (low, high) }
}
