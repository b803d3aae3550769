//! Double cantilever beam against corrected beam theory and LEFM.
//!
//! Elastic arms (k1 = 0, ν = 0), pulled at the mouth. Corrected beam theory (Hashemi, Kinloch &
//! Williams 1990, 10.1098/rspa.1990.0007): δ = 8 P (a + χh)³/(E b h³), with the crack lengthened by
//! χh for the root's rotation; in growth G = 12 P² (a + χh)²/(E b² h³) = Gc. Measured here: compliance before
//! growth, and the energy release rate G = Gc along the plateau from P and δ alone (the effective
//! crack length from the compliance), which needs no χ and no knowledge of the process zone.
use crate::common;

use common::*;
use mesh::{Sizing, Strip};

const E: f64 = 1e4;
const H: f64 = 1.0;
const A0: f64 = 10.0;
const GC: f64 = 0.01;

struct Dcb {
    /// Compliance before growth over that of corrected beam theory.
    compliance: f64,
    /// Gc-measured over Gc, mean and spread along the plateau.
    release: (f64, f64),
    closure: f64,
    /// Peak force over LEFM with corrected beam theory.
    peak: f64,
}

/// A run with `n` bricks per arm to an opening of the mouth of 0.55 mm.
fn torn(n: usize, sigma_c: f64) -> fem::Run {
    let size = H / n as f64;
    let width = 20.0;
    let strip = Strip {
        cut: A0,
        tear: true,
        sizing: Sizing::Divisions([(width / size).round() as usize, 2 * n, 2]),
        half_height: true,
        half_thickness: true,
        ..Strip::new(2.0 * H, width, 1.0)
    };
    let problem = problem(&strip, Ends::Mouth, 1);
    let tissue = Tissue {
        // ν = 0: μ = E/2, K0 = E/3; plane stress and plane strain are then one.
        bulk: Tissue::neo_hookean(E / 2.0, E / 3.0),
        lambda: 1.0,
        penalty: cohesive::initial_stiffness(GC, sigma_c),
        gc: GC,
        sigma_c,
    };
    complete(&problem, &tissue.theta(1), &plan([0.01].into_iter().chain(ramp(0.01, 0.55, 54))), shipped())
}

/// Crack length of a slender beam of this compliance: contains the root's rotation.
fn length(s: &fem::StepRecord) -> f64 {
    (E * H.powi(3) * s.actuator / (8.0 * s.force)).cbrt()
}

/// Energy release rate from force and displacement alone, over Gc.
fn release(s: &fem::StepRecord) -> f64 {
    12.0 * (s.force * length(s)).powi(2) / (E * H.powi(3)) / GC
}

fn dcb(n: usize, sigma_c: f64) -> Dcb {
    let run = torn(n, sigma_c);
    let shear = E / 2.0;
    let gamma = 1.18 * E / shear;
    let chi = (E / (11.0 * shear) * (3.0 - 2.0 * (gamma / (1.0 + gamma)).powi(2))).sqrt();
    let beam = |a: f64| 8.0 * (a + chi * H).powi(3) / (E * H.powi(3));
    let first = &run.steps[1];
    let compliance = first.actuator / first.force / beam(A0);
    // LEFM: P = sqrt(Gc E h³/12)/(a + χh).
    let critical = (GC * E * H.powi(3) / 12.0).sqrt() / (A0 + chi * H);
    // Plateau: grown by 1.5 to 5 mm, far from the far edge.
    let plateau = run.steps.iter().filter(|s| (A0 + 2.5..A0 + 6.0).contains(&length(s)));
    let rates: Vec<f64> = plateau.map(release).collect();
    assert!(rates.len() > 8, "{} points on the plateau", rates.len());
    let mean = rates.iter().sum::<f64>() / rates.len() as f64;
    let spread = rates.iter().fold(0.0f64, |m, r| m.max((r - mean).abs()));
    Dcb { compliance, release: (mean, spread), closure: worst_closure(&run), peak: peak(&run) / critical }
}

#[test]
fn dcb_against_corrected_beam_theory() {
    println!(
        "DCB: bricks per arm height, σc: compliance/CBT, Gc from the plateau/Gc (± spread), peak/LEFM, ledger"
    );
    let mut results = Vec::new();
    for (n, sigma_c) in [(4, 5.0), (8, 5.0), (8, 10.0)] {
        let r = dcb(n, sigma_c);
        println!(
            "  {n}, {sigma_c:4} MPa (δc = {:.2e} mm): {:.4}, {:.4} ± {:.4}, {:.4}, {:.1e}",
            GC / (std::f64::consts::E * sigma_c),
            r.compliance,
            r.release.0,
            r.release.1,
            r.peak,
            r.closure
        );
        results.push(r);
    }
    let finest = &results[2];
    assert!((finest.compliance - 1.0).abs() < 0.03);
    assert!((finest.release.0 - 1.0).abs() < 0.02 && finest.release.1 < 0.01);
    assert!(results.iter().all(|r| r.closure < 1e-3));
    assert!((finest.peak - 1.0).abs() < 0.04);
}

/// A process zone shorter than an element: the tear goes on by one small jump per element, each a sharp limit point on
/// a path that is nearly a line in displacement and mean opening. The mesh resists more than Gc there, which is no
/// fault of the walk; that a jump ends one element further is what it must find.
#[test]
fn a_tear_that_the_mesh_does_not_resolve_goes_on_element_by_element() {
    let n = 2;
    let size = H / f64::from(n);
    let run = torn(n as usize, 20.0);
    let landed: Vec<f64> = run.steps.iter().filter(|s| s.after_jump).map(length).collect();
    let lengths: Vec<String> = landed.iter().map(|a| format!("{a:.2}")).collect();
    let grown: Vec<f64> = at_targets(&run).filter(|s| length(s) > A0 + 1.5).map(release).collect();
    let mean = grown.iter().sum::<f64>() / grown.len() as f64;
    let (at, closure) = (lengths.join(", "), worst_closure(&run));
    println!("landed at {at} mm, closure {closure:.1e}, G/Gc in growth {mean:.2}");
    assert!(landed.len() > 3, "{} jumps", landed.len());
    for (a, b) in landed.iter().zip(&landed[1..]) {
        assert!((b - a - size).abs() < 0.05 * size, "a jump by {} mm", b - a);
    }
    assert!(run.jumps.iter().all(|j| j.released > 0.0 && j.force_after < j.force_before));
    keeps_its_pace(&run, 100.0);
    // Over a whole jump the work is that of the path, which turns back in displacement twice.
    assert!(worst_closure(&run) < 1e-3);
}
