//! Protocols that were weighed, as a table and in words.

use super::{Style, wrap};
use analysis::{Confirmed, DesignAnswer, Foresight, RatedProtocol};
use input::Leg;
use std::fmt::Write as _;

/// Columns of a line.
const WIDTH: usize = 98;

/// Power that counts as seen.
const SEEN: f64 = 0.9;

/// What `fct design` prints.
pub fn design(answer: &DesignAnswer, style: Style) -> String {
    let mut out = String::new();
    let Some(best) = answer.protocols.first() else { return out };
    let _ = writeln!(out, "{}", style.bold(&format!("Proposed: {} ({})", best.words, time(best.seconds))));
    for (test, legs) in &best.protocols {
        let _ =
            writeln!(out, "  {test}: protocol = [{}]", legs.iter().map(leg).collect::<Vec<_>>().join(", "));
    }
    if !best.full.is_empty() {
        confirmed(&mut out, &best.full);
    }
    told(&mut out, "with the load cell, by the linear look", &best.force);
    told(&mut out, "with cameras too, by the linear look", &best.camera);
    out.push('\n');
    for w in &answer.protocols {
        let _ = writeln!(out, "{}", row(w));
    }
    for (name, why) in &answer.left_out {
        let _ = writeln!(out, "  {name}: left out, {why}");
    }
    for v in answer.variants.iter().take(5) {
        let line = format!(
            "tells the rivals apart with {:.0} % power: {} ({} more)",
            100.0 * v.power,
            v.proposal,
            time(v.seconds)
        );
        let _ = writeln!(out, "{}", wrap(&line, WIDTH, 2));
    }
    for ((test, peak), (_, sd)) in answer.peaks_n.iter().zip(&answer.noise_n) {
        let _ = writeln!(out, "{test}: a peak of about {peak:.3} N, noise of {sd:.2e} N assumed");
    }
    for r in &answer.remarks {
        let _ = writeln!(out, "{}", style.notice(&wrap(r, WIDTH, 2)));
    }
    out
}

/// Effects by the full model: those that are seen, with the size that is seen with 90 % power, and the others.
fn confirmed(out: &mut String, full: &[Confirmed]) {
    let least = |c: &Confirmed| match c.seen_at[2] {
        Some(size) => format!("{} (from {} = {})", c.effect, c.amplitude, short(size)),
        None => c.effect.clone(),
    };
    let seen: Vec<String> = full.iter().filter(|c| c.power >= SEEN).map(least).collect();
    let faint: Vec<String> = full
        .iter()
        .filter(|c| c.not.is_none() && (0.1..SEEN).contains(&c.power))
        .map(|c| format!("{} ({:.0} %)", c.effect, 100.0 * c.power))
        .collect();
    let mut line = format!("with the load cell, by the full model: shows {}", or_none(seen));
    if !faint.is_empty() {
        let _ = write!(line, "; perhaps {}", faint.join(", "));
    }
    let _ = writeln!(out, "  {}", wrap(&line, WIDTH - 2, 4));
    for c in full.iter().filter(|c| c.power < SEEN) {
        if let Some(why) = &c.not {
            let line = format!("{}: not asked to the end ({why})", c.effect);
            let _ = writeln!(out, "  {}", wrap(&line, WIDTH - 2, 4));
        }
    }
}

fn told(out: &mut String, what: &str, f: &Foresight) {
    let seen: Vec<String> = f.effects.iter().filter(|e| e.power >= SEEN).map(|e| e.effect.clone()).collect();
    let faint: Vec<String> = f
        .effects
        .iter()
        .filter(|e| (0.1..SEEN).contains(&e.power))
        .map(|e| format!("{} ({:.0} %)", e.effect, 100.0 * e.power))
        .collect();
    let strengths: Vec<String> = f
        .parameters
        .iter()
        .filter(|k| k.path.starts_with("interface."))
        .map(|k| format!("{} ±{:.1} %", k.path, 100.0 * k.relative_error))
        .collect();
    let mut line = format!("{what}: shows {}", or_none(seen));
    if !faint.is_empty() {
        let _ = write!(line, "; perhaps {}", faint.join(", "));
    }
    if !strengths.is_empty() {
        let _ = write!(line, "; {}", strengths.join(", "));
    }
    let _ = writeln!(out, "  {}", wrap(&line, WIDTH - 2, 4));
}

fn or_none(list: Vec<String>) -> String {
    if list.is_empty() { "no effect".to_owned() } else { list.join(", ") }
}

fn row(w: &RatedProtocol) -> String {
    let seen = |f: &Foresight| f.effects.iter().filter(|e| e.power >= SEEN).count();
    let rivals = w.rivals_power.map_or_else(String::new, |[force, camera]| {
        format!(", rivals apart with {:.0} % power ({:.0} % with cameras)", 100.0 * force, 100.0 * camera)
    });
    format!(
        "  {}: {}, shows {} effects ({} with cameras){rivals}",
        w.name,
        time(w.seconds),
        seen(&w.force),
        seen(&w.camera)
    )
}

fn time(seconds: f64) -> String {
    if seconds < 90.0 { format!("{seconds:.0} s") } else { format!("{:.0} min", seconds / 60.0) }
}

fn leg(leg: &Leg) -> String {
    match leg {
        Leg::Ramp { to_mm, rate_mm_per_s } => {
            format!("{{ to_mm = {}, rate_mm_per_s = {} }}", short(*to_mm), short(*rate_mm_per_s))
        }
        Leg::Hold { hold_s } => format!("{{ hold_s = {} }}", short(*hold_s)),
    }
}

/// Four significant digits.
fn short(x: f64) -> String {
    if x == 0.0 {
        return "0.0".into();
    }
    let digits = (3 - x.abs().log10().floor() as i32).clamp(0, 12) as usize;
    let text = format!("{x:.digits$}");
    let text = if text.contains('.') { text.trim_end_matches('0').to_owned() } else { text };
    if text.ends_with('.') { format!("{text}0") } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn legs_are_what_a_file_takes() {
        assert_eq!(
            leg(&Leg::Ramp { to_mm: 1.234_56, rate_mm_per_s: 0.05 }),
            "{ to_mm = 1.235, rate_mm_per_s = 0.05 }"
        );
        assert_eq!(
            leg(&Leg::Ramp { to_mm: 0.0, rate_mm_per_s: 12_345.6 }),
            "{ to_mm = 0.0, rate_mm_per_s = 12346 }"
        );
        assert_eq!(leg(&Leg::Hold { hold_s: 120.0 }), "{ hold_s = 120.0 }");
        assert_eq!((time(80.0), time(600.0)), ("80 s".to_owned(), "10 min".to_owned()));
    }
}
