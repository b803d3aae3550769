//! What was tested and measured, resolved: defaults applied, units converted to mm, s, N, MPa, rad.

use crate::config::{
    BulkConfig, DiagnoseConfig, EffectConfig, IdentifyConfig, InterfaceConfig, MeshConfig, OutputConfig,
    SolverConfig,
};
use crate::diagnostics::Diagnostic;
use crate::experiment::TestKind;
use crate::inputs::InputFile;
use serde::Serialize;
use std::fmt;
use std::path::{Path, PathBuf};

/// A specimen with its tests and the configuration of the run: everything a command needs to start.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Case {
    /// Name of the specimen (or of the config, if that gives one); shown in every answer.
    pub name: String,
    /// Where the measurements come from, in the user's words; empty if the file does not say.
    pub provenance: String,
    /// The run this configuration was derived from (`fct add`), if any.
    pub parent: Option<String>,
    /// The specimen file, if geometry and tests came from one (a specimen read alone is its own file).
    pub specimen_file: Option<PathBuf>,
    /// The configuration file; `None` if a specimen was read alone.
    pub config_file: Option<PathBuf>,
    /// Dimensions of the strip.
    pub geometry: Geometry,
    /// Tests in the order in which they were done on the piece.
    pub tests: Vec<Test>,
    /// `[mesh]`
    pub mesh: MeshConfig,
    /// `[bulk]`
    pub bulk: BulkConfig,
    /// `[interface]`
    pub interface: InterfaceConfig,
    /// `[effects.NAME]`, in the order of the file (which must not change any answer).
    pub effects: Vec<EffectConfig>,
    /// `[identify]`
    pub identify: IdentifyConfig,
    /// `[diagnose]`
    pub diagnose: DiagnoseConfig,
    /// `[solver]`
    pub solver: SolverConfig,
    /// `[output]`
    pub output: OutputConfig,
    /// Things worth saying that are not errors; to be shown on stderr.
    pub warnings: Vec<Diagnostic>,
    /// Every file that was read, with the hash of the bytes that were read.
    pub inputs: Vec<InputFile>,
}

impl Case {
    /// The configuration of effect `name`, if the case has it.
    pub fn effect(&self, name: &str) -> Option<&EffectConfig> {
        self.effects.iter().find(|e| e.name == name)
    }

    /// Whether two cases describe the same run: equal in everything but where it was read from
    /// (files, line numbers, warnings).
    pub fn same_input(&self, other: &Case) -> bool {
        self.without_locations() == other.without_locations()
    }

    /// SHA-256 of everything the case says: the content of the files that were read, to the last bit of every number, but
    /// not where they stood, nor their comments and order of keys.
    pub fn fingerprint(&self) -> String {
        let mut case = self.without_locations();
        case.parent = None;
        for record in case.tests.iter_mut().filter_map(|t| t.record.as_mut()) {
            record.path.clear();
        }
        crate::sha256(format!("{case:?}").as_bytes())
    }

    fn without_locations(&self) -> Case {
        let mut case = self.clone();
        (case.specimen_file, case.config_file) = (None, None);
        case.warnings.clear();
        case.inputs.clear();
        for effect in &mut case.effects {
            effect.location = Location::default();
        }
        for record in case.tests.iter_mut().filter_map(|t| t.record.as_mut()) {
            record.path = absolute(&record.path);
        }
        case
    }
}

/// The path made absolute without asking the file system whether it exists.
pub(crate) fn absolute(path: &Path) -> PathBuf {
    std::path::absolute(path).unwrap_or_else(|_| path.to_owned())
}

/// Dimensions of the specimen, mm. Axes: x across the width (tear direction), y along the load, z through
/// the thickness.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Geometry {
    /// Length along the load between the clamps, mm.
    pub length: f64,
    /// Width along the tear, mm.
    pub width: f64,
    /// Thickness, mm.
    pub thickness: f64,
    /// Initial cut from the edge x = 0, mm; 0 for none.
    pub cut: f64,
    /// Height y of the tear path, mm; `None` is the middle, length/2.
    pub path_y: Option<f64>,
    /// Rows `[y, left, right]` of the outline (mm), y increasing; `None` for a rectangle.
    pub outline: Option<Vec<[f64; 3]>>,
    /// Rows `[y, thickness]` (mm), y increasing; `None` for a uniform thickness.
    pub thickness_profile: Option<Vec<[f64; 2]>>,
}

/// How the end faces are held.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Ends {
    /// x and z held (default).
    #[default]
    Clamped,
    /// Free lateral motion: a homogeneous uniaxial state.
    Sliding,
}

/// Where the specimen is pulled.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Grips {
    /// At both end faces (default).
    #[default]
    Ends,
    /// At the two edges x = 0, y = 0 and y = length: a double-cantilever beam or a peel.
    Mouth,
}

/// One test on the piece.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Test {
    /// Key of the test in every answer and file; unique in the case.
    pub name: String,
    /// The experiment: what it offers is asked of its card.
    pub kind: TestKind,
    /// How the ends are held.
    pub ends: Ends,
    /// Where it is pulled.
    pub grips: Grips,
    /// The measurement, if there is one.
    pub record: Option<Record>,
    /// What the actuator is to do, for a test without a record; never empty.
    pub protocol: Option<Vec<Leg>>,
    /// Displacement of the second actuator over that of the first; of no account with one axis.
    pub ratio_x: f64,
    /// Rest before this test, s; `None`: long enough for viscous stresses to be gone.
    pub rest_s: Option<f64>,
    /// Whether the piece was mounted anew before this test, so that rig slip starts at 0.
    pub remount: bool,
    /// Whether this is a fresh piece of the same tissue: all history starts anew.
    pub fresh_piece: bool,
    /// Standard deviation of the force noise, N; `None`: estimated from the record.
    pub force_sd: Option<f64>,
    /// Standard deviation of the noise of the second force, N; `None`: estimated from the record.
    pub force_x_sd: Option<f64>,
    /// Standard deviation of the camera's grip displacement, mm; `None`: estimated from the record.
    pub grip_displacement_sd: Option<f64>,
    /// Standard deviation of the camera's tear front, mm; `None`: estimated from the record.
    pub tear_front_sd: Option<f64>,
    /// Standard deviation of the camera's width change, mm; `None`: estimated from the record.
    pub width_change_sd: Option<f64>,
    /// Opening from which the camera counts a point as torn, mm; `None`: δc.
    pub tear_front_opening: Option<f64>,
    /// Stretches of the record that count less, more, or not at all in a fit; where two overlap, the later one holds.
    pub weights: Vec<Weight>,
}

impl Test {
    /// The weight of what was measured at a time; 0: left out of the fit.
    pub fn weight_at(&self, time: f64) -> f64 {
        let mine = |w: &&Weight| (w.from_s..=w.to_s).contains(&time);
        self.weights.iter().rev().find(mine).map_or(1.0, |w| w.weight)
    }
}

/// How much a stretch of a record counts.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Weight {
    /// Its first instant, s.
    pub from_s: f64,
    /// Its last instant, s.
    pub to_s: f64,
    /// Factor of its part in χ²; 0: left out.
    pub weight: f64,
}

/// One leg of a protocol.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Leg {
    /// Move the actuator at constant speed.
    Ramp {
        /// Displacement at the end of the ramp, mm.
        to_mm: f64,
        /// Speed (positive), mm/s.
        rate_mm_per_s: f64,
    },
    /// Keep the actuator where it is.
    Hold {
        /// Duration, s.
        hold_s: f64,
    },
}

/// A measured record. All channels have one entry per row of the file.
///
/// Camera channels may have gaps: an empty cell in the file is `None` here, "not measured at that time".
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Record {
    /// The CSV file.
    pub path: PathBuf,
    /// Time, s; strictly increasing.
    pub time: Vec<f64>,
    /// Actuator displacement, mm.
    pub displacement: Vec<f64>,
    /// Load cell force, N.
    pub force: Vec<f64>,
    /// Second actuator's displacement, mm, of a test with two axes.
    pub displacement_x: Option<Vec<f64>>,
    /// Second load cell's force, N.
    pub force_x: Option<Vec<Option<f64>>>,
    /// The user's name of the segment each row belongs to.
    pub segment: Option<Vec<String>>,
    /// Camera: change of the distance between the clamped edges, mm.
    pub grip_displacement: Option<Vec<Option<f64>>>,
    /// Camera: largest reference x with an opening of at least [`Test::tear_front_opening`], mm.
    pub tear_front: Option<Vec<Option<f64>>>,
    /// Camera: width minus initial width at y = length/2, mm; negative when contracting.
    pub width_change: Option<Vec<Option<f64>>>,
    /// How a long record was averaged to fewer points; `None`: rows as they were measured. A file never says so.
    pub averaged: Option<Averaged>,
}

/// A record whose points are averages of rows.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Averaged {
    /// Rows of the whole record.
    pub rows: usize,
    /// Force, grip displacement, tear front, width change, second force.
    pub channels: [Averages; 5],
}

/// What is behind the points of one channel.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Averages {
    /// Readings in each point; 0 where there was none.
    pub readings: Vec<usize>,
    /// The sd of a mean of m readings falls as m to the power of minus this: ½ for independent ones, 0 for readings that
    /// share their error.
    pub decay: f64,
}

impl Record {
    /// Number of rows.
    pub fn len(&self) -> usize {
        self.time.len()
    }

    /// Keeps the first rows.
    pub fn truncate(&mut self, rows: usize) {
        for column in [&mut self.time, &mut self.displacement, &mut self.force] {
            column.truncate(rows);
        }
        self.displacement_x.iter_mut().for_each(|u| u.truncate(rows));
        for camera in self.measured_beside() {
            camera.iter_mut().for_each(|c| c.truncate(rows));
        }
        self.segment.iter_mut().for_each(|s| s.truncate(rows));
        for channel in self.averaged.iter_mut().flat_map(|a| &mut a.channels) {
            channel.readings.truncate(rows);
        }
    }

    /// Channels that may have gaps: the camera's, and the second force.
    pub fn measured_beside(&mut self) -> [&mut Option<Vec<Option<f64>>>; 4] {
        [&mut self.grip_displacement, &mut self.tear_front, &mut self.width_change, &mut self.force_x]
    }

    /// Rows of the record as it was measured.
    pub fn measured_rows(&self) -> usize {
        self.averaged.as_ref().map_or(self.len(), |a| a.rows)
    }

    /// Whether there are no rows; never true for a record that was read from a file.
    pub fn is_empty(&self) -> bool {
        self.time.is_empty()
    }
}

/// Where something stood in a file; line and column count from 1, 0 is "unknown".
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Location {
    /// The file.
    pub file: PathBuf,
    /// Line, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
}

impl fmt::Display for Location {
    /// `file:line:column`, as compilers write it.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}:{}", self.file.display(), self.line, self.column)
    }
}
