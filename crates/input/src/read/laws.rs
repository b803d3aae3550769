//! `[bulk]` and `[interface]`: which law, its parameters and settings, by the registry.

use super::effects::{option, whole_numbers};
use super::scalar;
use super::section::{Context, Section};
use super::specimen::subsection_of;
use crate::case::Test;
use crate::config::{BulkConfig, InterfaceConfig, OptionValue, Profile, Value};
use crate::diagnostics::Report;
use crate::keys::{self, FOREIGN, Key, Kind, closest, either, law_keys};
use crate::registry::{LawRegistry, LawSite, OptionSpec};
use crate::text::short;
use params::{ParamSpec, Reciprocal};
use std::collections::BTreeMap;
use toml::de::{DeTable, DeValue};

/// The law that a file chooses for a site.
pub(crate) struct Chosen {
    site: LawSite,
    law: String,
    specs: Vec<ParamSpec>,
    options: Vec<OptionSpec>,
    /// Whether there is such a law; if not, that was said, and its keys are not looked at.
    known: bool,
    /// Keys that only other laws of the site have.
    foreign: Vec<Key>,
    /// Which laws have which parameter or setting.
    owners: BTreeMap<String, Vec<String>>,
}

/// Finds the law of a site: what the file names, or the registry's first.
pub(crate) fn chosen(top: &Section<'_>, registry: &dyn LawRegistry, site: LawSite) -> Chosen {
    let names = registry.law_names(site);
    let table = top.entry(site.section()).and_then(|e| match e.item.get_ref() {
        DeValue::Table(table) => Some(table),
        _ => None,
    });
    let (law, known) = match table.and_then(|t| t.get("law")) {
        None => (names.first().cloned().unwrap_or_default(), true),
        Some(item) => named(top.context, site, &names, item),
    };
    let options = registry.law_options(site, &law);
    let settings = table.map(|t| whole_numbers(&options, t)).unwrap_or_default();
    let specs = registry.law_parameters(site, &law, &settings).unwrap_or_default();
    let own = law_keys(site, &specs, &options);
    let (mut foreign, mut owners) = (Vec::new(), BTreeMap::<String, Vec<String>>::new());
    for other in &names {
        for mut key in keys_of_law(registry, site, other) {
            owners.entry(key.name.to_string()).or_default().push(other.clone());
            let spelt = |k: &Key| k.spelling() == key.spelling();
            if !own.iter().any(spelt) && !foreign.iter().any(spelt) {
                key.section = FOREIGN.into();
                foreign.push(key);
            }
        }
    }
    Chosen { site, law, specs, options, known, foreign, owners }
}

/// The keys of a law, with its list of parameters as long as its settings can make it: each parameter (a reciprocal
/// before it), then the settings.
pub fn keys_of_law(registry: &dyn LawRegistry, site: LawSite, law: &str) -> Vec<Key> {
    let options = registry.law_options(site, law);
    let most = options.iter().filter_map(|o| match o.kind {
        crate::registry::OptionKind::Integer { max, .. } => Some((o.name.clone(), OptionValue::Integer(max))),
        _ => None,
    });
    let specs = registry.law_parameters(site, law, &most.collect()).unwrap_or_default();
    law_keys(site, &specs, &options)
}

/// The law that a file names, and whether there is one of this name.
fn named(context: Context<'_>, site: LawSite, names: &[String], item: &scalar::Item<'_>) -> (String, bool) {
    let Some(given) = scalar::text(context, "law", item) else { return (String::new(), false) };
    if names.iter().any(|n| n == given) {
        return (given.to_owned(), true);
    }
    let words = || names.iter().map(String::as_str);
    let unknown = format!("unknown law `{}` in [{}]", short(given), site.section());
    let report = match closest(given, words()) {
        Some(meant) => Report::error(format!("{unknown}; did you mean `{meant}`?")),
        None => Report::error(format!("{unknown}; expected {}", either(words()))),
    };
    context.report(report.key("law"), item.span());
    (given.to_owned(), false)
}

impl Chosen {
    /// The site's keys that hold for every law, the law's own, and those of the other laws.
    fn keys(&self) -> Vec<Key> {
        let mut all = keys::of(self.site.section());
        all.extend(law_keys(self.site, &self.specs, &self.options));
        all.extend(self.foreign.iter().cloned());
        all
    }

    /// The keys of priors: parameters, other laws' too so that they can be refused by name.
    pub fn prior_keys(&self) -> Vec<Key> {
        self.keys().into_iter().filter(|k| matches!(k.kind, Kind::Parameter { .. })).collect()
    }

    /// Reports every key of the section that only other laws have.
    pub fn refuse_foreign(&self, section: &Section<'_>) {
        if !self.known {
            return;
        }
        for (key, entry) in section.all().filter(|(k, _)| k.section == FOREIGN) {
            let message = format!("law `{}` has no `{}`", self.law, key.name);
            let owners = self.owners.get(key.name.as_ref()).map(Vec::as_slice).unwrap_or_default();
            let own = law_keys(self.site, &self.specs, &self.options);
            let own = keys::list(own.iter().map(|k| format!("`{}`", k.spelling())), "and");
            let help = if owners.contains(&self.law) {
                format!("it has under other settings; as it stands it takes {own}")
            } else {
                let all = keys::list(owners.iter().map(|o| format!("`{o}`")), "and");
                let take = if owners.len() > 1 { "take" } else { "takes" };
                format!("{all} {take} it; `{}` takes {own}", self.law)
            };
            section
                .context
                .report(Report::error(message).key(entry.written).help(help), entry.key_span.clone());
        }
    }

    /// The parameter that a key gives as its reciprocal.
    pub fn reciprocal(&self, key: &Key) -> Option<(&ParamSpec, Reciprocal)> {
        let own = self.specs.iter().filter(|_| key.section == self.site.section());
        own.filter_map(|s| Some((s, s.reciprocal?))).find(|(_, r)| r.name == key.name)
    }

    fn section<'a>(&self, top: &Section<'a>) -> Section<'a> {
        let section = subsection_of(top, self.site.section(), self.keys());
        self.refuse_foreign(&section);
        section
    }

    /// What the file says about the parameters from the one with index `first` on.
    fn parameters(&self, s: &Section<'_>, first: usize) -> BTreeMap<String, Value> {
        let own = self.specs.iter().skip(first).filter(|p| !p.internal);
        let read = own.filter_map(|spec| {
            let value = parameter(s, spec);
            (value != Value::default()).then(|| (spec.name.to_string(), value))
        });
        read.collect()
    }

    fn settings(&self, s: &Section<'_>, tests: &[Test]) -> BTreeMap<String, OptionValue> {
        self.options.iter().filter_map(|o| Some((o.name.clone(), option(s, o, tests)?))).collect()
    }
}

/// One parameter, under its own name or as its reciprocal.
fn parameter(s: &Section<'_>, spec: &ParamSpec) -> Value {
    let Some(other) = spec.reciprocal else { return s.parameter(&spec.name) };
    match (s.entry(other.name), s.entry(&spec.name)) {
        (Some(k), Some(d)) => {
            let (numerator, symbol) = (keys::plain(other.numerator), &spec.symbol);
            let message = format!(
                "`{}` and `{}` mean the same ({symbol} = {numerator}/{}); expected one of them",
                k.written, d.written, other.name
            );
            s.fault(&spec.name, message);
            Value::default()
        }
        (None, Some(_)) => s.parameter(&spec.name),
        _ => {
            // The bounds change places, and a bound of 0 is none.
            let k = s.parameter(other.name);
            let of = |x: Option<f64>| x.map(|x| other.of(x)).filter(|x| x.is_finite());
            Value { value: of(k.value), min: of(k.max), max: of(k.min), fixed: k.fixed }
        }
    }
}

/// `[bulk]`
pub(crate) fn bulk(top: &Section<'_>, law: &Chosen, tests: &[Test]) -> BulkConfig {
    let s = law.section(top);
    BulkConfig {
        law: law.law.clone(),
        options: law.settings(&s, tests),
        parameters: law.parameters(&s, 0),
        specs: law.specs.clone(),
    }
}

/// Parameters of an interface law that have a value per area: Gc, σc.
pub(crate) const PER_AREA: usize = 2;

/// `[interface]`
pub(crate) fn interface(top: &Section<'_>, law: &Chosen, tests: &[Test]) -> InterfaceConfig {
    let s = law.section(top);
    let areas = s.checked_integer("areas");
    let per_area = |at: usize| match law.specs.get(at) {
        Some(spec) => s.parameter_list(&spec.name, areas),
        None => vec![Value::default()],
    };
    InterfaceConfig {
        law: law.law.clone(),
        options: law.settings(&s, tests),
        areas: areas.unwrap_or(1),
        profile: [Profile::Piecewise, Profile::Smooth][s.choice("profile")],
        gc: per_area(0),
        sigma_c: per_area(1),
        parameters: law.parameters(&s, PER_AREA),
        specs: law.specs.clone(),
    }
}

/// The tables of a table, by name.
pub(crate) fn law_tables<'a>(
    s: &Section<'a>,
    site: LawSite,
) -> Option<(std::ops::Range<usize>, &'a DeTable<'a>)> {
    let entry = s.entry(site.section())?;
    Some((entry.key_span.clone(), super::effects::as_table(s, site.section(), entry.item)?))
}
