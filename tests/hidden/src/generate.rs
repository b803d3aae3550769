//! Makes one case: draws a piece of tissue, finds a protocol that tears it through without a jump, computes its
//! records with and without what is hidden, adds noise, and says what the records could show.

use crate::GenerateError;
use crate::amplitude::{self, Parameters, Sizes};
use crate::draw::{self, Tissue, between};
use crate::files::{self, Truth};
use crate::foreign::{Foreign, load_cell};
use crate::forward::{self, Computed, Fineness, add_effect, compute, probe, refine};
use crate::outside::{Outside, law_of};
use crate::protocol::{self, Extent};
use crate::signal::Visible;
use crate::spec::{Hidden, Spec};
use input::{Case, Geometry, Record};
use inverse::Random;
use model::Catalogue;
use std::collections::BTreeMap;
use std::path::Path;

/// A tear that jumps gets its strength lowered by this.
const SHRINK: f64 = 0.88;

/// As often as that, for one piece of tissue.
const SHRINKS: usize = 14;

/// Pieces of tissue that are tried for one case.
const PIECES: u64 = 6;

/// Noise of the camera's grip displacement, mm.
const CAMERA_SD: f64 = 0.005;

/// What is hidden, with its numbers.
#[derive(Clone, Debug)]
struct Secret {
    /// (name in the truth, strength, parameters).
    parts: Vec<(String, f64, Parameters)>,
}

/// A piece whose tear does not jump, with its protocol and its records.
struct Made {
    case: Case,
    tissue: Tissue,
    secret: Secret,
    base: Computed,
    /// With everything that is hidden.
    full: Computed,
    /// Without one part of it each.
    without: Vec<Computed>,
    fine: String,
}

/// Makes a case and writes its folder.
///
/// # Errors
/// When none of several pieces of tissue can be torn without a jump, or a file cannot be written.
pub fn generate(spec: &Spec, fineness: &Fineness, folder: &Path) -> Result<Truth, GenerateError> {
    let catalogue = forward::catalogue();
    for piece in 0..PIECES {
        let mut random = Random::new(spec.seed * 100 + piece);
        if let Some(p) = piece_of(spec, fineness, &catalogue, &mut random)? {
            return finish(spec, fineness, p, &catalogue, &mut random, folder);
        }
    }
    Err(GenerateError::Model(format!("{}: every piece of tissue jumps", spec.name)))
}

fn template() -> Result<Case, GenerateError> {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/template.toml");
    input::read_case(Path::new(path), &Catalogue::default()).map_err(|e| GenerateError::file(path, &e))
}

/// Draws one piece and lowers its strength until nothing jumps.
fn piece_of(
    spec: &Spec,
    fineness: &Fineness,
    catalogue: &Catalogue,
    random: &mut Random,
) -> Result<Option<Made>, GenerateError> {
    let mut case = template()?;
    (case.mesh.bulk_size, case.mesh.path_size) = (fineness.fit.bulk, fineness.fit.path);
    case.geometry = draw::geometry(random);
    let mut tissue = draw::tissue(random, fineness.fit.areas)?;
    let share = between(random, 0.5, 0.9);
    // Every attempt sees the same draws, so that only the strength differs.
    let stream = random.clone();
    for _ in 0..SHRINKS {
        *random = stream.clone();
        tissue.put(&mut case);
        if let Some(extent) = probe(&case, catalogue, share)? {
            let attempt = Attempt { spec, fineness, catalogue, tissue: &tissue, extent, share };
            if let Some(p) = attempt.compute(case.clone(), random)? {
                return Ok(Some(p));
            }
        }
        tissue.shrink(SHRINK);
    }
    Ok(None)
}

struct Attempt<'a> {
    spec: &'a Spec,
    fineness: &'a Fineness,
    catalogue: &'a Catalogue,
    tissue: &'a Tissue,
    extent: Extent,
    share: f64,
}

impl Attempt<'_> {
    fn compute(&self, mut case: Case, random: &mut Random) -> Result<Option<Made>, GenerateError> {
        for t in &mut case.tests {
            let legs = if t.kind.tears {
                protocol::tearing(self.spec.protocol, &self.extent, random)
            } else {
                protocol::uniaxial(self.spec.protocol, &self.extent, random)
            };
            (t.record, t.protocol) = (Some(protocol::motion(&legs)), None);
        }
        let mut fine = case.clone();
        refine(&mut fine, self.fineness, random);
        let Some(base) = compute(&fine, self.catalogue, self.fineness.steps)? else { return Ok(None) };
        let secret = self.secret(&case.geometry, &case, &base, random)?;
        let with = |left_out: Option<usize>| self.with(&fine, &secret, left_out, &base);
        let Some(full) = with(None)? else { return Ok(None) };
        let mut without = Vec::new();
        for i in 0..secret.parts.len() {
            match with(Some(i))? {
                Some(c) => without.push(c),
                None => return Ok(None),
            }
        }
        let m = &fine.mesh;
        let words = match m.divisions {
            Some(d) => format!("divisions {d:?}"),
            None => format!("bulk {:.3} mm, path {:.3} mm, {} layers", m.bulk_size, m.path_size, m.layers),
        };
        let fine = format!("{words}, nodal interface, {} steps", self.fineness.steps);
        Ok(Some(Made { case, tissue: self.tissue.clone(), secret, base, full, without, fine }))
    }

    /// What is hidden, with parameters drawn to the sizes of this piece.
    fn secret(
        &self,
        geometry: &Geometry,
        case: &Case,
        base: &Computed,
        random: &mut Random,
    ) -> Result<Secret, GenerateError> {
        let peak = |i: usize| base.force[i].iter().fold(0.0f64, |m, f| m.max(*f));
        let last = |i: usize| case.tests[i].record.as_ref().map_or(1.0, |r| r.time[r.len() - 1]);
        let sizes = Sizes {
            geometry: geometry.clone(),
            tissue: self.tissue.clone(),
            uniaxial: (self.extent.uniaxial, self.share * peak(1)),
            tearing: (self.extent.tearing, peak(1)),
            duration: (last(0), last(1)),
        };
        let mut parts = Vec::new();
        match &self.spec.hidden {
            Hidden::None => {}
            Hidden::Effects(list) => {
                for (name, strength) in list {
                    let p = amplitude::parameters(name, *strength, &sizes, random).ok_or_else(|| {
                        GenerateError::Model(format!("the suite has no strength for the effect {name}"))
                    })?;
                    parts.push((name.clone(), *strength, p));
                }
            }
            Hidden::Outside(o, strength) => {
                parts.push((o.word().to_owned(), *strength, o.parameters(*strength, &sizes, random)));
            }
            Hidden::Foreign(f, strength) => {
                parts.push((f.word().to_owned(), *strength, f.parameters(*strength, &sizes, random)));
            }
        }
        Ok(Secret { parts })
    }

    /// Records with all that is hidden but one part.
    fn with(
        &self,
        fine: &Case,
        secret: &Secret,
        left_out: Option<usize>,
        base: &Computed,
    ) -> Result<Option<Computed>, GenerateError> {
        let mut case = fine.clone();
        let mut falsify = None;
        let kept = secret.parts.iter().enumerate().filter(|(i, _)| Some(*i) != left_out);
        for (_, (name, _, p)) in kept {
            match law_of(name) {
                Some(law) => add_effect(&mut case, self.catalogue, law, p)?,
                None => falsify = Outside::of(name).map(|o| (o, p)),
            }
        }
        let computed = if case.effects.is_empty() {
            Some(base.clone())
        } else {
            compute(&case, self.catalogue, self.fineness.steps)?
        };
        Ok(computed.map(|mut c| {
            if let Some((o, p)) = falsify {
                for (t, force) in fine.tests.iter().zip(&mut c.force) {
                    *force = t.record.as_ref().map_or(Vec::new(), |r| o.falsify(p, t.kind, r, force));
                }
            }
            c
        }))
    }
}

/// Noise, what the records show, files.
fn finish(
    spec: &Spec,
    fineness: &Fineness,
    p: Made,
    catalogue: &Catalogue,
    random: &mut Random,
    folder: &Path,
) -> Result<Truth, GenerateError> {
    let fraction = between(random, 0.007, 0.01) * noise_strength(&spec.hidden);
    let ar1 = if spec.correlated { between(random, 0.3, 0.6) } else { 0.0 };
    let camera = spec.protocol == crate::spec::Protocol::Rich && random.uniform() < 0.25;
    let peak = |f: &[f64]| f.iter().fold(0.0f64, |m, x| m.max(x.abs()));
    let sd: Vec<f64> = p.full.force.iter().map(|f| fraction * peak(f)).collect();
    let visible = Visible::new(&p.case, catalogue, &sd.iter().map(|&s| (s, ar1)).collect::<Vec<_>>())?;
    let beyond = |from: &Computed| visible.beyond_base(&change(from, &p.full));
    let name = |i: usize| p.case.tests[i].name.clone();
    let rms = |i: usize, other: &[f64]| rms_between(&p.base.force[i], other) / sd[i];
    let coarse = |i: usize| {
        let from: usize = p.base.force[..i].iter().map(Vec::len).sum();
        &visible.coarse[from..from + p.base.force[i].len()]
    };
    let parts = &p.secret.parts;
    let truth = Truth {
        name: spec.name.clone(),
        seed: spec.seed,
        protocol: spec.protocol,
        effects: parts.iter().map(|x| x.0.clone()).collect(),
        strengths: parts.iter().map(|x| x.1).collect(),
        effect_parameters: parts
            .iter()
            .map(|x| (x.0.clone(), x.2.iter().map(|(k, v)| ((*k).to_owned(), *v)).collect()))
            .collect(),
        tissue: p.tissue.clone(),
        noise_fraction: fraction,
        noise_ar1: ar1,
        noise_sd_n: (0..sd.len()).map(|i| (name(i), sd[i])).collect::<BTreeMap<_, _>>(),
        camera,
        effect_rms_over_noise: (0..sd.len()).map(|i| (name(i), rms(i, &p.full.force[i]))).collect(),
        what_no_base_parameter_imitates_over_noise: beyond(&p.base),
        each_over_noise: parts.iter().zip(&p.without).map(|(x, w)| (x.0.clone(), beyond(w))).collect(),
        mesh_error_rms_over_noise: (0..sd.len()).map(|i| (name(i), rms(i, coarse(i)))).collect(),
        computed_on: p.fine.clone(),
    };
    let records: Vec<(String, Record)> =
        (0..sd.len()).map(|i| (name(i), noisy(&p, i, sd[i], ar1, camera, random))).collect();
    files::write(folder, &truth, &fineness.fit, &p.case.geometry, &records)?;
    Ok(truth)
}

/// A load cell's noise is what is hidden, and as strong as that.
fn noise_strength(hidden: &Hidden) -> f64 {
    if let Hidden::Foreign(Foreign::LoadCell, strength) = hidden { *strength } else { 1.0 }
}

fn rms_between(a: &[f64], b: &[f64]) -> f64 {
    (a.iter().zip(b).map(|(x, y)| (x - y).powi(2)).sum::<f64>() / a.len() as f64).sqrt()
}

/// Change of all forces, tests one after the other.
fn change(from: &Computed, to: &Computed) -> Vec<f64> {
    from.force.iter().flatten().zip(to.force.iter().flatten()).map(|(a, b)| b - a).collect()
}

fn noisy(p: &Made, test: usize, sd: f64, ar1: f64, camera: bool, random: &mut Random) -> Record {
    let mut r = p.case.tests[test].record.clone().unwrap_or_default();
    let as_a_load_cell = p.secret.parts.iter().any(|x| Foreign::of(&x.0) == Some(Foreign::LoadCell));
    let noise = if as_a_load_cell {
        load_cell(r.len(), sd, random)
    } else {
        random.ar1(r.len(), sd, ar1).as_slice().to_vec()
    };
    r.force = p.full.force[test].iter().zip(noise.iter()).map(|(f, n)| f + n).collect();
    r.grip_displacement =
        camera.then(|| p.full.grip[test].iter().map(|g| Some(g + CAMERA_SD * random.normal())).collect());
    r
}
