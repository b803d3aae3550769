//! What records are good for, in a dozen lines.

use super::wrap;
use analysis::{Doctor, Foresight, RecordFindings};
use diagnose::{Foreseen, Policy, Shown};

/// Columns of a line.
const WIDTH: usize = 94;
/// Advice on what would show the rest: that many.
const ADVISED: usize = 3;
/// A multiple of a plausible size beyond which nobody asks for its digits.
const MANY: f64 = 100.0;

/// Lines of the doctor's answer; none where there is no record.
pub fn doctor_lines(d: &Doctor) -> Vec<String> {
    if d.records.is_empty() {
        return Vec::new();
    }
    let mut out = vec!["What these records are good for".to_owned()];
    for r in &d.records {
        push(&mut out, &record(r));
    }
    let doubts = d.records.iter().flat_map(|r| r.advice.iter().map(move |a| (r, a)));
    for (r, a) in doubts {
        push(&mut out, &format!("WARNING {} ({}): {}. Remedy: {}.", r.test, a.fault, a.found, a.remedy));
    }
    match (&d.shows, &d.shows_not) {
        (Some(f), _) => shows(&mut out, f),
        (None, Some(why)) => {
            push(
                &mut out,
                &format!("What they can show was not computed: {why}. Give start values near the tissue."),
            );
        }
        (None, None) => {}
    }
    out
}

fn push(out: &mut Vec<String>, text: &str) {
    out.extend(wrap(text, WIDTH, 2).lines().map(str::to_owned));
}

fn record(r: &RecordFindings) -> String {
    let averaged =
        if r.points < r.rows { format!(" (averaged to {} points)", r.points) } else { String::new() };
    let noise = match (r.noise_n, r.noise_correlation, &r.noise_unknown) {
        (Some(sd), correlation, _) => {
            let kind = match correlation {
                Some(c) if c != 0.0 => format!(", neighbours correlated {c:.2}"),
                Some(_) => ", white".to_owned(),
                None => ", as given".to_owned(),
            };
            format!(
                "noise {sd:.2e} N ({:.1} % of the peak of {:.3} N{kind})",
                100.0 * sd / r.peak_n,
                r.peak_n
            )
        }
        (None, _, why) => format!("noise unknown: {}", why.as_deref().unwrap_or("no estimate")),
    };
    let steadiness = if r.jitter_mm > 1e-4 * r.motion.to_mm {
        format!("displacement jitters by {:.1e} mm", r.jitter_mm)
    } else {
        "steady displacement".to_owned()
    };
    format!(
        "{}: {} rows{averaged}, one per {:.3} s; {noise}; {steadiness}; {}; {}",
        r.test,
        r.rows,
        r.interval_s,
        r.motion.words(),
        if r.tears { "tears" } else { "does not tear" }
    )
}

fn shows(out: &mut Vec<String>, f: &Foresight) {
    let or_none = |list: String| if list.is_empty() { "none".to_owned() } else { list };
    let names = |how: Shown, said: &dyn Fn(&Foreseen) -> String| {
        let list: Vec<String> = f.effects.iter().filter(|e| e.shown == how).map(said).collect();
        or_none(list.join(", "))
    };
    let policy = Policy::default();
    let shown_from = |e: &Foreseen| format!("{} ({})", e.effect, times(e.shown_from(&policy)));
    let found_from = |e: &Foreseen| format!("{} ({})", e.effect, times(e.found_from()));
    let error = |k: &analysis::Known| format!("{} ±{:.0} %", k.path, 100.0 * k.relative_error);
    let known: Vec<String> = f.parameters.iter().filter(|k| k.known).map(error).collect();
    let open: Vec<&str> = f.parameters.iter().filter(|k| !k.known).map(|k| k.path.as_str()).collect();
    let known = or_none(known.join(", "));
    push(out, &format!("parameters they fix (standard error by noise alone, no effect present): {known}"));
    push(out, &format!("parameters they leave open: {}", or_none(open.join(", "))));
    let shown = names(Shown::Shown, &|e| e.effect.clone());
    push(out, &format!("effects they show at a plausible size: {shown}"));
    let faint = names(Shown::Faint, &shown_from);
    push(out, &format!("effects they may miss at that size (and show from so many times it): {faint}"));
    let hidden = names(Shown::Hidden, &found_from);
    push(
        out,
        &format!(
            "effects they hide at that size (and find from so many times it, one time in two): {hidden}"
        ),
    );
    for (name, how) in f.hidden.iter().take(ADVISED) {
        push(out, &format!("to show `{name}`: {how}"));
    }
    if f.hidden.len() > ADVISED {
        push(out, "`fct design FILE` weighs protocols and cameras for the rest");
    }
}

/// A multiple as one reads it.
fn times(multiple: f64) -> String {
    if multiple < MANY { format!("{multiple:.1}×") } else { format!("over {MANY:.0}×") }
}

#[cfg(test)]
mod tests {
    use super::*;
    use analysis::Advice;

    #[test]
    fn a_doubt_is_told_with_its_remedy() {
        let advice = Advice { fault: "tare", found: "the cell reads 1 N".into(), remedy: "tare it".into() };
        let record = RecordFindings {
            test: "uniaxial".into(),
            rows: 20_000,
            points: 420,
            interval_s: 0.01,
            duration_s: 200.0,
            peak_n: 2.0,
            noise_n: Some(0.01),
            noise_correlation: Some(0.0),
            noise_unknown: None,
            resolution_n: 1e-4,
            jitter_mm: 0.0,
            motion: Default::default(),
            tears: false,
            advice: vec![advice],
        };
        let lines = doctor_lines(&Doctor { records: vec![record], shows: None, shows_not: None });
        // As it is read, wherever the lines are broken.
        let text = lines.iter().flat_map(|l| l.split_whitespace()).collect::<Vec<_>>().join(" ");
        assert!(text.contains("20000 rows (averaged to 420 points)"), "{text}");
        assert!(text.contains("Remedy: tare it") && text.contains("0.5 % of the peak"), "{text}");
        assert!(lines.iter().all(|l| l.chars().count() <= WIDTH), "{lines:?}");
    }
}
