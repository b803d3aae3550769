//! The table, first part: what was tested and measured.

use super::table::{Builder, FOREVER, INSTANT, LONGEST, SHORTEST, absent, choice, number, word};
use super::{Fallback, Kind, Limits};
use params::Quantity::*;

pub(super) fn specimen(b: &mut Builder) {
    b.section("")
        .key("name", Kind::Text, absent("the file's name"), "name of the specimen, shown in every answer")
        .key(
            "provenance",
            Kind::Text,
            absent("not stated"),
            "where the measurements come from, shown in every report",
        )
        .key(
            "specimen",
            Kind::File,
            absent("[geometry] and [[tests]] stand in this file"),
            "the specimen file of a config",
        )
        .key("parent", Kind::Text, absent("none"), "the run this config was derived from")
        .key("geometry", Kind::Table, absent("taken from `specimen`"), "dimensions of the strip")
        .key(
            "tests",
            Kind::Tables,
            absent("taken from `specimen`"),
            "the tests in the order in which they were done",
        )
        .key("mesh", Kind::Table, absent("defaults"), "the finite element mesh")
        .key("bulk", Kind::Table, absent("defaults"), "the law of the tissue")
        .key("interface", Kind::Table, absent("defaults"), "the law of the tear path")
        .key("effects", Kind::Table, absent("none"), "effects added to the base model, `[effects.NAME]`")
        .key("diagnose", Kind::Table, absent("defaults"), "what is believed before a record is looked at")
        .key("identify", Kind::Table, absent("defaults"), "the inverse analysis")
        .key("solver", Kind::Table, absent("defaults"), "the forward analysis")
        .key("output", Kind::Table, absent("defaults"), "what is written");
    b.section("geometry")
        .key(
            "length",
            number(Length, Limits::within(SHORTEST, LONGEST)),
            Fallback::Required,
            "length along the load y between the clamps",
        )
        .key(
            "width",
            number(Length, Limits::within(SHORTEST, LONGEST)),
            Fallback::Required,
            "width along the tear x",
        )
        .key(
            "thickness",
            number(Length, Limits::within(SHORTEST, LONGEST)),
            Fallback::Required,
            "thickness along z",
        )
        .key(
            "cut",
            number(Length, Limits::within(0.0, LONGEST)),
            Fallback::Number(0.0),
            "initial cut from the edge x = 0; less than the width",
        )
        .key(
            "path_y",
            number(Length, Limits::within(SHORTEST, LONGEST)),
            absent("length/2"),
            "height y of the tear path",
        )
        .key(
            "outline",
            Kind::Rows { quantity: Length, columns: 3 },
            absent("a rectangle"),
            "CSV `y_mm,left_mm,right_mm` of the left and right edge, or rows [y, left, right]",
        )
        .key(
            "thickness_profile",
            Kind::Rows { quantity: Length, columns: 2 },
            absent("uniform"),
            "CSV `y_mm,thickness_mm`, or rows [y, thickness]",
        );
}

pub(super) fn tests(b: &mut Builder) {
    let sd = |quantity| number(quantity, Limits::within(1e-12, 1e9));
    b.section("tests")
        .key(
            "name",
            Kind::Text,
            absent("its kind; repeats get -2, -3"),
            "key of the test in every answer and file",
        )
        .key(
            "kind",
            Kind::Text,
            Fallback::Required,
            "the experiment: `uniaxial` (intact strip), `tearing` (strip with the cut and the tear path), or another of the registry",
        )
        .key("data", Kind::File, absent("`protocol` is needed"), "the record, a CSV file")
        .key(
            "protocol",
            Kind::Legs,
            absent("`data` is needed"),
            "what the actuator does: { to_mm, rate_mm_per_s } or { hold_s } each",
        )
        .key(
            "ends",
            choice(&["clamped", "sliding"]),
            word("clamped"),
            "end faces held, or free to move laterally",
        )
        .key(
            "grips",
            choice(&["ends", "mouth"]),
            word("ends"),
            "pulled at both end faces, or open at the mouth of the cut",
        )
        .key(
            "rest",
            number(Time, Limits::within(0.0, FOREVER)),
            absent("long: viscous stresses are gone"),
            "rest before this test",
        )
        .key(
            "remount",
            Kind::Bool,
            Fallback::Bool(true),
            "mounted anew before this test: rig slip starts at 0",
        )
        .key(
            "fresh_piece",
            Kind::Bool,
            Fallback::Bool(false),
            "a fresh piece of the same tissue: all history starts anew",
        )
        .key(
            "force_sd",
            sd(Force),
            absent("estimated from the record"),
            "standard deviation of the force noise; 1e-6 to 10 times the record's largest value",
        )
        .key(
            "ratio_x",
            number(Dimensionless, Limits::within(-10.0, 10.0)),
            Fallback::Number(1.0),
            "two axes, without `data`: displacement along x over that along y",
        )
        .key(
            "force_x_sd",
            sd(Force),
            absent("estimated from the record"),
            "standard deviation of the noise of the second force; 1e-6 to 10 times the record's largest value",
        )
        .key(
            "grip_displacement_sd",
            sd(Length),
            absent("estimated from the record"),
            "standard deviation of the camera's grip displacement; 1e-6 to 10 times the record's largest value",
        )
        .key(
            "tear_front_sd",
            sd(Length),
            absent("estimated from the record"),
            "standard deviation of the camera's tear front; 1e-6 to 10 times the record's largest value",
        )
        .key(
            "width_change_sd",
            sd(Length),
            absent("estimated from the record"),
            "standard deviation of the camera's width change; 1e-6 to 10 times the record's largest value",
        )
        .key(
            "tear_front_opening",
            number(Length, Limits::within(SHORTEST, LONGEST)),
            absent("δc"),
            "opening from which the camera counts a point as torn",
        )
        .key(
            "weights",
            Kind::Weights,
            absent("all points count alike"),
            "stretches of the record that count less, more, or not at all in a fit: { from_s, to_s, weight } each; where two overlap, the later one holds",
        );
    b.section("tests.weights")
        .key(
            "from",
            number(Time, Limits::within(0.0, FOREVER)),
            Fallback::Required,
            "first instant of the stretch",
        )
        .key(
            "to",
            number(Time, Limits::within(0.0, FOREVER)),
            Fallback::Required,
            "last instant of the stretch",
        )
        .key(
            "weight",
            number(Dimensionless, Limits::within(0.0, 100.0)),
            Fallback::Number(0.0),
            "factor of its part in χ²; 0: left out of the fit",
        );
    b.section("tests.protocol")
        .key(
            "to",
            number(Length, Limits::within(-LONGEST, LONGEST)),
            absent("`hold_s` is needed"),
            "displacement at the end of a ramp",
        )
        .key(
            "rate",
            number(Speed, Limits::within(1e-9, 1e6)),
            absent("`hold_s` is needed"),
            "speed of a ramp, positive in either direction",
        )
        .key(
            "hold",
            number(Time, Limits::within(INSTANT, FOREVER)),
            absent("`to_mm` and `rate_mm_per_s` are needed"),
            "duration of a hold",
        );
}
