//! Small problems for the verification tests, built without the rest of the workspace.
#![allow(dead_code)]

use fem::interface::Integration;
use fem::{
    Blend, Body, Ledger, NewtonOptions, NoObserver, Path, Prescribed, Problem, Run, StepRecord,
    SteppingOptions, System, Target, run_steps,
};
use mesh::{Mesh, Sizing, Strip};
use std::sync::Arc;

/// First interface parameter in θ: λ, K, then Gc of every area, then σc of every area.
pub const LAMBDA: usize = 7;
pub const PENALTY: usize = 8;
pub const GC: usize = 9;

/// How the strip is held.
#[derive(Clone, Copy, PartialEq)]
pub enum Ends {
    /// End faces rigid, pulled apart along y.
    Clamped,
    /// End faces keep plane, free to contract; homogeneous state of an intact strip.
    Sliding,
    /// Pulled at the two corners over the cut.
    Mouth,
}

/// The four materials of a test.
#[derive(Clone, Copy)]
pub struct Tissue {
    pub bulk: [f64; 7],
    pub lambda: f64,
    pub penalty: f64,
    pub gc: f64,
    pub sigma_c: f64,
}

impl Tissue {
    /// The material of `tests/data/peers`: K0 = 2/D and σc as given, penalty 10 e σc/δc.
    pub fn peers(bulk_modulus: f64, sigma_c: f64) -> Self {
        let gc = 0.23;
        Self {
            bulk: [0.0051, 0.9388, 20.09, 38.53f64.to_radians(), 0.23, 2.0 / bulk_modulus, 0.0],
            lambda: 1.0,
            penalty: 10.0 * cohesive::initial_stiffness(gc, sigma_c),
            gc,
            sigma_c,
        }
    }

    /// Neo-Hookean (k1 = 0): μ and initial bulk modulus.
    pub fn neo_hookean(mu: f64, bulk_modulus: f64) -> [f64; 7] {
        [mu, 0.0, 1.0, 0.7, 0.2, 2.0 / bulk_modulus, 0.0]
    }

    /// θ with the same Gc and σc in all areas.
    pub fn theta(&self, areas: usize) -> Vec<f64> {
        let mut t = self.bulk.to_vec();
        t.extend([self.lambda, self.penalty]);
        t.extend(vec![self.gc; areas]);
        t.extend(vec![self.sigma_c; areas]);
        t
    }
}

/// A strip of the peers: 10 × 4 × 1 mm, cut 1 mm.
pub fn peer_strip(divisions: [usize; 3], tear: bool, quarter: bool) -> Strip {
    Strip {
        cut: 1.0,
        tear,
        sizing: Sizing::Divisions(divisions),
        half_height: quarter,
        half_thickness: quarter,
        ..Strip::new(10.0, 4.0, 1.0)
    }
}

/// Supports of a mesh.
pub fn supports(mesh: &Mesh, ends: Ends) -> Vec<Option<Prescribed>> {
    let mut s = vec![None; 3 * mesh.nodes.len()];
    let share = if mesh.half_height { 0.5 } else { 1.0 };
    let intact = mesh.interfaces.is_empty();
    let mut hold = |set: &str, component: usize, grip: f64| {
        for &n in mesh.set(set).unwrap_or_else(|| panic!("the mesh has no set {set}")) {
            s[3 * n + component] = Some(Prescribed { grip, mount: 0.0 });
        }
    };
    let (top, bottom) = if ends == Ends::Mouth { ("mouth_top", "mouth_bottom") } else { ("top", "bottom") };
    hold(top, 1, share);
    if !mesh.half_height {
        hold(bottom, 1, 0.0);
    } else if intact {
        hold("mid_height", 1, 0.0);
    }
    let lateral: &[usize] = match ends {
        Ends::Clamped => &[0, 2],
        Ends::Sliding => &[],
        Ends::Mouth => &[0],
    };
    for &c in lateral {
        hold(top, c, 0.0);
        if !mesh.half_height {
            hold(bottom, c, 0.0);
        }
    }
    if ends == Ends::Sliding {
        hold("left", 0, 0.0);
    }
    if mesh.half_thickness {
        hold("mid_thickness", 2, 0.0);
    } else if ends != Ends::Clamped {
        let low = mesh.nodes.iter().map(|x| x[2]).fold(f64::MAX, f64::min);
        let held = mesh.nodes.iter().enumerate().filter(|(_, x)| (x[2] - low).abs() < 1e-12);
        for (n, _) in held {
            s[3 * n + 2] = Some(Prescribed::default());
        }
    }
    s
}

/// The problem of a strip with `areas` equal areas on its path.
pub fn problem(strip: &Strip, ends: Ends, areas: usize) -> Problem {
    let mesh = mesh::strip(strip).expect("mesh");
    let supports = supports(&mesh, ends);
    let body = Body::of(&mesh);
    let path = strip.tear.then(|| Path {
        law: Arc::new(cohesive::Cohesive),
        rule: Integration::Gauss.into(),
        params: (0..body.cohesive.len())
            .map(|e| {
                let area = mesh.area(e, areas);
                std::array::from_fn(|_| {
                    [GC + area, GC + areas + area, LAMBDA, PENALTY].map(Blend::one).to_vec()
                })
            })
            .collect(),
        position: vec![[0.5; 4]; body.cohesive.len()],
    });
    let half = |yes: bool| if yes { 2.0 } else { 1.0 };
    Problem {
        body: Arc::new(body),
        supports: Arc::new(supports),
        waypoints: Arc::default(),
        reactions: Arc::default(),
        multiplicity: half(mesh.half_height) * half(mesh.half_thickness),
        bulk: Arc::new(hgo::Hgo::default()),
        bulk_params: (0..7).collect(),
        path,
        train: vec![],
        takeup: vec![],
        shape: vec![],
        mount: vec![],
    }
}

/// Ledger on, tight Newton tolerance.
pub fn tight() -> SteppingOptions {
    SteppingOptions {
        ledger: true,
        newton: NewtonOptions { tolerance: 1e-11, ..NewtonOptions::default() },
        ..SteppingOptions::default()
    }
}

/// Ledger on, shipped tolerances.
pub fn shipped() -> SteppingOptions {
    SteppingOptions { ledger: true, ..SteppingOptions::default() }
}

/// Targets one second apart, the start first.
pub fn plan(displacements: impl IntoIterator<Item = f64>) -> Vec<Target> {
    std::iter::once(Target::new(0.0, 0.0))
        .chain(displacements.into_iter().map(|u| Target::new(u, 1.0)))
        .collect()
}

/// `n` equal steps from (not with) `from` to `to`.
pub fn ramp(from: f64, to: f64, n: usize) -> impl Iterator<Item = f64> {
    (1..=n).map(move |i| from + (to - from) * i as f64 / n as f64)
}

/// The time of every step is that at which the actuator stands there, in jumps and cuts too: `pace` seconds for a mm.
pub fn keeps_its_pace(run: &Run, pace: f64) {
    assert!(run.steps.windows(2).all(|w| w[0].time <= w[1].time), "time goes back");
    for s in &run.steps {
        let at = pace * s.actuator;
        assert!((s.time - at).abs() < 1e-9 * (1.0 + at), "{} s at {} mm, expected {at}", s.time, s.actuator);
    }
    for j in &run.jumps {
        assert!((j.time - pace * j.displacement).abs() < 1e-9 * (1.0 + j.time), "{j:?}");
    }
}

/// Runs a plan without sensitivities.
pub fn run(problem: &Problem, theta: &[f64], targets: &[Target], options: SteppingOptions) -> Run {
    let mut system = System::new(problem).expect("system");
    run_steps(problem, theta, &mut system, None, targets, &mut [], &NoObserver, options, None, &|| false)
}

/// Runs, and insists on reaching the end.
pub fn complete(problem: &Problem, theta: &[f64], targets: &[Target], options: SteppingOptions) -> Run {
    let run = run(problem, theta, targets, options);
    assert!(run.failure.is_none(), "{:?}", run.failure);
    run
}

/// Force at every target.
pub fn forces(run: &Run) -> Vec<f64> {
    at_targets(run).map(|s| s.force).collect()
}

/// The step that stands at each target.
pub fn at_targets(run: &Run) -> impl Iterator<Item = &StepRecord> {
    run.steps.iter().filter(|s| s.target.is_some())
}

/// Largest force of a run.
pub fn peak(run: &Run) -> f64 {
    run.steps.iter().fold(0.0, |m, s| s.force.max(m))
}

/// Peak between the steps: cubic through the forces and slopes of the two steps around it.
pub fn smooth_peak(run: &Run) -> (f64, f64) {
    let at = run.steps.windows(2).position(|w| w[0].slope > 0.0 && w[1].slope <= 0.0).expect("a peak");
    let (a, b) = (&run.steps[at], &run.steps[at + 1]);
    let h = b.actuator - a.actuator;
    let force = |s: f64| {
        let (s2, s3) = (s * s, s * s * s);
        (2.0 * s3 - 3.0 * s2 + 1.0) * a.force
            + (s3 - 2.0 * s2 + s) * h * a.slope
            + (3.0 * s2 - 2.0 * s3) * b.force
            + (s3 - s2) * h * b.slope
    };
    let (mut lo, mut hi) = (0.0, 1.0);
    for _ in 0..100 {
        let (p, q) = (lo + (hi - lo) / 3.0, hi - (hi - lo) / 3.0);
        if force(p) < force(q) { lo = p } else { hi = q }
    }
    (a.actuator + lo * h, force(lo))
}

/// Energy not accounted for, over the external work.
pub fn closure(ledger: &Ledger) -> f64 {
    ledger.gap().abs() / ledger.external_work.abs().max(1e-300)
}

/// Worst closure of all steps with at least a hundredth of the largest work.
pub fn worst_closure(run: &Run) -> f64 {
    let most = run.steps.iter().fold(0.0f64, |m, s| m.max(s.ledger.external_work));
    let counted = run.steps.iter().filter(|s| s.ledger.external_work > 0.01 * most);
    counted.fold(0.0, |m, s| m.max(s.ledger.gap().abs() / most))
}

/// Worst |a − b| over the largest |b|.
pub fn worst(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    let scale = b.iter().fold(1e-300f64, |m, x| m.max(x.abs()));
    a.iter().zip(b).fold(0.0f64, |m, (x, y)| m.max((x - y).abs())) / scale
}

/// Order observed from three meshes or steps, each finer by `factor`.
pub fn order(values: [f64; 3], factor: f64) -> f64 {
    ((values[0] - values[1]) / (values[1] - values[2])).abs().ln() / factor.ln()
}

/// Numbers with one digit and exponent.
pub fn sci(values: &[f64]) -> String {
    values.iter().map(|v| format!("{v:.1e}")).collect::<Vec<_>>().join(" ")
}
