//! `[identify]`, `[solver]`, `[output]`

use super::effects::test_exists;
use super::scalar;
use super::section::Section;
use super::specimen::subsection;
use crate::case::{Leg, Test};
use crate::config::{
    Control, Figure, HoldOut, IdentifyConfig, Integration, Mode, OutputConfig, PriorsConfig, SolverConfig,
};
use crate::diagnostics::Report;
use crate::keys::{self, Kind, plain};
use toml::de::DeValue;

/// More answers of one test than anyone reads.
const MOST_STEPS: f64 = 1e6;

/// `[identify]`, priors apart.
pub(crate) fn identify(s: &Section<'_>, tests: &[Test], priors: PriorsConfig) -> IdentifyConfig {
    IdentifyConfig {
        mode: [Mode::Staged, Mode::Joint][s.choice("mode")],
        tolerance: s.number("tolerance"),
        max_iterations: s.integer("max_iterations"),
        multi_start: s.integer("multi_start"),
        priors,
        hold_out: hold_out(s, tests),
        coarse_first: s.flag("coarse_first"),
        seed: s.integer("seed") as u64,
    }
}

fn hold_out(s: &Section<'_>, tests: &[Test]) -> Vec<HoldOut> {
    let Some(entry) = s.entry("hold_out") else { return Vec::new() };
    let expected = "a list of test names, or of { test, segment, from_s, to_s }";
    let Some(items) = scalar::list(s.context, "hold_out", entry.item, expected) else { return Vec::new() };
    let mut out = Vec::new();
    for (i, item) in items.iter().enumerate() {
        match item.get_ref() {
            DeValue::String(name) => {
                test_exists(s, "hold_out", name, tests, item.span());
                out.push(HoldOut { test: name.to_string(), segment: None, from_s: None, to_s: None });
            }
            DeValue::Table(table) => {
                let title = format!("hold_out {}", i + 1);
                let part = Section::open(s.context, title, item.span(), table, keys::of("identify.hold_out"));
                out.extend(held_part(&part, tests));
            }
            _ => scalar::wrong_type(
                s.context,
                "hold_out",
                item,
                "a test name, or { test, segment, from_s, to_s }",
            ),
        }
    }
    out
}

fn held_part(s: &Section<'_>, tests: &[Test]) -> Option<HoldOut> {
    let Some(name) = s.text("test") else {
        if s.entry("test").is_none() {
            s.missing("test");
        }
        return None;
    };
    test_exists(s, "test", name, tests, s.span_of("test"));
    let part = HoldOut {
        test: name.to_owned(),
        segment: s.text("segment").map(str::to_owned),
        from_s: s.optional_number("from"),
        to_s: s.optional_number("to"),
    };
    if let (Some(from), Some(to)) = (part.from_s, part.to_s)
        && from >= to
    {
        s.fault(
            "to",
            format!(
                "{} ends at {} s; expected more than its beginning, {} s",
                s.title,
                plain(to),
                plain(from)
            ),
        );
    }
    Some(part)
}

/// `[solver]`
pub(crate) fn solver(top: &Section<'_>, tests: &[Test]) -> SolverConfig {
    let s = subsection(top, "solver");
    let solver = SolverConfig {
        step_mm: s.optional_number("step"),
        control: [Control::Actuator, Control::Path][s.choice("control")],
        tolerance: s.number("tolerance"),
        max_iterations: s.integer("max_iterations"),
        min_step_fraction: s.number("min_step_fraction"),
        max_cuts: s.integer("max_cuts"),
        integration: [Integration::Gauss, Integration::Nodal][s.choice("integration")],
        viscous_regularisation_s: s.number("viscous_regularisation"),
        separated_damage: s.number("separated_damage"),
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
