//! A text as lines of cells: line endings of three systems, quotes, any delimiter. Rows keep their number.

use std::ops::Range;

/// A text and where its lines are.
#[derive(Debug)]
pub(crate) struct Text {
    text: String,
    lines: Vec<Range<usize>>,
}

impl Text {
    /// Cuts at CRLF, LF or a lone CR; NULs at the ends of lines (WinTest) are no part of them.
    pub fn new(text: String) -> Self {
        let bytes = text.as_bytes();
        let (mut lines, mut start, mut at) = (Vec::new(), 0, 0);
        while at < bytes.len() {
            if bytes[at] == b'\n' || bytes[at] == b'\r' {
                lines.push(start..at);
                at += usize::from(bytes[at] == b'\r' && bytes.get(at + 1) == Some(&b'\n'));
                start = at + 1;
            }
            at += 1;
        }
        if start < bytes.len() {
            lines.push(start..bytes.len());
        }
        Self { text, lines }
    }

    /// Number of lines.
    pub fn len(&self) -> usize {
        self.lines.len()
    }

    /// A line without its end, from 0.
    pub fn line(&self, k: usize) -> &str {
        let line = &self.text[self.lines[k].clone()];
        line.trim_end_matches('\0')
    }

    /// Line and the cells in it.
    pub fn cells(&self, k: usize, delimiter: char, into: &mut Vec<Range<usize>>) -> &str {
        let line = self.line(k);
        cut(line, delimiter, into);
        line
    }

    /// The cells of a line as texts of their own.
    pub fn row(&self, k: usize, delimiter: char) -> Vec<String> {
        let mut ranges = Vec::new();
        let line = self.cells(k, delimiter, &mut ranges);
        ranges.into_iter().map(|r| line[r].replace("\"\"", "\"")).collect()
    }
}

/// Cuts a line into cells: without outer blanks and quotes. A quote that is not closed before the next delimiter or
/// the end of the line is a sign like any other (5" jaws). Blanks as delimiter: runs count as one.
pub(crate) fn cut(line: &str, delimiter: char, into: &mut Vec<Range<usize>>) {
    into.clear();
    if delimiter == ' ' {
        return blanks(line, into);
    }
    let bytes = line.as_bytes();
    let mut at = 0;
    loop {
        let start = at + bytes[at..].iter().take_while(|b| **b == b' ').count();
        if bytes.get(start) == Some(&b'"')
            && let Some((inside, next)) = quoted(line, start, delimiter)
        {
            into.push(inside);
            match next {
                Some(next) => at = next,
                None => return,
            }
            continue;
        }
        let end = line[at..].find(delimiter).map_or(line.len(), |n| at + n);
        into.push(trimmed(line, at..end));
        if end == line.len() {
            return;
        }
        at = end + delimiter.len_utf8();
    }
}

/// The inside of a quoted cell, and where the next one begins.
fn quoted(line: &str, start: usize, delimiter: char) -> Option<(Range<usize>, Option<usize>)> {
    let mut at = start + 1;
    loop {
        let close = at + line[at..].find('"')?;
        if line[close + 1..].starts_with('"') {
            at = close + 2;
            continue;
        }
        let rest = line[close + 1..].trim_start_matches(' ');
        let inside = trimmed(line, start + 1..close);
        if rest.is_empty() {
            return Some((inside, None));
        }
        let next = line.len() - rest.len();
        return rest.starts_with(delimiter).then(|| (inside, Some(next + delimiter.len_utf8())));
    }
}

fn blanks(line: &str, into: &mut Vec<Range<usize>>) {
    let mut at = 0;
    while at < line.len() {
        let rest = &line[at..];
        let skipped = rest.len() - rest.trim_start_matches([' ', '\t']).len();
        at += skipped;
        if at >= line.len() {
            return;
        }
        if line[at..].starts_with('"')
            && let Some(n) = line[at + 1..].find('"')
        {
            into.push(at + 1..at + 1 + n);
            at += n + 2;
            continue;
        }
        let end = line[at..].find([' ', '\t']).map_or(line.len(), |n| at + n);
        into.push(at..end);
        at = end;
    }
}

fn trimmed(line: &str, range: Range<usize>) -> Range<usize> {
    let text = &line[range.clone()];
    let front = text.len() - text.trim_start().len();
    let start = (range.start + front).min(range.end);
    start..start + text.trim().len()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(line: &str, delimiter: char) -> Vec<String> {
        Text::new(line.to_owned()).row(0, delimiter)
    }

    #[test]
    fn lines_end_in_three_ways() {
        for text in ["a\nb\nc", "a\r\nb\r\nc\r\n", "a\rb\rc\r", "a\0\r\nb\nc\n"] {
            let text = Text::new(text.to_owned());
            let lines: Vec<&str> = (0..text.len()).map(|k| text.line(k)).collect();
            assert_eq!(lines, ["a", "b", "c"]);
        }
        assert_eq!(Text::new("a\n\n\nb".into()).len(), 4);
    }

    #[test]
    fn cells_lose_blanks_and_quotes() {
        assert_eq!(row("a, b ,,\"c,d\" ,\"e\"\"f\"", ','), ["a", "b", "", "c,d", "e\"f"]);
        assert_eq!(row("\"Jaws 5\" wide\";2;", ';'), ["\"Jaws 5\" wide\"", "2", ""]);
        assert_eq!(row("  1.5\t 2   3 ", ' '), ["1.5", "2", "3"]);
        assert_eq!(row("\"a b\" c", ' '), ["a b", "c"]);
        assert_eq!(row("1\t\t3", '\t'), ["1", "", "3"]);
    }
}
