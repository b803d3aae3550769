//! From files to a [`Case`].

mod axes;
mod effects;
mod laws;
mod model;
mod noise;
mod parameter;
mod priors;
mod run;
mod scalar;
mod section;
mod specimen;
pub use specimen::name_fault;
mod tests;

pub(crate) use effects::option_key;
pub(crate) use laws::PER_AREA;
pub use laws::keys_of_law;
pub(crate) use parameter::key_of;

use crate::case::{Case, Geometry, Test};
use crate::diagnostics::{Diagnostic, Diagnostics, Report, Sink};
use crate::keys;
use crate::registry::{EffectRegistry, LawSite};
use crate::text::SourceFile;
use section::{Context, Section};
use std::path::{Path, PathBuf};
use toml::Spanned;
use toml::de::DeTable;

/// Largest TOML file, bytes.
pub const LARGEST_TOML: u64 = 10_000_000;
/// What a specimen file may hold when a config points to it.
const SPECIMEN_KEYS: [&str; 4] = ["name", "provenance", "geometry", "tests"];

/// Reads a specimen or a config with everything it points to.
///
/// # Errors
/// Everything that is wrong with the file, the specimen it points to and their CSV files, at once.
pub fn read_case(path: &Path, registry: &dyn EffectRegistry) -> Result<Case, Diagnostics> {
    read_case_as(path, Reading::default(), registry)
}

/// How a file is read that a study or a program puts together with others.
#[derive(Clone, Copy, Debug, Default)]
pub struct Reading<'a> {
    /// The specimen that the file, a config, is of; it then names none itself.
    pub specimen: Option<&'a Path>,
    /// Tables that stand behind the file's own text, as TOML.
    pub more: &'a str,
}

/// The same with a specimen of the caller's, and with tables added.
///
/// # Errors
/// As [`read_case`]; a file that names a specimen where one is given, tables that the file has already.
pub fn read_case_as(
    path: &Path,
    reading: Reading<'_>,
    registry: &dyn EffectRegistry,
) -> Result<Case, Diagnostics> {
    let sink = Sink::default();
    let case = read(path, reading, registry, &sink);
    let (failed, inputs) = (sink.has_errors(), sink.files());
    let found = sink.into_sorted();
    match case {
        Some(case) if !failed => Ok(Case { warnings: found, inputs, ..case }),
        _ => Err(Diagnostics(found)),
    }
}

fn read(path: &Path, reading: Reading<'_>, registry: &dyn EffectRegistry, sink: &Sink) -> Option<Case> {
    let mut file = load(path, "a specimen or config file (TOML)", sink)?;
    if !reading.more.is_empty() {
        let text = format!("{}\n{}", file.text, reading.more);
        let sha256 = file.sha256.take();
        file = SourceFile::new(path, text);
        file.sha256 = sha256;
    }
    let document = parse(&file, sink)?;
    let laws = every_law_key(registry);
    let kinds = registry.kinds();
    let context = Context { file: &file, sink, laws: &laws, kinds: &kinds };
    let top = Section::open(context, "the file", 0..0, document.get_ref(), keys::of(""));
    let measured = match (reading.specimen, top.entry("specimen")) {
        (Some(given), _) => pointed(&top, Some(given))?,
        (None, Some(_)) => pointed(&top, None)?,
        (None, None) => Some(inline(&top)),
    };
    let (given, specimen_file) = match measured {
        Some(measured) => (Some(measured.0), Some(measured.1)),
        None => (None, None),
    };
    // A specimen that could not be read leaves no tests; the rest of the config is checked all the same.
    let Measured { name, provenance, geometry, tests } = given.unwrap_or_default();
    let chosen = LawSite::ALL.map(|site| laws::chosen(&top, registry, site));
    let (bulk, interface) = (laws::bulk(&top, &chosen[0], &tests), laws::interface(&top, &chosen[1], &tests));
    let identify = specimen::subsection(&top, "identify");
    let priors = priors::priors(&identify, registry, &chosen);
    let is_config =
        reading.specimen.is_some() || top.entry("specimen").is_some() || keys_beyond_specimen(&top);
    let own_name = specimen::checked_name(&top);
    Some(Case {
        name: own_name.or(name).unwrap_or_else(|| stem(path)),
        provenance: top.text("provenance").map(str::to_owned).or(provenance).unwrap_or_default(),
        parent: top.text("parent").map(|given| {
            // Relative to the file, as every path in it.
            let place = crate::case::absolute(&specimen::resolve(context, given));
            place.to_string_lossy().into_owned()
        }),
        specimen_file: specimen_file.filter(|f| !is_config || f != path),
        config_file: is_config.then(|| path.to_owned()),
        mesh: model::mesh(&top, &geometry),
        effects: effects::effects(&top, registry, &tests, (&bulk, &interface)),
        bulk,
        interface,
        identify: run::identify(&identify, priors),
        diagnose: run::diagnose(&top),
        solver: run::solver(&top, &tests),
        output: run::output(&top),
        geometry,
        tests,
        warnings: Vec::new(),
        inputs: Vec::new(),
    })
}

/// Checks the `name` and the `[geometry]` of a file of which no more is asked; dimensions that it leaves out may be known
/// elsewhere.
///
/// # Errors
/// Everything that is wrong with them, at once; a file that cannot be read or has no `[geometry]`.
pub fn check_geometry(path: &Path) -> Result<(), Diagnostics> {
    let sink = Sink::default();
    given_geometry(path, &sink);
    if sink.has_errors() { Err(Diagnostics(sink.into_sorted())) } else { Ok(()) }
}

fn given_geometry(path: &Path, sink: &Sink) -> Option<()> {
    let file = load(path, "a TOML file with a [geometry] table", sink)?;
    let document = parse(&file, sink)?;
    let context = Context { file: &file, sink, laws: &[], kinds: &[] };
    let top = Section::open(context, "the file", 0..0, document.get_ref(), keys::of(""));
    if top.entry("geometry").is_none() {
        top.missing("geometry");
        return None;
    }
    specimen::checked_name(&top);
    let geometry = specimen::given_geometry(&top);
    specimen::check_fit(&top, &geometry, &[]);
    Some(())
}

/// The keys of every law, each with the section it stands in.
fn every_law_key(registry: &dyn EffectRegistry) -> Vec<keys::Key> {
    let of = |site: LawSite| {
        let names = registry.law_names(site);
        names.into_iter().flat_map(move |law| keys_of_law(registry, site, &law))
    };
    LawSite::ALL.into_iter().flat_map(of).collect()
}

fn keys_beyond_specimen(top: &Section<'_>) -> bool {
    top.all().any(|(k, _)| !SPECIMEN_KEYS.contains(&k.name.as_ref()))
}

/// What a specimen file holds.
#[derive(Default)]
struct Measured {
    name: Option<String>,
    provenance: Option<String>,
    geometry: Geometry,
    tests: Vec<Test>,
}

/// Geometry and tests that stand in the file itself.
fn inline(top: &Section<'_>) -> (Measured, PathBuf) {
    let path = top.context.file.path.clone();
    for (name, expected) in [
        ("geometry", "[geometry] with length_mm, width_mm and thickness_mm"),
        ("tests", "[[tests]] with kind and data or protocol"),
    ] {
        if top.entry(name).is_none() {
            let report = Report::error(format!("missing {expected}")).key(name);
            top.context.report_file(report.help("or `specimen = \"…\"`, the file that has them"));
        }
    }
    if top.entry("geometry").is_none() {
        // Without dimensions nothing further can be said about them; the tests can still be checked.
        let geometry = Geometry { length: f64::NAN, width: f64::NAN, ..Geometry::default() };
        let tests = tests::tests(top, &geometry);
        return (Measured { geometry, tests, ..Measured::default() }, path);
    }
    let geometry = specimen::geometry(top);
    let tests = tests::tests(top, &geometry);
    specimen::check_fit(top, &geometry, &tests);
    (Measured { name: None, provenance: None, geometry, tests }, path)
}

/// Geometry and tests of the specimen file that a config points to, or that it is `given`. The outer `None`: not worth
/// going on.
#[allow(clippy::option_option)]
fn pointed(top: &Section<'_>, given: Option<&Path>) -> Option<Option<(Measured, PathBuf)>> {
    let context = top.context;
    for name in ["geometry", "tests"] {
        if top.entry(name).is_some() {
            top.fault(name, format!("`{name}` stands beside `specimen`; expected one or the other"));
        }
    }
    if given.is_some() && top.entry("specimen").is_some() {
        top.fault("specimen", "a model of a study names no specimen: the study does".to_owned());
    }
    let path = match (given, top.text("specimen")) {
        (Some(path), _) => path.to_owned(),
        (None, Some(named)) => specimen::resolve(context, named),
        (None, None) => return Some(None),
    };
    let file = match SourceFile::read(&path, LARGEST_TOML, "a specimen file (TOML)") {
        Ok(file) => file,
        Err(diagnostic) if given.is_some() => {
            context.sink.push(*diagnostic);
            return Some(None);
        }
        Err(diagnostic) => {
            specimen::linked(top, "specimen", *diagnostic);
            return Some(None);
        }
    };
    context.sink.was_read(&file);
    let Some(document) = parse(&file, context.sink) else { return Some(None) };
    let inner = Context { file: &file, ..context };
    let section = Section::open(inner, "the specimen file", 0..0, document.get_ref(), keys::of(""));
    for (key, entry) in section.all() {
        if !SPECIMEN_KEYS.contains(&key.name.as_ref()) {
            let message =
                format!("`{}` does not belong in a specimen file that a config points to", entry.written);
            let report = Report::error(message).key(entry.written).help("move it to the config");
            inner.report(report, entry.key_span.clone());
        }
    }
    let (measured, path) = inline(&section);
    let name = specimen::checked_name(&section).unwrap_or_else(|| stem(&path));
    let provenance = section.text("provenance").map(str::to_owned);
    Some(Some((Measured { name: Some(name), provenance, ..measured }, path)))
}

/// A name for a file that gives none: its own, or its folder's if it is called like the scaffold's.
fn stem(path: &Path) -> String {
    let absolute = crate::case::absolute(path);
    let stem = absolute.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default();
    let folder = absolute.parent().and_then(Path::file_name).map(|s| s.to_string_lossy().into_owned());
    match stem.as_str() {
        "specimen" | "config" | "run" | "" => folder.unwrap_or_else(|| "case".to_owned()),
        _ => stem,
    }
}

/// The text of a TOML file, or `None` and an error.
fn load(path: &Path, what: &str, sink: &Sink) -> Option<SourceFile> {
    match SourceFile::read(path, LARGEST_TOML, what) {
        Ok(file) if file.is_blank() => {
            sink.push(Report::error(format!("the file is empty; expected {what}")).about(path));
            None
        }
        Ok(file) => {
            sink.was_read(&file);
            Some(file)
        }
        Err(diagnostic) => {
            sink.push(with_directory_help(path, *diagnostic));
            None
        }
    }
}

fn with_directory_help(path: &Path, mut diagnostic: Diagnostic) -> Diagnostic {
    let inside = ["config.toml", "specimen.toml", "run.toml"].map(|name| path.join(name));
    if let Some(file) = inside.iter().find(|f| f.is_file()) {
        let file = crate::text::visible(&file.display().to_string());
        diagnostic.help = Some(format!("did you mean `{file}`?"));
    }
    diagnostic
}

/// Errors of syntax shown per file.
const SYNTAX_ERRORS: usize = 10;

/// Parses TOML; errors of syntax end the reading of this file, keys given twice do not.
fn parse<'a>(file: &'a SourceFile, sink: &Sink) -> Option<Spanned<DeTable<'a>>> {
    // A large file is not worth recovering in: errors could be as many as its bytes.
    let (document, errors) = if file.text.len() > 1_000_000 {
        match DeTable::parse(&file.text) {
            Ok(document) => (Some(document), Vec::new()),
            Err(error) => (None, vec![error]),
        }
    } else {
        let (document, errors) = DeTable::parse_recoverable(&file.text);
        (Some(document), errors)
    };
    let mut fatal = document.is_none();
    let mut last_line = 0;
    for error in errors.iter().take(SYNTAX_ERRORS) {
        let twice = error.message().starts_with("duplicate key");
        fatal |= !twice;
        let span = error.span().unwrap_or(0..0);
        let line = file.line_column(span.start).0;
        // What follows a first error in the same line is mostly its consequence.
        if std::mem::replace(&mut last_line, line) == line {
            continue;
        }
        let text = crate::text::visible(error.message());
        let message =
            if twice { "this key is given twice".to_owned() } else { format!("not valid TOML: {text}") };
        let mut report = Report::error(message);
        if !twice
            && line == 1
            && file.text.lines().next().is_some_and(|l| l.contains("time_") && l.contains(','))
        {
            report = report.help("this looks like a record; expected the specimen file that points to it");
        }
        sink.push(report.at(file, span));
    }
    fatal |= errors.len() > SYNTAX_ERRORS;
    document.filter(|_| !fatal)
}
