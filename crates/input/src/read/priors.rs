//! `identify.priors`: on, off, the literature's, or priors of one's own, keyed like the sections themselves.

use super::effects::as_table;
use super::laws::{Chosen, law_tables};
use super::parameter::key_of;
use super::scalar::{self, Item};
use super::section::{Context, Entry, Section};
use crate::config::{Prior, PriorsConfig};
use crate::diagnostics::Report;
use crate::keys::{self, Fallback, Key, Kind, Limits};
use crate::registry::{EffectRegistry, LawSite};
use crate::text::short;
use params::Quantity;
use toml::de::{DeTable, DeValue};

/// `identify.priors`
pub(crate) fn priors(
    identify: &Section<'_>,
    registry: &dyn EffectRegistry,
    laws: &[Chosen; 2],
) -> PriorsConfig {
    let mut out = PriorsConfig::default();
    let all = (registry, laws);
    if let Some(entry) = identify.entry("prior") {
        match entry.item.get_ref() {
            DeValue::Table(table) => own(identify, (entry, "prior"), table, all, &mut out),
            _ => scalar::wrong_type(identify.context, "prior", entry.item, "a table"),
        }
    }
    let Some(entry) = identify.entry("priors") else { return out };
    match entry.item.get_ref() {
        DeValue::Boolean(b) => out.literature = Some(*b),
        DeValue::String(s) if s == "literature" => out.literature = Some(true),
        DeValue::String(s) if s == "off" => out.literature = Some(false),
        DeValue::Table(table) => own(identify, (entry, "priors"), table, all, &mut out),
        _ => scalar::wrong_type(
            identify.context,
            "priors",
            entry.item,
            "true, false, \"literature\" or a table",
        ),
    }
    out
}

fn own<'a>(
    identify: &Section<'a>,
    (entry, named): (&Entry<'a>, &str),
    table: &'a DeTable<'a>,
    (registry, laws): (&dyn EffectRegistry, &[Chosen; 2]),
    out: &mut PriorsConfig,
) {
    let group = |name: &'static str, kind| Key {
        section: "identify.priors".into(),
        name: name.into(),
        kind,
        default: Fallback::Absent("".into()),
        description: "".into(),
    };
    let with_literature = named == "priors";
    let mut groups = ["bulk", "interface", "effects"].map(|name| group(name, Kind::Table)).to_vec();
    if with_literature {
        groups.push(group("literature", Kind::Bool));
    }
    let context = identify.context;
    let s = Section::open(context, format!("[identify.{named}]"), entry.key_span.clone(), table, groups);
    if with_literature {
        out.literature = Some(s.flag("literature"));
    }
    for (site, law) in LawSite::ALL.into_iter().zip(laws) {
        let Some((span, table)) = law_tables(&s, site) else { continue };
        let title = format!("[identify.{named}.{}]", site.section());
        let part = Section::open(context, title, span, table, law.prior_keys());
        law.refuse_foreign(&part);
        collect(&part, site.section(), law, out);
    }
    let effects = s.entry("effects").and_then(|e| as_table(&s, "effects", e.item));
    for (key, item) in effects.into_iter().flatten() {
        let name = key.get_ref().as_ref();
        let Some(specs) = registry.parameters(name) else {
            context.report(
                Report::error(format!("unknown effect `{}` in [identify.{named}]", short(name))),
                key.span(),
            );
            continue;
        };
        let keys = specs.iter().map(|s| key_of(format!("effects.{name}"), s)).collect();
        if let Some(table) = as_table(&s, name, item) {
            let title = format!("[identify.{named}.effects.{name}]");
            let part = Section::open(context, title, key.span(), table, keys);
            collect(&part, &format!("effects.{name}"), &laws[0], out);
        }
    }
}

/// Every prior of a section, under its parameter path.
fn collect(s: &Section<'_>, prefix: &str, law: &Chosen, out: &mut PriorsConfig) {
    for (key, entry) in s.all().filter(|(k, _)| k.section != keys::FOREIGN) {
        let Some(prior) = prior(s.context, entry.written, entry.item, entry.factor, key) else { continue };
        let (path, prior) = match law.reciprocal(key) {
            Some((spec, r)) => (
                format!("{prefix}.{}", spec.name),
                Prior { mean: r.of(prior.mean), quantity: spec.quantity, ..prior },
            ),
            None => (format!("{prefix}.{}", key.name), prior),
        };
        if out.given.insert(path.clone(), prior).is_some() {
            s.context.report(Report::error(format!("`{path}` has two priors")), entry.key_span.clone());
        }
    }
}

/// `{ value, factor }` or `{ mean, relative_sd }`: `factor` is that of one standard deviation either way, in the logarithm.
fn prior(context: Context<'_>, written: &str, item: &Item<'_>, factor: f64, key: &Key) -> Option<Prior> {
    let DeValue::Table(table) = item.get_ref() else {
        scalar::wrong_type(context, written, item, "{ value, factor } or { mean, relative_sd }");
        return None;
    };
    let Kind::Parameter { limits, .. } = key.kind else { return None };
    let number = |name: &'static str, limits| Key {
        section: "prior".into(),
        name: name.into(),
        kind: Kind::Number { quantity: Quantity::Dimensionless, limits },
        default: Fallback::Required,
        description: "a number".into(),
    };
    let in_file = Limits { lower: limits.lower / factor, upper: limits.upper / factor, ..limits };
    let by_factor = table.keys().any(|k| ["value", "factor"].contains(&k.get_ref().as_ref()));
    let (middle, spread, widest) = if by_factor {
        ("value", "factor", Limits::within(1.001, 1e3))
    } else {
        ("mean", "relative_sd", Limits::positive(100.0))
    };
    let keys = vec![number(middle, in_file), number(spread, widest)];
    let s = Section::open(context, format!("prior `{}`", short(written)), item.span(), table, keys);
    let given = s.number(spread);
    // Of a log-normal distribution: sd of the logarithm = √ln(1 + relative_sd²).
    let relative_sd = if by_factor { given.ln().powi(2).exp_m1().sqrt() } else { given };
    let prior = Prior { mean: s.number(middle) * factor, relative_sd, quantity: key.quantity() };
    if prior.mean == 0.0 {
        s.fault(
            middle,
            format!(
                "`{middle}` is 0; expected another number, since {spread} is {}",
                if by_factor { "relative to it" } else { "a share of it" }
            ),
        );
    }
    (prior.mean.is_finite() && prior.relative_sd.is_finite()).then_some(prior)
}
