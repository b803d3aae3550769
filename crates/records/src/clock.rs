//! The clock of a file: rows that it repeats or puts out of order, and the parts between its starts.

use crate::choices::{Choices, FaultKind, Restart};
use crate::error::Question;
use crate::faults::{Found, counted, found};
use crate::noise;
use crate::rows::Rows;

/// Rows that may stand before the clock goes on.
const HICCUP: usize = 3;

/// Parts of a file between starts of its clock, each with strictly increasing time.
///
/// # Errors
/// A question where the clock starts again and the user has not said what that means.
pub(crate) fn parts(rows: &mut Rows, choices: &Choices, out: &mut Vec<Found>) -> Result<Vec<Rows>, Question> {
    let walk = Walk::along(rows);
    walk.tell(out);
    if walk.starts.len() > 1 && choices.restart.is_none() {
        return Err(walk.what_of_the_starts(rows));
    }
    // Positions of the starts among the rows that stay.
    let kept_before = |at: usize| walk.keep[..at].iter().filter(|k| **k).count();
    let ends = walk.starts.iter().copied().chain([rows.len()]);
    let bounds: Vec<usize> = ends.map(kept_before).collect();
    rows.keep(&walk.keep);
    if walk.starts.len() > 1 && choices.restart == Some(Restart::Append) {
        append(rows, &bounds);
        return Ok(vec![std::mem::take(rows)]);
    }
    Ok(bounds.windows(2).map(|w| rows.part(w[0]..w[1])).collect())
}

/// What a walk along the times of all rows finds.
struct Walk {
    /// Per row: whether it stays.
    keep: Vec<bool>,
    /// Rows at which the clock starts, the first among them.
    starts: Vec<usize>,
    /// Rows of the file at the time of the one before.
    repeated: Vec<u32>,
    /// Of these, the ones that are the same in all.
    twice: usize,
    /// Rows of the file out of the order of time.
    backward: Vec<u32>,
}

impl Walk {
    fn along(rows: &Rows) -> Self {
        let t = &rows.time;
        let (repeated, backward) = (Vec::new(), Vec::new());
        let mut walk = Self { keep: vec![false; t.len()], starts: vec![0], repeated, twice: 0, backward };
        // The last two kept rows of this part.
        let (mut before, mut last): (Option<usize>, Option<usize>) = (None, None);
        let mut i = 0;
        while let Some(&now) = t.get(i) {
            match last {
                Some(l) if now == t[l] => walk.repeat(rows, l, i),
                Some(l) if now < t[l] && before.is_some_and(|b| now > t[b]) => {
                    // The row before was the one that jumped ahead.
                    (walk.keep[l], walk.keep[i]) = (false, true);
                    walk.backward.push(rows.row[l]);
                    last = Some(i);
                }
                Some(l) if now < t[l] => {
                    let stay = t[i..].iter().take(HICCUP + 1).take_while(|x| **x <= t[l]).count();
                    if stay <= HICCUP && i + stay < t.len() {
                        walk.backward.extend(&rows.row[i..i + stay]);
                        i += stay;
                        continue;
                    }
                    walk.starts.push(i);
                    walk.keep[i] = true;
                    (before, last) = (None, Some(i));
                }
                _ => {
                    walk.keep[i] = true;
                    (before, last) = (last, Some(i));
                }
            }
            i += 1;
        }
        walk
    }

    /// Row `i` has the time of row `last`.
    fn repeat(&mut self, rows: &Rows, last: usize, i: usize) {
        let same = rows.force[i] == rows.force[last] && rows.displacement[i] == rows.displacement[last];
        self.twice += usize::from(same);
        self.repeated.push(rows.row[i]);
    }

    /// Says what does not stay, and why.
    fn tell(&self, out: &mut Vec<Found>) {
        if !self.repeated.is_empty() {
            let what = format!(
                "{} at the time of the row before ({} the same in all, of the others the first is kept)",
                counted(self.repeated.len(), "row"),
                self.twice
            );
            let remedy = "export the time with more digits";
            out.push(found(FaultKind::Repeated, &self.repeated, true, what, remedy));
        }
        if !self.backward.is_empty() {
            let what = format!("{} out of the order of time", counted(self.backward.len(), "row"));
            let remedy = "correct the times in the file";
            out.push(found(FaultKind::Backward, &self.backward, true, what, remedy));
        }
    }

    fn what_of_the_starts(&self, rows: &Rows) -> Question {
        let numbers: Vec<String> =
            self.starts[1..].iter().take(5).map(|s| rows.row[*s].to_string()).collect();
        let more = if self.starts.len() > 6 { ", …" } else { "" };
        let count = self.starts.len();
        let what = format!("the clock starts again in row {}{more}: {count} parts", numbers.join(", "));
        let choices = vec![
            ("split".into(), "every part is a test of its own".into()),
            ("append".into(), "one test: each part goes on where the last one ended".into()),
        ];
        Question::new("restart", what, choices)
    }
}

/// Moves the clock of every part behind the one before, one sampling interval later.
fn append(rows: &mut Rows, bounds: &[usize]) {
    let mut offset = 0.0;
    for w in bounds.windows(2) {
        let part = &mut rows.time[w[0]..w[1]];
        let Some((first, last)) = part.first().copied().zip(part.last().copied()) else { continue };
        let mut steps: Vec<f64> = part.windows(2).map(|p| p[1] - p[0]).collect();
        let step = noise::median(&mut steps).max(1e-9);
        let shift = if w[0] == 0 { 0.0 } else { offset - first };
        part.iter_mut().for_each(|t| *t += shift);
        offset = last + shift + step;
    }
}
