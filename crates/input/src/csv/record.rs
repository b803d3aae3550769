//! A measured record: `time_s,displacement_mm,force_N`, a segment name and camera channels.

use super::columns::{Column, Found, header, number, right_count};
use super::sanity::sane;
use super::{Cell, Faults, cells, lines, load};
use crate::case::Record;
use crate::diagnostics::{Diagnostic, Report, Sink};
use crate::keys::plain;
use crate::text::{SourceFile, visible};
use params::Quantity::{Dimensionless, Force, Length, Time};
use std::ops::Range;
use std::path::Path;

/// Fewest rows of a record: less cannot even bend.
const FEWEST: usize = 3;
/// What was expected, for messages.
const WHAT: &str = "a record, a CSV file with the header `time_s,displacement_mm,force_N`";

const COLUMNS: [Column; 9] = [
    Column { name: "time", quantity: Time, required: true },
    Column { name: "displacement", quantity: Length, required: true },
    Column { name: "force", quantity: Force, required: true },
    Column { name: "segment", quantity: Dimensionless, required: false },
    Column { name: "grip_displacement", quantity: Length, required: false },
    Column { name: "tear_front", quantity: Length, required: false },
    Column { name: "width_change", quantity: Length, required: false },
    Column { name: "force_x", quantity: Force, required: false },
    Column { name: "displacement_x", quantity: Length, required: false },
];

/// Reads a record. Faults go to the sink; `None` if there were any.
pub(crate) fn read_record(path: &Path, sink: &Sink) -> Result<Option<Record>, Box<Diagnostic>> {
    let file = load(path, WHAT).map_err(|mut fault| {
        // Another encoding is a testing machine's.
        if fault.message.contains("UTF-") {
            fault.help = Some(import_help(path));
        }
        fault
    })?;
    sink.was_read(&file);
    let mut faults = Faults::new(&file, sink);
    let record = rows(&file, &mut faults);
    if faults.finish() {
        return Ok(None);
    }
    let Some(record) = record else { return Ok(None) };
    Ok(plausible(&file, sink, &record).then_some(record))
}

/// What to do with a file as a testing machine writes it.
fn import_help(path: &Path) -> String {
    format!(
        "`fct import {}` makes one of whatever a testing machine wrote",
        visible(&path.display().to_string())
    )
}

fn rows(file: &SourceFile, faults: &mut Faults<'_>) -> Option<Record> {
    let mut lines = lines(file);
    let Some(first) = lines.next() else {
        faults.add(Report::error(format!("only comments here; expected {WHAT}")), 0..0);
        return None;
    };
    let names = cells(file, first.clone(), faults)?;
    let Some(found) = header(&names, &COLUMNS, faults) else {
        let report = Report::error("this is no record as `fct` takes it").help(import_help(&file.path));
        faults.sink.push(report.about(file.path.clone()));
        return None;
    };
    let mut reader = Rows::new(file, &found);
    for line in lines {
        if let Some(row) = cells(file, line.clone(), faults)
            && right_count(&row, names.len(), faults)
        {
            reader.row(&row, line, faults);
        }
    }
    if reader.seen < FEWEST && !faults.any() {
        let rows = if reader.seen == 1 { "row" } else { "rows" };
        let message = format!("the record has {} {rows}; expected at least {FEWEST}", reader.seen);
        faults.add(Report::error(message), first);
    }
    Some(reader.record)
}

/// Fills a record row by row.
struct Rows<'a> {
    file: &'a SourceFile,
    found: &'a [Option<Found>],
    record: Record,
    seen: usize,
    /// Time of the last good row and where it stands.
    last: Option<(f64, usize)>,
}

impl<'a> Rows<'a> {
    fn new(file: &'a SourceFile, found: &'a [Option<Found>]) -> Self {
        let camera = |k: usize| found[k].as_ref().map(|_| Vec::new());
        let record = Record {
            path: crate::case::absolute(&file.path),
            segment: found[3].as_ref().map(|_| Vec::new()),
            grip_displacement: camera(4),
            tear_front: camera(5),
            width_change: camera(6),
            force_x: camera(7),
            displacement_x: found[8].as_ref().map(|_| Vec::new()),
            ..Record::default()
        };
        Self { file, found, record, seen: 0, last: None }
    }

    fn row(&mut self, row: &[Cell<'_>], line: Range<usize>, faults: &mut Faults<'_>) {
        self.seen += 1;
        let mut needed = |k: usize| {
            let column = self.found[k].as_ref()?;
            number(&row[column.index], column, faults)
        };
        let (time, displacement, force) = (needed(0), needed(1), needed(2));
        if let Some(t) = time {
            self.check_time(t, row, line, faults);
        }
        self.record.time.extend(time);
        self.record.displacement.extend(displacement);
        self.record.force.extend(force);
        if let (Some(column), Some(segment)) = (&self.found[3], &mut self.record.segment) {
            segment.push(row[column.index].text.trim().to_owned());
        }
        if let (Some(column), Some(across)) = (&self.found[8], &mut self.record.displacement_x) {
            across.extend(number(&row[column.index], column, faults));
        }
        for (column, channel) in self.found[4..8].iter().zip(self.record.measured_beside()) {
            if let (Some(column), Some(channel)) = (column, channel) {
                let cell = &row[column.index];
                let measured = !cell.text.is_empty();
                channel.push(if measured { number(cell, column, faults) } else { None });
            }
        }
    }

    fn check_time(&mut self, t: f64, row: &[Cell<'_>], line: Range<usize>, faults: &mut Faults<'_>) {
        let Some(column) = &self.found[0] else { return };
        if let Some((last, at)) = self.last
            && t <= last
        {
            let cell = &row[column.index];
            let before = self.file.line_column(at).0;
            let (last, name) = (plain(last / column.factor), &column.written);
            let message = format!(
                "`{name}` (field {}) is {}; expected more than {last}, the time in line {before}: time must increase",
                column.index + 1,
                cell.text
            );
            faults.add(Report::error(message).key(name.as_str()), cell.span.clone());
            return;
        }
        self.last = Some((t, line.start));
    }
}

/// Rough noise of a displacement: the median second difference. A clean motion has none, but at its corners.
fn encoder_noise(u: &[f64]) -> f64 {
    let mut misses: Vec<f64> = u.windows(3).map(|w| (w[0] - 2.0 * w[1] + w[2]).abs()).collect();
    let middle = misses.len() / 2;
    if misses.is_empty() {
        0.0
    } else {
        *misses.select_nth_unstable_by(middle, f64::total_cmp).1 / 6f64.sqrt()
    }
}

/// What no single row shows: a displacement that never moves, one that does not start at 0, a camera channel without a
/// single value.
fn plausible(file: &SourceFile, sink: &Sink, record: &Record) -> bool {
    let u = &record.displacement;
    let (low, high) = u.iter().fold((f64::MAX, f64::MIN), |(l, h), &x| (l.min(x), h.max(x)));
    let mut good = sane(file, sink, record);
    if high <= low {
        let report = Report::error(format!(
            "displacement is {} mm in every row; expected a test that moves",
            plain(low)
        ));
        sink.push(report.key("displacement").about(file.path.clone()));
        good = false;
    } else if u[0].abs() > (1e-3 * (high - low)).max((5.0 * encoder_noise(u)).min(0.01 * (high - low))) {
        let report = Report::error(format!(
            "displacement starts at {} mm; expected 0, where the test begins",
            plain(u[0])
        ));
        let help = "`fct import FILE --zero` subtracts it; a strip that was pulled before the record began (a pre-load, a \
                    second test that goes on where the first ended) keeps its force at displacement 0";
        sink.push(report.key("displacement").help(help).about(file.path.clone()));
        good = false;
    }
    let cameras = [
        ("grip_displacement_mm", &record.grip_displacement),
        ("tear_front_mm", &record.tear_front),
        ("width_change_mm", &record.width_change),
        ("force_x_N", &record.force_x),
    ];
    for (name, channel) in cameras {
        if channel.as_ref().is_some_and(|c| c.iter().all(Option::is_none)) {
            let report = Report::error(format!("column `{name}` is empty in every row; leave it out"));
            sink.push(report.key(name).about(file.path.clone()));
            good = false;
        }
    }
    good
}
