//! dF/dθ by direct differentiation against central differences of whole runs, through load,
//! unload and reload. The derivatives come from runs with the shipped tolerances, the differences
//! from runs solved to 1e-12.
//!
//! The measure: worst |dF/dθ − difference| over the steps, relative to the largest |dF/dθ| of the
//! parameter in the run. A parameter whose |θ dF/dθ| never reaches 1e-6 of the peak force must
//! agree absolutely to 1e-9 of the peak instead (the differences' own rounding).
use crate::common;
use crate::laws;

use common::*;
use fem::sensitivity::Group;
use fem::{
    Link, MountField, NewtonOptions, NoObserver, Prescribed, Problem, Run, ShapeField, SteppingOptions,
    System, Target, run_steps,
};
use laws::{Compliance, Fading, Play, Slack, Slip, Softening};
use mesh::{Sizing, Strip};
use std::sync::Arc;

const AREAS: usize = 2;

fn options() -> SteppingOptions {
    SteppingOptions {
        newton: NewtonOptions { tolerance: 1e-12, ..NewtonOptions::default() },
        ..SteppingOptions::default()
    }
}

/// Load, unload, reload beyond: through the peak of σc = 0.1 and well down.
fn cycle() -> Vec<Target> {
    let up = ramp(0.0, 2.4, 8).chain(ramp(2.4, 0.7, 4));
    plan(up.chain(ramp(0.7, 2.4, 3)).chain(ramp(2.4, 3.6, 4)))
}

/// A problem that depends on θ beyond its laws (node positions, mounting).
type Build<'a> = &'a dyn Fn(&[f64]) -> Problem;

fn differentiate(build: Build, theta: &[f64], seeds: &[usize], targets: &[Target]) -> Run {
    let problem = Arc::new(build(theta));
    let mut group = Group::new(&problem, theta, seeds);
    let mut columns = group.columns();
    let mut system = System::new(&problem).unwrap();
    let run = run_steps(
        &problem,
        theta,
        &mut system,
        None,
        targets,
        &mut columns,
        &NoObserver,
        SteppingOptions::default(),
        None,
        &|| false,
    );
    assert!(run.failure.is_none(), "{:?}", run.failure);
    run
}

/// Largest derivative of the force by a seed.
fn size(run: &Run, k: usize) -> f64 {
    run.steps.iter().fold(0.0f64, |m, s| m.max(s.derivatives.force[k].abs()))
}

/// Worst relative error of each seed.
fn check(title: &str, build: Build, theta: &[f64], names: &[&str], targets: &[Target]) {
    let seeds: Vec<usize> = (0..theta.len()).collect();
    let exact = differentiate(build, theta, &seeds, targets);
    let top = peak(&exact);
    println!("{title}: {} steps, peak {top:.4} N", exact.steps.len());
    let mut bad = Vec::new();
    for &k in &seeds {
        let scale = size(&exact, k);
        let step = 2e-5 * theta[k].abs().max(if theta[k] == 0.0 { 0.5 } else { 0.0 });
        let difference = |h: f64| {
            let at = |by: f64| {
                let mut t = theta.to_vec();
                t[k] += by;
                let run = complete(&build(&t), &t, targets, options());
                assert_eq!(run.steps.len(), exact.steps.len(), "the same steps");
                run.steps.iter().map(|s| s.force).collect::<Vec<_>>()
            };
            let (up, down) = (at(h), at(-h));
            let ours = exact.steps.iter().map(|s| s.derivatives.force[k]);
            ours.zip(up.iter().zip(&down))
                .fold(0.0f64, |m, (d, (u, l))| m.max(((u - l) / (2.0 * h) - d).abs()))
        };
        let mut error = difference(step);
        if error > 1e-5 * scale {
            // Of a parameter that is hardly felt a short difference holds mostly rounding.
            error = error.min(difference(10.0 * step));
        }
        let unit = if theta[k] == 0.0 { 0.5 } else { theta[k].abs() };
        let name = names.get(k).copied().unwrap_or("?");
        let felt = scale * unit / top;
        let fine = if felt > 1e-6 { error / scale < 1e-5 } else { error * unit < 1e-9 * top };
        let shown = if felt > 1e-6 { format!("{:.1e}", error / scale) } else { "not felt".into() };
        println!("  {name:12} |θ dF/dθ|/peak {felt:9.2e}   error {shown}");
        if !fine {
            bad.push(name.to_owned());
        }
    }
    assert!(bad.is_empty(), "{title}: {bad:?}");
}

const NAMES: [&str; 13] = [
    "mu",
    "k1",
    "k2",
    "gamma",
    "kappa",
    "d",
    "fibre_onset",
    "lambda",
    "K",
    "gc_1",
    "gc_2",
    "sigma_1",
    "sigma_2",
];

fn theta() -> Vec<f64> {
    let mut t = Tissue { penalty: 10.0, ..Tissue::peers(1.0, 0.1) }.theta(AREAS);
    // At 0 the unloaded strip stands on the fibres' switch.
    t[6] = 0.004;
    (t[GC + 1], t[GC + AREAS + 1]) = (0.30, 0.08);
    t
}

fn uniform(quarter: bool) -> Strip {
    Strip { sizing: Sizing::Divisions([4, 8, 2]), ..peer_strip([4, 8, 2], true, quarter) }
}

fn graded(quarter: bool) -> Strip {
    Strip { sizing: Sizing::Graded { bulk_size: 1.2, path_size: 0.6, layers: 2 }, ..uniform(quarter) }
}

#[test]
fn sensitivities_mirrored_uniform() {
    check(
        "mirrored, uniform",
        &|_| problem(&uniform(true), Ends::Clamped, AREAS),
        &theta(),
        &NAMES,
        &cycle(),
    );
}

#[test]
fn sensitivities_mirrored_graded() {
    check("mirrored, graded", &|_| problem(&graded(true), Ends::Clamped, AREAS), &theta(), &NAMES, &cycle());
}

#[test]
fn sensitivities_full_height_uniform() {
    // The path above mid-height: it slides too, so that λ counts.
    let strip = Strip { path_y: Some(6.25), half_thickness: true, ..uniform(false) };
    check(
        "full height, off-centre path, uniform",
        &|_| problem(&strip, Ends::Clamped, AREAS),
        &theta(),
        &NAMES,
        &cycle(),
    );
}

#[test]
fn sensitivities_full_height_graded() {
    let strip = Strip { path_y: Some(6.0), half_thickness: true, ..graded(false) };
    check(
        "full height, off-centre path, graded",
        &|_| problem(&strip, Ends::Clamped, AREAS),
        &theta(),
        &NAMES,
        &cycle(),
    );
}

#[test]
fn sensitivities_pulled_at_the_mouth() {
    // Turning arms press the far edge of the path together: K counts.
    let strip = Strip { half_thickness: true, ..uniform(false) };
    let path = plan(ramp(0.0, 5.0, 8).chain(ramp(5.0, 2.0, 3)).chain(ramp(2.0, 6.0, 5)));
    check("mouth grips", &|_| problem(&strip, Ends::Mouth, AREAS), &theta(), &NAMES, &path);
}

#[test]
fn sensitivities_with_load_train_and_take_up() {
    let build = |_: &[f64]| {
        let link =
            |law: Arc<dyn constitutive::PointLaw<1>>, params: &[usize]| Link { law, params: params.to_vec() };
        let train = vec![link(Arc::new(Compliance), &[13]), link(Arc::new(Slip), &[14])];
        let takeup = vec![link(Arc::new(Slack), &[15, 16])];
        Problem { train, takeup, ..problem(&uniform(true), Ends::Clamped, AREAS) }
    };
    let mut t = theta();
    t.extend([0.6, 2.0, 0.3, 0.5]);
    let names: Vec<&str> = NAMES.into_iter().chain(["compliance", "slip", "slack a", "slack b"]).collect();
    check("load train and take-up", &build, &t, &names, &cycle());
}

#[test]
fn sensitivities_with_play_behind_slack_and_train() {
    let build = |_: &[f64]| {
        let link =
            |law: Arc<dyn constitutive::PointLaw<1>>, params: &[usize]| Link { law, params: params.to_vec() };
        let train = vec![link(Arc::new(Compliance), &[13]), link(Arc::new(Slip), &[14])];
        let takeup = vec![link(Arc::new(Slack), &[15, 16]), link(Arc::new(Play), &[17])];
        Problem { train, takeup, ..problem(&uniform(true), Ends::Clamped, AREAS) }
    };
    let mut t = theta();
    t.extend([0.6, 2.0, 0.3, 0.5, 0.4]);
    let names: Vec<&str> =
        NAMES.into_iter().chain(["compliance", "slip", "slack a", "slack b", "play"]).collect();
    check("play", &build, &t, &names, &cycle());
}

#[test]
fn sensitivities_of_shape_and_mounting() {
    let strip = Strip { half_thickness: true, ..uniform(false) };
    let (shape, mount) = (13, 14);
    let build = |theta: &[f64]| {
        let mut p = problem(&strip, Ends::Clamped, AREAS);
        let mesh = mesh::strip(&strip).unwrap();
        // Narrower in the middle: x moves by θ sin(π y/L)(x − 2)/2, and the right edge leans.
        let field = |x: &[f64; 3]| {
            [(std::f64::consts::PI * x[1] / 10.0).sin() * (x[0] - 2.0) / 2.0, 0.02 * x[0], 0.1 * x[2]]
        };
        let fields: Vec<[f64; 3]> = p.body.nodes.iter().map(field).collect();
        let mut body = (*p.body).clone();
        for (x, f) in body.nodes.iter_mut().zip(&fields) {
            (0..3).for_each(|i| x[i] += theta[shape] * f[i]);
        }
        // The upper clamp turned: u_y += θ (x − w/2).
        let turned: Vec<(usize, f64)> =
            mesh.set("top").unwrap().iter().map(|&n| (3 * n + 1, mesh.nodes[n][0] - 2.0)).collect();
        let mut supports = (*p.supports).clone();
        for &(dof, d) in &turned {
            let held = supports[dof].unwrap();
            supports[dof] = Some(Prescribed { mount: held.mount + theta[mount] * d, ..held });
        }
        p.body = Arc::new(body);
        p.supports = Arc::new(supports);
        p.shape = vec![ShapeField { param: shape, field: fields }];
        p.mount = vec![MountField { param: mount, field: turned }];
        p
    };
    let mut t = theta();
    t.extend([-0.08, 0.03]);
    let names: Vec<&str> = NAMES.into_iter().chain(["shape", "mount"]).collect();
    check("shape and mounting", &build, &t, &names, &cycle());
}

fn with_bulk(
    law: Arc<dyn constitutive::PointLaw<9>>,
    extra: [f64; 2],
) -> (impl Fn(&[f64]) -> Problem, Vec<f64>) {
    let build = move |_: &[f64]| {
        let mut p = problem(&uniform(true), Ends::Clamped, AREAS);
        p.bulk = law.clone();
        p.bulk_params.extend([13, 14]);
        p
    };
    let mut t = theta();
    t.extend(extra);
    (build, t)
}

#[test]
fn sensitivities_through_a_softening_bulk() {
    let (build, t) = with_bulk(Arc::new(Softening), [0.4, 0.004]);
    let names: Vec<&str> = NAMES.into_iter().chain(["m", "w"]).collect();
    check("bulk softened by its past", &build, &t, &names, &cycle());
}

#[test]
fn sensitivities_through_a_fading_bulk_and_a_hold() {
    let (build, t) = with_bulk(Arc::new(Fading), [0.5, 3.0]);
    let names: Vec<&str> = NAMES.into_iter().chain(["g", "tau"]).collect();
    let mut targets = plan(ramp(0.0, 1.8, 6));
    targets.extend([0.5, 2.0, 8.0].map(|dt| Target::new(1.8, dt)));
    targets.extend(ramp(1.8, 0.8, 3).map(|u| Target::new(u, 0.5)));
    targets.extend(ramp(0.8, 3.2, 8).map(|u| Target::new(u, 2.0)));
    check("bulk that fades, with a hold", &build, &t, &names, &targets);
}

/// After a jump the displacement where it happened is frozen; the branch after it is exact.
#[test]
fn sensitivities_behind_a_jump() {
    let t = Tissue::peers(1.0, 0.2).theta(1);
    let build = |_: &[f64]| problem(&peer_strip([8, 10, 2], true, true), Ends::Clamped, 1);
    let targets = plan(ramp(0.0, 5.0, 25));
    let exact = differentiate(&build, &t, &[0, 1, 4, GC, GC + 1], &targets);
    assert_eq!(exact.jumps.len(), 1);
    let jump = exact.jumps[0].displacement;
    let behind = |run: &Run| -> Vec<f64> {
        at_targets(run).filter(|s| s.actuator > jump + 0.1).map(|s| s.force).collect()
    };
    for (c, &k) in [0, 1, 4, GC, GC + 1].iter().enumerate() {
        let h = 1e-5 * t[k];
        let at = |by: f64| {
            let mut t = t.clone();
            t[k] += by;
            behind(&complete(&build(&t), &t, &targets, options()))
        };
        let (up, down) = (at(h), at(-h));
        let ours: Vec<f64> =
            at_targets(&exact).filter(|s| s.actuator > jump + 0.1).map(|s| s.derivatives.force[c]).collect();
        let fd: Vec<f64> = up.iter().zip(&down).map(|(a, b)| (a - b) / (2.0 * h)).collect();
        println!("behind the jump at {jump:.3}: parameter {k}, error {:.1e}", worst(&fd, &ours));
        assert!(worst(&fd, &ours) < 1e-4);
    }
}

/// Along a followed path actuator and force both depend on θ: what the arc step gives, reduced to a
/// held actuator, is what displacement control gives there.
#[test]
fn sensitivities_along_a_followed_path() {
    let t = Tissue::peers(1.0, 0.2).theta(1);
    let problem = Arc::new(problem(&peer_strip([8, 10, 2], true, true), Ends::Clamped, 1));
    let seeds = [0, 1, 4, GC, GC + 1];
    let run = |targets: &[Target], follow_path: bool| {
        let mut group = Group::new(&problem, &t, &seeds);
        let mut columns = group.columns();
        let mut system = System::new(&problem).unwrap();
        let o = SteppingOptions { follow_path, ..options() };
        run_steps(&problem, &t, &mut system, None, targets, &mut columns, &NoObserver, o, None, &|| false)
    };
    let path = run(&[Target::new(0.0, 0.0), Target::new(8.0, 100.0)], true);
    assert!(path.failure.is_none(), "{:?}", path.failure);
    let last = path.steps.windows(2).position(|w| w[1].actuator < w[0].actuator).unwrap();
    let stable: Vec<usize> = (1..last - 2).collect();
    let held = run(&plan(stable.iter().map(|&i| path.steps[i].actuator)), false);
    for (c, seed) in seeds.iter().enumerate() {
        let reduced: Vec<f64> = stable
            .iter()
            .map(|&i| {
                let s = &path.steps[i];
                s.derivatives.force[c] - s.slope * s.derivatives.actuator[c]
            })
            .collect();
        let want: Vec<f64> = at_targets(&held).skip(1).map(|s| s.derivatives.force[c]).collect();
        println!("followed path, parameter {seed}: {:.1e} over {} steps", worst(&reduced, &want), want.len());
        assert!(worst(&reduced, &want) < 1e-5);
    }
}
