//! What the user decides: the flags of `fct import`.

use serde::Serialize;
use std::collections::BTreeMap;

/// Decisions about a file. Everything unset is taken from the file, or asked for.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Choices {
    /// Columns by flag (`time`, `displacement`, `force`, `grip-displacement`, `tear-front`, `width-change`,
    /// `segment`; with two axes `displacement-x` and `force-x`): a number from 1, or a name.
    pub columns: BTreeMap<String, String>,
    /// Units by flag.
    pub units: BTreeMap<String, String>,
    /// `.` or `,`.
    pub decimal: Option<char>,
    /// Between cells.
    pub delimiter: Option<char>,
    /// Name of the encoding.
    pub encoding: Option<String>,
    /// Sheet of a workbook: a number from 1, or a name.
    pub sheet: Option<String>,
    /// Lines to pass over.
    pub skip_rows: usize,
    /// Speed of the actuator, mm/s, where there is no time.
    pub rate: Option<f64>,
    /// Rows per second, where there is no time.
    pub frequency: Option<f64>,
    /// Take the first displacement off.
    pub zero: bool,
    /// Take the force before the motion off.
    pub tare: bool,
    /// Signs to turn.
    pub flip: Option<Flip>,
    /// Faults whose rows are to go.
    pub drop: Vec<FaultKind>,
    /// What a clock that starts again means.
    pub restart: Option<Restart>,
    /// Points of a longer test that is thinned out; `None`, or with two axes: every row is kept.
    pub points: Option<usize>,
    /// A second actuator pulls along x, and a second load cell measures there: both are needed, and the displacement and the
    /// force are those along y.
    pub two_axes: bool,
    /// Strain and stress are true (logarithmic, Cauchy), not engineering.
    pub true_measures: bool,
}

/// Signs to turn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Flip {
    /// Those whose largest value is negative.
    Found,
    /// The force.
    Force,
    /// The displacement.
    Displacement,
    /// Both.
    Both,
}

/// What a clock that starts again means.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Restart {
    /// A test of its own.
    Split,
    /// The same test goes on.
    Append,
}

/// Kinds of faults of rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum FaultKind {
    /// Blank or NaN.
    Missing,
    /// No number.
    Unreadable,
    /// The time of the row before.
    Repeated,
    /// A time before that of the row before.
    Backward,
    /// Rows that are not there.
    Gap,
    /// One force far from both neighbours.
    Spike,
    /// A force that stays at its extreme while the actuator moves: the load cell's limit.
    Clipped,
    /// Forces in coarse steps.
    Quantised,
}

impl FaultKind {
    /// The word of `--drop` and of the log.
    pub fn word(self) -> &'static str {
        match self {
            Self::Missing => "missing",
            Self::Unreadable => "unreadable",
            Self::Repeated => "repeated",
            Self::Backward => "backward",
            Self::Gap => "gap",
            Self::Spike => "spike",
            Self::Clipped => "clipped",
            Self::Quantised => "quantised",
        }
    }
}

impl Choices {
    /// Nothing decided.
    pub fn new() -> Self {
        Self::default()
    }

    /// Takes an answer to a [`crate::Question`].
    ///
    /// # Errors
    /// What was expected instead.
    pub fn answer(&mut self, flag: &str, value: &str) -> Result<(), String> {
        let value = value.trim();
        match flag {
            "decimal" => self.decimal = Some(decimal(value)?),
            "delimiter" => self.delimiter = Some(delimiter(value)?),
            "encoding" => self.encoding = Some(value.to_owned()),
            "sheet" => self.sheet = Some(value.to_owned()),
            "units" => self.units.extend(units(value)?),
            "rate" => self.rate = Some(rate(value)?),
            "restart" => {
                self.restart = Some(match value {
                    "split" => Restart::Split,
                    "append" => Restart::Append,
                    _ => return Err(format!("`{value}`; expected split or append")),
                });
            }
            "time" | "displacement" | "force" | "grip-displacement" | "tear-front" | "width-change"
            | "displacement-x" | "force-x" | "segment" => {
                self.columns.insert(flag.to_owned(), value.to_owned());
            }
            _ => return Err(format!("no flag --{flag} takes an answer here")),
        }
        Ok(())
    }
}

/// A decimal mark: `.`, `,`, `point`, `comma`.
///
/// # Errors
/// What was expected.
pub fn decimal(value: &str) -> Result<char, String> {
    match value {
        "." | "point" => Ok('.'),
        "," | "comma" => Ok(','),
        _ => Err(format!("`{value}` is no decimal mark; expected . or , (point or comma)")),
    }
}

/// A delimiter: `,`, `;`, `tab`, `space`, `|`.
///
/// # Errors
/// What was expected.
pub fn delimiter(value: &str) -> Result<char, String> {
    match value {
        "," | "comma" => Ok(','),
        ";" | "semicolon" => Ok(';'),
        "\t" | "\\t" | "tab" => Ok('\t'),
        " " | "space" | "blank" => Ok(' '),
        "|" | "bar" => Ok('|'),
        _ => Err(format!("`{value}` is no delimiter; expected one of , ; tab space |")),
    }
}

/// `force=kN,time=ms`.
///
/// # Errors
/// What was expected.
pub fn units(value: &str) -> Result<BTreeMap<String, String>, String> {
    const FLAGS: [&str; 8] = [
        "time",
        "displacement",
        "force",
        "displacement-x",
        "force-x",
        "grip-displacement",
        "tear-front",
        "width-change",
    ];
    let mut out = BTreeMap::new();
    for part in value.split(',').filter(|p| !p.trim().is_empty()) {
        let (flag, unit) =
            part.split_once('=').ok_or_else(|| format!("`{part}`; expected force=kN and such"))?;
        let (flag, unit) = (flag.trim(), unit.trim());
        if !FLAGS.contains(&flag) {
            return Err(format!("`{flag}` is no channel; expected one of {}", FLAGS.join(", ")));
        }
        if crate::units::parse(unit).is_none() {
            return Err(format!(
                "`{unit}` is no unit that is known here; expected s, ms, min, mm, um, m, in, N, mN, kN, %, 1, kPa, MPa, …"
            ));
        }
        out.insert(flag.to_owned(), unit.to_owned());
    }
    Ok(out)
}

/// A speed in mm/s, or with its unit: `0.05`, `3mm/min`.
///
/// # Errors
/// What was expected.
pub fn rate(value: &str) -> Result<f64, String> {
    let expected = || format!("`{value}` is no speed; expected mm/s, or a number with a unit: 3mm/min");
    let at = value.find(|c: char| c.is_alphabetic() && !"eE".contains(c)).unwrap_or(value.len());
    let number: f64 = value[..at].trim().parse().map_err(|_| expected())?;
    let unit = value[at..].trim();
    let factor = if unit.is_empty() {
        1.0
    } else {
        let speed = crate::units::parse(unit).filter(|u| u.measure == crate::units::Measure::Speed);
        speed.ok_or_else(expected)?.scale()
    };
    let rate = number * factor;
    if rate.is_finite() && rate > 0.0 { Ok(rate) } else { Err(expected()) }
}
