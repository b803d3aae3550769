//! Where a key of a case stands, for faults that are only found when a model is made of it.

use crate::case::{Case, Location};
use crate::keys::{self, Speller};
use crate::read::LARGEST_TOML;
use crate::text::SourceFile;
use std::path::Path;
use toml::de::{DeTable, DeValue};

/// Where a key of a section stands: in the specimen file for `[geometry]` and `[[tests]]`, else in the config. Line 0 where
/// the file does not give it; `None` for a case that was not read from a file.
pub fn locate(case: &Case, section: &str, key: &str) -> Option<Location> {
    let measured = ["geometry", "tests"].contains(&section);
    let [first, second] = match measured {
        true => [&case.specimen_file, &case.config_file],
        false => [&case.config_file, &case.specimen_file],
    };
    let file = first.as_deref().or(second.as_deref())?;
    let place = in_file(file, section, key).unwrap_or_default();
    Some(Location { file: file.to_owned(), line: place.0, column: place.1 })
}

/// Line and column of a key, else of its section.
fn in_file(file: &Path, section: &str, key: &str) -> Option<(usize, usize)> {
    let source = SourceFile::read(file, LARGEST_TOML, "a config").ok()?;
    let document = DeTable::parse(&source.text).ok()?;
    let (name, item) = document.get_ref().iter().find(|(name, _)| name.get_ref() == section)?;
    let known = keys::of(section);
    let speller = Speller::new(section, &known);
    let wanted = |written: &str| speller.known(written).is_some_and(|(k, _)| known[k].name == key);
    let span = match item.get_ref() {
        DeValue::Table(table) => {
            table.iter().find(|(name, _)| wanted(name.get_ref())).map(|(name, _)| name.span())
        }
        _ => None,
    };
    Some(source.line_column(span.unwrap_or(name.span()).start))
}
