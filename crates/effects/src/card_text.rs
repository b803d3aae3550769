//! Cards as text: a Markdown page of the whole catalogue, and one card for a terminal.

use input::OptionKind;
use model::{Card, Catalogue, Effect, Options, Screening, Sided};
use params::ParamSpec;
use std::fmt::Write;

/// The catalogue as a Markdown page: an overview table, then one section per effect.
pub fn markdown(catalogue: &Catalogue) -> String {
    let mut out = String::from(
        "# The catalogue of effects\n\n\
         Generated from the cards in `crates/effects`; do not edit by hand.\n\n\
         | effect | site | rank | what is missing | parameters |\n|---|---|---|---|---|\n",
    );
    for effect in catalogue.iter() {
        let card = effect.card();
        let keys: Vec<String> =
            effect.parameters(&Options::new()).iter().map(|p| format!("`{}`", p.key())).collect();
        let name = format!("[`{}`](#{})", card.name, card.name);
        let control = if card.negative_control { " (negative control)" } else { "" };
        let _ = writeln!(
            out,
            "| {name}{control} | {} | {} | {} | {} |",
            card.site.word(),
            card.rank,
            cell(card.summary),
            keys.join(", ")
        );
    }
    for effect in catalogue.iter() {
        let _ = write!(out, "\n{}", section(&**effect));
    }
    out
}

/// One effect as a Markdown section.
pub fn section(effect: &dyn Effect) -> String {
    let card = effect.card();
    let mut out = format!("## {}\n\n| | |\n|---|---|\n", card.name);
    let stated = [("what is missing", card.summary.to_owned()), ("law", format!("`{}`", card.law))];
    for (what, text) in stated.into_iter().chain(facts(effect)) {
        let _ = writeln!(out, "| **{what}** | {} |", cell(&text));
    }
    out.push('\n');
    out.push_str("| parameter | key | neutral | bounds | start | meaning |\n|---|---|---|---|---|---|\n");
    for p in effect.parameters(&Options::new()) {
        let _ = writeln!(
            out,
            "| {} | `{}` | {} | {} | {} | {} |",
            p.symbol,
            p.key(),
            neutral(&p),
            bounds(&p),
            start(&p),
            cell(&p.description)
        );
    }
    out
}

/// One effect for a terminal: plain lines.
pub fn terminal(effect: &dyn Effect) -> String {
    let card = effect.card();
    let mut out = format!(
        "{}  ({}, rank {})\n\n{}\n\n    {}\n\n",
        card.name,
        card.site.word(),
        card.rank,
        card.summary,
        card.law
    );
    for p in effect.parameters(&Options::new()) {
        let _ = writeln!(
            out,
            "    {:<18} {}; neutral {}, {}, start {}",
            p.key(),
            p.description,
            neutral(&p),
            bounds(&p),
            start(&p)
        );
    }
    out.push('\n');
    for (what, text) in facts(effect) {
        let _ = writeln!(out, "{what}: {text}");
    }
    out
}

fn facts(effect: &dyn Effect) -> Vec<(&'static str, String)> {
    let card = effect.card();
    let mut facts = vec![
        ("site", format!("{} (rank {})", card.site.word(), card.rank)),
        ("reference", card.reference.to_owned()),
        ("shows in", card.shows_in.join(", ")),
        ("look-alikes", or_none(card.look_alikes)),
        ("separated by", card.separated_by.to_owned()),
        ("ordinary size (the search's prior)", card.ordinary.to_owned()),
        ("needs", or_none(card.needs)),
        ("screening", screening(card)),
    ];
    if !card.excludes.is_empty() {
        facts.push(("not together with", card.excludes.join(", ")));
    }
    let asks: Vec<&str> = effect.asks(&Options::new()).into_iter().map(|a| a.words()).collect();
    if !asks.is_empty() {
        facts.push(("asks of the law", asks.join(", ")));
    }
    if card.breaks_half_height {
        facts.push(("symmetry", "refits need the full height".to_owned()));
    }
    if card.negative_control {
        facts.push(("negative control", "must never be chosen on quasi-static records".to_owned()));
    }
    for option in effect.options() {
        let values = match option.kind {
            OptionKind::Bool => "true or false".to_owned(),
            OptionKind::Integer { min, max } => format!("{min} to {max}"),
            OptionKind::Number { min, max } => format!("{min} to {max}"),
            OptionKind::Choice(words) => words.join(" or "),
            OptionKind::Test => "name of a test".to_owned(),
            OptionKind::TestKind => "name of an experiment".to_owned(),
            OptionKind::Text => "text".to_owned(),
        };
        facts.push(("option", format!("`{}` ({values}): {}", option.name, option.description)));
    }
    facts
}

fn screening(card: &Card) -> String {
    let (how, sided) = match card.screening {
        Screening::Score(sided) => ("score test", sided),
        Screening::Refit(sided) => ("short refit", sided),
    };
    let side = match sided {
        Sided::Positive => "one-sided",
        Sided::Both => "two-sided",
    };
    format!("{how}, {side}")
}

fn or_none(list: &[&str]) -> String {
    if list.is_empty() { "none".to_owned() } else { list.join(", ") }
}

fn neutral(p: &ParamSpec) -> String {
    p.neutral.map_or_else(|| "void at the neutral amplitude".to_owned(), |n| number(p.in_file_unit(n)))
}

fn bounds(p: &ParamSpec) -> String {
    format!("{} … {}", number(p.in_file_unit(p.lower)), number(p.in_file_unit(p.upper)))
}

fn start(p: &ParamSpec) -> String {
    let fixed = if p.fixed { " (fixed)" } else { "" };
    format!("{}{fixed}", number(p.in_file_unit(p.start)))
}

/// Four significant digits: a factor between units must not print as 0.020000000000000004.
fn number(x: f64) -> String {
    let short = format!("{x:.3e}").parse::<f64>().unwrap_or(x);
    if short != 0.0 && !(1e-4..1e6).contains(&short.abs()) {
        format!("{short:e}")
    } else {
        format!("{short}")
    }
}

/// Text of a table cell.
fn cell(text: &str) -> String {
    text.replace('|', "\\|")
}
