//! Single values: type, range and what was found instead.

use super::section::Context;
use crate::diagnostics::Report;
use crate::keys::{Limits, closest, list as list_words, plain};
use crate::text::short;
use std::ops::Range;
use toml::Spanned;
use toml::de::DeValue;

/// A value with its place in the file.
pub(crate) type Item<'a> = Spanned<DeValue<'a>>;

/// What stands in the file, for a message.
pub(crate) fn describe(item: &Item<'_>) -> String {
    match item.get_ref() {
        DeValue::String(s) => format!("the text \"{}\"", short(s)),
        DeValue::Integer(i) => short(&i.to_string()),
        DeValue::Float(x) => short(x.as_str()),
        DeValue::Boolean(b) => format!("{b}"),
        DeValue::Datetime(_) => "a date or time".to_owned(),
        DeValue::Array(a) => format!("a list of {}", a.len()),
        DeValue::Table(_) => "a table".to_owned(),
    }
}

/// Reports a value of the wrong type.
pub(crate) fn wrong_type(context: Context<'_>, written: &str, item: &Item<'_>, expected: &str) {
    let message = format!("`{}` is {}; expected {expected}", short(written), describe(item));
    let report = Report::error(message).key(short(written));
    let help = match item.get_ref() {
        DeValue::String(s) if s.trim().parse::<f64>().is_ok() && expected.contains("number") => {
            Some("write the number without quotes")
        }
        _ => None,
    };
    let report = if let Some(help) = help { report.help(help) } else { report };
    context.report(report, item.span());
}

/// The number behind an integer or a float, if it is one; not necessarily finite.
pub(crate) fn as_number(item: &Item<'_>) -> Option<f64> {
    match item.get_ref() {
        DeValue::Integer(i) => {
            let digits = i.as_str();
            match i64::from_str_radix(digits, i.radix()) {
                Ok(n) => Some(n as f64),
                Err(_) if i.radix() == 10 => digits.parse().ok(),
                Err(_) => None,
            }
        }
        DeValue::Float(x) => x.as_str().parse().ok(),
        _ => None,
    }
}

/// A number converted to the internal unit and inside `limits`, else an error.
pub(crate) fn quantity(
    context: Context<'_>,
    written: &str,
    item: &Item<'_>,
    factor: f64,
    limits: &Limits,
) -> Option<f64> {
    let Some(x) = as_number(item) else {
        wrong_type(context, written, item, &limits.words(factor));
        return None;
    };
    match limits.admit(x * factor) {
        Some(x) if x.is_finite() => Some(x),
        _ => {
            out_of_range(context, written, item, &limits.words(factor));
            None
        }
    }
}

fn out_of_range(context: Context<'_>, written: &str, item: &Item<'_>, expected: &str) {
    let found = match as_number(item) {
        Some(x) if x.is_nan() => "not a number (nan)".to_owned(),
        Some(x) if x.is_infinite() => format!("{} (infinite)", describe(item)),
        _ => describe(item),
    };
    let message = format!("`{}` is {found}; expected {expected}", short(written));
    context.report(Report::error(message).key(short(written)), item.span());
}

/// A whole number between two limits, else an error.
pub(crate) fn integer(
    context: Context<'_>,
    written: &str,
    item: &Item<'_>,
    min: i64,
    max: i64,
) -> Option<i64> {
    let expected = match max {
        i64::MAX => format!("a whole number of at least {min}"),
        _ => format!("a whole number from {min} to {max}"),
    };
    let DeValue::Integer(i) = item.get_ref() else {
        wrong_type(context, written, item, &expected);
        return None;
    };
    let n = i64::from_str_radix(i.as_str(), i.radix()).ok().filter(|n| (min..=max).contains(n));
    if n.is_none() {
        out_of_range(context, written, item, &expected);
    }
    n
}

/// `true` or `false`, else an error.
pub(crate) fn flag(context: Context<'_>, written: &str, item: &Item<'_>) -> Option<bool> {
    if let DeValue::Boolean(b) = item.get_ref() {
        return Some(*b);
    }
    wrong_type(context, written, item, "true or false");
    None
}

/// Text, else an error.
pub(crate) fn text<'a>(context: Context<'_>, written: &str, item: &'a Item<'a>) -> Option<&'a str> {
    if let DeValue::String(s) = item.get_ref() {
        return Some(s);
    }
    wrong_type(context, written, item, "text in quotes");
    None
}

/// The index of one of the words, else an error.
pub(crate) fn choice(
    context: Context<'_>,
    written: &str,
    item: &Item<'_>,
    words: &[String],
) -> Option<usize> {
    let all = list_words(words.iter().map(|w| format!("\"{w}\"")), "or");
    let DeValue::String(s) = item.get_ref() else {
        wrong_type(context, written, item, &all);
        return None;
    };
    let found = words.iter().position(|w| w.as_str() == s.as_ref());
    if found.is_none() {
        let mut message = format!("`{}` is \"{}\"; expected {all}", short(written), short(s));
        if let Some(meant) = closest(s, words.iter().map(String::as_str)) {
            message.push_str(&format!("; did you mean \"{meant}\"?"));
        }
        context.report(Report::error(message).key(short(written)), item.span());
    }
    found
}

/// The number of a row of numbers, in internal units, else an error.
pub(crate) fn row_number(context: Context<'_>, written: &str, item: &Item<'_>, factor: f64) -> Option<f64> {
    quantity(context, written, item, factor, &Limits::within(-1e4, 1e4))
}

/// The elements of a list, else an error.
pub(crate) fn list<'a>(
    context: Context<'_>,
    written: &str,
    item: &'a Item<'a>,
    expected: &str,
) -> Option<&'a [Item<'a>]> {
    if let DeValue::Array(a) = item.get_ref() {
        return Some(a);
    }
    wrong_type(context, written, item, expected);
    None
}

/// An error about a value that is a number of the right kind but does not fit with another.
pub(crate) fn clash(context: Context<'_>, key: &str, span: Range<usize>, message: String) {
    context.report(Report::error(message).key(short(key)), span);
}

/// A number in words, in the unit of a key.
pub(crate) fn shown(x: f64, factor: f64) -> String {
    plain(x / factor)
}
