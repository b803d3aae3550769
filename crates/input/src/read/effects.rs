//! `[effects.NAME]`, by the catalogue.

use super::parameter::key_of;
use super::scalar;
use super::section::Section;
use crate::case::{Location, Test};
use crate::config::{BulkConfig, EffectConfig, InterfaceConfig, OptionValue};
use crate::diagnostics::Report;
use crate::keys::{Fallback, Key, Kind, Limits, closest};
use crate::registry::{EffectRegistry, OptionKind, OptionSpec};
use crate::text::short;
use params::Quantity;
use std::borrow::Cow;
use std::collections::BTreeMap;
use toml::de::{DeTable, DeValue};

/// All effects of the file, in its order.
pub(crate) fn effects(
    top: &Section<'_>,
    registry: &dyn EffectRegistry,
    tests: &[Test],
    (bulk, interface): (&BulkConfig, &InterfaceConfig),
) -> Vec<EffectConfig> {
    let context = top.context;
    let Some(entry) = top.entry("effects") else { return Vec::new() };
    let DeValue::Table(table) = entry.item.get_ref() else {
        scalar::wrong_type(context, "effects", entry.item, "tables [effects.NAME]");
        return Vec::new();
    };
    let mut out: Vec<EffectConfig> = Vec::new();
    for (key, item) in table {
        let name = key.get_ref().as_ref();
        let settings = match item.get_ref() {
            DeValue::Table(table) => whole_numbers(&registry.options(name), table),
            _ => BTreeMap::new(),
        };
        let Some(specs) = registry.parameters_with(name, &settings) else {
            context.report(unknown(registry, name), key.span());
            continue;
        };
        let title = format!("[effects.{name}]");
        let DeValue::Table(table) = item.get_ref() else {
            scalar::wrong_type(context, name, item, &format!("the table {title}"));
            continue;
        };
        let (line, column) = context.file.line_column(key.span().start);
        let location = Location { file: context.file.path.clone(), line, column };
        let options = registry.options(name);
        let mut keys: Vec<Key> = specs.iter().map(|s| key_of(format!("effects.{name}"), s)).collect();
        keys.extend(options.iter().map(|o| option_key(format!("effects.{name}").into(), o)));
        let section = Section::open(context, title, key.span(), table, keys);
        exclusions(&section, registry, name, &out);
        let given = |spec: &params::ParamSpec| section.entry(&spec.name).is_some();
        let parameters = specs.iter().filter(|s| given(s));
        let effect = EffectConfig {
            name: name.to_owned(),
            parameters: parameters.map(|s| (s.name.to_string(), section.parameter(&s.name))).collect(),
            specs: specs.clone(),
            options: options
                .iter()
                .filter_map(|o| Some((o.name.clone(), option(&section, o, tests)?)))
                .collect(),
            location,
        };
        if let Some(lacking) = registry.lacks(&effect, bulk, interface) {
            let message = format!("effect `{name}` cannot act on this model: {lacking}");
            let report = Report::error(message).key(format!("effects.{name}"));
            context.report(report.help("take the effect out, or choose another law"), key.span());
        }
        out.push(effect);
    }
    out
}

/// The whole-number options as they stand in the file, unchecked: they may say which parameters there are. What is
/// wrong with them is reported when they are read.
pub(crate) fn whole_numbers(options: &[OptionSpec], table: &DeTable<'_>) -> BTreeMap<String, OptionValue> {
    let given = options.iter().filter_map(|o| {
        let OptionKind::Integer { min, max } = o.kind else { return None };
        let DeValue::Integer(i) = table.get(o.name.as_str())?.get_ref() else { return None };
        let value = i64::from_str_radix(i.as_str(), i.radix()).ok()?;
        Some((o.name.clone(), OptionValue::Integer(value.clamp(min, max))))
    });
    given.collect()
}

fn unknown(registry: &dyn EffectRegistry, name: &str) -> Report {
    let names = registry.names();
    let report = match closest(name, names.iter().copied()) {
        Some(meant) => Report::error(format!("unknown effect `{}`; did you mean `{meant}`?", short(name))),
        None => Report::error(format!("unknown effect `{}`", short(name))),
    };
    report.key(format!("effects.{}", short(name))).help("`fct effects` lists the catalogue")
}

fn exclusions(section: &Section<'_>, registry: &dyn EffectRegistry, name: &str, before: &[EffectConfig]) {
    for other in before {
        if registry.excludes(name).contains(&other.name)
            || registry.excludes(&other.name).iter().any(|e| e == name)
        {
            let (other, line) = (&other.name, other.location.line);
            let message = format!(
                "effect `{name}` cannot be used together with `{other}` of line {line}; take one of them out"
            );
            section
                .context
                .report(Report::error(message).key(format!("effects.{name}")), section.span.clone());
        }
    }
}

/// The key of an option in the file.
pub(crate) fn option_key(section: Cow<'static, str>, option: &OptionSpec) -> Key {
    let kind = match &option.kind {
        OptionKind::Bool => Kind::Bool,
        OptionKind::Integer { min, max } => Kind::Integer { min: *min, max: *max },
        OptionKind::Number { min, max } => {
            Kind::Number { quantity: Quantity::Dimensionless, limits: Limits::within(*min, *max) }
        }
        OptionKind::Choice(words) => Kind::Choice { words: words.clone() },
        OptionKind::Test | OptionKind::TestKind | OptionKind::Text => Kind::Text,
    };
    let default = match &option.default {
        None => Fallback::Absent("none".into()),
        Some(OptionValue::Bool(b)) => Fallback::Bool(*b),
        Some(OptionValue::Integer(i)) => Fallback::Integer(*i),
        Some(OptionValue::Number(x)) => Fallback::Number(*x),
        Some(OptionValue::Text(t)) => Fallback::Word(t.clone().into()),
    };
    Key {
        section,
        name: option.name.clone().into(),
        kind,
        default,
        description: option.description.clone().into(),
    }
}

pub(crate) fn option(s: &Section<'_>, option: &OptionSpec, tests: &[Test]) -> Option<OptionValue> {
    let name = option.name.as_str();
    let Some(entry) = s.entry(name) else { return option.default.clone() };
    let (context, item) = (s.context, entry.item);
    match &option.kind {
        OptionKind::Bool => scalar::flag(context, name, item).map(OptionValue::Bool),
        OptionKind::Integer { min, max } => {
            scalar::integer(context, name, item, *min, *max).map(OptionValue::Integer)
        }
        OptionKind::Number { .. } => s.optional_number(name).map(OptionValue::Number),
        OptionKind::Choice(words) => {
            scalar::choice(context, name, item, words).map(|i| OptionValue::Text(words[i].clone()))
        }
        OptionKind::TestKind => {
            let words: Vec<String> = context.kinds.iter().map(|k| k.word().to_owned()).collect();
            scalar::choice(context, name, item, &words).map(|i| OptionValue::Text(words[i].clone()))
        }
        OptionKind::Text => s.text(name).map(|t| OptionValue::Text(t.to_owned())),
        OptionKind::Test => {
            let given = s.text(name)?;
            test_exists(s, name, given, tests, item.span());
            Some(OptionValue::Text(given.to_owned()))
        }
    }
}

/// Reports a test that the case does not have.
pub(crate) fn test_exists(
    s: &Section<'_>,
    key: &str,
    given: &str,
    tests: &[Test],
    span: std::ops::Range<usize>,
) {
    // Without tests something else was wrong, and was said.
    if tests.is_empty() || tests.iter().any(|t| t.name == given) {
        return;
    }
    let names = || tests.iter().map(|t| t.name.as_str());
    let list = crate::keys::list(names().map(|n| format!("\"{}\"", short(n))), "or");
    let message = format!("`{key}` is \"{}\"; expected the name of a test: {list}", short(given));
    s.context.report(Report::error(message).key(key), span);
}

/// The tables of a table, by name; anything else is an error.
pub(crate) fn as_table<'a>(
    s: &Section<'a>,
    title: &str,
    item: &'a scalar::Item<'a>,
) -> Option<&'a DeTable<'a>> {
    if let DeValue::Table(table) = item.get_ref() {
        return Some(table);
    }
    scalar::wrong_type(s.context, title, item, "a table");
    None
}
