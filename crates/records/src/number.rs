//! Numbers as locales write them: decimal comma, grouped thousands, a missing zero. What a cell says about its
//! locale, and its value to the last bit.

/// How a file writes numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Locale {
    /// `.` or `,`.
    pub decimal: char,
}

/// What a cell says about the decimal mark.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Evidence {
    /// No mark: an integer, or no number.
    Silent,
    /// The decimal mark is a point.
    Point,
    /// The decimal mark is a comma.
    Comma,
    /// `1.234`: a point, or thousands in a comma's locale.
    EitherPoint,
    /// `1,234`: a comma, or thousands in a point's locale.
    EitherComma,
}

/// Signs that stand between thousands and can be nothing else.
const BLANKS: [char; 6] = [' ', '\u{A0}', '\u{202F}', '\u{2009}', '\'', '\u{2019}'];

/// Words that stand for "no value".
pub(crate) fn is_missing(cell: &str) -> bool {
    let cell = cell.trim();
    if cell.len() > 10 {
        return false;
    }
    let plain = cell.trim_start_matches('-');
    plain.is_empty()
        || [
            "nan", "na", "n/a", "#n/a", "null", "none", "inf", "infinity", "#div/0!", "#value!", "#num!",
            "?", "*", "ovr",
        ]
        .iter()
        .any(|w| plain.eq_ignore_ascii_case(w))
        || plain.starts_with("1.#")
        || plain.chars().all(|c| c == '-' || c == '.')
}

/// Sign, and the rest without it; a true minus counts.
fn signed(cell: &str) -> (bool, &str) {
    let cell = cell.trim();
    match cell.strip_prefix(['-', '\u{2212}']) {
        Some(rest) => (true, rest),
        None => (false, cell.strip_prefix('+').unwrap_or(cell)),
    }
}

/// Mantissa and exponent of a text that starts with a digit or a mark.
fn parted(text: &str) -> Option<(&str, i32)> {
    match text.find(['e', 'E']) {
        None => Some((text, 0)),
        Some(at) => {
            let exponent = text[at + 1..].strip_prefix('+').unwrap_or(&text[at + 1..]);
            let digits = exponent.strip_prefix('-').unwrap_or(exponent);
            let fine = !digits.is_empty() && digits.len() < 5 && digits.bytes().all(|b| b.is_ascii_digit());
            fine.then(|| exponent.parse().ok()).flatten().map(|e| (&text[..at], e))
        }
    }
}

/// Whether a cell looks like a number in some locale.
pub(crate) fn looks_numeric(cell: &str) -> bool {
    let plain = cell.as_bytes();
    // Most cells: digits and one point.
    if !plain.is_empty() && plain.iter().all(u8::is_ascii_digit) {
        return true;
    }
    value(cell, Locale { decimal: '.' }, 0).is_some() || value(cell, Locale { decimal: ',' }, 0).is_some()
}

/// What a cell that looks like a number says about the decimal mark.
pub(crate) fn evidence(cell: &str) -> Evidence {
    let Some((mantissa, exponent)) = parted(signed(cell).1) else { return Evidence::Silent };
    let (points, commas) = (mantissa.matches('.').count(), mantissa.matches(',').count());
    let as_decimal = |point: bool| if point { Evidence::Point } else { Evidence::Comma };
    match (points, commas) {
        (0, 0) => Evidence::Silent,
        (1.., 1..) => as_decimal(mantissa.rfind('.') > mantissa.rfind(',')),
        (2.., 0) => as_decimal(false),
        (0, 2..) => as_decimal(true),
        _ => {
            let point = points == 1;
            let (front, back) = mantissa.split_once(if point { '.' } else { ',' }).unwrap_or((mantissa, ""));
            let grouped = back.len() == 3
                && (1..=3).contains(&front.len())
                && !front.starts_with('0')
                && exponent == 0
                && !cell.contains(['e', 'E']);
            match (grouped, point) {
                (false, _) => as_decimal(point),
                (true, true) => Evidence::EitherPoint,
                (true, false) => Evidence::EitherComma,
            }
        }
    }
}

/// The number in a cell times ten to a power, correctly rounded; `None` if it is no number of this locale.
pub(crate) fn value(cell: &str, locale: Locale, power: i32) -> Option<f64> {
    let (negative, rest) = signed(cell);
    let (mantissa, exponent) = parted(rest)?;
    let mut digits = [0_u8; 64];
    let mut n = 0;
    let mut push = |b: u8| {
        if n < digits.len() - 8 {
            digits[n] = b;
            n += 1;
            true
        } else {
            false
        }
    };
    let (whole, fraction) = match mantissa.find(locale.decimal) {
        Some(at) => (&mantissa[..at], &mantissa[at + 1..]),
        None => (mantissa, ""),
    };
    if whole.is_empty() && fraction.is_empty() {
        return None;
    }
    let other = if locale.decimal == '.' { ',' } else { '.' };
    let mark = whole.chars().find(|c| !c.is_ascii_digit());
    let grouping = mark.is_none_or(|c| c == other || BLANKS.contains(&c));
    if !grouping {
        return None;
    }
    for (k, group) in mark.map_or(vec![whole], |m| whole.split(m).collect()).into_iter().enumerate() {
        let length = if mark.is_none() {
            true
        } else if k == 0 {
            (1..=3).contains(&group.len()) && group != "0"
        } else {
            group.len() == 3
        };
        if !length || !group.bytes().all(|b| b.is_ascii_digit()) || !group.bytes().all(&mut push) {
            return None;
        }
    }
    if !fraction.bytes().all(|b| b.is_ascii_digit()) {
        return None;
    }
    push(b'.');
    for b in fraction.bytes() {
        // Digits beyond the fiftieth change no double.
        if !push(b) {
            break;
        }
    }
    let text = std::str::from_utf8(&digits[..n]).ok()?;
    let shift = exponent + power;
    let size: f64 = if shift == 0 { text.parse().ok()? } else { format!("{text}e{shift}").parse().ok()? };
    // 0 − x and not −x: a record has no −0.
    size.is_finite().then_some(if negative { 0.0 - size } else { size })
}

#[cfg(test)]
mod tests {
    use super::*;

    const POINT: Locale = Locale { decimal: '.' };
    const COMMA: Locale = Locale { decimal: ',' };

    #[test]
    fn numbers_of_both_locales_are_read_to_the_last_bit() {
        for (cell, locale, expected) in [
            ("1.5", POINT, 1.5),
            ("1,5", COMMA, 1.5),
            (".008", POINT, 0.008),
            ("-,03", COMMA, -0.03),
            ("1,234.5", POINT, 1234.5),
            ("1.234.567,25", COMMA, 1_234_567.25),
            ("1 234,5", COMMA, 1234.5),
            ("1'234.5", POINT, 1234.5),
            ("12\u{A0}345", COMMA, 12345.0),
            ("1.64994E-01", POINT, 0.164994),
            ("-1,5e+3", COMMA, -1500.0),
            ("\u{2212}2", POINT, -2.0),
            ("+3.", POINT, 3.0),
        ] {
            assert_eq!(value(cell, locale, 0), Some(expected), "{cell}");
            assert!(looks_numeric(cell), "{cell}");
        }
        assert_eq!(value("12.3", POINT, -3), Some(0.0123));
        for cell in [
            "",
            ".",
            "1,23",
            "1,2345.6",
            "1 23.5",
            "22.07.2014",
            "12:30:01",
            "1e",
            "0,123.5",
            "abc",
            "1.2.3",
            "-",
        ] {
            assert_eq!(value(cell, POINT, 0), None, "{cell}");
        }
    }

    #[test]
    fn cells_say_what_their_mark_is() {
        for (cell, expected) in [
            ("12", Evidence::Silent),
            ("0,123", Evidence::Comma),
            ("1,234", Evidence::EitherComma),
            ("1.234", Evidence::EitherPoint),
            ("1,234.5", Evidence::Point),
            ("1.234,5", Evidence::Comma),
            ("1,234,567", Evidence::Point),
            ("12,34", Evidence::Comma),
            ("1234.567", Evidence::Point),
            ("1,234e0", Evidence::Comma),
        ] {
            assert_eq!(evidence(cell), expected, "{cell}");
        }
        assert!(
            is_missing("NaN")
                && is_missing("")
                && is_missing("---")
                && is_missing("-1.#IND")
                && !is_missing("0")
        );
    }
}
