//! Laws of one's own, from their cards to a model that uses them: a Fung solid and a linear softening.
//! `cargo run -p effects --example own_laws`; docs/adding-a-law.md walks through it.

use cohesive::{Curve, GC, Irreversible, SIGMA_C};
use constitutive::{Context, PointLaw, Scalar, StartGrid, tangent_by_jets_9, testing};
use laws::bulk::invariants::{Function, InvariantLaw, Invariants, Terms};
use laws::{LawCard, LawEntry, Settings};
use model::{Discretisation, Model, Request, RunOptions};
use params::{ParamSpec, Quantity, Transform};
use std::error::Error;
use std::sync::Arc;

// ---- A bulk law: Ψ = U(J) + μ/(2b) (exp(b (Ī1 − 3)) − 1) -----------------------------------

const MU: usize = 0;
const B: usize = 1;
const D: usize = 2;

static FUNG: LawCard = LawCard {
    name: "fung_isotropic",
    summary: "Isotropic, stiffening exponentially: skin and other tissue without a main fibre direction.",
    equation: "Ψ = U(J) + μ/(2b) (exp(b (Ī1 − 3)) − 1);  initial shear modulus μ",
    reference: "Demiray 1972, J. Biomech. 5, 309–311, doi:10.1016/0021-9290(72)90047-4",
};

/// The exponential solid of Demiray.
#[derive(Clone, Copy)]
struct Fung;

impl LawEntry<9> for Fung {
    fn card(&self) -> &LawCard {
        &FUNG
    }

    fn law(&self, _settings: &Settings) -> Arc<dyn PointLaw<9>> {
        Arc::new(Invariants(*self))
    }
}

impl InvariantLaw for Fung {
    fn parameters(&self) -> Vec<ParamSpec> {
        vec![
            ParamSpec::new("mu", "μ", Quantity::Stress, (1e-6, 1e4), 0.02, "initial shear modulus μ")
                .expected(0.02, 2.0),
            // Zero is admissible (neo-Hooke), but a search is over orders of magnitude.
            ParamSpec::new("b", "b", Quantity::Dimensionless, (0.0, 1e3), 3.0, "stiffening b")
                .transform(Transform::Log)
                .expected(3.0, 1.0),
            laws::bulk::compliance(),
        ]
    }

    fn d(&self) -> usize {
        D
    }

    fn terms<S: Scalar>(&self, params: &[S]) -> Terms<S> {
        Terms::new().isotropic(Function::Exponential { a: params[MU], b: params[B] })
    }

    fn matrix_modulus(&self) -> fn(&[f64]) -> f64 {
        |params| params[MU]
    }

    /// Tried on a free strip before a search: seven values of b, each scaled to the record by μ.
    fn starts(&self) -> Option<StartGrid> {
        let template = vec![0.0, 0.0, 1.0];
        Some(StartGrid { template, axes: vec![(MU, 1), (B, 7)], scaled: vec![MU], size: MU, apart: None })
    }
}

// ---- An interface law: σc from a short rise on, then a parabola to zero ---------------------

const RISE: usize = cohesive::PARAMETERS;

static PARABOLIC: LawCard = LawCard {
    name: "parabolic",
    summary: "A straight rise to σc, then a fall that starts flat and ends steep: brittle at the end.",
    equation: "t = σc δ/δc to δc = r δf, then σc (1 − y²), y = (δ − δc)/(δf − δc);  \
               δf = Gc/(σc (2/3 − r/6))",
    reference: "an example: the area under it is Gc by construction",
};

/// Rise and parabola.
#[derive(Clone, Copy)]
struct Parabolic;

impl LawEntry<3> for Parabolic {
    fn card(&self) -> &LawCard {
        &PARABOLIC
    }

    fn law(&self, _settings: &Settings) -> Arc<dyn PointLaw<3>> {
        Arc::new(Irreversible(*self))
    }
}

/// δf, mm: ½ r σc δf + ⅔ (1 − r) σc δf = Gc.
fn last<S: Scalar>(params: &[S]) -> S {
    params[GC] / (params[SIGMA_C] * (params[RISE] / -6.0 + 2.0 / 3.0))
}

impl Curve for Parabolic {
    fn shape(&self) -> Vec<ParamSpec> {
        let about = "opening of the peak over the last opening; fixed unless freed";
        vec![ParamSpec::new("rise", "r", Quantity::Dimensionless, (0.01, 0.8), 0.2, about).fixed()]
    }

    fn secant<S: Scalar>(&self, delta: S, params: &[S]) -> S {
        let (peak, last) = (self.delta_c(params), last(params));
        if delta.value() <= peak.value() {
            params[SIGMA_C] / peak
        } else if delta.value() < last.value() {
            let y = (delta - peak) / (last - peak);
            params[SIGMA_C] * (-(y * y) + 1.0) / delta
        } else {
            S::zero()
        }
    }

    fn work<S: Scalar>(&self, delta: S, params: &[S]) -> S {
        let (peak, last) = (self.delta_c(params), last(params));
        if delta.value() <= peak.value() {
            params[SIGMA_C] * delta * delta / (peak * 2.0)
        } else if delta.value() < last.value() {
            let y = (delta - peak) / (last - peak);
            params[SIGMA_C] * (peak * 0.5 + (last - peak) * (y - y * y * y / 3.0))
        } else {
            params[GC]
        }
    }

    fn delta_c<S: Scalar>(&self, params: &[S]) -> S {
        params[RISE] * last(params)
    }
}

// ---- Checks of the laws alone ---------------------------------------------------------------

fn check_bulk() {
    let law = Fung.law(&Settings::new());
    let (ctx, p) = (Context::default(), [0.02, 2.0, 0.1]);
    let f = [1.1, 0.2, 0.0, -0.1, 1.2, 0.1, 0.05, 0.0, 0.9];
    // The analytic tangent against dual numbers, the dual numbers against differences.
    let jets = tangent_by_jets_9(&*law, &ctx, &f, &p, &[], &mut []);
    assert!(testing::analytic_tangent_error(&*law, &ctx, &f, &p, &[], jets).is_some_and(|e| e < 1e-12));
    assert!(testing::tangent_error_9(&*law, &ctx, &f, &p, &[], 1e-6) < 1e-7);
    assert!(testing::parameter_error(&*law, &ctx, &f, &p, &[], 1e-5) < 1e-6);
    let q = testing::rotation(0.4, 0.7, -1.1);
    assert!(testing::objectivity_error(&*law, &ctx, &f, &q, &p, &[]) < 1e-11);
    // Simple shear in closed form: τ = μ g exp(b g²).
    let g = 0.3;
    let sheared = testing::respond(&*law, &ctx, &[1.0, g, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0], &p, &[]).0;
    assert!((sheared[1] - 0.02 * g * (2.0f64 * g * g).exp()).abs() < 1e-15);
}

fn check_interface() {
    let law = Parabolic.law(&Settings::new());
    let p = [0.2, 0.1, 1.0, 10.0, 0.2];
    // The work of the traction to full opening is Gc, and damage ends at 1.
    let (n, far) = (20_000, 4.0);
    let traction = |i: usize| {
        let opening = far * i as f64 / n as f64;
        testing::respond(&*law, &Context::default(), &[opening, 0.0, 0.0], &p, &[0.0]).0[0]
    };
    let work: f64 = (0..n).map(|i| 0.5 * (traction(i) + traction(i + 1)) * far / n as f64).sum();
    assert!((work / 0.2 - 1.0).abs() < 1e-6, "{work}");
    let scales = law.offers().cohesion.expect("every curve has scales");
    assert!((scales.damage(far, &p) - 1.0).abs() < 1e-12 && scales.damage(0.0, &p) == 0.0);
}

// ---- Use: a registry with two more, named by a file, run by the finite elements -------------

const STRIP: &str = r#"
name = "strip"
[geometry]
length_mm = 6.0
width_mm = 4.0
thickness_mm = 0.8
cut_mm = 1.0
[[tests]]
kind = "tearing"
protocol = [{ to_mm = 2.0, rate_mm_per_s = 0.05 }]
[mesh]
divisions = [8, 4, 1]
[bulk]
law = "fung_isotropic"
mu_kPa = 20.0
b = 1.5
[interface]
law = "parabolic"
gc_N_per_mm = 0.05
sigma_c_MPa = 0.02
rise = 0.3
"#;

/// Largest force of the test, N.
fn peak() -> Result<f64, Box<dyn Error>> {
    let known = laws::registry().with_bulk(Arc::new(Fung)).with_interface(Arc::new(Parabolic));
    let catalogue = effects::catalogue().with_laws(known);
    let folder = std::env::temp_dir().join(format!("own-laws-{}", std::process::id()));
    std::fs::create_dir_all(&folder)?;
    let file = folder.join("strip.toml");
    std::fs::write(&file, STRIP)?;
    let case = input::read_case(&file, &catalogue).map_err(|e| e.to_string());
    std::fs::remove_dir_all(&folder)?;
    let model = Model::new(Arc::new(case?), &catalogue, Discretisation::default())?;
    let runs = model.run(&Request {
        theta: &model.theta(),
        seeds: &[],
        options: RunOptions::default(),
        wanted: &[true],
        warm: &[],
        cancelled: &|| false,
    })?;
    let run = &runs[0].as_ref().ok_or("the test was not run")?.run;
    if let Some(failure) = &run.failure {
        return Err(failure.to_string().into());
    }
    Ok(run.steps.iter().fold(0.0, |m, s| m.max(s.force)))
}

fn main() -> Result<(), Box<dyn Error>> {
    check_bulk();
    check_interface();
    let force = peak()?;
    println!("largest force of the strip: {force:.4} N");
    // Never more than the strength over the whole ligament.
    assert!(force > 0.0 && force <= 0.02 * 3.0 * 0.8);
    Ok(())
}
