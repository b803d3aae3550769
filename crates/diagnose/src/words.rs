//! Findings and verdicts in sentences.

use crate::atlas::SegmentMisfit;
use crate::dependence::Dependence;
use crate::{Finding, Policy};

/// p-value from which a reader asks why an effect is not called for.
const UNLIKELY: f64 = 0.05;

/// What the screen says about one effect.
pub fn finding(f: &Finding, policy: &Policy) -> String {
    let name = &f.effect;
    if f.refit_only && f.fall < policy.min_fall {
        return format!("{name}: its derivative at neutral does not tell; a short refit decides.");
    }
    let alike = alike(&f.look_alikes);
    if f.significant {
        let estimate: Vec<String> = f
            .amplitudes
            .iter()
            .chain(&f.shape)
            .map(|(name, value)| format!("{name} ≈ {}", short(*value)))
            .collect();
        return format!(
            "{name} would take away {:.0} % of χ² ({}), with {}.{alike}",
            100.0 * f.expected_fall,
            p_is(f.p_shown()),
            estimate.join(", ")
        );
    }
    if !f.visible {
        return format!(
            "{name} cannot be seen in these records: a plausible amount shows at {:.1} noise standard deviations beyond what the base parameters imitate.{alike}",
            f.snr
        );
    }
    let conservative = match f.p_estimated {
        Some(p) if p < UNLIKELY && f.p_value >= UNLIKELY => {
            format!("; {} if the noise is as correlated as these records allow", p_value(f.p_value))
        }
        _ => String::new(),
    };
    format!(
        "{name} is not called for ({}{conservative}), though a plausible amount would show.",
        p_is(f.p_shown())
    )
}

fn alike(names: &[String]) -> String {
    match names {
        [] => String::new(),
        names => format!(" These records cannot tell it from {}.", join(names, "or")),
    }
}

/// Where the misfit is: the segments that hold most of it.
pub fn place(rows: &[SegmentMisfit]) -> String {
    let mut order: Vec<&SegmentMisfit> = rows.iter().collect();
    order.sort_by(|a, b| b.share.total_cmp(&a.share).then(a.segment.cmp(&b.segment)));
    let parts: Vec<String> = order
        .iter()
        .take(3)
        .filter(|r| r.share >= 0.1)
        .map(|r| {
            let sense = match r.sign {
                '+' => ", measured above the model",
                '-' => ", measured below the model",
                _ => "",
            };
            format!("{} ({:.0} %{sense})", r.segment, 100.0 * r.share)
        })
        .collect();
    if parts.is_empty() {
        "The misfit is spread over all segments.".into()
    } else {
        format!("The misfit sits in {}.", join(&parts, "and"))
    }
}

/// What the misfit depends on.
pub fn depends(rows: &[Dependence]) -> String {
    let parts: Vec<String> = rows
        .iter()
        .filter(|d| d.p_value < 1e-3 && d.share_beyond >= 0.02)
        .take(3)
        .map(|d| format!("{} ({:.0} % beyond the others)", d.variable, 100.0 * d.share_beyond))
        .collect();
    if parts.is_empty() {
        "No single variable explains the misfit beyond the others.".into()
    } else {
        format!("The misfit depends on {}.", join(&parts, "and"))
    }
}

/// `a`, `a or b`, `a, b or c`.
pub fn join<S: AsRef<str>>(names: &[S], last: &str) -> String {
    match names {
        [] => String::new(),
        [one] => one.as_ref().to_owned(),
        [head @ .., end] => {
            let head: Vec<&str> = head.iter().map(AsRef::as_ref).collect();
            format!("{} {last} {}", head.join(", "), end.as_ref())
        }
    }
}

/// Three significant digits.
/// Three significant digits, with an exponent where many zeros would stand.
fn short(x: f64) -> String {
    if x == 0.0 || !x.is_finite() {
        return format!("{x}");
    }
    let magnitude = x.abs().log10().floor();
    if (-3.0..4.0).contains(&magnitude) {
        let decimals = (2.0 - magnitude).max(0.0) as usize;
        format!("{x:.decimals$}")
    } else {
        format!("{x:.2e}")
    }
}

/// A p-value with its name.
fn p_is(p: f64) -> String {
    let p = p_value(p);
    if p.starts_with('<') { format!("p {p}") } else { format!("p = {p}") }
}

/// A p-value; a tail beyond what a double holds well is said to be below it.
fn p_value(p: f64) -> String {
    if p < 1e-99 {
        "< 1e-99".into()
    } else if p < 1e-3 {
        format!("{p:.0e}")
    } else {
        format!("{p:.3}")
    }
}
