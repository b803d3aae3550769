//! The tests of a case with protocols in them: how far they go, their noise, and a linear look at what they would show.

use super::engine::{Linear, Steps, linear, model_of, options};
use super::guess::with_strength;
use super::program::{Program, Pull, record, seconds};
use super::{DesignRequest, RatedProtocol, Variant};
use crate::DataBlock;
use crate::data::Measured;
use crate::identify::AnalysisError;
use crate::ladder::next_test::extension::{self, Extension};
use crate::problem::{Cancelled, FeProblem};
use diagnose::Policy;
use input::{Case, Leg, Record};
use inverse::Problem as _;
use model::{Catalogue, Channel, Discretisation, Model};
use std::sync::Arc;

/// Rate of a pull that the file says nothing about, lengths per second.
const RATE: f64 = 0.01;
/// A tear is followed to where the force has fallen to this share of its peak, at most as far as the
/// experiment usually goes.
const FALLEN: f64 = 0.25;
/// Noise of a load cell that nothing is known of, as a share of the peak; and of cameras, mm.
const NOISE: f64 = 0.005;
const CAMERA_SD: f64 = 0.01;
const FRONT_SD: f64 = 0.1;
/// Shares of the guessed strength that are tried until a run comes to its end.
const STRENGTHS: [f64; 3] = [1.0, 0.7, 1.4];

/// What a design is made with.
#[derive(Clone)]
pub(super) struct Table<'a> {
    pub case: Arc<Case>,
    pub catalogue: &'a Catalogue,
    pub cancelled: Cancelled<'a>,
    pub policy: Policy,
    pub steps: Steps,
}

impl Table<'_> {
    pub fn named(&self, values: &[f64]) -> Vec<(String, f64)> {
        self.case.tests.iter().map(|t| t.name.clone()).zip(values.iter().copied()).collect()
    }

    /// The case with planned records in its tests.
    pub fn planned(&self, legs: &[Vec<Leg>], noise: &[f64], camera: bool) -> Case {
        let mut case = (*self.case).clone();
        for ((test, legs), sd) in case.tests.iter_mut().zip(legs).zip(noise) {
            test.record = Some(record(legs, camera, test.kind));
            test.protocol = None;
            test.force_sd = Some(*sd);
            test.grip_displacement_sd = test.grip_displacement_sd.or(Some(CAMERA_SD));
            test.width_change_sd = test.width_change_sd.or(Some(CAMERA_SD));
            test.tear_front_sd = test.tear_front_sd.or(Some(FRONT_SD));
        }
        case
    }

    /// How far each test would go, and its largest force.
    pub fn pulls(&self) -> Result<(Vec<Pull>, Vec<f64>), AnalysisError> {
        let g = &self.case.geometry;
        let mut pulls = Vec::new();
        let mut open = Vec::new();
        for test in &self.case.tests {
            let (to, rate) = match (&test.record, &test.protocol) {
                (Some(r), _) => (Some(r.displacement.iter().fold(0.0f64, |m, u| m.max(*u))), pace(r)),
                (_, Some(legs)) => farthest(legs),
                _ => (None, None),
            };
            let kind = test.kind;
            let default = (kind.farthest)(g);
            open.push(to.is_none() && kind.tears);
            pulls.push(Pull { kind, to_mm: to.unwrap_or(default), rate: rate.unwrap_or(RATE * g.length) });
        }
        let legs: Vec<Vec<Leg>> =
            pulls.iter().map(|p| vec![Leg::Ramp { to_mm: p.to_mm, rate_mm_per_s: p.rate }]).collect();
        let case = self.planned(&legs, &vec![1.0; pulls.len()], false);
        let (model, _) = model_of(&case, self.catalogue)?;
        let (_, forces) = self.run(&model)?;
        for ((pull, open), (test, force)) in
            pulls.iter_mut().zip(open).zip(model.tests.iter().zip(&forces)).filter(|((_, open), _)| *open)
        {
            let Some(r) = test.test.record.as_ref().filter(|_| open) else { continue };
            let peak = force.iter().fold(0.0f64, |m, f| m.max(*f));
            let at = force.iter().position(|f| *f >= peak).unwrap_or(0);
            let fallen = (at..force.len()).find(|&i| force[i] < FALLEN * peak);
            pull.to_mm = r.displacement[fallen.unwrap_or(force.len() - 1)];
        }
        let peaks = forces.iter().map(|f| f.iter().fold(0.0f64, |m, f| m.max(*f))).collect();
        Ok((pulls, peaks))
    }

    /// Forces of planned records, at the guess or near it: values and one list per test.
    fn run(&self, model: &Model) -> Result<(Vec<f64>, Vec<Vec<f64>>), AnalysisError> {
        let slots: Vec<DataBlock> = (0..model.tests.len())
            .filter_map(|t| {
                let record = model.tests[t].test.record.as_ref()?;
                Some(DataBlock { test: t, channel: Channel::Force, rows: (0..record.len()).collect() })
            })
            .collect();
        let mut last = None;
        for share in STRENGTHS {
            let theta = with_strength(model, &model.theta(), share);
            let problem = FeProblem::new(
                model,
                theta.clone(),
                Vec::new(),
                &slots,
                options(&model.case, self.steps),
                self.cancelled,
            );
            match problem.predict(&[], false) {
                Ok(p) => {
                    let mut at = 0;
                    let lists = slots.iter().map(|s| {
                        at += s.rows.len();
                        p.values.as_slice()[at - s.rows.len()..at].to_vec()
                    });
                    return Ok((theta, lists.collect()));
                }
                Err(e) => last = Some(e),
            }
            if self.cancelled.stops() {
                break;
            }
        }
        Err(last.map_or_else(|| AnalysisError::Case("nothing to run".into()), AnalysisError::from))
    }

    /// Noise of each test's force, N.
    pub fn noise(&self, peaks: &[f64], given: Option<f64>) -> Vec<f64> {
        let tests = self.case.tests.iter().zip(peaks);
        let of_record = |test: &input::Test| {
            let r = test.record.as_ref()?;
            let breaks: Vec<usize> = model::corner_rows(r).iter().map(|c| c.0).collect();
            diagnose::noise::estimate(&r.time, &r.force, &breaks).ok().map(|n| n.sd)
        };
        tests.map(|(t, peak)| given.or(t.force_sd).or_else(|| of_record(t)).unwrap_or(NOISE * peak)).collect()
    }

    /// The linearised model of a case with planned records.
    pub fn look(&self, case: Case, catalogue: &Catalogue) -> Result<(Linear, Case), AnalysisError> {
        let (model, _) = model_of(&case, catalogue)?;
        let (theta, forces) = self.run(&model)?;
        // Sizes of effects are taken from the forces of the records.
        let mut case = case;
        for (test, force) in case.tests.iter_mut().zip(forces) {
            if let Some(r) = &mut test.record {
                r.force = force;
            }
        }
        let (model, how): (Model, Discretisation) = model_of(&case, catalogue)?;
        let measured = Measured::of(&model, &model.recorded())?;
        let linear = linear(&model, (how, self.steps), &theta, measured, catalogue, self.cancelled)?;
        Ok((linear, case))
    }

    pub fn weigh(
        &self,
        program: Program,
        legs: &[Vec<Leg>],
        noise: &[f64],
        request: &DesignRequest,
    ) -> Result<RatedProtocol, AnalysisError> {
        let (linear, case) = self.look(self.planned(legs, noise, true), self.catalogue)?;
        let tell = |camera| linear.foresight(self.catalogue, &self.policy, camera);
        let apart =
            |camera| request.rivals.as_ref().map(|[a, b]| linear.separation(a, b, &self.policy, camera));
        Ok(RatedProtocol {
            name: program.name.to_owned(),
            words: program.words.to_owned(),
            seconds: legs.iter().map(|l| seconds(l)).sum(),
            protocols: case.tests.iter().map(|t| t.name.clone()).zip(legs.iter().cloned()).collect(),
            force: tell(false)?,
            camera: tell(true)?,
            full: Vec::new(),
            rivals_power: apart(false).zip(apart(true)).map(|(f, c)| [f, c]),
        })
    }

    /// Additions to a protocol that tell two effects apart.
    pub fn variants(
        &self,
        legs: &[Vec<Leg>],
        noise: &[f64],
        [a, b]: &[String; 2],
    ) -> Result<Vec<Variant>, AnalysisError> {
        let both = [a, b].into_iter().filter_map(|n| self.catalogue.get(n).cloned()).collect();
        let rivals = Catalogue::new(both);
        let (_, case) = self.look(self.planned(legs, noise, false), &rivals)?;
        let segments = extension::extensions(&case);
        let mut out: Vec<Variant> = Vec::new();
        for x in segments.iter().filter(|x| x.seconds > 0.0) {
            let Extension { words, seconds, parts } = x;
            let mut longer = case.clone();
            for part in parts {
                longer.tests[part.test].record = Some(part.record.clone());
            }
            match self.look(longer, &rivals) {
                Ok((linear, _)) => out.push(Variant {
                    proposal: words.clone(),
                    seconds: *seconds,
                    power: linear.separation(a, b, &self.policy, false),
                }),
                Err(e) if self.cancelled.stops() => return Err(e),
                // What cannot be computed is not proposed.
                Err(_) => {}
            }
        }
        out.sort_by(|x, y| {
            let rounded = |v: &Variant| (100.0 * v.power).round();
            rounded(y).total_cmp(&rounded(x)).then(x.seconds.total_cmp(&y.seconds))
        });
        Ok(out)
    }

    pub fn remarks(&self, peaks: &[f64], noise: &[f64], request: &DesignRequest) -> Vec<String> {
        let mut out = Vec::new();
        for ((test, peak), sd) in self.case.tests.iter().zip(peaks).zip(noise) {
            let name = &test.name;
            if let Some(range) = request.range_n {
                if *peak > 0.9 * range {
                    out.push(format!(
                        "{name}: about {peak:.3} N are expected, the load cell ends at {range} N"
                    ));
                } else if *peak < 0.02 * range {
                    out.push(format!(
                        "{name}: about {peak:.3} N are expected, {:.1} % of the load cell's range: a smaller one is less noisy",
                        100.0 * peak / range
                    ));
                }
            }
            if *sd > 0.02 * peak {
                out.push(format!(
                    "{name}: noise of {sd:.4} N is {:.0} % of the expected peak",
                    100.0 * sd / peak
                ));
            }
        }
        if !self.case.tests.iter().any(|t| t.kind.tears) {
            out.push("no tearing test: toughness and strength are not measured".into());
        }
        if self.case.tests.iter().all(|t| t.kind.tears) {
            out.push("no uniaxial test: the tissue is told by the tear alone".into());
        }
        out
    }
}

/// Usual rate of a record, mm/s.
fn pace(r: &Record) -> Option<f64> {
    let corners = model::corners_of_record(r);
    let legs = corners.windows(2).filter(|w| w[1].displacement > w[0].displacement);
    let rates: Vec<f64> =
        legs.map(|w| (w[1].displacement - w[0].displacement) / (w[1].time - w[0].time)).collect();
    rates.first().copied()
}

/// Largest displacement and first rate of a protocol.
fn farthest(legs: &[Leg]) -> (Option<f64>, Option<f64>) {
    let ramps = legs.iter().filter_map(|l| match l {
        Leg::Ramp { to_mm, rate_mm_per_s } => Some((*to_mm, *rate_mm_per_s)),
        Leg::Hold { .. } => None,
    });
    let list: Vec<(f64, f64)> = ramps.collect();
    let most = list.iter().map(|l| l.0).fold(f64::MIN, f64::max);
    (list.first().map(|_| most), list.first().map(|l| l.1))
}
