//! `[[tests]]`

use super::axes;
use super::noise::check_noise;
use super::scalar;
use super::section::{Context, Section};
use super::specimen::{checked_name, linked, resolve};
use crate::case::{Ends, Geometry, Grips, Leg, Record, Test, Weight};
use crate::csv;
use crate::diagnostics::Report;
use crate::experiment::TestKind;
use crate::keys::{self, plain};
use std::ops::Range;
use toml::de::DeValue;

/// Least way of a ramp, mm.
const LEAST_WAY: f64 = 1e-6;
/// Most legs of one protocol.
const MOST_LEGS: usize = 20_000;
/// Most stretches of one record with a weight.
const MOST_WEIGHTS: usize = 1000;
/// Fewest points of a record that must count.
const LEAST_POINTS: usize = 4;
/// Most tests of one piece.
const MOST: usize = 1000;

/// All tests, in order, with unique names.
pub(crate) fn tests(top: &Section<'_>, geometry: &Geometry) -> Vec<Test> {
    let context = top.context;
    let Some(entry) = top.entry("tests") else { return Vec::new() };
    let Some(items) = scalar::list(context, "tests", entry.item, "[[tests]], one table per test") else {
        return Vec::new();
    };
    if items.is_empty() || items.len() > MOST {
        let message = format!("`tests` lists {}; expected 1 to {MOST} tests", items.len());
        context.report(Report::error(message).key("tests"), entry.key_span.clone());
        return Vec::new();
    }
    let mut out = Vec::new();
    let mut named: Vec<(Option<String>, Range<usize>)> = Vec::new();
    for (i, item) in items.iter().enumerate() {
        let title = format!("[[tests]] {}", i + 1);
        let DeValue::Table(table) = item.get_ref() else {
            scalar::wrong_type(context, &title, item, "a table");
            continue;
        };
        let section = Section::open(context, title, item.span(), table, keys::of("tests"));
        named.push((checked_name(&section), section.span_of("name")));
        out.extend(test(&section, geometry));
    }
    name_all(context, &mut out, &named);
    out
}

fn test(s: &Section<'_>, geometry: &Geometry) -> Option<Test> {
    let kind = kind(s)?;
    let record = record(s);
    let test = Test {
        name: String::new(),
        kind,
        ratio_x: axes::ratio(s, kind, record.as_ref()),
        force_x_sd: s.optional_number("force_x_sd"),
        ends: offered(s, "ends", kind, &[Ends::Clamped, Ends::Sliding], kind.ends),
        grips: offered(s, "grips", kind, &[Grips::Ends, Grips::Mouth], kind.grips),
        record,
        protocol: protocol(s),
        rest_s: s.optional_number("rest"),
        remount: s.flag("remount"),
        fresh_piece: s.flag("fresh_piece"),
        force_sd: s.optional_number("force_sd"),
        grip_displacement_sd: s.optional_number("grip_displacement_sd"),
        tear_front_sd: s.optional_number("tear_front_sd"),
        width_change_sd: s.optional_number("width_change_sd"),
        tear_front_opening: s.optional_number("tear_front_opening"),
        weights: weights(s),
    };
    if s.entry("data").is_none() && s.entry("protocol").is_none() {
        let report =
            Report::error(format!("{} has neither `data` nor `protocol`; expected one of them", s.title));
        let help =
            "`data = \"record.csv\"`, or `protocol = [{ to_mm = 2.0, rate_mm_per_s = 0.05 }]` to simulate";
        s.context.report(report.help(help), s.span.clone());
    }
    if s.entry("data").is_some() && s.entry("protocol").is_some() {
        let report = Report::warning(format!("{} has `data` and `protocol`; the record is used", s.title));
        s.context.report(report.key("protocol"), s.span_of("protocol"));
    }
    if let Some(record) = &test.record {
        check_channels(s, &test, record, geometry);
        check_noise(s, &test, record);
        check_weights(s, &test, record);
    }
    Some(test)
}

/// The experiment; after a fault the first, so that the rest of the test is checked too.
fn kind(s: &Section<'_>) -> Option<TestKind> {
    let kinds = s.context.kinds;
    let words: Vec<String> = kinds.iter().map(|k| k.word().to_owned()).collect();
    let found = match s.entry("kind") {
        Some(e) => scalar::choice(s.context, e.written, e.item, &words).unwrap_or(0),
        None => {
            s.missing("kind");
            0
        }
    };
    kinds.get(found).copied()
}

/// One of a key's values, `all` in the order of its words, if the experiment offers it; its own default without the key.
fn offered<T: Copy + PartialEq + Default>(
    s: &Section<'_>,
    key: &str,
    kind: TestKind,
    all: &[T],
    offers: &[T],
) -> T {
    let default = offers.first().copied().unwrap_or_default();
    let Some(entry) = s.entry(key) else { return default };
    let given = all.get(s.choice(key)).copied().unwrap_or_default();
    if offers.contains(&given) {
        return given;
    }
    let report = Report::error(format!("`{key}`: a `{}` test is held in one way only", kind.word()));
    s.context.report(report.key(key).help("leave the key out"), entry.item.span());
    default
}

fn record(s: &Section<'_>) -> Option<Record> {
    let given = s.text("data")?;
    match csv::read_record(&resolve(s.context, given), s.context.sink) {
        Ok(record) => record,
        Err(diagnostic) => {
            linked(s, "data", *diagnostic);
            None
        }
    }
}

/// Channels that this kind of test cannot use, and displacements that look like another unit.
fn check_channels(s: &Section<'_>, test: &Test, record: &Record, geometry: &Geometry) {
    let warn = |message: String| {
        let span = s.entry("data").map_or(s.span.clone(), |e| e.item.span());
        s.context.report(Report::warning(message).key("data"), span);
    };
    let word = test.kind.word();
    let unused = |channel: &str, given: bool| given && !test.kind.measures(channel);
    if unused("width_change", record.width_change.is_some()) {
        warn(format!("column `width_change_mm` of a {word} test is not used: it is for uniaxial tests"));
    }
    if unused("tear_front", record.tear_front.is_some()) {
        let why = if test.kind.tears { "it is not measured there" } else { "nothing tears" };
        warn(format!("column `tear_front_mm` of a {word} test is not used: {why}"));
    }
    if unused("grip_displacement", record.grip_displacement.is_some()) {
        warn(format!("column `grip_displacement_mm` of a {word} test is not used: it is not measured there"));
    }
    let travel = record.displacement.iter().fold(0.0_f64, |m, u| m.max(u.abs()));
    if test.kind.whole_section && test.grips == Grips::Ends && travel > 20.0 * geometry.length {
        let (travel, length) = (plain(travel), plain(geometry.length));
        warn(format!("the record moves {travel} mm on a length of {length} mm; are the units right?"));
    }
}

fn protocol(s: &Section<'_>) -> Option<Vec<Leg>> {
    let entry = s.entry("protocol")?;
    let expected = "a list of { to_mm, rate_mm_per_s } and { hold_s }";
    let items = scalar::list(s.context, "protocol", entry.item, expected)?;
    if items.is_empty() {
        s.fault("protocol", format!("`protocol` is empty; expected {expected}"));
        return None;
    }
    if items.len() > MOST_LEGS {
        s.fault("protocol", format!("`protocol` has {} legs; expected at most {MOST_LEGS}", items.len()));
        return None;
    }
    let (mut legs, mut at) = (Vec::new(), Some(0.0));
    for (i, item) in items.iter().enumerate() {
        let title = format!("protocol leg {}", i + 1);
        let DeValue::Table(table) = item.get_ref() else {
            scalar::wrong_type(s.context, &title, item, "{ to_mm, rate_mm_per_s } or { hold_s }");
            continue;
        };
        let section = Section::open(s.context, title, item.span(), table, keys::of("tests.protocol"));
        legs.extend(leg(&section, &mut at));
    }
    (legs.len() == items.len()).then_some(legs)
}

/// Stretches of the record with a weight.
fn weights(s: &Section<'_>) -> Vec<Weight> {
    let expected = "a list of { from_s, to_s, weight }";
    let Some(entry) = s.entry("weights") else { return Vec::new() };
    let Some(items) = scalar::list(s.context, "weights", entry.item, expected) else { return Vec::new() };
    if items.len() > MOST_WEIGHTS {
        s.fault("weights", format!("`weights` has {}; expected at most {MOST_WEIGHTS}", items.len()));
        return Vec::new();
    }
    let mut out = Vec::new();
    for (i, item) in items.iter().enumerate() {
        let title = format!("weight {}", i + 1);
        let DeValue::Table(table) = item.get_ref() else {
            scalar::wrong_type(s.context, &title, item, "{ from_s, to_s, weight }");
            continue;
        };
        let section = Section::open(s.context, title, item.span(), table, keys::of("tests.weights"));
        let one = Weight {
            from_s: section.number("from"),
            to_s: section.number("to"),
            weight: section.number("weight"),
        };
        if one.from_s > one.to_s {
            let message = format!("`to_s` is {}; expected {} or later", plain(one.to_s), plain(one.from_s));
            s.context.report(Report::error(message).key("to_s"), item.span());
        }
        out.push(one);
    }
    out
}

/// A stretch beside the record, and a record of which nothing is left.
fn check_weights(s: &Section<'_>, test: &Test, record: &Record) {
    let Some(entry) = s.entry("weights") else { return };
    let used = record.time.iter().filter(|t| test.weight_at(**t) > 0.0).count();
    if used < LEAST_POINTS.min(record.len()) {
        let message =
            format!("`weights` leave {used} of {} rows; expected at least {LEAST_POINTS}", record.len());
        s.context.report(Report::error(message).key("weights"), entry.item.span());
    }
    for w in &test.weights {
        if !record.time.iter().any(|t| (w.from_s..=w.to_s).contains(t)) {
            let end = record.time.last().copied().unwrap_or_default();
            let message = format!(
                "no row of the record lies from {} s to {} s; it ends at {} s",
                plain(w.from_s),
                plain(w.to_s),
                plain(end)
            );
            s.context.report(Report::warning(message).key("weights"), entry.item.span());
        }
    }
}

/// One leg; `at` is where the actuator stands, if that is known.
fn leg(s: &Section<'_>, at: &mut Option<f64>) -> Option<Leg> {
    let given = ["to", "rate", "hold"].map(|name| s.entry(name).is_some());
    let fault = |message: String| {
        s.context.report(Report::error(message), s.span.clone());
        None
    };
    match given {
        [true, true, false] => {
            let (to, rate) = (s.optional_number("to"), s.optional_number("rate"));
            let from = std::mem::replace(at, to);
            if let (Some(from), Some(to)) = (from, to)
                && (to - from).abs() < LEAST_WAY
            {
                let end = if from == to { "ends where it begins" } else { "ends next to where it begins" };
                return fault(format!(
                    "{} {end}, at {} mm; expected some travel, or a hold",
                    s.title,
                    plain(to)
                ));
            }
            Some(Leg::Ramp { to_mm: to?, rate_mm_per_s: rate? })
        }
        [false, false, true] => Some(Leg::Hold { hold_s: s.optional_number("hold")? }),
        _ if s.has_unknown() => None,
        _ => fault(format!("{} must have `to_mm` and `rate_mm_per_s`, or `hold_s` alone", s.title)),
    }
}

/// Gives every test its name: its own, or its kind, repeats numbered. Equal names are errors.
fn name_all(context: Context<'_>, tests: &mut [Test], named: &[(Option<String>, Range<usize>)]) {
    for (i, (name, span)) in named.iter().enumerate() {
        let Some(name) = name else { continue };
        if let Some(first) = named[..i].iter().find(|n| n.0.as_ref() == Some(name)) {
            let line = context.file.line_column(first.1.start).0;
            let message = format!("two tests are named \"{name}\": the other stands in line {line}");
            context.report(Report::error(message).key("name"), span.clone());
        }
        tests[i].name.clone_from(name);
    }
    let mut taken: Vec<String> = named.iter().filter_map(|n| n.0.clone()).collect();
    for test in tests.iter_mut().filter(|t| t.name.is_empty()) {
        let word = test.kind.word();
        let numbered = std::iter::once(word.to_owned()).chain((2..).map(|n| format!("{word}-{n}")));
        test.name = numbered.into_iter().find(|n| !taken.contains(n)).unwrap_or_default();
        taken.push(test.name.clone());
    }
}
