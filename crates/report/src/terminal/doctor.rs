//! What records are good for, in a dozen lines.

use super::wrap;
use analysis::{Doctor, Expected, Foresight, RecordFindings};
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
    let expected = |how: Expected, said: &dyn Fn(&analysis::Known) -> String| {
        let list: Vec<String> = f.parameters.iter().filter(|k| k.expected == how).map(said).collect();
        or_none(list.join(", "))
    };
    let by = if f.counts_mesh { "noise and the mesh's error" } else { "noise alone" };
    push(
        out,
        &format!(
            "parameters they fix (standard error by {by}, no effect present): {}",
            expected(Expected::Fixed, &error)
        ),
    );
    if let Some(opening) = opening(f) {
        push(out, &format!("of these so many may be open beside an effect: {opening}"));
    }
    let uncertain = expected(Expected::Uncertain, &error);
    push(out, &format!("parameters they may fix (known to a factor of three before a fit): {uncertain}"));
    push(out, &format!("parameters they leave open: {}", expected(Expected::Open, &|k| k.path.clone())));
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

/// Effects beside which parameters may be open that are fixed without, and how many; none where there are none.
fn opening(f: &Foresight) -> Option<String> {
    let fixed = || f.parameters.iter().filter(|k| k.expected == Expected::Fixed);
    let opens = |e: &&Foreseen| fixed().filter(|k| k.beside.contains_key(&e.effect)).count();
    let mut list: Vec<(usize, &str)> = f.effects.iter().map(|e| (opens(&e), e.effect.as_str())).collect();
    list.retain(|(n, _)| *n > 0);
    list.sort_by(|a, b| b.0.cmp(&a.0).then(a.1.cmp(b.1)));
    let said: Vec<String> = list.iter().map(|(n, e)| format!("{e} {n}")).collect();
    (!said.is_empty()).then(|| said.join(", "))
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

    /// Words of the parameters, and of effects with the multiples from which on they are found and shown.
    #[test]
    fn what_the_records_show_is_told_with_what_opens_it() {
        use Expected::{Fixed, Open, Uncertain};
        let known = |path: &str, relative_error: f64, expected: Expected, beside: &[&str]| analysis::Known {
            path: path.into(),
            value: 1.0,
            relative_error,
            by_noise: 0.5 * relative_error,
            expected,
            beside: beside.iter().map(|&b| (b.to_owned(), Open)).collect(),
        };
        let effect = |name: &str, snr: f64, shown: Shown| Foreseen {
            effect: name.into(),
            amplitude: "a".into(),
            plausible: 1.0,
            shape: Vec::new(),
            snr,
            power: 0.5,
            least: Some(6.0 / snr),
            shown,
        };
        let shows = Foresight {
            parameters: vec![
                known("bulk.mu", 0.05, Fixed, &[]),
                known("bulk.k1", 0.1, Fixed, &["mullins", "slack"]),
                known("bulk.k2", 0.15, Fixed, &["slack"]),
                known("bulk.gamma", 0.4, Uncertain, &["slack"]),
                known("bulk.kappa", 2.0, Open, &[]),
            ],
            counts_mesh: true,
            effects: vec![
                effect("mullins", 60.0, Shown::Shown),
                effect("slack", 5.0, Shown::Faint),
                effect("gain", 1.0, Shown::Hidden),
            ],
            hidden: vec![("gain".into(), "hang a weight".into())],
        };
        let mut lines = Vec::new();
        super::shows(&mut lines, &shows);
        let text = lines.iter().flat_map(|l| l.split_whitespace()).collect::<Vec<_>>().join(" ");
        for part in [
            "(standard error by noise and the mesh's error, no effect present): bulk.mu ±5 %, bulk.k1 ±10 %",
            "of these so many may be open beside an effect: slack 2, mullins 1",
            "may fix (known to a factor of three before a fit): bulk.gamma ±40 %",
            "parameters they leave open: bulk.kappa",
            "at a plausible size: mullins",
            // Called from a power of one half on, 6 − 1.28 standard deviations; shown from the visible ones on.
            "gain (4.7×)",
            "to show `gain`: hang a weight",
        ] {
            assert!(text.contains(part), "{part} is not in {text}");
        }
        let visible = Policy::default().visible_snr.max(6.0) / 5.0;
        assert!(text.contains(&format!("slack ({visible:.1}×)")), "{text}");
    }
}
