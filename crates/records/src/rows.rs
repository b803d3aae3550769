//! The numbers of the columns that are used, with the row of the file each came from; what could not be read.

use crate::columns::Column;
use crate::layout::Block;
use crate::number::{Locale, clock, is_missing, value};
use crate::text::Text;
use crate::words::Role;
use std::ops::Range;

/// More names of segments than that are no names.
const MOST_LABELS: usize = 2000;

/// Numbers in internal units: mm, s, N, MPa. NaN: not there. All columns have one entry per row.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Rows {
    /// Row of the file, from 1.
    pub row: Vec<u32>,
    /// Table of the file, from 0.
    pub table: Vec<u32>,
    /// Time, or NaN everywhere.
    pub time: Vec<f64>,
    /// Displacement (or strain, or stretch).
    pub displacement: Vec<f64>,
    /// Force (or stress).
    pub force: Vec<f64>,
    /// Camera channels that the file has: clamps, tear, width.
    pub camera: [Option<Vec<f64>>; 3],
    /// Along x, where a second actuator pulls there: its displacement, the force of its load cell.
    pub across: [Option<Vec<f64>>; 2],
    /// Index into `labels`; empty without segments.
    pub label: Vec<u32>,
    /// Names of segments, in their order.
    pub labels: Vec<String>,
}

/// A cell that is no number.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Bad {
    /// Index among the rows.
    pub at: usize,
    /// Column of the file, from 1.
    pub column: usize,
    /// Name of the column.
    pub name: String,
    /// What stands there; empty: nothing.
    pub cell: String,
}

/// Cells that were not read.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Unread {
    /// Blank, NaN, a sign for overload.
    pub missing: Vec<Bad>,
    /// Text.
    pub unreadable: Vec<Bad>,
}

/// Reads the rows of tables with the same columns.
pub(crate) fn read(
    text: &Text,
    delimiter: char,
    blocks: &[&Block],
    columns: &[Column],
    locale: Locale,
) -> (Rows, Unread) {
    let mut reading = Reading::of(columns, locale);
    let mut cells = Vec::new();
    for (table, block) in blocks.iter().enumerate() {
        for k in block.rows.clone() {
            let line = text.line(k);
            if line.trim().is_empty() || line.trim_start().starts_with('#') {
                continue;
            }
            text.cells(k, delimiter, &mut cells);
            reading.row(&Line { text: line, cells: &cells });
            reading.rows.row.push(u32::try_from(k + 1).unwrap_or(u32::MAX));
            reading.rows.table.push(u32::try_from(table).unwrap_or(u32::MAX));
        }
    }
    let Reading { mut rows, unread, .. } = reading;
    // A name of its own in every row is a count, no name.
    if rows.label.len() != rows.row.len() {
        rows.label.clear();
        rows.labels.clear();
    }
    (rows, unread)
}

/// A line, and where its cells stand.
struct Line<'a> {
    text: &'a str,
    cells: &'a [Range<usize>],
}

impl<'a> Line<'a> {
    /// Empty where the line ends before it.
    fn cell(&self, index: usize) -> &'a str {
        self.cells.get(index).map_or("", |r| &self.text[r.clone()])
    }
}

/// Columns by what is read from them, and what was read so far.
struct Reading<'a> {
    time: Option<&'a Column>,
    displacement: Option<&'a Column>,
    force: Option<&'a Column>,
    camera: [Option<&'a Column>; 3],
    across: [Option<&'a Column>; 2],
    segments: Vec<usize>,
    locale: Locale,
    label: String,
    rows: Rows,
    unread: Unread,
}

impl<'a> Reading<'a> {
    fn of(columns: &'a [Column], locale: Locale) -> Self {
        let of = |roles: &[Role]| columns.iter().find(|c| roles.contains(&c.role));
        let camera = [of(&[Role::GripDisplacement]), of(&[Role::TearFront]), of(&[Role::WidthChange])];
        let across = [of(&[Role::DisplacementX]), of(&[Role::ForceX])];
        Self {
            time: of(&[Role::Time]),
            displacement: of(&[Role::Displacement, Role::Strain, Role::Stretch]),
            force: of(&[Role::Force, Role::Stress]),
            camera,
            across,
            segments: columns.iter().filter(|c| c.role == Role::Segment).map(|c| c.index).collect(),
            locale,
            label: String::new(),
            rows: Rows {
                camera: camera.map(|column| column.map(|_| Vec::new())),
                across: across.map(|column| column.map(|_| Vec::new())),
                ..Rows::default()
            },
            unread: Unread::default(),
        }
    }

    fn row(&mut self, line: &Line) {
        let [t, u, f] = [self.time, self.displacement, self.force].map(|c| self.needed(line, c));
        self.rows.time.push(t);
        self.rows.displacement.push(u);
        self.rows.force.push(f);
        for (channel, column) in self.across.into_iter().enumerate() {
            let value = self.needed(line, column);
            self.rows.across[channel].iter_mut().for_each(|c| c.push(value));
        }
        for (channel, column) in self.camera.into_iter().enumerate() {
            // A camera sees less often than the load cell: a blank is no fault.
            let blank = column.is_none_or(|c| is_missing(line.cell(c.index)));
            let value = if blank { f64::NAN } else { self.needed(line, column) };
            self.rows.camera[channel].iter_mut().for_each(|c| c.push(value));
        }
        if !self.segments.is_empty() {
            self.name(line);
        }
    }

    /// The number of a cell; what is none is noted.
    fn needed(&mut self, line: &Line, column: Option<&Column>) -> f64 {
        let Some(column) = column else { return f64::NAN };
        let cell = line.cell(column.index);
        number(cell, column, self.locale).unwrap_or_else(|| {
            let list = if is_missing(cell) { &mut self.unread.missing } else { &mut self.unread.unreadable };
            list.push(Bad {
                at: self.rows.row.len(),
                column: column.index + 1,
                name: column.name.clone(),
                cell: cell.chars().take(60).collect(),
            });
            f64::NAN
        })
    }

    /// The name of the row's segment, as long as there are not too many.
    fn name(&mut self, line: &Line) {
        if self.rows.labels.len() >= MOST_LABELS {
            return;
        }
        self.label.clear();
        for index in &self.segments {
            let cell = line.cell(*index).trim();
            if !self.label.is_empty() && !cell.is_empty() {
                self.label.push(' ');
            }
            self.label.push_str(cell);
        }
        let last = self.rows.label.last().copied();
        let known = last.filter(|l| self.rows.labels[*l as usize] == self.label);
        let index = known.unwrap_or_else(|| index_of(&mut self.rows.labels, &self.label));
        self.rows.label.push(index);
    }
}

fn index_of(labels: &mut Vec<String>, label: &str) -> u32 {
    let at = labels.iter().rposition(|l| l == label).unwrap_or_else(|| {
        labels.push(label.to_owned());
        labels.len() - 1
    });
    u32::try_from(at).unwrap_or(u32::MAX)
}

/// The number of a cell in the internal unit.
fn number(cell: &str, column: &Column, locale: Locale) -> Option<f64> {
    if column.role == Role::Time && cell.contains(':') {
        return clock(cell, locale);
    }
    let x = value(cell, locale, column.unit.exponent)?;
    let x = if column.unit.factor == 1.0 { x } else { x * column.unit.factor };
    x.is_finite().then_some(x)
}

impl Rows {
    /// Number of rows.
    pub fn len(&self) -> usize {
        self.row.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.row.is_empty()
    }

    /// Force, displacement and what the force is called, along y and, if there is a second axis, along x.
    pub(crate) fn axes(&self) -> Vec<(&[f64], &[f64], &'static str)> {
        let mut out = vec![(self.force.as_slice(), self.displacement.as_slice(), "force")];
        if let [Some(displacement), Some(force)] = &self.across {
            out.push((force, displacement, "force along x"));
        }
        out
    }

    /// Forces and displacements with their names.
    pub(crate) fn named(&self) -> Vec<(&[f64], &'static str)> {
        let mut out = vec![(self.force.as_slice(), "force"), (self.displacement.as_slice(), "displacement")];
        if let [Some(displacement), Some(force)] = &self.across {
            out.extend([
                (force.as_slice(), "force along x"),
                (displacement.as_slice(), "displacement along x"),
            ]);
        }
        out
    }

    /// Keeps the rows that are marked.
    pub fn keep(&mut self, marked: &[bool]) {
        fn some<T: Copy>(all: &mut Vec<T>, marked: &[bool]) {
            let mut k = 0;
            all.retain(|_| {
                k += 1;
                marked.get(k - 1).copied().unwrap_or(false)
            });
        }
        some(&mut self.row, marked);
        some(&mut self.table, marked);
        some(&mut self.time, marked);
        some(&mut self.displacement, marked);
        some(&mut self.force, marked);
        some(&mut self.label, marked);
        self.camera.iter_mut().chain(&mut self.across).flatten().for_each(|c| some(c, marked));
    }

    /// Some rows in a row.
    pub fn part(&self, range: std::ops::Range<usize>) -> Self {
        Self {
            row: self.row[range.clone()].to_vec(),
            table: self.table[range.clone()].to_vec(),
            time: self.time[range.clone()].to_vec(),
            displacement: self.displacement[range.clone()].to_vec(),
            force: self.force[range.clone()].to_vec(),
            camera: self.camera.clone().map(|c| c.map(|c| c[range.clone()].to_vec())),
            across: self.across.clone().map(|c| c.map(|c| c[range.clone()].to_vec())),
            label: if self.label.is_empty() { Vec::new() } else { self.label[range].to_vec() },
            labels: self.labels.clone(),
        }
    }
}
