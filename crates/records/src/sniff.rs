//! What stands between cells, and what the decimal mark is: counted over the rows, asked where both would do.

use crate::error::Question;
use crate::number::{Evidence, evidence, is_missing, looks_numeric};
use crate::text::{Text, cut};

/// Delimiters, most telling first.
const DELIMITERS: [(char, &str); 5] =
    [('\t', "tab"), (';', "semicolon"), (',', "comma"), ('|', "bar"), (' ', "blanks")];
/// Lines that are looked at.
const LOOKED_AT: usize = 400;

/// The name of a delimiter.
pub(crate) fn name(delimiter: char) -> &'static str {
    DELIMITERS.iter().find(|d| d.0 == delimiter).map_or("other", |d| d.1)
}

/// What separates cells.
///
/// # Errors
/// A question if two would do equally well; `None` in it if none does.
pub(crate) fn delimiter(text: &Text) -> Result<char, Option<Question>> {
    // The rows are at the end; the header may be anything.
    let lines: Vec<&str> = {
        let all: Vec<usize> = (0..text.len()).filter(|&k| !text.line(k).trim().is_empty()).collect();
        let step = (all.len() / (2 * LOOKED_AT)).max(1);
        let half = if all.len() > 20 { all.len() / 3 } else { 0 };
        all[half..].iter().step_by(step).map(|&k| text.line(k)).take(2 * LOOKED_AT).collect()
    };
    let mut scores: Vec<(f64, usize, char)> = Vec::new();
    let mut ranges = Vec::new();
    for (delimiter, _) in DELIMITERS {
        let mut counts: Vec<(usize, usize)> = Vec::new();
        for line in &lines {
            cut(line, delimiter, &mut ranges);
            let cells = ranges.iter().map(|r| &line[r.clone()]);
            let numeric = cells.filter(|c| looks_numeric(c)).count();
            counts.push((ranges.len(), numeric));
        }
        // Rows of the most frequent length that have at least two numbers.
        let mut lengths: Vec<usize> = counts.iter().filter(|c| c.1 > 1).map(|c| c.0).collect();
        lengths.sort_unstable();
        let runs = lengths.chunk_by(|a, b| a == b).map(|r| (r.len(), r[0]));
        let Some((rows, width)) = runs.max() else { continue };
        let numbers: usize = counts.iter().filter(|c| c.0 == width && c.1 > 1).map(|c| c.1).sum();
        let filled = numbers as f64 / (rows * width) as f64;
        scores.push((rows as f64 / lines.len().max(1) as f64 * filled.max(0.3), width, delimiter));
    }
    scores.sort_by(|a, b| b.0.total_cmp(&a.0));
    let Some(best) = scores.first() else { return Err(None) };
    let rivals: Vec<_> = scores.iter().filter(|s| s.0 > 0.9 * best.0).collect();
    // Blanks that only follow another delimiter, and groups of thousands, are no rivals.
    let rivals: Vec<_> = rivals.iter().filter(|s| s.2 != ' ' || rivals.len() == 1).collect();
    if rivals.len() < 2 {
        return Ok(rivals.first().map_or(best.2, |s| s.2));
    }
    // `0,5;1,2`: cut at the comma the cells `5;1` are no numbers, so this happens only where really both would do.
    let options = rivals
        .iter()
        .map(|s| (if s.2 == '\t' { "tab".to_owned() } else { s.2.to_string() }, format!("{} columns", s.1)))
        .collect();
    Err(Some(Question::new("delimiter", "the cells can be separated in several ways", options)))
}

/// Counts of what cells say about the decimal mark.
#[derive(Debug, Default)]
pub(crate) struct Marks {
    point: usize,
    comma: usize,
    either_point: usize,
    either_comma: usize,
}

impl Marks {
    /// Counts a cell.
    pub fn add(&mut self, cell: &str) {
        if is_missing(cell) || !looks_numeric(cell) {
            return;
        }
        match evidence(cell) {
            Evidence::Silent => {}
            Evidence::Point => self.point += 1,
            Evidence::Comma => self.comma += 1,
            Evidence::EitherPoint => self.either_point += 1,
            Evidence::EitherComma => self.either_comma += 1,
        }
    }

    /// The decimal mark, and why; `None` where no cell has a mark.
    ///
    /// # Errors
    /// A question where the cells contradict each other, or none of them decides.
    pub fn decide(&self, delimiter: char) -> Result<Option<(char, String)>, Question> {
        let both = |what: String| {
            let options = vec![
                (".".into(), "1.500 is one and a half".into()),
                (",".into(), "1,500 is one and a half".into()),
            ];
            Question::new("decimal", what, options)
        };
        match (self.point, self.comma) {
            (0, 0) if self.either_point == 0 && self.either_comma == 0 => Ok(None),
            // A cell of a file with commas between its cells holds none, unless quoted.
            (0, 0) if delimiter == ',' && self.either_comma == 0 => {
                Ok(Some(('.', "the comma separates cells".into())))
            }
            (0, 0) => {
                let mark = if self.either_comma > 0 { "1,234" } else { "1.234" };
                Err(both(format!(
                    "the decimal mark cannot be told: every number with a mark is like {mark}, which may also be thousands"
                )))
            }
            (n, 0) => Ok(Some(('.', format!("{n} numbers have a decimal point, none a comma")))),
            (0, n) => Ok(Some((',', format!("{n} numbers have a decimal comma, none a point")))),
            (p, c) => Err(both(format!("{p} numbers have a decimal point, {c} a decimal comma"))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str) -> Result<char, Option<Question>> {
        delimiter(&Text::new(text.to_owned()))
    }

    #[test]
    fn delimiters_are_found_among_decimal_commas_and_thousands() {
        let rows = |row: &str| format!("a header, of; words\n{}", format!("{row}\n").repeat(8));
        for (row, expected) in [
            ("0.1,0.2,0.3", ','),
            ("0,1;0,2;0,3", ';'),
            ("0,1\t0,2\t0,3", '\t'),
            ("0,1 0,2 0,3", ' '),
            ("1 234,5;2 345,6;1", ';'),
            ("\"0,1\",\"0,2\",\"0,3\"", ','),
            ("a b,1-Hold,200,9.1,-0.2", ','),
            ("0.1, 0.2, 0.3", ','),
            ("1.5|2.5", '|'),
        ] {
            assert_eq!(of(&rows(row)), Ok(expected), "{row}");
        }
        assert_eq!(of("no table\nat all\n"), Err(None));
    }

    #[test]
    fn decimal_marks_are_found_or_asked_for() {
        let told = |cells: &[&str], delimiter| {
            let mut marks = Marks::default();
            cells.iter().for_each(|c| marks.add(c));
            marks.decide(delimiter).map(|d| d.map(|d| d.0)).map_err(|q| q.flag)
        };
        assert_eq!(told(&["1", "2"], ';'), Ok(None));
        assert_eq!(told(&["0,125", "1,250"], ';'), Ok(Some(',')));
        assert_eq!(told(&["1,250", "1,234.5"], ';'), Ok(Some('.')));
        assert_eq!(told(&["1.250", "2.500"], ','), Ok(Some('.')));
        assert_eq!(told(&["1.250", "2.500"], ';'), Err("decimal".into()));
        assert_eq!(told(&["1,250", "2,500"], '\t'), Err("decimal".into()));
        assert_eq!(told(&["1,25", "2.5"], ';'), Err("decimal".into()));
    }
}
