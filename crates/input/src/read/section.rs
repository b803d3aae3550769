//! One table of a file, its keys checked against the table of keys, its values taken with unit and range.

use super::scalar::{self, Item};
use crate::diagnostics::{Report, Sink};
use crate::experiment::TestKind;
use crate::keys::{Fallback, Key, Kind, Speller};
use crate::text::{SourceFile, short};
use std::ops::Range;
use toml::de::DeTable;

/// Where diagnostics go, and the file they are about.
#[derive(Clone, Copy)]
pub(crate) struct Context<'a> {
    pub file: &'a SourceFile,
    pub sink: &'a Sink,
    /// The keys of every law of the registry.
    pub laws: &'a [Key],
    /// The experiments of the registry.
    pub kinds: &'a [TestKind],
}

impl Context<'_> {
    /// Reports something about a place in the file.
    pub fn report(&self, report: Report, span: Range<usize>) {
        if !self.sink.is_full(self.file) {
            self.sink.push(report.at(self.file, span));
        }
    }

    /// Reports something about the file as a whole.
    pub fn report_file(&self, report: Report) {
        self.sink.push(report.about(self.file.path.clone()));
    }
}

/// A key of the file that is known, with what stands behind it.
pub(crate) struct Entry<'a> {
    key: usize,
    /// Factor of its unit to the internal unit.
    pub factor: f64,
    /// As written.
    pub written: &'a str,
    /// Where the key stands.
    pub key_span: Range<usize>,
    /// The value.
    pub item: &'a Item<'a>,
}

/// A table of the file.
pub(crate) struct Section<'a> {
    pub context: Context<'a>,
    /// As in messages: `[bulk]`.
    pub title: String,
    /// Where to point for what is missing.
    pub span: Range<usize>,
    keys: Vec<Key>,
    entries: Vec<Entry<'a>>,
    /// For every unknown key, the name of the one that was probably meant.
    misspelt: Vec<Option<String>>,
}

impl<'a> Section<'a> {
    /// Opens a table: unknown keys, and keys given twice in two units, are reported here.
    pub fn open(
        context: Context<'a>,
        title: impl Into<String>,
        span: Range<usize>,
        table: &'a DeTable<'a>,
        keys: Vec<Key>,
    ) -> Self {
        let mut section =
            Self { context, title: title.into(), span, keys, entries: Vec::new(), misspelt: Vec::new() };
        let (title, keys) = (section.title.clone(), section.keys.clone());
        let speller = Speller::new(&title, &keys).beside(context.laws);
        for (key, item) in table {
            let (written, span) = (key.get_ref().as_ref(), key.span());
            if let Some((index, factor)) = speller.known(written) {
                section.add(index, factor, written, span, item);
            } else if !context.sink.is_full(context.file) {
                let unknown = speller.explain(written);
                let mut report = Report::error(unknown.message).key(short(written));
                if let Some(help) = unknown.help {
                    report = report.help(help);
                }
                context.report(report, span);
                section.misspelt.push(unknown.meant);
            }
        }
        section
    }

    /// A table that is not there: every key at its default.
    pub fn absent(context: Context<'a>, title: impl Into<String>, keys: Vec<Key>) -> Self {
        Self { context, title: title.into(), span: 0..0, keys, entries: Vec::new(), misspelt: Vec::new() }
    }

    fn add(&mut self, key: usize, factor: f64, written: &'a str, key_span: Range<usize>, item: &'a Item<'a>) {
        if let Some(first) = self.entries.iter().find(|e| e.key == key) {
            let line = self.context.file.line_column(first.key_span.start).0;
            let message = format!("`{written}` is given twice: `{}` stands in line {line}", first.written);
            self.context.report(Report::error(message).key(written), key_span);
            return;
        }
        self.entries.push(Entry { key, factor, written, key_span, item });
    }

    /// The description of a key of this section.
    pub fn key(&self, name: &str) -> &Key {
        let found = self.keys.iter().find(|k| k.name == name);
        found.unwrap_or_else(|| unreachable!("key `{name}` is not in the table of {}", self.title))
    }

    /// What the file gives for a key.
    pub fn entry(&self, name: &str) -> Option<&Entry<'a>> {
        self.entries.iter().find(|e| self.keys[e.key].name == name)
    }

    /// Where a key stands, or the section if it does not.
    pub fn span_of(&self, name: &str) -> Range<usize> {
        self.entry(name).map_or(self.span.clone(), |e| e.key_span.clone())
    }

    /// An error about a key: at the key if it stands in the file, else at the section.
    pub fn fault(&self, name: &str, message: impl Into<String>) {
        let report = Report::error(message).key(self.spelling(name));
        self.context.report(report, self.span_of(name));
    }

    /// As the user wrote it, or the preferred spelling.
    pub fn spelling(&self, name: &str) -> String {
        self.entry(name).map_or_else(|| self.key(name).spelling(), |e| e.written.to_owned())
    }

    /// Whether there was an unknown key, so that what is missing may well be misspelt.
    pub fn has_unknown(&self) -> bool {
        !self.misspelt.is_empty()
    }

    /// Reports that a key is missing, unless one was there that probably meant it.
    pub fn missing(&self, name: &str) {
        let key = self.key(name);
        if self.misspelt.iter().flatten().any(|m| m == name) {
            return;
        }
        let message = format!("missing key `{}` in {}: {}", key.spelling(), self.title, key.description);
        self.context.report(Report::error(message).key(key.spelling()), self.span.clone());
    }

    /// A number in the internal unit. After a fault that was reported: NaN, which passes no comparison.
    pub fn number(&self, name: &str) -> f64 {
        match (self.entry(name), &self.key(name).default) {
            (Some(_), _) => self.optional_number(name).unwrap_or(f64::NAN),
            (None, Fallback::Number(x)) => *x,
            (None, _) => {
                self.missing(name);
                f64::NAN
            }
        }
    }

    /// A number in the internal unit, if the file gives one (and it is right).
    pub fn optional_number(&self, name: &str) -> Option<f64> {
        let entry = self.entry(name)?;
        let Kind::Number { limits, .. } = self.key(name).kind else { return None };
        scalar::quantity(self.context, entry.written, entry.item, entry.factor, &limits)
    }

    /// A whole number; after a fault, its default.
    pub fn integer(&self, name: &str) -> usize {
        let default = if let Fallback::Integer(i) = self.key(name).default { i } else { 0 };
        self.checked_integer(name).unwrap_or(usize::try_from(default).unwrap_or_default())
    }

    /// A whole number or its default; `None` after a fault.
    pub fn checked_integer(&self, name: &str) -> Option<usize> {
        let key = self.key(name);
        let (min, max) = match key.kind {
            Kind::Integer { min, max } => (min, max),
            Kind::Count { max } => (0, max),
            _ => (0, i64::MAX),
        };
        let given = match (self.entry(name), &key.default) {
            (Some(e), _) => scalar::integer(self.context, e.written, e.item, min, max)?,
            (None, Fallback::Integer(i)) => *i,
            (None, _) => 0,
        };
        usize::try_from(given).ok()
    }

    /// `true` or `false`; after a fault, its default.
    pub fn flag(&self, name: &str) -> bool {
        let default = matches!(self.key(name).default, Fallback::Bool(true));
        let entry = self.entry(name);
        entry.and_then(|e| scalar::flag(self.context, e.written, e.item)).unwrap_or(default)
    }

    /// Text, if the file gives one.
    pub fn text(&self, name: &str) -> Option<&'a str> {
        let entry = self.entry(name)?;
        scalar::text(self.context, entry.written, entry.item)
    }

    /// The index of one of a choice's words; after a fault, or if it is required and missing, the first.
    pub fn choice(&self, name: &str) -> usize {
        let key = self.key(name);
        let Kind::Choice { words } = &key.kind else { return 0 };
        match (self.entry(name), &key.default) {
            (Some(e), _) => scalar::choice(self.context, e.written, e.item, words).unwrap_or(0),
            (None, Fallback::Word(word)) => words.iter().position(|w| w == word).unwrap_or(0),
            (None, _) => {
                self.missing(name);
                0
            }
        }
    }
}

impl<'a> Section<'a> {
    /// Every known key that the file gives.
    pub fn all(&self) -> impl Iterator<Item = (&Key, &Entry<'a>)> {
        self.entries.iter().map(|e| (&self.keys[e.key], e))
    }
}
