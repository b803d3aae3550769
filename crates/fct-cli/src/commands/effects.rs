//! `fct effects`: the catalogue, or one card.

use crate::outcome::{Failure, Outcome};
use crate::session::Session;
use ::report::answer::SCHEMA;
use ::report::terminal::{Style, significant, wrap};
use model::{Card, Effect, Options};
use serde_json::{Value, json};

/// Arguments of `fct effects`.
#[derive(Clone, Debug, clap::Args)]
pub struct Arguments {
    /// Name of an effect; all of them when left out
    #[arg(value_name = "NAME")]
    pub name: Option<String>,
}

/// Shows the catalogue.
///
/// # Errors
/// If there is no such effect.
pub fn run(arguments: &Arguments, session: &Session) -> Result<Outcome, Failure> {
    let style = session.style();
    match &arguments.name {
        Some(name) => {
            let effect = find(session, name)?;
            Outcome::new(
                &json!({ "schema": SCHEMA, "effect": card_json(session, effect) }),
                card_text(session, effect, style),
            )
        }
        None => {
            let list: Vec<Value> = session.catalogue.iter().map(|e| card_json(session, &**e)).collect();
            let mut text = String::new();
            let mut site = None;
            for e in session.catalogue.iter() {
                let card = e.card();
                if site != Some(card.site) {
                    site = Some(card.site);
                    text.push_str(&format!("\n{}\n", style.bold(card.site.word())));
                }
                let head = format!("  {:<24}", card.name);
                text.push_str(&format!("{}\n", style.after(&head, card.summary)));
            }
            text.push_str("\n`fct effects NAME` shows one card.\n");
            Outcome::new(&json!({ "schema": SCHEMA, "effects": list }), text)
        }
    }
}

/// The effect of a name, or an error with the nearest name.
///
/// # Errors
/// If there is none.
pub fn find<'a>(session: &'a Session, name: &str) -> Result<&'a dyn Effect, Failure> {
    if let Some(effect) = session.catalogue.get(name) {
        return Ok(&**effect);
    }
    let names = session.catalogue.iter().map(|e| e.card().name.to_owned()).collect();
    Err(unknown("effect", name, names))
}

/// That there is nothing of that name, and which name may have been meant.
pub fn unknown(what: &str, name: &str, names: Vec<String>) -> Failure {
    let nearest = names
        .into_iter()
        .map(|n| (strsim::jaro_winkler(&n, name), n))
        .filter(|(score, _)| *score > 0.75)
        .max_by(|a, b| a.0.total_cmp(&b.0));
    let hint = nearest.map_or("`fct effects` lists them".to_owned(), |(_, n)| format!("did you mean `{n}`?"));
    Failure::usage(format!("fct: unknown {what} `{name}`; {hint}"))
}

fn card_json(session: &Session, e: &dyn Effect) -> Value {
    let c = e.card();
    json!({
        "name": c.name, "site": c.site.word(), "summary": c.summary, "law": c.law, "reference": c.reference,
        "shows_in": c.shows_in, "look_alikes": c.look_alikes, "separated_by": c.separated_by, "ordinary": c.ordinary,
        "excludes": c.excludes, "needs": c.needs, "experiments": session.catalogue.shown_in(e), "negative_control": c.negative_control,
        "parameters": e.parameters(&Options::new()), "options": e.options(),
    })
}

fn card_text(session: &Session, e: &dyn Effect, style: Style) -> String {
    let c: &Card = e.card();
    let mut out =
        format!("{} ({})\n{}\n\n", style.bold(c.name), c.site.word(), wrap(c.summary, style.width, 0));
    let mut line = |head: &str, text: &str| {
        if !text.is_empty() {
            out.push_str(&format!("{}\n", style.after(&format!("{head:<14}"), text)));
        }
    };
    line("law", c.law);
    line("shows in", &c.shows_in.join(", "));
    line("experiments", &session.catalogue.shown_in(e).join(", "));
    line("looks like", &c.look_alikes.join(", "));
    line("separated by", c.separated_by);
    line("ordinary size", c.ordinary);
    line("excludes", &c.excludes.join(", "));
    line("needs", &c.needs.join(", "));
    line("reference", c.reference);
    if c.negative_control {
        line("note", "a negative control: never to be chosen on quasi-static records");
    }
    out.push_str(&format!("\n{}\n", style.bold("parameters")));
    for p in e.parameters(&Options::new()) {
        let neutral =
            p.neutral.map_or(String::new(), |n| format!(", neutral {}", significant(p.in_file_unit(n), 3)));
        let bounds = format!(
            "{} … {}",
            significant(p.in_file_unit(p.lower), 3),
            significant(p.in_file_unit(p.upper), 3)
        );
        let about = format!("{} {}: {} ({bounds}{neutral})", p.symbol, p.key(), p.description);
        out.push_str(&format!("  {}\n", wrap(&about, style.width, 4)));
    }
    for o in e.options() {
        out.push_str(&format!(
            "  {}\n",
            wrap(&format!("option {}: {}", o.name, o.description), style.width, 4)
        ));
    }
    out
}
