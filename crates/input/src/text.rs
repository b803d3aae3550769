//! Reading a file as text within limits; lines, columns and excerpts; text made safe to print.

use crate::diagnostics::{Diagnostic, Diagnostics, Excerpt, Report};
use std::fs::File;
use std::io::{ErrorKind, Read};
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Characters of an excerpt line.
const EXCERPT: usize = 110;

/// A text file in memory.
#[derive(Debug)]
pub(crate) struct SourceFile {
    /// As the user named it.
    pub path: PathBuf,
    /// Content without a byte-order mark.
    pub text: String,
    /// SHA-256 of the bytes as they were read; `None` for a text that came from no file.
    pub sha256: Option<String>,
    line_starts: Vec<usize>,
}

/// A place in a file.
pub(crate) struct Place {
    /// From 1.
    pub line: usize,
    /// In characters, from 1.
    pub column: usize,
    /// The line around it.
    pub excerpt: Excerpt,
}

impl SourceFile {
    /// Wraps a text that is already in memory.
    pub fn new(path: impl Into<PathBuf>, text: String) -> Self {
        let line_starts =
            std::iter::once(0).chain(text.bytes().enumerate().filter(|b| b.1 == b'\n').map(|b| b.0 + 1));
        Self { path: path.into(), line_starts: line_starts.collect(), text, sha256: None }
    }

    /// Reads a file of at most `limit` bytes; `what` names what was expected ("a specimen or config file").
    pub fn read(path: &Path, limit: u64, what: &str) -> Result<Self, Box<Diagnostic>> {
        let bytes = bytes(path, limit, what)?;
        let sha256 = crate::inputs::sha256(&bytes);
        Self::from_bytes(path, bytes).map(|file| Self { sha256: Some(sha256), ..file })
    }

    /// Decodes UTF-8, with or without a byte-order mark.
    pub fn from_bytes(path: &Path, mut bytes: Vec<u8>) -> Result<Self, Box<Diagnostic>> {
        if bytes.starts_with(&[0xEF, 0xBB, 0xBF]) {
            bytes.drain(..3);
        }
        if bytes.starts_with(&[0xFF, 0xFE]) || bytes.starts_with(&[0xFE, 0xFF]) {
            let report = Report::error("this is UTF-16 text; expected UTF-8").help("save the file as UTF-8");
            return Err(Box::new(report.about(path)));
        }
        match String::from_utf8(bytes) {
            Ok(text) => Ok(Self::new(path, text)),
            Err(error) => {
                let at = error.utf8_error().valid_up_to();
                let byte = error.as_bytes().get(at).copied().unwrap_or_default();
                let lossy = String::from_utf8_lossy(error.as_bytes()).into_owned();
                let message = format!("invalid UTF-8: byte 0x{byte:02X} here; expected UTF-8 text");
                let report = Report::error(message).help("save the file as UTF-8");
                Err(Box::new(report.at(&Self::new(path, lossy), at..at + 1)))
            }
        }
    }

    /// Whether there is nothing but blanks.
    pub fn is_blank(&self) -> bool {
        self.text.bytes().all(|b| b.is_ascii_whitespace())
    }

    /// Line, column and excerpt of a span of bytes.
    pub fn place(&self, span: Range<usize>) -> Place {
        let start = self.boundary(span.start);
        let line = self.line_starts.partition_point(|&s| s <= start).max(1);
        let first = self.line_starts[line - 1];
        let next = self.line_starts.get(line).map_or(self.text.len(), |&s| s - 1);
        let end = self.boundary(span.end.max(start)).min(next);
        let before = &self.text[first..start.min(next).max(first)];
        let inside = &self.text[start.min(next)..end.max(start.min(next))];
        let after = self.text[end.max(start.min(next))..next].trim_end_matches('\r');
        Place { line, column: before.chars().count() + 1, excerpt: excerpt(before, inside, after) }
    }

    /// Line and column, both from 1.
    pub fn line_column(&self, offset: usize) -> (usize, usize) {
        let place = self.place(offset..offset);
        (place.line, place.column)
    }

    fn boundary(&self, offset: usize) -> usize {
        let mut offset = offset.min(self.text.len());
        while !self.text.is_char_boundary(offset) {
            offset -= 1;
        }
        offset
    }
}

/// Reads a text that the user names, other than the files that [`crate::read_case`] reads by itself: a config to be
/// edited, published values, an answer of an earlier run. `what` names what was expected, `limit` is in bytes.
///
/// # Errors
/// What is no regular file (a device, a pipe, a directory), is larger than `limit`, cannot be read or is no UTF-8.
/// Nothing of it is read then, or at most `limit` bytes.
pub fn read_text(path: &Path, limit: u64, what: &str) -> Result<String, Diagnostics> {
    SourceFile::read(path, limit, what).map(|file| file.text).map_err(|d| Diagnostics(vec![*d]))
}

/// The bytes of a regular file. A device or a pipe may have no end, and cannot be read a second time for the hash
/// that a run keeps of its input.
fn bytes(path: &Path, limit: u64, what: &str) -> Result<Vec<u8>, Box<Diagnostic>> {
    let fault = |message: String| Box::new(Report::error(message).about(path));
    let meta = std::fs::metadata(path).map_err(|e| fault(io_message(&e, what)))?;
    if meta.is_dir() {
        return Err(fault(format!("this is a directory; expected {what}")));
    }
    if !meta.is_file() {
        let message = format!("this is not a regular file but {}; expected {what}", special(&meta));
        let help = "a pipe or a device may have no end: write it to a file, and name that";
        return Err(Box::new(Report::error(message).help(help).about(path)));
    }
    if meta.len() > limit {
        return Err(too_large(path, meta.len(), limit, what));
    }
    let file = File::open(path).map_err(|e| fault(io_message(&e, what)))?;
    // Files of /proc say that they are empty.
    let mut bytes = Vec::with_capacity(usize::try_from(meta.len()).unwrap_or_default());
    file.take(limit + 1).read_to_end(&mut bytes).map_err(|e| fault(io_message(&e, what)))?;
    if bytes.len() as u64 > limit {
        return Err(too_large(path, bytes.len() as u64, limit, what));
    }
    Ok(bytes)
}

/// What a file is that is neither a regular one nor a directory.
#[cfg(unix)]
fn special(meta: &std::fs::Metadata) -> &'static str {
    use std::os::unix::fs::FileTypeExt;
    let kind = meta.file_type();
    match () {
        () if kind.is_fifo() => "a pipe",
        () if kind.is_socket() => "a socket",
        () if kind.is_char_device() || kind.is_block_device() => "a device",
        () => "something else",
    }
}

/// What a file is that is neither a regular one nor a directory.
#[cfg(not(unix))]
fn special(_meta: &std::fs::Metadata) -> &'static str {
    "something else"
}

/// The part of a line that fits, with the place in question inside.
fn excerpt(before: &str, inside: &str, after: &str) -> Excerpt {
    let tail = last_chars(before, EXCERPT / 2);
    let cut_left = tail.len() < before.len();
    let left = format!("{}{}", if cut_left { "…" } else { "" }, visible(tail));
    let indent = left.chars().count();
    let middle_raw = first_chars(inside, EXCERPT / 2);
    let middle = visible(middle_raw);
    let cut_middle = middle_raw.len() < inside.len();
    let right_raw = if cut_middle { "" } else { first_chars(after, EXCERPT / 2) };
    let cut_right = cut_middle || right_raw.len() < after.len();
    let line = format!("{left}{middle}{}{}", visible(right_raw), if cut_right { "…" } else { "" });
    Excerpt { line: line.trim_end().to_owned(), indent, width: middle.chars().count().max(1) }
}

fn first_chars(text: &str, n: usize) -> &str {
    text.char_indices().nth(n).map_or(text, |(i, _)| &text[..i])
}

fn last_chars(text: &str, n: usize) -> &str {
    text.char_indices().rev().nth(n.saturating_sub(1)).map_or(text, |(i, _)| &text[i..])
}

/// The text with control and direction characters escaped, so that it can neither drive a terminal nor turn what
/// stands beside it around; tabs become blanks. Everything of a file's or a user's that is shown goes through here.
pub fn visible(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '\t' => out.push(' '),
            '\u{061C}'
            | '\u{200B}'..='\u{200F}'
            | '\u{2028}'..='\u{202E}'
            | '\u{2060}'..='\u{206F}'
            | '\u{FEFF}' => {
                out.extend(c.escape_unicode());
            }
            c if c.is_control() => out.extend(c.escape_default()),
            c => out.push(c),
        }
    }
    out
}

/// User text for the middle of a sentence: visible and not too long.
pub(crate) fn short(text: &str) -> String {
    let cut = first_chars(text, 60);
    if cut.len() < text.len() { format!("{}…", visible(cut)) } else { visible(text) }
}

fn io_message(error: &std::io::Error, what: &str) -> String {
    match error.kind() {
        ErrorKind::NotFound => format!("no such file; expected {what}"),
        ErrorKind::PermissionDenied => format!("permission denied; expected {what} that can be read"),
        ErrorKind::NotADirectory => {
            format!("no such file: a part of the path is not a directory; expected {what}")
        }
        ErrorKind::IsADirectory => format!("this is a directory; expected {what}"),
        ErrorKind::InvalidInput => format!("not a valid file name; expected {what}"),
        _ => format!("cannot be read: {}; expected {what}", visible(&error.to_string())),
    }
}

fn too_large(path: &Path, size: u64, limit: u64, what: &str) -> Box<Diagnostic> {
    const MB: f64 = 1e6;
    let (size, limit) = (size as f64 / MB, limit as f64 / MB);
    let message = format!("the file has {size:.1} MB; expected {what} of at most {limit:.0} MB");
    Box::new(Report::error(message).about(path))
}
