//! Which column is what: by its name, its unit, the dialect's preference; asked where several would do.

use crate::axes::fits_on_axis;
use crate::choices::Choices;
use crate::dialects::Hints;
use crate::error::{Fault, Question, visible};
use crate::layout::Block;
use crate::units::{self, Measure, Unit};
use crate::words::{Role, fits, fold};
use serde::Serialize;

/// A column that is used.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Column {
    /// Index among the cells.
    pub index: usize,
    /// What it is.
    pub role: Role,
    /// Name as shown.
    pub name: String,
    /// Its unit; pure numbers for text.
    pub unit: Unit,
    /// The unit as written, and where.
    pub unit_text: String,
}

/// A column, for the log.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Understood {
    /// What it is taken for.
    pub role: Role,
    /// From 1.
    pub column: usize,
    /// As written.
    pub name: String,
    /// As written, or as the dialect or a flag says.
    pub unit: String,
}

impl Column {
    pub(crate) fn understood(&self) -> Understood {
        Understood {
            role: self.role,
            column: self.index + 1,
            name: self.name.clone(),
            unit: self.unit_text.clone(),
        }
    }
}

/// What kept columns from being told.
#[derive(Debug, Default)]
pub(crate) struct Open {
    /// Flags must decide.
    pub questions: Vec<Question>,
    /// Flags that do not fit.
    pub faults: Vec<Fault>,
}

/// The columns of a table.
pub(crate) struct Assigner<'a> {
    pub block: &'a Block,
    pub choices: &'a Choices,
    pub hints: &'a Hints,
    /// Whether two columns hold the same cells, or one the same cell in every row.
    pub same: &'a dyn Fn(usize, usize) -> bool,
    pub constant: &'a dyn Fn(usize) -> bool,
    /// Whether a column holds times like 12:30:01.
    pub clock: &'a dyn Fn(usize) -> bool,
}

/// Channels that a record must have or may have.
const NEEDED: [Role; 3] = [Role::Time, Role::Displacement, Role::Force];
const ACROSS: [Role; 2] = [Role::DisplacementX, Role::ForceX];
const CAMERA: [Role; 3] = [Role::GripDisplacement, Role::TearFront, Role::WidthChange];

impl Assigner<'_> {
    /// All columns that are used; segments last. Without a time there must be a rate or a frequency.
    pub fn assign(&self) -> Result<Vec<Column>, Open> {
        let (mut out, mut open) = (Vec::new(), Open::default());
        let across: &[Role] = if self.choices.two_axes { &ACROSS } else { &[] };
        for role in NEEDED.into_iter().chain(across.iter().copied()).chain(CAMERA) {
            match self.find(role) {
                Ok(Some((index, role))) => match self.unit(index, role) {
                    Ok(column) => out.push(column),
                    Err(question) => open.questions.push(question),
                },
                Ok(None) => {}
                Err(Unassigned::Ask(question)) => open.questions.push(question),
                Err(Unassigned::Wrong(fault)) => open.faults.push(fault),
            }
        }
        match self.segments() {
            Ok(indices) => out.extend(indices.into_iter().map(|index| self.text(index))),
            Err(fault) => open.faults.push(fault),
        }
        if open.questions.is_empty() && open.faults.is_empty() { Ok(out) } else { Err(open) }
    }

    /// Whether the needed columns could be told, or be asked for, from their names.
    pub fn has_names(&self) -> bool {
        NEEDED[1..].iter().all(|role| !matches!(self.find(*role), Ok(None)) && !self.nothing_fits(*role))
    }

    fn nothing_fits(&self, role: Role) -> bool {
        !self.choices.columns.contains_key(role.flag())
            && role.stand_ins().iter().all(|r| self.best(*r).is_empty())
    }

    fn find(&self, role: Role) -> Result<Option<(usize, Role)>, Unassigned> {
        if let Some(said) = self.choices.columns.get(role.flag()) {
            let index = self.named(said, role.flag()).map_err(Unassigned::Wrong)?;
            return Ok(Some((index, self.as_said(index, role))));
        }
        for stand_in in role.stand_ins() {
            let best = self.best(*stand_in);
            match best.as_slice() {
                [] => {}
                [one] => return Ok(Some((*one, *stand_in))),
                many if many.iter().all(|i| (self.same)(many[0], *i)) => {
                    return Ok(Some((many[0], *stand_in)));
                }
                many => {
                    let what = format!("{} columns could be the {}", many.len(), role.spoken());
                    return Err(Unassigned::Ask(Question::new(role.flag(), what, self.listed(many))));
                }
            }
        }
        if CAMERA.contains(&role) {
            return Ok(None);
        }
        if role == Role::Time {
            return if self.choices.rate.is_some() || self.choices.frequency.is_some() {
                Ok(None)
            } else {
                let what = "no column is the time, and neither --rate (mm/s, of a motion that never stops) nor \
                            --frequency (rows per second) stands for it";
                Err(Unassigned::Ask(Question::new("time", what, self.listed(&self.rest()))))
            };
        }
        let what = format!("no column is called the {}", role.spoken());
        Err(Unassigned::Ask(Question::new(role.flag(), what, self.listed(&self.rest()))))
    }

    /// The columns that fit best: those the dialect prefers, those that change, those with the best name.
    fn best(&self, role: Role) -> Vec<usize> {
        let mut all: Vec<(u8, usize)> = (0..self.block.width).map(|i| (self.score(i, role), i)).collect();
        all.retain(|(score, _)| *score > 0);
        let top = all.iter().map(|a| a.0).max().unwrap_or(0);
        let mut best: Vec<usize> = all.into_iter().filter(|a| a.0 == top).map(|a| a.1).collect();
        if best.len() > 1 {
            let moving: Vec<usize> = best.iter().copied().filter(|i| !(self.constant)(*i)).collect();
            if !moving.is_empty() {
                best = moving;
            }
        }
        best
    }

    fn score(&self, index: usize, role: Role) -> u8 {
        let (bare, unit) = self.bare(index);
        let measure = unit.as_deref().and_then(units::parse).map(|u| u.measure);
        if measure.is_some_and(|m| Some(m) != role.measure()) {
            return 0;
        }
        let folded = fold(&bare);
        if self.choices.two_axes && role.on_axis().is_some() {
            return fits_on_axis(&bare, role);
        }
        if self.hints.columns.iter().any(|(r, name)| *r == role && *name == folded) {
            return 4;
        }
        let score = fits(&bare, role);
        // A deformation in mm is a displacement, whatever the word means elsewhere.
        let length = role == Role::Displacement && measure == Some(Measure::Length);
        if score == 0 && length { u8::from(fits(&bare, Role::Strain) > 1) } else { score }
    }

    /// Name without unit, and the unit: a flag's, the name's, or the unit row's.
    fn bare(&self, index: usize) -> (String, Option<String>) {
        let name = self.block.names.get(index).map_or("", String::as_str);
        let below = self.block.units.get(index).cloned().flatten();
        match below {
            Some(unit) if units::parse(&unit).is_some() => (name.to_owned(), Some(unit)),
            below => {
                let (bare, unit) = units::split(name);
                (bare, unit.or(below))
            }
        }
    }

    /// What a column that the user named is: strain instead of displacement where its unit or name says so.
    fn as_said(&self, index: usize, role: Role) -> Role {
        let (bare, unit) = self.bare(index);
        let unit = self.choices.units.get(role.flag()).cloned().or(unit);
        let measure = unit.as_deref().and_then(units::parse).map(|u| u.measure);
        let of = |r: &&Role| measure.map_or(fits(&bare, **r) > 0, |m| r.measure() == Some(m));
        let candidates = role.stand_ins();
        let by_name = candidates.iter().filter(of).max_by_key(|r| fits(&bare, **r));
        by_name.copied().unwrap_or(role)
    }

    fn unit(&self, index: usize, role: Role) -> Result<Column, Question> {
        let (_, written) = self.bare(index);
        let kin = role.on_axis().map_or(role, |(_, channel)| channel);
        let hinted = self.hints.units.iter().find(|(r, _)| *r == kin).map(|u| u.1.to_owned());
        // A stretch is a ratio of lengths: it needs no unit.
        let pure = (role == Role::Stretch).then(|| "1".to_owned());
        if role == Role::Time && (self.clock)(index) {
            let unit = Unit { measure: Measure::Time, exponent: 0, factor: 1.0 };
            return Ok(Column {
                index,
                role,
                name: self.block.shown(index),
                unit,
                unit_text: "h:min:s".into(),
            });
        }
        let text = self.choices.units.get(role.flag()).cloned().or(written).or(hinted).or(pure);
        let name = self.block.shown(index);
        let examples: &[&str] = match role {
            Role::Time => &["s", "ms", "min"],
            Role::Force | Role::ForceX => &["N", "mN", "kN"],
            Role::Strain | Role::Stretch => &["%", "1"],
            Role::Stress => &["MPa", "kPa", "Pa"],
            _ => &["mm", "um", "m"],
        };
        let options =
            || examples.iter().map(|u| (format!("{}={u}", role.flag()), format!("it is in {u}"))).collect();
        let Some(text) = text else {
            let what =
                format!("column {} `{}` (the {}) has no unit", index + 1, visible(&name), role.spoken());
            return Err(Question::new("units", what, options()));
        };
        match units::parse(&text) {
            Some(unit) if Some(unit.measure) == role.measure() => Ok(Column {
                index,
                role,
                name,
                unit,
                unit_text: text.trim_matches(['(', ')', '[', ']', ' ']).to_owned(),
            }),
            _ => {
                let what = format!(
                    "the unit `{}` of column {} `{}` is none of a {}",
                    visible(&text),
                    index + 1,
                    visible(&name),
                    role.spoken()
                );
                Err(Question::new("units", what, options()))
            }
        }
    }

    fn segments(&self) -> Result<Vec<usize>, Fault> {
        if let Some(said) = self.choices.columns.get("segment") {
            return if said == "none" { Ok(Vec::new()) } else { Ok(vec![self.named(said, "segment")?]) };
        }
        let named = |i: &usize| self.score(*i, Role::Segment) > 1;
        let indices: Vec<usize> = (0..self.block.width).filter(named).collect();
        Ok(indices.into_iter().filter(|i| !(self.constant)(*i)).collect())
    }

    fn text(&self, index: usize) -> Column {
        let unit = Unit { measure: Measure::Ratio, exponent: 0, factor: 1.0 };
        Column { index, role: Role::Segment, name: self.block.shown(index), unit, unit_text: String::new() }
    }

    /// The column that a flag means: a number from 1, a whole name, a name without unit.
    fn named(&self, said: &str, flag: &str) -> Result<usize, Fault> {
        let names = &self.block.names;
        let exact = |i: &usize| names.get(*i).is_some_and(|n| n == said) || self.block.shown(*i) == said;
        let loose = |i: &usize| {
            let same = |n: &str| fold(n) == fold(said) && !fold(said).is_empty();
            same(names.get(*i).map_or("", String::as_str))
                || same(&self.bare(*i).0)
                || same(&self.block.shown(*i))
        };
        let all = || 0..self.block.width;
        if let Some(i) = all().find(exact) {
            return Ok(i);
        }
        if let Ok(n) = said.parse::<usize>()
            && (1..=self.block.width).contains(&n)
        {
            return Ok(n - 1);
        }
        let found: Vec<usize> = all().filter(loose).collect();
        if let [one] = found.as_slice() {
            return Ok(*one);
        }
        let list: Vec<String> =
            all().map(|i| format!("{} `{}`", i + 1, visible(&self.block.shown(i)))).take(40).collect();
        let trouble = if found.is_empty() { "no column" } else { "more than one column" };
        Err(Fault {
            row: self.block.header.map(|h| h + 1),
            column: None,
            message: format!("--{flag} `{}` names {trouble}", visible(said)),
            remedy: format!("the columns are {}", list.join(", ")),
        })
    }

    /// Columns that no other channel has claimed by name.
    fn rest(&self) -> Vec<usize> {
        (0..self.block.width).filter(|i| !(self.constant)(*i)).take(20).collect()
    }

    fn listed(&self, indices: &[usize]) -> Vec<(String, String)> {
        indices
            .iter()
            .map(|i| ((i + 1).to_string(), format!("`{}`", visible(&self.block.shown(*i)))))
            .collect()
    }
}

/// Why a channel has no column.
enum Unassigned {
    Ask(Question),
    Wrong(Fault),
}
