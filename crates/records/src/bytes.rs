//! A file's bytes within limits, and what it is: text, a workbook, or nothing that could be a record.

use crate::error::ImportError;
use std::fs::File;
use std::io::{ErrorKind, Read};
use std::path::Path;

/// Largest text file, bytes: some five million rows.
pub const LARGEST_TEXT: u64 = 400_000_000;
/// Largest workbook, bytes (it is compressed).
pub const LARGEST_WORKBOOK: u64 = 60_000_000;
/// What a workbook may hold when unpacked, bytes.
const LARGEST_UNPACKED: u64 = 600_000_000;
/// Bytes looked at before the rest is read.
const HEAD: usize = 65_536;

/// What a file holds.
#[derive(Debug)]
pub(crate) enum Content {
    /// Text in some encoding.
    Text(Vec<u8>),
    /// A workbook that `calamine` may read.
    Workbook(Vec<u8>),
}

/// Reads a file that could be a record.
///
/// # Errors
/// What it is instead. A directory, a pipe, a picture, an archive or 10 GB are told from at most 64 kB.
pub(crate) fn read(path: &Path) -> Result<Content, ImportError> {
    let fault = |reason: String| ImportError::NotARecord { path: path.to_owned(), reason };
    let meta = std::fs::metadata(path).map_err(|e| fault(io_message(&e)))?;
    if meta.is_dir() {
        return Err(fault("this is a directory; expected the file that the testing machine wrote".into()));
    }
    if !meta.is_file() {
        return Err(fault("this is no regular file (a pipe or a device); save its content to a file".into()));
    }
    if meta.len() == 0 {
        return Err(fault("the file is empty; expected a table of time, displacement and force".into()));
    }
    if meta.len() > LARGEST_TEXT {
        return Err(fault(too_large(meta.len(), LARGEST_TEXT)));
    }
    let mut file = File::open(path).map_err(|e| fault(io_message(&e)))?;
    let mut bytes = Vec::new();
    let head = file.by_ref().take(HEAD as u64);
    let read = |mut from: std::io::Take<&mut File>, into: &mut Vec<u8>| from.read_to_end(into);
    read(head, &mut bytes).map_err(|e| fault(io_message(&e)))?;
    let workbook = kind(&bytes).map_err(fault)?;
    let limit = if workbook { LARGEST_WORKBOOK } else { LARGEST_TEXT };
    if meta.len() > limit {
        return Err(fault(too_large(meta.len(), limit)));
    }
    // A file that grows while it is read stays within the limit.
    let rest = (limit + 1).saturating_sub(bytes.len() as u64);
    read(file.by_ref().take(rest), &mut bytes).map_err(|e| fault(io_message(&e)))?;
    if bytes.len() as u64 > limit {
        return Err(fault(too_large(bytes.len() as u64, limit)));
    }
    content(bytes).map_err(fault)
}

/// What bytes in memory are.
///
/// # Errors
/// Why they can be no record.
pub(crate) fn content(bytes: Vec<u8>) -> Result<Content, String> {
    if !kind(&bytes[..bytes.len().min(HEAD)])? {
        return Ok(Content::Text(bytes));
    }
    if bytes.starts_with(b"PK") {
        let unpacked =
            unpacked_size(&bytes).ok_or("this is an archive that cannot be opened; expected a table")?;
        if unpacked > LARGEST_UNPACKED {
            return Err(too_large(unpacked, LARGEST_UNPACKED));
        }
    }
    Ok(Content::Workbook(bytes))
}

/// Whether the head is that of a workbook (else: of text).
fn kind(head: &[u8]) -> Result<bool, String> {
    const KNOWN: [(&[u8], &str); 17] = [
        (b"\x89PNG", "a picture (PNG)"),
        (b"\xFF\xD8\xFF", "a picture (JPEG)"),
        (b"GIF8", "a picture (GIF)"),
        (b"II*\0", "a picture (TIFF)"),
        (b"MM\0*", "a picture (TIFF)"),
        (b"BM", "a picture (BMP)"),
        (b"%PDF", "a PDF document"),
        (b"\x1F\x8B", "an archive (gzip); unpack it"),
        (b"BZh", "an archive (bzip2); unpack it"),
        (b"\xFD7zXZ", "an archive (xz); unpack it"),
        (b"7z\xBC\xAF", "an archive (7z); unpack it"),
        (b"Rar!", "an archive (rar); unpack it"),
        (b"\x28\xB5\x2F\xFD", "an archive (zstd); unpack it"),
        (b"\x7FELF", "a program"),
        (b"MZ", "a program"),
        (b"RIFF", "a film or sound"),
        (b"\x89HDF", "an HDF5 file (MATLAB); save the columns as CSV"),
    ];
    let binary = share_of_control(head) > 0.002;
    // Two letters may begin a header too: then the rest is text.
    let known = KNOWN.iter().find(|(magic, _)| head.starts_with(magic) && (magic.len() > 2 || binary));
    if let Some((_, what)) = known {
        return Err(format!("this is {what}; expected a table of time, displacement and force"));
    }
    if head.starts_with(b"\xD0\xCF\x11\xE0") {
        return Ok(true);
    }
    if head.starts_with(b"PK\x03\x04") {
        let holds = |name: &[u8]| head.windows(name.len()).any(|w| w == name);
        let sheet = [&b"[Content_Types].xml"[..], b"xl/", b"opendocument.spreadsheet", b"content.xml"];
        return if sheet.into_iter().any(holds) {
            Ok(true)
        } else {
            Err("this is an archive (zip); unpack it and import the files in it".into())
        };
    }
    if binary && !utf16(head) {
        let what =
            "a binary file; expected text or a workbook: export the test as CSV from the machine's program";
        return Err(format!("this is {what}"));
    }
    Ok(false)
}

/// Share of bytes that no text has.
fn share_of_control(head: &[u8]) -> f64 {
    let control = |b: &&u8| (**b < 0x20 && !b"\t\n\r\x0C\x1A".contains(b)) || **b == 0x7F;
    // A few stray bytes (WinTest ends its first line with NUL) are no proof.
    let count = head.iter().filter(control).count().saturating_sub(4);
    count as f64 / head.len().max(1) as f64
}

/// Whether every second byte is NUL as often as in UTF-16 text of mostly ASCII, or there is a mark.
pub(crate) fn utf16(head: &[u8]) -> bool {
    if head.starts_with(&[0xFF, 0xFE]) || head.starts_with(&[0xFE, 0xFF]) {
        return true;
    }
    let pairs = head.chunks_exact(2);
    let (n, low, high) = pairs.fold((0, 0, 0), |(n, l, h), p| {
        (n + 1, l + usize::from(p[0] == 0 && p[1] != 0), h + usize::from(p[1] == 0 && p[0] != 0))
    });
    n > 3 && (low.max(high) * 10 > n * 7) && low.min(high) * 20 < n
}

/// What the entries of a zip file add up to when unpacked, by its central directory.
fn unpacked_size(bytes: &[u8]) -> Option<u64> {
    let word = |at: usize| Some(u32::from_le_bytes(bytes.get(at..at + 4)?.try_into().ok()?));
    let half = |at: usize| Some(u16::from_le_bytes(bytes.get(at..at + 2)?.try_into().ok()?));
    let first = bytes.len().saturating_sub(66_000);
    let end =
        (first..bytes.len().saturating_sub(21)).rev().find(|&i| bytes[i..].starts_with(b"PK\x05\x06"))?;
    let (count, mut at) = (half(end + 10)?, word(end + 16)? as usize);
    let mut sum = 0_u64;
    for _ in 0..count {
        if word(at)? != 0x0201_4B50 {
            return None;
        }
        sum += u64::from(word(at + 24)?);
        at += 46 + usize::from(half(at + 28)?) + usize::from(half(at + 30)?) + usize::from(half(at + 32)?);
    }
    Some(sum)
}

fn io_message(error: &std::io::Error) -> String {
    match error.kind() {
        ErrorKind::NotFound => "no such file; expected the file that the testing machine wrote".into(),
        ErrorKind::PermissionDenied => "permission denied; expected a file that can be read".into(),
        ErrorKind::NotADirectory => "no such file: a part of the path is not a directory".into(),
        ErrorKind::InvalidInput => "not a valid file name".into(),
        _ => format!("cannot be read: {error}"),
    }
}

fn too_large(size: u64, limit: u64) -> String {
    let mb = |bytes: u64| bytes as f64 / 1e6;
    format!("the file holds {:.0} MB; expected a record of at most {:.0} MB: split it", mb(size), mb(limit))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_can_be_no_record_is_named() {
        for (bytes, what) in [
            (&b"\x89PNG\r\n\x1a\n"[..], "picture"),
            (b"%PDF-1.4", "PDF"),
            (b"\x1f\x8b\x08\0\0\0", "gzip"),
            (b"PK\x03\x04\x14\0\0\0photo.jpg", "zip"),
            (&[0_u8; 200], "binary"),
        ] {
            let told = content(bytes.to_vec()).map(|_| ()).unwrap_err();
            assert!(told.contains(what), "{told}");
        }
        assert!(matches!(content(b"BMI,Time\n1,2\n".to_vec()), Ok(Content::Text(_))));
        assert!(matches!(content(b"Time,Load\0\n1,2\n".to_vec()), Ok(Content::Text(_))));
        let wide: Vec<u8> = "Time;Load\n".encode_utf16().flat_map(u16::to_le_bytes).collect();
        assert!(utf16(&wide) && matches!(content(wide), Ok(Content::Text(_))));
    }
}
