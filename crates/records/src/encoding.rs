//! Bytes to text: marks first, then UTF-8 by its grammar, UTF-16 by its zeros, and old code pages by the detector
//! that browsers use, held against the column names that come out.

use crate::bytes::utf16;
use crate::words;
use encoding_rs::{Encoding, GBK, UTF_8, UTF_16BE, UTF_16LE, WINDOWS_1250, WINDOWS_1252};

/// Text and how it was found to be text.
#[derive(Debug)]
pub(crate) struct Decoded {
    /// Without a byte-order mark.
    pub text: String,
    /// Name of the encoding.
    pub encoding: &'static str,
    /// Why this one.
    pub why: &'static str,
}

/// Decodes bytes; `said` is what the user calls the encoding.
///
/// # Errors
/// If there is no such encoding, or the bytes are not in it.
pub(crate) fn decode(bytes: &[u8], said: Option<&str>) -> Result<Decoded, String> {
    if let Some(name) = said {
        let label = name.trim().to_ascii_lowercase();
        let label = if label == "utf-16" { "utf-16le" } else { &label };
        let label =
            label.strip_prefix("cp125").map_or_else(|| label.to_owned(), |n| format!("windows-125{n}"));
        let encoding = Encoding::for_label(label.as_bytes()).ok_or_else(|| {
            format!("unknown encoding `{name}`; expected utf-8, utf-16le, latin1, cp1250, gbk, …")
        })?;
        let (text, encoding, damaged) = encoding.decode(bytes);
        return if damaged {
            Err(format!("the bytes are not {}; leave --encoding out, or name another", encoding.name()))
        } else {
            Ok(Decoded { text: text.into_owned(), encoding: encoding.name(), why: "said" })
        };
    }
    if let Some((encoding, mark)) = Encoding::for_bom(bytes) {
        let text = encoding.decode_without_bom_handling(&bytes[mark..]).0.into_owned();
        return Ok(Decoded { text, encoding: encoding.name(), why: "byte-order mark" });
    }
    if utf16(&bytes[..bytes.len().min(65_536)]) {
        let big = bytes.chunks_exact(2).take(2000).filter(|p| p[0] == 0).count() > 500.min(bytes.len() / 8);
        let encoding = if big { UTF_16BE } else { UTF_16LE };
        let text = encoding.decode_without_bom_handling(bytes).0.into_owned();
        return Ok(Decoded { text, encoding: encoding.name(), why: "every second byte is zero" });
    }
    if let Ok(text) = std::str::from_utf8(bytes) {
        let why = if text.is_ascii() { "plain ASCII" } else { "valid UTF-8" };
        return Ok(Decoded { text: text.to_owned(), encoding: UTF_8.name(), why });
    }
    Ok(code_page(bytes))
}

/// An old code page. Digits and marks are the same in all; names are not, so that page is taken in which most
/// names of columns are words; the detector decides among equals.
fn code_page(bytes: &[u8]) -> Decoded {
    let mut detector = chardetng::EncodingDetector::new(chardetng::Iso2022JpDetection::Deny);
    let head = &bytes[..bytes.len().min(1_000_000)];
    detector.feed(head, true);
    let guess = detector.guess(None, chardetng::Utf8Detection::Deny);
    let mut best = (guess, known_words(guess, head));
    for page in [WINDOWS_1252, WINDOWS_1250, GBK] {
        let known = known_words(page, head);
        if known > best.1 {
            best = (page, known);
        }
    }
    let text = best.0.decode_without_bom_handling(bytes).0.into_owned();
    let why = if best.0 == guess { "detected" } else { "its words are names of columns" };
    Decoded { text, encoding: best.0.name(), why }
}

/// How many words with letters beyond ASCII are known names; fewer where bytes have no meaning.
fn known_words(page: &'static Encoding, head: &[u8]) -> i64 {
    let (text, damaged) = page.decode_without_bom_handling(head);
    let text: String = text.chars().take(40_000).collect();
    let split = |c: char| "\t\n\r;,\"()[]:".contains(c);
    let known = text.split(split).filter(|w| !w.is_ascii() && words::is_known(w)).count();
    known as i64 * 10 - i64::from(damaged) * 1000
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_encoding_of_the_list_is_found() {
        let told = |bytes: &[u8]| decode(bytes, None).map(|d| (d.encoding, d.text)).unwrap();
        let german = "Prüfzeit;Längenänderung;Kraft\ns;mm;N\n0;0;1\n";
        let polish = "Czas [s];Wydłużenie [mm];Siła [N]\n0;0;1\n";
        let chinese = "时间(s),位移(mm),力(N)\n0,0,1\n";
        for text in [german, polish, chinese] {
            assert_eq!(told(text.as_bytes()), ("UTF-8", text.to_owned()));
            let marked = [b"\xEF\xBB\xBF", text.as_bytes()].concat();
            assert_eq!(told(&marked), ("UTF-8", text.to_owned()));
            let wide: Vec<u8> = text.encode_utf16().flat_map(u16::to_le_bytes).collect();
            assert_eq!(told(&[&b"\xFF\xFE"[..], &wide].concat()), ("UTF-16LE", text.to_owned()));
        }
        let wide: Vec<u8> = german.encode_utf16().flat_map(u16::to_le_bytes).collect();
        assert_eq!(told(&wide), ("UTF-16LE", german.to_owned()));
        let wide: Vec<u8> = german.encode_utf16().flat_map(u16::to_be_bytes).collect();
        assert_eq!(told(&wide), ("UTF-16BE", german.to_owned()));
        assert_eq!(told(&WINDOWS_1252.encode(german).0), ("windows-1252", german.to_owned()));
        assert_eq!(told(&WINDOWS_1250.encode(polish).0), ("windows-1250", polish.to_owned()));
        assert_eq!(told(&GBK.encode(chinese).0), ("GBK", chinese.to_owned()));
    }

    #[test]
    fn what_is_said_is_taken_or_refused() {
        let bytes = WINDOWS_1252.encode("Prüfzeit").0;
        assert_eq!(decode(&bytes, Some("latin1")).map(|d| d.text), Ok("Prüfzeit".into()));
        assert_eq!(decode(&bytes, Some("cp1250")).map(|d| d.encoding), Ok("windows-1250"));
        assert!(decode(&bytes, Some("utf-8")).is_err());
        assert!(decode(&bytes, Some("klingon")).is_err());
    }
}
