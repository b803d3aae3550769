//! An effect of one's own, from its card to a model that uses it: grips that creep.
//! `cargo run -p effects --example own_effect`; docs/adding-an-effect.md walks through it.

use constitutive::{Context, Describe, Energy, HistorySpec, Law, Response, Scalar, testing};
use model::{
    Action, Card, Discretisation, Effect, Model, Options, Piece, Request, RunOptions, Scales, Screening,
    Sided, Site,
};
use params::{ParamSpec, Quantity};
use std::error::Error;
use std::sync::Arc;

// ---- The card: everything that is printed, and how it is screened ---------------------------

static CARD: Card = Card {
    name: "creeping_grips",
    site: Site::LoadTrain,
    rank: 15,
    summary: "Soft clamp linings give way slowly under load and come back slowly without it.",
    law: "u_grip = u_actuator − e,  e + τ ė = C F  (Kelvin–Voigt)",
    reference: "Kelvin–Voigt element in series with the tissue",
    shows_in: &["hold", "rate change", "unload"],
    look_alikes: &["viscoelastic", "lag", "compliance"],
    separated_by: "a camera on the clamped edges (grip_displacement_mm) sees it directly",
    ordinary: "C for which the grips take 5 % of the travel at the peak force: soft linings",
    excludes: &[],
    needs: &[],
    screening: Screening::Score(Sided::Positive),
    negative_control: false,
    breaks_half_height: false,
};

// ---- The effect: parameters, shapes, start, action ------------------------------------------

/// Grips that creep.
struct CreepingGrips;

impl Effect for CreepingGrips {
    fn card(&self) -> &Card {
        &CARD
    }

    fn parameters(&self, _options: &Options) -> Vec<ParamSpec> {
        Describe::parameters(&KelvinVoigt)
    }

    /// At C = 0 the delay has no influence: the screen tries a few.
    fn shapes(&self, scales: &Scales) -> Vec<Vec<f64>> {
        [0.003, 0.01, 0.03, 0.1].map(|share| vec![0.0, (share * scales.duration).clamp(1e-2, 1e5)]).to_vec()
    }

    fn start(&self, scales: &Scales) -> Vec<f64> {
        let c = 0.05 * scales.displacement / scales.peak_force;
        vec![c.clamp(0.0, 100.0), (0.03 * scales.duration).clamp(1e-2, 1e5)]
    }

    fn act(&self, _options: &Options, _piece: &Piece) -> Action {
        Action::Train(Arc::new(KelvinVoigt))
    }
}

// ---- The law: force in, elongation out, with memory and time --------------------------------

const C: usize = 0;
const TAU: usize = 1;

const FORCE: usize = 0;
const DELAYED: usize = 1;
const HEAT: usize = 2;

/// e = C f, where f follows the force F with the delay τ: f + τ ḟ = F. Exact where F is linear
/// within the step.
struct KelvinVoigt;

/// φ(x) = (1 − e⁻ˣ)/x, also at x = 0.
fn mean_decay<S: Scalar>(x: S) -> S {
    if x.value() < 1e-4 { S::one() - x * 0.5 + x * x * (1.0 / 6.0) } else { -(-x).exp_m1() / x }
}

impl<S: Scalar> Law<S, 1> for KelvinVoigt {
    fn respond(
        &self,
        ctx: &Context,
        force: &[S; 1],
        params: &[S],
        old: &[S],
        new: &mut [S],
    ) -> Response<S, 1> {
        // dt is a plain number and may be zero: an instantaneous change moves no dashpot.
        let x = S::from(ctx.dt) / params[TAU];
        let decay = (-x).exp();
        let f =
            old[DELAYED] * decay + force[0] - old[FORCE] * decay - (force[0] - old[FORCE]) * mean_decay(x);
        new[FORCE] = force[0];
        new[DELAYED] = f;
        // Heat over C: τ ∫ ḟ² dt with the mean rate of the step.
        new[HEAT] = old[HEAT];
        if ctx.dt > 0.0 {
            new[HEAT] += (f - old[DELAYED]).square() * params[TAU] / ctx.dt;
        }
        Response { force: [params[C] * f], energy: params[C] * f * f * 0.5 }
    }
}

impl Describe<1> for KelvinVoigt {
    fn parameters(&self) -> Vec<ParamSpec> {
        let c = "elongation per force after a long time";
        let tau = "time in which the grips follow the force";
        vec![
            ParamSpec::new("c", "C", Quantity::Compliance, (0.0, 100.0), 0.1, c).neutral(0.0),
            ParamSpec::new("tau", "τ", Quantity::Time, (1e-2, 1e5), 10.0, tau),
        ]
    }

    fn history(&self) -> Vec<HistorySpec> {
        ["force", "delayed_force", "heat"]
            .map(|name| HistorySpec { name: name.into(), initial: 0.0 })
            .to_vec()
    }

    fn rate_dependent(&self) -> bool {
        true
    }

    fn energies(&self, _: &Context, _: &[f64; 1], params: &[f64], _: &[f64], new: &[f64]) -> Energy {
        Energy { stored: 0.5 * params[C] * new[DELAYED] * new[DELAYED], dissipated: params[C] * new[HEAT] }
    }
}

// ---- Checks of the law alone ----------------------------------------------------------------

fn context(dt: f64) -> Context {
    Context { dt, ..Context::default() }
}

fn check_law() {
    let law = KelvinVoigt;
    let (c, tau, f) = (0.4, 5.0, 0.3);
    // A force put on at once and held: e = C F (1 − exp(−t/τ)), whatever the steps.
    let (_, _, mut history) = testing::respond(&law, &context(0.0), &[f], &[c, tau], &testing::virgin(&law));
    let mut time = 0.0;
    for dt in [0.1, 1.0, 3.0, 20.0] {
        time += dt;
        let (e, _, next) = testing::respond(&law, &context(dt), &[f], &[c, tau], &history);
        assert!((e[0] - c * f * (1.0 - (-time / tau).exp())).abs() < 1e-14);
        history = next;
    }
    // Neutral: nothing, exactly.
    assert_eq!(testing::respond(&law, &context(1.0), &[f], &[0.0, tau], &history).0, [0.0]);
    // The jets against differences, after a history.
    assert!(testing::parameter_error(&law, &context(2.0), &[0.5], &[c, tau], &history, 1e-5) < 1e-7);
    // Work = stored + dissipated on a fine ramp, and nothing given back.
    let (mut history, mut work, mut last) = (testing::virgin(&law), 0.0, (0.0, 0.0));
    for i in 1..=2000 {
        let force = 0.3 * (f64::from(i) * 0.003).sin();
        let (e, _, next) = testing::respond(&law, &context(0.02), &[force], &[c, tau], &history);
        work += 0.5 * (force + last.0) * (e[0] - last.1);
        let before = law.energies(&context(0.02), &[force], &[c, tau], &history, &history);
        let now = law.energies(&context(0.02), &[force], &[c, tau], &history, &next);
        assert!(now.dissipated >= before.dissipated);
        assert!((work - now.stored - now.dissipated).abs() < 1e-6);
        (history, last) = (next, (force, e[0]));
    }
}

// ---- Use: a catalogue with one more, read by a file, run by the finite elements -------------

const STRIP: &str = r#"
name = "strip"
[geometry]
length_mm = 8.0
width_mm = 6.0
thickness_mm = 0.8
[[tests]]
kind = "uniaxial"
protocol = [{ to_mm = 1.0, rate_mm_per_s = 0.5 }, { hold_s = 60.0 }]
[mesh]
divisions = [2, 4, 1]
"#;

/// Forces along the test: at its first step to the full stretch, and at its end.
fn forces(effect: &str) -> Result<(f64, f64), Box<dyn Error>> {
    let catalogue = effects::catalogue().with(Arc::new(CreepingGrips));
    let folder = std::env::temp_dir().join(format!("own-effect-{}", std::process::id()));
    std::fs::create_dir_all(&folder)?;
    let file = folder.join("strip.toml");
    std::fs::write(&file, format!("{STRIP}{effect}"))?;
    let case = input::read_case(&file, &catalogue).map_err(|e| e.to_string());
    std::fs::remove_dir_all(&folder)?;
    let model = Model::new(Arc::new(case?), &catalogue, Discretisation::default())?;
    let runs = model.run(&Request {
        theta: &model.theta(),
        seeds: &[],
        options: RunOptions { follow_holds: true, ..RunOptions::default() },
        wanted: &[true],
        warm: &[],
        cancelled: &|| false,
    })?;
    let run = &runs[0].as_ref().ok_or("the test was not run")?.run;
    if let Some(failure) = &run.failure {
        return Err(failure.to_string().into());
    }
    let full = run.steps.iter().find(|s| (s.actuator - 1.0).abs() < 1e-9);
    let first = full.ok_or("no step at the full stretch")?;
    let last = run.steps.last().ok_or("no steps")?;
    Ok((first.force, last.force))
}

fn main() -> Result<(), Box<dyn Error>> {
    check_law();
    println!("{}", effects::card_text::terminal(&CreepingGrips));
    let base = forces("")?;
    let neutral = forces("[effects.creeping_grips]\nc_mm_per_N = 0.0\ntau_s = 10.0\n")?;
    let creeping = forces("[effects.creeping_grips]\nc_mm_per_N = 0.5\ntau_s = 10.0\n")?;
    println!("force at the full stretch and 60 s later, N");
    for (name, (a, b)) in [("without", base), ("neutral", neutral), ("C = 0.5", creeping)] {
        println!("  {name:<8} {a:.6} {b:.6}");
    }
    // The law is neutral to the bit. A run with it is so to the tolerance of the solver: a link in the
    // train adds the force to Newton's unknowns, and other iterates end at the same equilibrium.
    assert!((base.0 - neutral.0).abs() < 1e-9 * base.0 && (base.1 - neutral.1).abs() < 1e-9 * base.1);
    assert!(creeping.1 < creeping.0 && creeping.1 < base.1);
    Ok(())
}
