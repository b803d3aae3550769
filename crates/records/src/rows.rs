//! The numbers of the columns that are used, with the row of the file each came from; what could not be read.

use crate::columns::Column;
use crate::layout::Block;
use crate::number::{Locale, clock, is_missing, value};
use crate::text::Text;
use crate::words::Role;

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
    let mut rows = Rows::default();
    let mut unread = Unread::default();
    let segments: Vec<usize> = columns.iter().filter(|c| c.role == Role::Segment).map(|c| c.index).collect();
    let of = |roles: &[Role]| columns.iter().find(|c| roles.contains(&c.role));
    let time = of(&[Role::Time]);
    let displacement = of(&[Role::Displacement, Role::Strain, Role::Stretch]);
    let force = of(&[Role::Force, Role::Stress]);
    let cameras = [of(&[Role::GripDisplacement]), of(&[Role::TearFront]), of(&[Role::WidthChange])];
    for (channel, column) in rows.camera.iter_mut().zip(cameras) {
        *channel = column.map(|_| Vec::new());
    }
    let across = [of(&[Role::DisplacementX]), of(&[Role::ForceX])];
    rows.across = across.map(|column| column.map(|_| Vec::new()));
    let mut ranges = Vec::new();
    let mut label = String::new();
    for (table, block) in blocks.iter().enumerate() {
        for k in block.rows.clone() {
            let line = text.line(k);
            if line.trim().is_empty() || line.trim_start().starts_with('#') {
                continue;
            }
            text.cells(k, delimiter, &mut ranges);
            let at = rows.row.len();
            let mut needed = |column: Option<&Column>| {
                let Some(column) = column else { return f64::NAN };
                let cell = ranges.get(column.index).map_or("", |r| &line[r.clone()]);
                number(cell, column, locale).unwrap_or_else(|| {
                    let bad = Bad {
                        at,
                        column: column.index + 1,
                        name: column.name.clone(),
                        cell: cell.chars().take(60).collect(),
                    };
                    if is_missing(cell) {
                        unread.missing.push(bad)
                    } else {
                        unread.unreadable.push(bad)
                    }
                    f64::NAN
                })
            };
            let (t, u, f) = (needed(time), needed(displacement), needed(force));
            rows.time.push(t);
            rows.displacement.push(u);
            rows.force.push(f);
            for (channel, column) in rows.across.iter_mut().zip(across) {
                channel.iter_mut().for_each(|c| c.push(needed(column)));
            }
            for (channel, column) in rows.camera.iter_mut().zip(cameras) {
                if let (Some(channel), Some(column)) = (channel, column) {
                    // A camera sees less often than the load cell: a blank is no fault.
                    let cell = ranges.get(column.index).map_or("", |r| &line[r.clone()]);
                    channel.push(if is_missing(cell) { f64::NAN } else { needed(Some(column)) });
                }
            }
            if !segments.is_empty() {
                label.clear();
                for index in &segments {
                    let cell = ranges.get(*index).map_or("", |r| line[r.clone()].trim());
                    if !label.is_empty() && !cell.is_empty() {
                        label.push(' ');
                    }
                    label.push_str(cell);
                }
                if rows.labels.len() >= MOST_LABELS {
                    rows.row.push(u32::try_from(k + 1).unwrap_or(u32::MAX));
                    rows.table.push(u32::try_from(table).unwrap_or(u32::MAX));
                    continue;
                }
                let known = rows.label.last().is_some_and(|l| rows.labels[*l as usize] == label);
                let index = if known { rows.label[at - 1] } else { index_of(&mut rows.labels, &label) };
                rows.label.push(index);
            }
            rows.row.push(u32::try_from(k + 1).unwrap_or(u32::MAX));
            rows.table.push(u32::try_from(table).unwrap_or(u32::MAX));
        }
    }
    // A name of its own in every row is a count, no name.
    if rows.label.len() != rows.row.len() {
        rows.label.clear();
        rows.labels.clear();
    }
    (rows, unread)
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
