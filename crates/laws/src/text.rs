//! Cards as text: a Markdown page of the whole registry.

use crate::entry::{LawCard, LawEntry, Settings};
use crate::registry::Laws;
use input::{Key, LawSite, OptionKind, OptionSpec, OptionValue, keys_of_law};
use params::ParamSpec;
use std::fmt::Write;

/// The registry as a Markdown page: an overview of each site, then one section per law.
pub fn markdown(laws: &Laws) -> String {
    let mut out = String::from(
        "# The laws\n\n\
         Written by `just book` from the cards in `crates/laws`. `[bulk] law = \"…\"` and `[interface] law = \"…\"` choose\n\
         one; without, it is the first. The volumetric part of every bulk law is\n\
         U(J) = (1/D)((J² − 1)/2 − ln J), C̄ = J^(−2/3) C. How to add a law: `docs/adding-a-law.md`.\n",
    );
    for (title, site) in [("Bulk", LawSite::Bulk), ("Interface", LawSite::Interface)] {
        let _ = write!(out, "\n## {title}\n\n| law | is |\n|---|---|\n");
        for card in laws.cards(site) {
            let _ = writeln!(out, "| [`{0}`](#{0}) | {1} |", card.name, cell(card.summary));
        }
    }
    for law in laws.all_bulk() {
        let keys = keys_of_law(laws, LawSite::Bulk, law.card().name);
        out.push_str(&section(law.card(), &most(&**law), &law.options(), &keys));
    }
    for law in laws.all_interface() {
        let keys = keys_of_law(laws, LawSite::Interface, law.card().name);
        out.push_str(&section(law.card(), &most(&**law), &law.options(), &keys));
    }
    out
}

/// A law's parameters with its list as long as its settings can make it.
fn most<const G: usize>(law: &dyn LawEntry<G>) -> Vec<ParamSpec> {
    let largest = law.options().into_iter().filter_map(|o| match o.kind {
        OptionKind::Integer { max, .. } => Some((o.name, OptionValue::Integer(max))),
        _ => None,
    });
    law.parameters(&largest.collect::<Settings>())
}

fn section(card: &LawCard, specs: &[ParamSpec], options: &[OptionSpec], keys: &[Key]) -> String {
    // Key and factor of its unit, as a file would be written.
    let spelt = |name: &str| {
        let key = keys.iter().find(|k| k.name == name);
        key.map_or_else(|| (name.to_owned(), 1.0), |k| k.spellings().swap_remove(0))
    };
    let mut out = format!("\n### {}\n\n| | |\n|---|---|\n", card.name);
    let settings = options.iter().map(|o| (format!("`{}`", o.name), o.description.to_string()));
    let stated = [
        ("**for**".to_owned(), card.summary.to_owned()),
        ("**law**".to_owned(), format!("`{}`", card.equation)),
        ("**source**".to_owned(), card.reference.to_owned()),
    ];
    for (what, text) in stated.into_iter().chain(settings) {
        let _ = writeln!(out, "| {what} | {} |", cell(&text));
    }
    out.push('\n');
    out.push_str(
        "| parameter | key | start | bounds of a search | prior | is |\n|---|---|---|---|---|---|\n",
    );
    for p in specs.iter().filter(|p| !p.internal) {
        let (key, factor) = spelt(&p.name);
        let prior = match p.expected {
            Some(e) => format!("{} (spread {})", number(e.median / factor), number(e.spread)),
            None => String::new(),
        };
        let _ = writeln!(
            out,
            "| {} | `{}` | {}{} | {} to {} | {prior} | {} |",
            p.symbol,
            key,
            number(p.start / factor),
            if p.fixed { ", fixed" } else { "" },
            number(p.lower / factor),
            number(p.upper / factor),
            cell(&p.description)
        );
        if let Some(r) = p.reciprocal {
            let (key, _) = spelt(r.name);
            let _ =
                writeln!(out, "| {}/{} | `{key}` | | | | {} |", number(r.numerator), p.symbol, r.description);
        }
    }
    out
}

fn number(x: f64) -> String {
    let rounded: f64 = format!("{x:.5e}").parse().unwrap_or(x);
    if rounded != 0.0 && !(1e-4..1e6).contains(&rounded.abs()) {
        format!("{rounded:e}")
    } else {
        format!("{rounded}")
    }
}

fn cell(text: &str) -> String {
    text.replace('|', "\\|")
}
