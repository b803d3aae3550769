//! The table, and its second part: the model and the run.

use super::{Fallback, Key, Kind, Limits, table_specimen};
use crate::config::DiagnoseConfig;
use params::Quantity::{self, *};

/// Collects the keys, section by section.
pub(super) struct Builder {
    section: &'static str,
    keys: Vec<Key>,
}

impl Builder {
    pub(super) fn section(&mut self, section: &'static str) -> &mut Self {
        self.section = section;
        self
    }

    pub(super) fn key(
        &mut self,
        name: &'static str,
        kind: Kind,
        default: Fallback,
        description: &'static str,
    ) -> &mut Self {
        let (section, name) = (self.section.into(), name.into());
        self.keys.push(Key { section, name, kind, default, description: description.into() });
        self
    }
}

pub(super) fn number(quantity: Quantity, limits: Limits) -> Kind {
    Kind::Number { quantity, limits }
}

pub(super) fn choice(words: &[&str]) -> Kind {
    Kind::Choice { words: words.iter().map(|&w| w.to_owned()).collect() }
}

const fn integer(min: i64, max: i64) -> Kind {
    Kind::Integer { min, max }
}

pub(super) fn absent(words: &'static str) -> Fallback {
    Fallback::Absent(words.into())
}

pub(super) fn word(word: &'static str) -> Fallback {
    Fallback::Word(word.into())
}

/// Lengths beyond this are a unit mistake, not a specimen; mm.
pub(super) const LONGEST: f64 = 1e4;
/// Lengths below this, a hundredth of a cell, are one too; mm.
pub(super) const SHORTEST: f64 = 1e-4;
/// Times beyond this are a unit mistake; s.
pub(super) const FOREVER: f64 = 1e9;
/// Times below this are one too; s.
pub(super) const INSTANT: f64 = 1e-6;

pub(super) fn build() -> Vec<Key> {
    let mut b = Builder { section: "", keys: Vec::new() };
    table_specimen::specimen(&mut b);
    table_specimen::tests(&mut b);
    model(&mut b);
    run(&mut b);
    b.keys
}

fn model(b: &mut Builder) {
    let size = || number(Length, Limits::within(SHORTEST, 1e3));
    b.section("mesh")
        .key("divisions", Kind::Divisions, absent("graded by the sizes below"), "hex8 along x, y, z, uniform")
        .key("bulk_size", size(), Fallback::Number(0.4), "element size away from the tear path")
        .key(
            "path_size",
            size(),
            absent("0.1 mm, or bulk_size if that is less"),
            "element size at the tear path",
        )
        .key("layers", integer(1, 64), Fallback::Integer(2), "elements through the thickness")
        .key(
            "symmetry",
            choice(&["auto", "none"]),
            word("auto"),
            "mirror planes used where the file allows it, or never",
        );
    b.section("bulk").key("law", Kind::Text, absent("the first of the registry, hgo"), "law of the tissue");
    b.section("interface")
        .key("law", Kind::Text, absent("the first of the registry, exponential"), "law of the tear path")
        .key(
            "areas",
            integer(1, 1000),
            Fallback::Integer(1),
            "equal areas along the path, each with its Gc and σc",
        )
        .key(
            "profile",
            choice(&["piecewise", "smooth"]),
            word("piecewise"),
            "constant in each area, or smooth through their centres",
        );
}

fn run(b: &mut Builder) {
    let share = |lower, upper| number(Dimensionless, Limits::within(lower, upper));
    let seed = || integer(0, i64::MAX);
    b.section("identify")
        .key(
            "mode",
            choice(&["staged", "joint"]),
            word("staged"),
            "bulk first, then the interface (then all at once, where effects outside the tear are free); or all tests at once",
        )
        .key(
            "tolerance",
            share(1e-15, 0.1),
            Fallback::Number(1e-6),
            "stop when the objective changes by less, relative",
        )
        .key(
            "max_iterations",
            integer(0, 100_000),
            Fallback::Integer(30),
            "most iterations; 0: no search, the model at its start values with its derivatives",
        )
        .key(
            "multi_start",
            integer(0, 10_000),
            Fallback::Integer(0),
            "number of starts; 0 or 1: only the given one",
        )
        .key(
            "priors",
            Kind::Priors,
            absent("off"),
            "literature's priors on or off, or priors of your own",
        )
        .key(
            "prior",
            Kind::Table,
            absent("none"),
            "what is believed of single parameters: `prior.bulk.mu_kPa = { value = 5, factor = 2 }`",
        )
        .key("coarse_first", Kind::Bool, Fallback::Bool(true), "fit on a coarser mesh first")
        .key(
            "release_bulk",
            Kind::Bool,
            Fallback::Bool(true),
            "staged: fit everything at once where the intact strip's bulk leaves the tear unexplained",
        );
    b.section("diagnose")
        .key(
            "rest",
            share(1e-4, 0.5),
            Fallback::Number(DiagnoseConfig::default().rest),
            "what a complete model of such a test leaves unexplained, share of the peak force",
        )
        .key(
            "practice",
            share(1e-4, 0.5),
            Fallback::Number(DiagnoseConfig::default().practice),
            "largest rest that counts as explained in practice, share of the peak force",
        )
        .key(
            "expected_effects",
            number(Dimensionless, Limits::within(0.01, 5.0)),
            Fallback::Number(DiagnoseConfig::default().expected_effects),
            "how many effects of the catalogue are expected to act",
        )
        .key(
            "laws",
            Kind::Bool,
            Fallback::Bool(false),
            "other laws of bulk and tear are candidates of a search, too",
        );
    b.section("solver")
        .key(
            "step",
            number(Length, Limits::within(1e-9, 1e3)),
            absent("chosen by the program"),
            "travel between answers; with control = \"path\": arc length",
        )
        .key(
            "control",
            choice(&["actuator", "path"]),
            word("actuator"),
            "as a rig, with jumps; or along the path, through snap-back",
        )
        .key(
            "tolerance",
            share(1e-13, 0.01),
            Fallback::Number(1e-9),
            "relative residual at which a step has converged",
        )
        .key(
            "max_iterations",
            integer(1, 1000),
            Fallback::Integer(25),
            "Newton iterations before a step is cut",
        )
        .key(
            "integration",
            choice(&["gauss", "nodal"]),
            word("gauss"),
            "2×2 points of the interface: Gauss or nodal",
        );
    b.section("output")
        .key(
            "noise",
            number(Dimensionless, Limits::within(0.0, 1.0)),
            absent("no synthetic record"),
            "noise of a synthetic record, share of the peak force",
        )
        .key("seed", seed(), Fallback::Integer(0), "seed of the noise")
        .key(
            "fields",
            Kind::Count { max: 10_000 },
            Fallback::Integer(8),
            "typical points of each curve with fields written; false: none",
        )
        .key(
            "figures",
            Kind::Words { words: ["svg", "pdf", "png"].map(str::to_owned).to_vec() },
            word("svg"),
            "formats of the figures",
        );
}
