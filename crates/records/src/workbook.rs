//! Workbooks: one sheet becomes lines of tab-separated cells, so that all that follows is the same as for text.

use crate::error::Question;
use calamine::{Data, Ods, Reader, Xls, Xlsx, open_workbook_from_rs};
use std::fmt::Write;
use std::io::Cursor;

/// Most columns of a sheet.
const MOST_COLUMNS: usize = 512;
/// Most cells of a sheet that are kept.
const MOST_CELLS: usize = 40_000_000;

/// A sheet as text.
#[derive(Debug)]
pub(crate) struct Sheet {
    /// Its name.
    pub name: String,
    /// Lines of tab-separated cells; row numbers are those of the sheet.
    pub text: String,
    /// Whether cells hold numbers (not text that looks like them): then the decimal mark is a point.
    pub numbers: bool,
}

/// Why there is no sheet.
#[derive(Debug)]
pub(crate) enum Unopened {
    /// The file is damaged or too large.
    Bad(String),
    /// Several sheets, or none of that name.
    Ask(Question),
}

/// Reads the sheet that is said, or the only one that holds a table.
pub(crate) fn read(bytes: Vec<u8>, said: Option<&str>) -> Result<Sheet, Unopened> {
    let zip = bytes.starts_with(b"PK");
    let holds = |name: &[u8]| bytes.windows(name.len()).take(70_000).any(|w| w == name);
    let ods = zip && holds(b"opendocument");
    let cursor = Cursor::new(bytes);
    // A library's panic on a damaged file must not be the user's.
    let opened = std::panic::catch_unwind(|| {
        let bad = |e: &dyn std::fmt::Display| Unopened::Bad(format!("the workbook cannot be opened: {e}"));
        if ods {
            let mut book: Ods<_> = open_workbook_from_rs(cursor).map_err(|e: calamine::OdsError| bad(&e))?;
            choose(&mut book, said, dense)
        } else if zip {
            let mut book: Xlsx<_> =
                open_workbook_from_rs(cursor).map_err(|e: calamine::XlsxError| bad(&e))?;
            choose(&mut book, said, sparse)
        } else {
            let mut book: Xls<_> = open_workbook_from_rs(cursor).map_err(|e: calamine::XlsError| bad(&e))?;
            choose(&mut book, said, dense)
        }
    });
    opened.unwrap_or_else(|_| Err(Unopened::Bad("the workbook is damaged; save it anew, or as CSV".into())))
}

/// Rows of a sheet.
type Cells = Vec<Vec<Data>>;

fn choose<B: Reader<Cursor<Vec<u8>>>>(
    book: &mut B,
    said: Option<&str>,
    rows_of: fn(&mut B, &str) -> Result<Cells, String>,
) -> Result<Sheet, Unopened> {
    let names = book.sheet_names();
    let listed = |names: &[(usize, String)]| {
        names.iter().map(|(k, n)| ((k + 1).to_string(), format!("`{}`", crate::error::visible(n)))).collect()
    };
    if let Some(said) = said {
        let by_name = names.iter().position(|n| n == said);
        let by_number = said.parse::<usize>().ok().filter(|n| (1..=names.len()).contains(n)).map(|n| n - 1);
        let Some(k) = by_name.or(by_number) else {
            let all: Vec<_> = names.into_iter().enumerate().collect();
            let what = format!("no sheet `{}`", crate::error::visible(said));
            return Err(Unopened::Ask(Question::new("sheet", what, listed(&all))));
        };
        return rows_of(book, &names[k]).map(|rows| sheet(&names[k], &rows)).map_err(Unopened::Bad);
    }
    let mut tables = Vec::new();
    for (k, name) in names.iter().enumerate() {
        let rows = rows_of(book, name).map_err(Unopened::Bad)?;
        // A table of a record: rows with two numbers.
        if rows.iter().filter(|r| r.iter().filter(|c| is_number(c)).count() > 1).count()
            >= crate::layout::FEWEST
        {
            tables.push((k, sheet(name, &rows)));
        }
    }
    match tables.len() {
        0 => Err(Unopened::Bad(format!("none of the {} sheets holds a table of numbers", names.len()))),
        1 => Ok(tables.remove(0).1),
        n => {
            let some: Vec<_> = tables.iter().map(|(k, s)| (*k, s.name.clone())).collect();
            let what = format!("{n} sheets hold a table");
            Err(Unopened::Ask(Question::new("sheet", what, listed(&some))))
        }
    }
}

fn is_number(cell: &Data) -> bool {
    match cell {
        Data::Int(_) | Data::Float(_) => true,
        Data::String(s) => crate::number::looks_numeric(s),
        _ => false,
    }
}

/// Cells as the file lists them: one far away costs nothing.
fn sparse(book: &mut Xlsx<Cursor<Vec<u8>>>, name: &str) -> Result<Cells, String> {
    let bad = |e: calamine::XlsxError| format!("sheet `{}` cannot be read: {e}", crate::error::visible(name));
    let mut reader = book.worksheet_cells_reader(name).map_err(bad)?;
    let (mut rows, mut count): (Cells, usize) = (Vec::new(), 0);
    while let Some(cell) = reader.next_cell().map_err(bad)? {
        let (row, column) = cell.get_position();
        let (row, column) = (row as usize, column as usize);
        let value: Data = cell.get_value().clone().into();
        if column >= MOST_COLUMNS || matches!(value, Data::Empty) {
            continue;
        }
        count += 1;
        // A row far below the rest is no row of a record; without this one cell would cost a million empty ones.
        if count > MOST_CELLS || row > rows.len() + 100_000 {
            return Err(format!(
                "sheet `{}` is too large or has a cell far from all others",
                crate::error::visible(name)
            ));
        }
        if rows.len() <= row {
            rows.resize(row + 1, Vec::new());
        }
        if rows[row].len() <= column {
            rows[row].resize(column + 1, Data::Empty);
        }
        rows[row][column] = value;
    }
    Ok(rows)
}

fn dense<B: Reader<Cursor<Vec<u8>>>>(book: &mut B, name: &str) -> Result<Cells, String>
where
    B::Error: std::fmt::Display,
{
    let range = book.worksheet_range(name).map_err(|e| format!("a sheet cannot be read: {e}"))?;
    let (height, width) = range.get_size();
    if height.saturating_mul(width) > MOST_CELLS {
        return Err("the sheet is too large".into());
    }
    let (top, left) = range.start().unwrap_or((0, 0));
    let mut rows = vec![Vec::new(); (top as usize).min(100_000)];
    rows.extend(range.rows().map(|r| {
        let mut row = vec![Data::Empty; (left as usize).min(MOST_COLUMNS)];
        row.extend(r.iter().take(MOST_COLUMNS).cloned());
        row
    }));
    Ok(rows)
}

fn sheet(name: &str, rows: &Cells) -> Sheet {
    let (mut text, mut numbers) = (String::new(), false);
    let width = rows.iter().map(Vec::len).max().unwrap_or(0);
    for row in rows {
        for k in 0..width {
            if k > 0 {
                text.push('\t');
            }
            match row.get(k) {
                Some(Data::Float(x)) => {
                    numbers = true;
                    let _ = write!(text, "{x}");
                }
                Some(Data::Int(i)) => {
                    let _ = write!(text, "{i}");
                }
                Some(Data::DateTime(d)) => {
                    let _ = write!(text, "{d}");
                }
                Some(Data::String(s) | Data::DateTimeIso(s) | Data::DurationIso(s)) => {
                    text.extend(s.chars().map(|c| if c.is_control() { ' ' } else { c }));
                }
                Some(Data::Bool(b)) => {
                    let _ = write!(text, "{b}");
                }
                Some(Data::Error(_)) => text.push_str("#N/A"),
                Some(Data::Empty) | None => {}
            }
        }
        text.push('\n');
    }
    Sheet { name: name.to_owned(), text, numbers }
}
