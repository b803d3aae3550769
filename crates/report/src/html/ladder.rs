//! The staircase of rungs, the ranked effects, the residual atlas.

use super::answer::called;
use super::view::{FittedModel, View};
use super::{Cell, escape, per_model, share_class, table};
use crate::answer::IdentifyAnswer;
use crate::law_columns::{cell, head, told_sites};
use crate::peek::{list, number, rows, text, yes};
use crate::terminal::{along_path, called as called_words, p_value, significant};
use analysis::Residuals;
use serde_json::Value;

/// A segment whose rms is less than so many times the noise is not looked at: few points scatter that far.
const NOISE: f64 = 1.6;
/// Effects that stand above the fold of the table.
const FIRST: usize = 8;

/// The staircase; each step is a button that shows its model everywhere on the page.
pub fn staircase(v: &View) -> String {
    if v.fitted_models.len() < 2 {
        return String::new();
    }
    let most = v.fitted_models.iter().map(FittedModel::rms).fold(f64::MIN_POSITIVE, f64::max);
    let noise = v.fitted_models.first().map_or(0.0, FittedModel::noise);
    let steps: String = v.fitted_models.iter().enumerate().map(|(k, r)| step(v, k, r, most)).collect();
    format!(
        "<section id=\"ladder\"><h2>Ladder</h2>\n<p class=\"muted\">Height: rms misfit over all force points (N). Dashed: \
         noise, {} N. Choose a rung: curves, values and tables below follow.</p>\n\
         <div class=\"stairs\" role=\"group\" aria-label=\"rungs of the ladder\">\n\
         <div class=\"noise {}\" aria-hidden=\"true\"></div>\n{steps}</div>\n{}</section>\n",
        significant(noise, 3),
        share_class(noise / most),
        ladder_table(v)
    )
}

fn step(v: &View, k: usize, r: &FittedModel, most: f64) -> String {
    let before = k.checked_sub(1).and_then(|b| v.fitted_models.get(b));
    let name = match before {
        None => r.name(),
        Some(b) => {
            let new: Vec<&String> = r.parts.iter().filter(|e| !b.parts.contains(e)).collect();
            if new.is_empty() {
                r.name()
            } else {
                new.iter().map(|e| format!("+ {e}")).collect::<Vec<_>>().join(" ")
            }
        }
    };
    format!(
        "<button type=\"button\" class=\"rung\" data-rung=\"{k}\" aria-pressed=\"{}\">\
         <span class=\"bar\"><span class=\"{}\"></span></span><b>{}</b>\
         <span>{} N</span><span>χ² {}</span></button>\n",
        k == v.shown,
        share_class(r.rms() / most),
        escape(&name),
        significant(r.rms(), 3),
        significant(r.chi2(), 3),
    )
}

fn ladder_table(v: &View) -> String {
    let mean = |r: &FittedModel, name: &str| {
        along_path(&r.answer, name).map_or_else(|| "–".into(), |mean| significant(mean, 3))
    };
    let optional = |x: Option<f64>, digits| x.map_or("–".to_owned(), |x| significant(x, digits));
    let sites = told_sites(v.fitted_models.iter().map(|r| r.answer.laws.as_ref()));
    let law = head(&sites);
    let rows = v.fitted_models.iter().map(|r| {
        let mut row = vec![
            Cell::left(r.name()),
            Cell::number(r.answer.parameters.len().to_string()),
            Cell::number(significant(r.rms(), 3)),
            Cell::number(optional(r.held_out(), 3)),
            Cell::number(significant(r.chi2(), 3)),
            Cell::number(optional(r.bic(), 5)),
            Cell::number(mean(r, "gc")),
            Cell::number(mean(r, "sigma_c")),
        ];
        if law.is_some() {
            row.insert(1, Cell::left(cell(r.answer.laws.as_ref(), &sites)));
        }
        row
    });
    let mut header = vec![
        "model",
        "parameters",
        "rms (N)",
        "held-out rms (N)",
        "reduced χ²",
        "BIC",
        "mean Gc (N/mm)",
        "mean σc (MPa)",
    ];
    if let Some(law) = &law {
        header.insert(1, law);
    }
    table(&header, rows)
}

/// The ranked catalogue.
pub fn effects(v: &View) -> String {
    let Some(d) = &v.diagnosis else { return String::new() };
    let screen = rows(d, "screen");
    if screen.is_empty() {
        return String::new();
    }
    let (first, rest) = screen.split_at(screen.len().min(FIRST));
    let more = if rest.is_empty() {
        String::new()
    } else {
        format!("<details><summary>{} more effects</summary>\n{}</details>\n", rest.len(), screen_table(rest))
    };
    format!(
        "<section id=\"effects\"><h2>What could be missing</h2>\n<p class=\"muted\">Score test of the whole catalogue at the base \
         model: the share of χ² that adding the effect is expected to take away, and how likely so much is by chance (p, with the noise as estimated; what is called for is decided with \
         noise as correlated as these records allow; if large: only in more than a plausible amount).</p>\n{}{more}</section>\n",
        screen_table(first)
    )
}

fn screen_table(screen: &[Value]) -> String {
    let lines: String = screen.iter().map(effect).collect();
    format!(
        "<div class=\"scroll\"><table class=\"effects\"><thead><tr><th>effect</th><th>expected fall of χ²</th>\
         <th class=\"n\">p</th><th>look-alikes</th><th>in words</th></tr></thead><tbody>\n{lines}</tbody></table></div>\n"
    )
}

fn effect(r: &Value) -> String {
    let fall = number(r, "expected_fall").unwrap_or(0.0).clamp(0.0, 1.0);
    let p = if yes(r, "refit_only") {
        "refit".into()
    } else {
        escape(&number(r, "p_value").map_or("–".into(), p_value))
    };
    let dim = if called(r) { "" } else { " class=\"dim\"" };
    let says = match called_words(r) {
        "" => String::new(),
        words => format!(" <span class=\"muted\">({words})</span>"),
    };
    format!(
        "<tr{dim}><td><b>{}</b>{says}</td><td><span class=\"fall\"><span class=\"{}\"></span></span> {:.0} %</td>\
         <td class=\"n\" data-head=\"p:\">{p}</td><td class=\"wrap\" data-head=\"look-alikes:\">{}</td><td class=\"wrap words\">{}</td></tr>\n",
        escape(text(r, "effect")),
        share_class(fall),
        100.0 * fall,
        escape(&list(r, "look_alikes").join(", ")),
        escape(text(r, "sentence")),
    )
}

/// The residual atlas of every rung.
pub fn residuals(v: &View) -> String {
    if v.fitted_models.iter().all(|r| r.curves.is_empty()) {
        return String::new();
    }
    let body = per_model(v, |r| {
        let all: Vec<Residuals> = r.curves.iter().map(crate::Curve::residuals).collect();
        let tables = format!("{}{}", by_segment(&all), by_tear_front(&all));
        // Where all is noise, nobody needs to read where it sits.
        match noise_only(&r.answer, &all) {
            Some(words) => format!("<details><summary>{words}</summary>\n{tables}</details>\n"),
            None => tables,
        }
    });
    format!(
        "<section id=\"atlas\"><h2>Residual atlas</h2>\n<p class=\"muted\">Where the misfit sits. rms / noise is 1 for a model that is \
         right; an autocorrelation well above 0 is structure, not noise. ▲ record above the model, ▼ below.</p>\n{body}</section>\n"
    )
}

/// What an atlas would say of a model that is at the noise in every segment; `None`: it is not.
fn noise_only(a: &IdentifyAnswer, all: &[Residuals]) -> Option<String> {
    let ratio = |r: &Residuals, rms: f64| rms / r.noise.max(f64::MIN_POSITIVE);
    let ratios: Vec<f64> = all
        .iter()
        .flat_map(|r| diagnose::atlas::atlas(&r.misfit, &r.segments).into_iter().map(|s| ratio(r, s.rms)))
        .collect();
    let most = ratios.iter().copied().fold(0.0, f64::max);
    (a.explained && a.reduced_chi2 <= diagnose::MESH_ERROR_ONLY && most < NOISE).then(|| {
        format!("{} segments, all at the noise: the largest rms is {most:.2} times it", ratios.len())
    })
}

fn by_segment(all: &[Residuals]) -> String {
    // Shares of the whole χ², as the first screen names them.
    let total: f64 = all.iter().map(Residuals::chi2).sum();
    let rows = all.iter().flat_map(|r| {
        let own = r.chi2() / total.max(f64::MIN_POSITIVE);
        diagnose::atlas::atlas(&r.misfit, &r.segments).into_iter().map(move |s| {
            vec![
                Cell::left(r.test.clone()),
                Cell::left(s.segment),
                Cell::number(s.points.to_string()),
                Cell::share(s.share * own),
                Cell::number(format!("{:.2}", s.rms / r.noise.max(f64::MIN_POSITIVE))),
                Cell::number(format!("{} {}", significant(s.mean, 2), side(s.sign))),
                Cell::number(format!("{:.2}", without_minus_zero(s.autocorrelation))),
            ]
        })
    });
    let header =
        ["test", "segment", "points", "share of χ²", "rms / noise", "mean misfit (N)", "autocorrelation"];
    table(&header, rows)
}

/// The same by where the model's tear stood.
fn by_tear_front(all: &[Residuals]) -> String {
    let noise = |test: &str| all.iter().find(|r| r.test == test).map_or(f64::NAN, |r| r.noise);
    let stretches = analysis::along_the_tear(all);
    if stretches.is_empty() {
        return String::new();
    }
    let rows = stretches.into_iter().map(|s| {
        let ends = if s.to_mm > s.from_mm {
            format!("{} – {}", significant(s.from_mm, 3), significant(s.to_mm, 3))
        } else {
            format!("{}, not yet torn", significant(s.from_mm, 3))
        };
        vec![
            Cell::left(s.test.clone()),
            Cell::left(ends),
            Cell::number(s.points.to_string()),
            Cell::share(s.share),
            Cell::number(format!("{:.2}", s.rms_n / noise(&s.test))),
            Cell::number(significant(s.mean_n, 2)),
        ]
    });
    let header = ["test", "tear front at (mm)", "points", "share of χ²", "rms / noise", "mean misfit (N)"];
    table(&header, rows)
}

fn side(sign: char) -> &'static str {
    match sign {
        '+' => "▲",
        '-' => "▼",
        _ => "·",
    }
}

/// To two decimals; what rounds to zero from below is zero.
fn without_minus_zero(x: f64) -> f64 {
    (100.0 * x).round() / 100.0 + 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_decimals_without_a_minus_before_zero() {
        for (x, shown) in [(-0.004, "0"), (-0.006, "-0.01"), (0.126, "0.13"), (12.0, "12")] {
            assert_eq!(without_minus_zero(x).to_string(), shown);
        }
    }
}
