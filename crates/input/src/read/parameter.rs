//! A parameter: a number, or `{ start, min, max, fixed }`; per area, a list of these.

use super::scalar::{self, Item};
use super::section::{Context, Entry, Section};
use crate::config::Value;
use crate::diagnostics::Report;
use crate::keys::{Fallback, Key, Kind, Limits, Match, Speller};
use crate::text::short;
use params::Quantity;
use toml::de::DeValue;

/// What one entry must satisfy.
struct Rule<'r> {
    written: &'r str,
    factor: f64,
    limits: Limits,
}

impl<'a> Section<'a> {
    /// A parameter; its defaults applied.
    pub fn parameter(&self, name: &str) -> Value {
        let key = self.key(name);
        let given = self.entry(name).map(|e| self.one(key, e, e.item));
        with_defaults(key, given.unwrap_or_default())
    }

    /// A parameter with one value, or one per area; `areas` is `None` if their number is itself at fault.
    pub fn parameter_list(&self, name: &str, areas: Option<usize>) -> Vec<Value> {
        let key = self.key(name);
        let Some(entry) = self.entry(name) else { return vec![Value::default()] };
        let DeValue::Array(items) = entry.item.get_ref() else {
            return vec![self.one(key, entry, entry.item)];
        };
        if items.is_empty() || (items.len() != 1 && areas.is_some_and(|m| m != items.len())) {
            self.wrong_count(entry, items.len(), areas.unwrap_or(1));
        }
        items.iter().map(|item| self.one(key, entry, item)).collect()
    }

    fn wrong_count(&self, entry: &Entry<'a>, found: usize, areas: usize) {
        let expected = if areas == 1 { "one value".to_owned() } else { format!("one value, or {areas}") };
        let message =
            format!("`{}` lists {found} values, but areas = {areas}; expected {expected}", entry.written);
        let mut report = Report::error(message).key(entry.written);
        if found > 0 {
            report = report.help(format!("set `areas = {found}` in [interface], or change the list"));
        }
        self.context.report(report, entry.item.span());
    }

    fn one(&self, key: &Key, entry: &Entry<'a>, item: &'a Item<'a>) -> Value {
        let Kind::Parameter { limits, .. } = key.kind else { return Value::default() };
        let rule = Rule { written: entry.written, factor: entry.factor, limits };
        value(self.context, &rule, item)
    }
}

fn with_defaults(key: &Key, mut value: Value) -> Value {
    if let (None, Fallback::Number(x)) = (value.value, &key.default) {
        let inside = value.min.is_none_or(|m| m <= *x) && value.max.is_none_or(|m| *x <= m);
        value.value = inside.then_some(*x);
    }
    if let Kind::Parameter { fixed: Some(fixed), .. } = key.kind {
        value.fixed = value.fixed.or(Some(fixed));
    }
    value
}

/// The keys of a parameter's table.
fn keys() -> Vec<Key> {
    let bare = |name: &'static str| Key {
        section: "parameter".into(),
        name: name.into(),
        kind: Kind::Text,
        default: Fallback::Absent("".into()),
        description: "".into(),
    };
    ["start", "value", "min", "max", "fixed"].map(bare).to_vec()
}

fn value(context: Context<'_>, rule: &Rule<'_>, item: &Item<'_>) -> Value {
    let DeValue::Table(table) = item.get_ref() else {
        if matches!(item.get_ref(), DeValue::Integer(_) | DeValue::Float(_)) {
            let x = scalar::quantity(context, rule.written, item, rule.factor, &rule.limits);
            return Value { value: x, ..Value::default() };
        }
        let expected = format!("{}, or {{ start, min, max, fixed }}", rule.limits.words(rule.factor));
        scalar::wrong_type(context, rule.written, item, &expected);
        return Value::default();
    };
    let title = format!("`{}`", short(rule.written));
    let (keys, mut out) = (keys(), Value::default());
    let speller = Speller::new(&title, &keys);
    // Beyond a bound there must be something left.
    let least = Limits { above: false, below: true, ..rule.limits };
    let most = Limits { above: true, below: false, ..rule.limits };
    for (key, item) in table {
        let written = key.get_ref().as_ref();
        let number = |limits: &Limits| {
            scalar::quantity(context, &format!("{}.{written}", rule.written), item, rule.factor, limits)
        };
        match speller.find(written) {
            Match::Unknown(unknown) => scalar::clash(context, written, key.span(), unknown.message),
            Match::Known(0 | 1, _) if out.value.is_some() => {
                let message = format!("{title} has both `start` and `value`: they mean the same");
                scalar::clash(context, written, key.span(), message);
            }
            Match::Known(0 | 1, _) => out.value = number(&rule.limits),
            // A least value of 0 is none to a value that is positive.
            Match::Known(2, _) if rule.limits.lower >= 0.0 && scalar::as_number(item) == Some(0.0) => {
                out.min = Some(0.0);
            }
            Match::Known(2, _) => out.min = number(&least),
            Match::Known(3, _) => out.max = number(&most),
            Match::Known(..) => out.fixed = scalar::flag(context, written, item),
        }
    }
    check_order(context, rule, item, &out);
    out
}

/// min < max, and the start between them.
fn check_order(context: Context<'_>, rule: &Rule<'_>, item: &Item<'_>, v: &Value) {
    let show = |x: f64| scalar::shown(x, rule.factor);
    let fault = |message| scalar::clash(context, rule.written, item.span(), message);
    let written = rule.written;
    if let (Some(min), Some(max)) = (v.min, v.max)
        && min >= max
    {
        fault(format!("`{written}` has min = {} and max = {}; expected min < max", show(min), show(max)));
        return;
    }
    if let (Some(x), Some(min)) = (v.value, v.min)
        && x < min
    {
        fault(format!("`{written}` starts at {}, below its min = {}", show(x), show(min)));
    }
    if let (Some(x), Some(max)) = (v.value, v.max)
        && x > max
    {
        fault(format!("`{written}` starts at {}, above its max = {}", show(x), show(max)));
    }
}

/// Limits of an effect's parameter, as its card says; the neutral value is always allowed.
pub(crate) fn limits_of(spec: &params::ParamSpec) -> Limits {
    let (lower, upper) = spec.admissible.unwrap_or((spec.lower, spec.upper));
    let neutral = spec.neutral.unwrap_or(lower);
    Limits::within(lower.min(neutral), upper.max(neutral))
}

/// A key of an effect's parameter.
pub(crate) fn key_of(section: String, spec: &params::ParamSpec) -> Key {
    let quantity: Quantity = spec.quantity;
    Key {
        section: section.into(),
        name: spec.name.clone(),
        kind: Kind::Parameter { quantity, limits: limits_of(spec), fixed: None, list: false },
        default: Fallback::Absent(
            format!("{} (start)", crate::keys::plain(spec.in_file_unit(spec.start))).into(),
        ),
        description: spec.description.clone(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use params::ParamSpec;

    /// A file may give what a search does not go to, where the effect says so.
    #[test]
    fn a_file_may_give_what_a_search_keeps_away_from() {
        let spec = ParamSpec::new("beta", "β", Quantity::Dimensionless, (0.02, 5.0), 0.2, "a share");
        let bounds = |spec: &ParamSpec| (limits_of(spec).lower, limits_of(spec).upper);
        assert_eq!(bounds(&spec), (0.02, 5.0));
        assert_eq!(bounds(&spec.clone().neutral(0.0)), (0.0, 5.0));
        assert_eq!(bounds(&spec.admissible(0.0, 9.0)), (0.0, 9.0));
    }
}
