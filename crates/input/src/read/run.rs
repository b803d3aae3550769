//! `[identify]`, `[solver]`, `[output]`

use super::scalar;
use super::section::Section;
use super::specimen::subsection;
use crate::case::{Leg, Test};
use crate::config::{
    Control, DiagnoseConfig, Figure, IdentifyConfig, Integration, Mode, OutputConfig, PriorsConfig,
    SolverConfig,
};
use crate::diagnostics::Report;
use crate::keys::{Kind, plain};
use toml::de::DeValue;

/// More answers of one test than anyone reads.
const MOST_STEPS: f64 = 1e6;

/// `[identify]`, priors apart.
pub(crate) fn identify(s: &Section<'_>, priors: PriorsConfig) -> IdentifyConfig {
    IdentifyConfig {
        mode: [Mode::Staged, Mode::Joint][s.choice("mode")],
        tolerance: s.number("tolerance"),
        max_iterations: s.integer("max_iterations"),
        multi_start: s.integer("multi_start"),
        priors,
        coarse_first: s.flag("coarse_first"),
        release_bulk: s.flag("release_bulk"),
    }
}

/// `[diagnose]`
pub(crate) fn diagnose(top: &Section<'_>) -> DiagnoseConfig {
    let s = subsection(top, "diagnose");
    DiagnoseConfig {
        rest: s.number("rest"),
        practice: s.number("practice"),
        expected_effects: s.number("expected_effects"),
        laws: s.flag("laws"),
    }
}

/// `[solver]`
pub(crate) fn solver(top: &Section<'_>, tests: &[Test]) -> SolverConfig {
    let s = subsection(top, "solver");
    let solver = SolverConfig {
        step_mm: s.optional_number("step"),
        control: [Control::Actuator, Control::Path][s.choice("control")],
        tolerance: s.number("tolerance"),
        max_iterations: s.integer("max_iterations"),
        integration: [Integration::Gauss, Integration::Nodal][s.choice("integration")],
    };
    if let Some(step) = solver.step_mm {
        let most = tests.iter().map(travel).fold(0.0, f64::max) / step;
        if most > MOST_STEPS {
            let message = format!(
                "`{}` = {} mm makes {most:.1e} steps; expected at most {MOST_STEPS:.0e}",
                s.spelling("step"),
                plain(step)
            );
            s.fault("step", message);
        }
    }
    solver
}

/// Way of the actuator in a test, mm.
fn travel(test: &Test) -> f64 {
    if let Some(record) = &test.record {
        return record.displacement.windows(2).map(|w| (w[1] - w[0]).abs()).sum();
    }
    let (mut at, mut way) = (0.0, 0.0);
    for leg in test.protocol.iter().flatten() {
        if let Leg::Ramp { to_mm, .. } = leg {
            way += (to_mm - at).abs();
            at = *to_mm;
        }
    }
    way
}

/// `[output]`
pub(crate) fn output(top: &Section<'_>) -> OutputConfig {
    let s = subsection(top, "output");
    let fields = match s.entry("fields").map(|e| e.item.get_ref()) {
        Some(DeValue::Boolean(false)) => 0,
        Some(DeValue::Boolean(true)) => 8,
        _ => s.integer("fields"),
    };
    let noise = s.optional_number("noise");
    OutputConfig { noise, seed: s.integer("seed") as u64, fields, figures: figures(&s) }
}

fn figures(s: &Section<'_>) -> Vec<Figure> {
    const ALL: [Figure; 3] = [Figure::Svg, Figure::Pdf, Figure::Png];
    let Some(entry) = s.entry("figures") else { return vec![Figure::Svg] };
    let Kind::Words { words } = &s.key("figures").kind else { return Vec::new() };
    let one = [entry.item.clone()];
    let items: &[scalar::Item<'_>] = match entry.item.get_ref() {
        DeValue::Array(items) => items,
        DeValue::String(_) => &one,
        _ => {
            scalar::wrong_type(s.context, "figures", entry.item, "a list of \"svg\", \"pdf\", \"png\"");
            &[]
        }
    };
    let mut out = Vec::new();
    for item in items {
        let Some(i) = scalar::choice(s.context, "figures", item, words) else { continue };
        if out.contains(&ALL[i]) {
            let report = Report::error(format!("`figures` lists \"{}\" twice", words[i])).key("figures");
            s.context.report(report, item.span());
            continue;
        }
        out.push(ALL[i]);
    }
    out
}
