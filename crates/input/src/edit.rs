//! Changes to a configuration that keep everything else as the user wrote it: comments, order, layout.

use std::fmt;
use std::path::{Component, Path, PathBuf};
use toml_edit::{DocumentMut, InlineTable, Item, Table, TableLike, value};

/// Why a file could not be changed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum EditError {
    /// It is not valid TOML.
    Syntax(String),
    /// The effect is already there.
    Present(String),
    /// The effect is not there.
    Absent(String),
    /// `effects` is not a table.
    NotATable,
    /// A section is not a table.
    NoTable(String),
}

impl fmt::Display for EditError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Syntax(message) => write!(f, "not valid TOML: {message}"),
            Self::Present(name) => write!(f, "effect `{name}` is already in the file"),
            Self::Absent(name) => write!(f, "effect `{name}` is not in the file"),
            Self::NotATable => write!(f, "`effects` is not a table"),
            Self::NoTable(name) => write!(f, "`{name}` is not a table"),
        }
    }
}

impl std::error::Error for EditError {}

/// A parameter to be written: key with unit suffix, value in that unit, comment (may be empty).
pub type NewParameter<'a> = (&'a str, f64, &'a str);

/// Adds `[effects.NAME]` with parameters and a comment with the reason.
///
/// # Errors
/// If the text is not TOML, or has the effect already.
pub fn add_effect(
    text: &str,
    name: &str,
    parameters: &[NewParameter<'_>],
    reason: &str,
) -> Result<String, EditError> {
    let mut doc = document(text)?;
    let effects = doc.entry("effects").or_insert_with(|| {
        let mut table = Table::new();
        table.set_implicit(true);
        Item::Table(table)
    });
    let dotted = effects.as_table().is_some_and(Table::is_dotted);
    let inline = effects.is_inline_table();
    let table = effects.as_table_like_mut().ok_or(EditError::NotATable)?;
    if table.contains_key(name) {
        return Err(EditError::Present(name.to_owned()));
    }
    if inline {
        let mut effect = InlineTable::new();
        for (key, x, _) in parameters {
            effect.insert(*key, (*x).into());
        }
        table.insert(name, value(effect));
        if let Some(mut key) = doc.key_mut("effects") {
            let before = key.leaf_decor().prefix().and_then(|p| p.as_str()).unwrap_or_default().to_owned();
            key.leaf_decor_mut().set_prefix(format!("{before}{}", comment(reason)));
        }
        return Ok(doc.to_string());
    }
    let mut effect = Table::new();
    effect.set_dotted(dotted);
    for (key, x, note) in parameters {
        let mut item = value(*x);
        if let (Some(v), false) = (item.as_value_mut(), note.is_empty()) {
            v.decor_mut().set_suffix(format!("  # {}", one_line(note)));
        }
        effect.insert(key, item);
    }
    if dotted {
        if let Some(mut first) = parameters.first().and_then(|p| effect.key_mut(p.0)) {
            first.leaf_decor_mut().set_prefix(comment(reason));
        }
    } else {
        effect.decor_mut().set_prefix(format!("\n{}", comment(reason)));
    }
    table.insert(name, Item::Table(effect));
    Ok(doc.to_string())
}

/// Has `[bulk]` or `[interface]` (`section`) name another law, with a comment with the reason. Keys of the names in `gone`,
/// in whatever unit, are taken out: the new law has no such parameter, or means something else by it.
///
/// # Errors
/// If the text is not TOML, or the section is no table.
pub fn choose_law(
    text: &str,
    section: &str,
    law: &str,
    gone: &[String],
    reason: &str,
) -> Result<String, EditError> {
    let mut doc = document(text)?;
    let item = doc.entry(section).or_insert_with(|| Item::Table(Table::new()));
    let table = item.as_table_like_mut().ok_or_else(|| EditError::NoTable(section.to_owned()))?;
    let named = |key: &str, name: &str| {
        key.strip_prefix(name).is_some_and(|unit| unit.is_empty() || unit.starts_with('_'))
    };
    let keys: Vec<String> = table.iter().map(|(key, _)| key.to_owned()).collect();
    for key in keys.iter().filter(|key| gone.iter().any(|name| named(key, name))) {
        table.remove(key);
    }
    let mut chosen = value(law);
    if let Some(v) = chosen.as_value_mut() {
        let inline = item.is_inline_table();
        if !inline {
            v.decor_mut().set_suffix(format!("  # {}", one_line(reason)));
        }
    }
    if let Some(table) = doc.get_mut(section).and_then(Item::as_table_like_mut) {
        table.insert("law", chosen);
    }
    Ok(doc.to_string())
}

/// Takes `[effects.NAME]` away, with the comments that belong to it; a comment with the reason is left at the
/// end of the file.
///
/// # Errors
/// If the text is not TOML, or has no such effect.
pub fn drop_effect(text: &str, name: &str, reason: &str) -> Result<String, EditError> {
    let mut doc = document(text)?;
    let absent = || EditError::Absent(name.to_owned());
    let effects = doc.get_mut("effects").ok_or_else(absent)?;
    let table = effects.as_table_like_mut().ok_or(EditError::NotATable)?;
    table.remove(name).ok_or_else(absent)?;
    if table.is_empty() {
        doc.remove("effects");
    }
    let mut out = doc.to_string();
    if !reason.is_empty() {
        if !out.is_empty() && !out.ends_with('\n') {
            out.push('\n');
        }
        out.push_str(&format!("# effect `{name}` taken out: {}\n", one_line(reason)));
    }
    Ok(out)
}

/// Sets the top-level key `parent`, the run this configuration was derived from.
///
/// # Errors
/// If the text is not TOML.
pub fn set_parent(text: &str, parent: &str) -> Result<String, EditError> {
    let mut doc = document(text)?;
    doc["parent"] = value(parent);
    Ok(doc.to_string())
}

/// Rewrites the paths of a file that moves from folder `from` to folder `to`: `specimen`, and `data`, `outline` and
/// `thickness_profile` where they are written in place. They are written relative to `to` where that is near
/// ([`near`]), so that a folder that holds both can be moved as a whole, else absolute. Absolute paths stay as the user
/// wrote them, unless `ours`: a file that this program wrote.
///
/// # Errors
/// If the text is not TOML.
pub fn rebase(text: &str, from: &Path, to: &Path, ours: bool) -> Result<String, EditError> {
    let (from, to) = (crate::case::absolute(from), crate::case::absolute(to));
    if from == to && !ours {
        return Ok(text.to_owned());
    }
    let move_key = |table: &mut dyn TableLike, key: &str| rebase_key(table, key, &from, &to, ours);
    let mut doc = document(text)?;
    move_key(doc.as_table_mut(), "specimen");
    if let Some(geometry) = doc.get_mut("geometry").and_then(Item::as_table_like_mut) {
        move_key(geometry, "outline");
        move_key(geometry, "thickness_profile");
    }
    match doc.get_mut("tests") {
        Some(Item::ArrayOfTables(tests)) => tests.iter_mut().for_each(|t| move_key(t, "data")),
        Some(Item::Value(toml_edit::Value::Array(tests))) => {
            for test in tests.iter_mut().filter_map(toml_edit::Value::as_inline_table_mut) {
                move_key(test, "data");
            }
        }
        _ => {}
    }
    Ok(doc.to_string())
}

/// Folders that a relative path climbs at most: what lies further off belongs elsewhere.
const CLIMBS: usize = 2;

/// A path as seen from a folder, both absolute; itself where the way there leads through the root or climbs more than
/// two folders.
pub fn near(path: &Path, folder: &Path) -> PathBuf {
    let (path, folder) = (clean(path), clean(folder));
    let shared = path.components().zip(folder.components()).take_while(|(a, b)| a == b).count();
    let climbs = folder.components().count() - shared;
    // The root alone is nothing that two places share.
    if shared < 2 || climbs > CLIMBS {
        return path;
    }
    let up = std::iter::repeat_n(Component::ParentDir, climbs);
    let relative: PathBuf = up.chain(path.components().skip(shared)).collect();
    if relative.as_os_str().is_empty() { PathBuf::from(".") } else { relative }
}

/// Without `.`, and without `..` where a folder stands before it.
fn clean(path: &Path) -> PathBuf {
    let mut out = PathBuf::new();
    for c in path.components() {
        match c {
            Component::CurDir => {}
            Component::ParentDir if matches!(out.components().next_back(), Some(Component::Normal(_))) => {
                out.pop();
            }
            c => out.push(c),
        }
    }
    out
}

fn rebase_key(table: &mut dyn TableLike, key: &str, from: &Path, to: &Path, ours: bool) {
    let Some(item) = table.get_mut(key) else { return };
    let Some(path) = item.as_str().map(Path::new).filter(|p| ours || p.is_relative()) else { return };
    let moved = near(&from.join(path), to).to_string_lossy().into_owned();
    if let Some(old) = item.as_value_mut() {
        let decor = old.decor().clone();
        *old = moved.into();
        *old.decor_mut() = decor;
    }
}

fn document(text: &str) -> Result<DocumentMut, EditError> {
    let text = text.strip_prefix('\u{FEFF}').unwrap_or(text);
    text.parse::<DocumentMut>().map_err(|e| EditError::Syntax(crate::text::visible(e.message())))
}

/// The reason as comment lines of readable width; nothing for no reason.
fn comment(reason: &str) -> String {
    let (mut out, mut line) = (String::new(), String::new());
    for word in one_line(reason).split_whitespace() {
        if !line.is_empty() && line.chars().count() + word.chars().count() > 97 {
            out.push_str(&format!("# {line}\n"));
            line.clear();
        }
        if !line.is_empty() {
            line.push(' ');
        }
        line.push_str(word);
    }
    if line.is_empty() { out } else { format!("{out}# {line}\n") }
}

fn one_line(text: &str) -> String {
    crate::text::visible(&text.split_whitespace().collect::<Vec<_>>().join(" "))
}
