//! Flags of `fct import`.

use input::{ExperimentRegistry, TestKind};
use records::choices::{decimal, delimiter, rate, units};
use records::{Choices, FaultKind, Flip, Restart};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Arguments of `fct import`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Files of the testing machine (text, xlsx, xls, ods), in the order of the tests on the piece
    #[arg(value_name = "FILE", required = true)]
    pub files: Vec<PathBuf>,
    /// A specimen or config whose `[geometry]` is taken; default: what the header of a file says
    #[arg(long, value_name = "FILE")]
    pub geometry: Option<PathBuf>,
    /// What was tested, by the experiment's name (uniaxial, tearing, biaxial, …): one for all files, or one per file
    #[arg(long, value_name = "KIND", value_delimiter = ',')]
    pub kind: Vec<String>,
    /// Column of the time: number from 1, or name
    #[arg(long, value_name = "COLUMN")]
    pub time: Option<String>,
    /// Column of the displacement, strain or stretch
    #[arg(long, value_name = "COLUMN")]
    pub displacement: Option<String>,
    /// Column of the force or stress
    #[arg(long, value_name = "COLUMN")]
    pub force: Option<String>,
    /// Column of the displacement along x, of a biaxial test
    #[arg(long, value_name = "COLUMN")]
    pub displacement_x: Option<String>,
    /// Column of the force along x, of a biaxial test
    #[arg(long, value_name = "COLUMN")]
    pub force_x: Option<String>,
    /// Column of the camera's change of the distance between the clamped edges
    #[arg(long, value_name = "COLUMN")]
    pub grip_displacement: Option<String>,
    /// Column of the camera's tear front
    #[arg(long, value_name = "COLUMN")]
    pub tear_front: Option<String>,
    /// Column of the camera's change of width
    #[arg(long, value_name = "COLUMN")]
    pub width_change: Option<String>,
    /// Column that names segments; `none` takes none
    #[arg(long, value_name = "COLUMN")]
    pub segment: Option<String>,
    /// Units where the file has none, or wrong ones: force=kN,time=ms
    #[arg(long, value_name = "CHANNEL=UNIT", value_parser = units)]
    pub units: Vec<BTreeMap<String, String>>,
    /// Decimal mark: . or ,
    #[arg(long, value_name = "MARK", value_parser = decimal)]
    pub decimal: Option<char>,
    /// What separates cells: , ; tab space |
    #[arg(long, value_name = "MARK", value_parser = delimiter)]
    pub delimiter: Option<char>,
    /// Encoding of the text: utf-8, utf-16le, latin1, cp1250, gbk, …
    #[arg(long, value_name = "NAME")]
    pub encoding: Option<String>,
    /// Sheet of a workbook: number from 1, or name
    #[arg(long, value_name = "SHEET")]
    pub sheet: Option<String>,
    /// Lines at the beginning that are passed over
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub skip_rows: usize,
    /// No column of the time: speed of the actuator, mm/s or with its unit (3mm/min)
    #[arg(long, value_name = "SPEED", value_parser = rate, conflicts_with = "frequency")]
    pub rate: Option<f64>,
    /// No column of the time: rows per second
    #[arg(long, value_name = "HZ", value_parser = positive)]
    pub frequency: Option<f64>,
    /// Take the first displacement off
    #[arg(long)]
    pub zero: bool,
    /// Take the force before the motion off
    #[arg(long)]
    pub tare: bool,
    /// Turn signs: force, displacement, both; alone: those that run to negative values
    #[arg(long, value_name = "CHANNEL", num_args = 0..=1, require_equals = false, default_missing_value = "found")]
    pub flip: Option<FlipWord>,
    /// Faults whose rows are left out: missing, unreadable, spike, clipped
    #[arg(long, value_name = "FAULT", value_delimiter = ',')]
    pub drop: Vec<DropWord>,
    /// What a clock that starts again means: tests of their own, or one that goes on
    #[arg(long, value_name = "HOW")]
    pub restart: Option<RestartWord>,
    /// Thin a longer test out to about N points; default: every row
    #[arg(long, value_name = "N")]
    pub points: Option<usize>,
    /// Strain is logarithmic, stress is Cauchy's; default: engineering, unless the name says so
    #[arg(long)]
    pub true_measures: bool,
}

/// Values of `--flip`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum FlipWord {
    /// Those that run to negative values
    Found,
    /// The force
    Force,
    /// The displacement
    Displacement,
    /// Both
    Both,
}

/// Values of `--drop`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum DropWord {
    /// Blank or NaN
    Missing,
    /// No number
    Unreadable,
    /// A value far from both neighbours
    Spike,
    /// At the limit of the load cell
    Clipped,
}

/// Values of `--restart`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum RestartWord {
    /// Every part is a test of its own
    Split,
    /// One test
    Append,
}

fn positive(text: &str) -> Result<f64, String> {
    let x: f64 = text.trim().parse().map_err(|_| format!("`{text}` is no number"))?;
    if x.is_finite() && x > 0.0 { Ok(x) } else { Err(format!("`{text}`; expected more than 0")) }
}

/// What was tested, per file.
pub struct Kinds {
    said: Vec<TestKind>,
    known: Vec<TestKind>,
}

impl Kinds {
    /// The kind of a file, and what to say if nobody said it.
    pub fn of(&self, k: usize, file: &Path) -> (TestKind, Option<String>) {
        if let Some(kind) = self.said.get(k).or(self.said.first().filter(|_| self.said.len() == 1)) {
            return (*kind, None);
        }
        let name = file.file_stem().map(|s| s.to_string_lossy().to_lowercase()).unwrap_or_default();
        let named = self.known.iter().filter(|k| name.contains(k.word())).max_by_key(|k| k.word().len());
        let torn = || {
            TEARS.iter().any(|w| name.contains(w)).then(|| self.known.iter().find(|k| k.word() == "tearing"))
        };
        let (kind, why) = match named.or_else(|| torn().flatten()) {
            Some(kind) => (*kind, "by its name"),
            None => (self.known[0], "nothing says otherwise"),
        };
        (kind, Some(format!("{}: taken for a {} test ({why}); --kind decides", file.display(), kind.word())))
    }
}

/// Parts of words for a tear, in the languages of the labs.
const TEARS: [&str; 4] = ["tear", "riss", "tore", "dechir"];

impl Arguments {
    /// Kinds of the files.
    ///
    /// # Errors
    /// If one is unknown, their number is not that of the files, or records of two axes are to be thinned out.
    pub fn kinds(&self, known: &dyn ExperimentRegistry) -> Result<Kinds, String> {
        let of = |word: &String| {
            let names = || known.kinds().iter().map(|k| k.word()).collect::<Vec<_>>().join(", ");
            known.kind(word).ok_or_else(|| format!("--kind `{word}`; expected one of {}", names()))
        };
        let said = self.kind.iter().map(of).collect::<Result<Vec<_>, _>>()?;
        if self.kind.len() > 1 && self.kind.len() != self.files.len() {
            return Err(format!("--kind names {} kinds for {} files", self.kind.len(), self.files.len()));
        }
        if let Some(kind) = said.iter().find(|k| k.two_axes && self.points.is_some()) {
            return Err(format!(
                "--points thins out records of one force; a {} test has two, and a fit averages its rows itself",
                kind.word()
            ));
        }
        Ok(Kinds { said, known: known.kinds() })
    }

    /// The decisions that the flags make.
    ///
    /// # Errors
    /// If a number is out of range.
    pub fn choices(&self) -> Result<Choices, String> {
        if let Some(few) = self.points.filter(|n| *n < 20) {
            return Err(format!("--points {few}; expected at least 20"));
        }
        let columns = [
            ("time", &self.time),
            ("displacement", &self.displacement),
            ("force", &self.force),
            ("displacement-x", &self.displacement_x),
            ("force-x", &self.force_x),
            ("grip-displacement", &self.grip_displacement),
            ("tear-front", &self.tear_front),
            ("width-change", &self.width_change),
            ("segment", &self.segment),
        ];
        Ok(Choices {
            columns: columns.into_iter().filter_map(|(k, v)| Some((k.to_owned(), v.clone()?))).collect(),
            units: self.units.iter().flatten().map(|(k, v)| (k.clone(), v.clone())).collect(),
            decimal: self.decimal,
            delimiter: self.delimiter,
            encoding: self.encoding.clone(),
            sheet: self.sheet.clone(),
            skip_rows: self.skip_rows,
            rate: self.rate,
            frequency: self.frequency,
            zero: self.zero,
            tare: self.tare,
            flip: self.flip.map(|f| match f {
                FlipWord::Found => Flip::Found,
                FlipWord::Force => Flip::Force,
                FlipWord::Displacement => Flip::Displacement,
                FlipWord::Both => Flip::Both,
            }),
            drop: self
                .drop
                .iter()
                .map(|d| match d {
                    DropWord::Missing => FaultKind::Missing,
                    DropWord::Unreadable => FaultKind::Unreadable,
                    DropWord::Spike => FaultKind::Spike,
                    DropWord::Clipped => FaultKind::Clipped,
                })
                .collect(),
            restart: self.restart.map(|r| match r {
                RestartWord::Split => Restart::Split,
                RestartWord::Append => Restart::Append,
            }),
            points: self.points,
            two_axes: false,
            true_measures: self.true_measures,
        })
    }
}
