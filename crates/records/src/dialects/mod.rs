//! What is known of the programs that write records: one file each. A dialect only adds to what the file itself says:
//! a mark that it declares, a column that it prefers, units that it leaves out.

mod bluehill;
mod canonical;
mod cellscale;
mod deben;
mod microtester;
mod mts;
mod testxpert;
mod wintest;

use crate::text::Text;
use crate::words::{Role, fold};

/// What a dialect knows.
#[derive(Clone, Debug, Default)]
pub(crate) struct Hints {
    /// Between cells.
    pub delimiter: Option<char>,
    /// The decimal mark.
    pub decimal: Option<char>,
    /// Names (folded) of columns beyond the common ones, or preferred among several.
    pub columns: &'static [(Role, &'static str)],
    /// Units of columns that carry none.
    pub units: &'static [(Role, &'static str)],
    /// What the user should know.
    pub remarks: &'static [&'static str],
}

/// A program that writes records.
pub(crate) struct Dialect {
    /// Its name.
    pub name: &'static str,
    /// Whether it wrote these first lines.
    wrote: fn(&[&str]) -> bool,
    /// What is known of it.
    hints: fn(&[&str]) -> Hints,
}

const ALL: [Dialect; 8] = [
    canonical::DIALECT,
    mts::DIALECT,
    bluehill::DIALECT,
    testxpert::DIALECT,
    cellscale::DIALECT,
    microtester::DIALECT,
    wintest::DIALECT,
    deben::DIALECT,
];

/// Lines that are looked at.
const HEAD: usize = 120;

/// The dialect of a text, and what is known of it.
pub(crate) fn recognise(text: &Text) -> (&'static str, Hints) {
    let head: Vec<&str> = (0..text.len().min(HEAD)).map(|k| text.line(k)).collect();
    match ALL.iter().find(|d| (d.wrote)(&head)) {
        Some(dialect) => (dialect.name, (dialect.hints)(&head)),
        None => ("generic", Hints::default()),
    }
}

/// Whether one line holds all these names, folded.
fn a_line_holds(head: &[&str], names: &[&str]) -> bool {
    head.iter().filter(|l| l.len() < 4000).any(|line| {
        let folded = format!(" {} ", fold(line));
        names.iter().all(|n| folded.contains(&format!(" {n} ")))
    })
}
