//! What right files give.

use crate::common;

use common::{Catalogue, STRIP};
use input::{
    Case, Control, Diagnostics, Ends, Grips, Leg, Mode, OptionValue, Symmetry, Value, keys, read_case,
    resolved_toml, resolved_toml_with,
};
use std::fs;
use std::path::PathBuf;
use tempfile::TempDir;

const RECORD: &str = "time_s,displacement_mm,force_N\n0,0,0\n1,0.1,0.5\n2,0.2,0.8\n3,0.1,0.3\n";

/// A folder with files in it.
fn folder(files: &[(&str, &str)]) -> TempDir {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for (name, text) in files {
        fs::write(folder.path().join(name), text).expect("written");
    }
    folder
}

fn read(text: &str) -> Result<Case, Diagnostics> {
    let folder = folder(&[("case.toml", text), ("a.csv", RECORD), ("b.csv", RECORD)]);
    read_case(&folder.path().join("case.toml"), &Catalogue)
}

fn good(text: &str) -> Case {
    read(text).unwrap_or_else(|e| panic!("{e}"))
}

#[test]
fn a_specimen_alone_has_every_default() {
    let case = good(STRIP);
    assert_eq!(case.name, "strip");
    assert_eq!((case.geometry.length, case.geometry.width, case.geometry.cut), (10.0, 6.0, 1.0));
    assert_eq!(case.tests.iter().map(|t| t.name.as_str()).collect::<Vec<_>>(), ["uniaxial", "tearing"]);
    let test = &case.tests[0];
    assert_eq!((test.kind.word(), test.ends, test.grips), ("uniaxial", Ends::Clamped, Grips::Ends));
    assert!(test.remount && !test.fresh_piece && test.rest_s.is_none() && test.record.is_none());
    let legs = [Leg::Ramp { to_mm: 2.0, rate_mm_per_s: 0.05 }, Leg::Hold { hold_s: 60.0 }];
    assert_eq!(test.protocol.as_deref(), Some(&legs[..]));
    assert_eq!((case.mesh.bulk_size, case.mesh.path_size, case.mesh.layers), (0.4, 0.1, 2));
    assert_eq!((case.mesh.divisions, case.mesh.symmetry), (None, Symmetry::Auto));
    assert_eq!(case.bulk.value("mu"), Value::default());
    assert_eq!(case.bulk.value("d"), Value { fixed: Some(true), ..Value::new(0.1) });
    assert_eq!((case.bulk.law.as_str(), case.interface.law.as_str()), ("hgo", "exponential"));
    assert_eq!(case.bulk.options["tension_only"], OptionValue::Bool(true));
    assert_eq!(case.bulk.options["fibre_invariants"], OptionValue::Text("isochoric".into()));
    assert_eq!((case.interface.areas, case.interface.gc.as_slice()), (1, &[Value::default()][..]));
    assert_eq!(case.interface.value("penalty").value, Some(10.0));
    assert_eq!(
        (case.identify.mode, case.identify.tolerance, case.identify.max_iterations),
        (Mode::Staged, 1e-6, 30)
    );
    assert_eq!((case.solver.control, case.solver.step_mm), (Control::Actuator, None));
    assert_eq!((case.output.fields, case.output.noise), (8, None));
    assert!(case.warnings.is_empty() && case.config_file.is_none() && case.specimen_file.is_some());
}

/// The example of the contract, word for word.
const CONTRACT: &str = r#"specimen = "strip.toml"            # or [geometry] and [[tests]] inline
[mesh]
divisions = [8, 20, 2]
symmetry = "none"                  # "auto" (default) | "none"
[bulk]
mu_kPa = 5.1                       # every stress-like key takes _Pa, _kPa or _MPa
k1_kPa = 938.8
k2 = 20.09
gamma_deg = 38.53
kappa = 0.23
bulk_modulus_MPa = 20.0            # = 2/D; `d_per_MPa` is accepted instead
tension_only = true
fibre_invariants = "isochoric"     # | "full"
[interface]
areas = 1
gc_N_per_mm = 0.23                 # one value, or a list with one per area
sigma_c_MPa = 0.1
lambda = 1.0
penalty_N_per_mm3 = 10.0
[effects.viscoelastic]             # parameters as in the card
g = 0.2
tau_s = 12.0
[solver]
step_mm = 0.05
control = "actuator"
"#;

#[test]
fn the_contracts_example_reads_in_internal_units() {
    let folder = folder(&[("config.toml", CONTRACT), ("strip.toml", STRIP)]);
    let case = read_case(&folder.path().join("config.toml"), &Catalogue).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(case.name, "strip");
    assert_eq!(case.config_file, Some(folder.path().join("config.toml")));
    assert_eq!(case.specimen_file, Some(folder.path().join("strip.toml")));
    assert_eq!(case.mesh.divisions, Some([8, 20, 2]));
    assert_eq!(case.bulk.value("mu"), Value::new(5.1 * 1e-3));
    assert_eq!(case.bulk.value("gamma").value, Some(38.53_f64 * (std::f64::consts::PI / 180.0)));
    assert_eq!(case.bulk.value("d").value, Some(0.1));
    assert_eq!(case.interface.gc_of(0).value, Some(0.23));
    let effect = case.effect("viscoelastic").expect("the effect");
    assert_eq!(effect.parameters["tau"], Value::new(12.0));
    assert_eq!(effect.options["branches"], OptionValue::Integer(1));
    assert_eq!(effect.location.line, 20);
    assert_eq!(case.solver.step_mm, Some(0.05));
}

#[test]
fn limits_are_allowed_where_they_mean_something() {
    let case =
        good(&format!("{STRIP}[bulk]\nkappa = 0.3333333333333333\ngamma_deg = 90\nk2 = 0\nk1_kPa = 0.0\n"));
    assert_eq!(case.bulk.value("kappa").value, Some(1.0 / 3.0));
    assert_eq!(case.bulk.value("gamma").value, Some(std::f64::consts::FRAC_PI_2));
    assert!(read(&format!("{STRIP}[bulk]\nkappa = 0.33334\n")).is_err());
    assert!(read(&STRIP.replace("cut_mm = 1.0", "cut_mm = 6.0")).is_err());
    assert_eq!(good(&STRIP.replace("cut_mm = 1.0", "cut_mm = 0")).geometry.cut, 0.0);
}

#[test]
fn bounds_of_the_bulk_modulus_change_places_in_d() {
    let freed = "bulk_modulus_MPa = { start = 20.0, min = 5.0, max = 50.0, fixed = false }";
    let d = good(&format!("{STRIP}[bulk]\n{freed}\n")).bulk.value("d");
    assert_eq!(
        d,
        Value { value: Some(0.1), min: Some(2.0 / 50.0), max: Some(2.0 / 5.0), fixed: Some(false) }
    );
    let open = good(&format!("{STRIP}[bulk]\nbulk_modulus_MPa = {{ min = 0 }}\n")).bulk.value("d");
    assert_eq!((open.min, open.max, open.value), (None, None, Some(0.1)));
    assert_eq!(good(&format!("{STRIP}[bulk]\nd_per_MPa = 0.25\n")).bulk.value("d").value, Some(0.25));
}

#[test]
fn repeated_tests_are_numbered_around_names_that_are_taken() {
    let test = |name: &str| format!("[[tests]]\n{name}kind = \"uniaxial\"\ndata = \"a.csv\"\n");
    let text = format!(
        "[geometry]\nlength_mm = 10\nwidth_mm = 6\nthickness_mm = 1\n{}{}{}{}",
        test(""),
        test("name = \"uniaxial-2\"\n"),
        test(""),
        test("name = \"slow to stretch 2\"\n")
    );
    let names: Vec<String> = good(&text).tests.into_iter().map(|t| t.name).collect();
    assert_eq!(names, ["uniaxial", "uniaxial-2", "uniaxial-3", "slow to stretch 2"]);
}

#[test]
fn a_record_is_read_in_any_unit_with_comments_quotes_gaps_and_windows_line_ends() {
    let csv = "\u{FEFF}# made by hand\r\n\r\n time_min , force_mN,displacement_um,segment,tear_front_mm\r\n\
               0,0,0,\"load, slow\",\r\n# turn\r\n0.5,100,200,\"a \"\"b\"\"\", 1.5\r\n  1,50,-1e2,,2\r\n";
    let text = STRIP.replace("protocol = [{ to_mm = 4.0, rate_mm_per_s = 0.05 }]", "data = \"r.csv\"");
    let folder = folder(&[("s.toml", &text.replace('\n', "\r\n")), ("r.csv", csv)]);
    let case = read_case(&folder.path().join("s.toml"), &Catalogue).unwrap_or_else(|e| panic!("{e}"));
    let record = case.tests[1].record.as_ref().expect("the record");
    assert_eq!(record.time, [0.0, 30.0, 60.0]);
    assert_eq!(record.displacement, [0.0, 0.2, -0.1]);
    assert_eq!(record.force, [0.0, 0.1, 0.05]);
    let segments = record.segment.as_ref().expect("segments");
    assert_eq!(segments, &["load, slow", "a \"b\"", ""]);
    assert_eq!(record.tear_front.as_deref(), Some(&[None, Some(1.5), Some(2.0)][..]));
    assert!(record.grip_displacement.is_none() && record.len() == 3);
}

#[test]
fn an_outline_is_read_from_a_file() {
    let csv = "right_mm,y_mm,left_mm\n6,0,0\n5.5,5,0.5\n6,10,0\n";
    let text = STRIP.replace("cut_mm", "outline = \"o.csv\"\ncut_mm");
    let folder = folder(&[("s.toml", &text), ("o.csv", csv)]);
    let case = read_case(&folder.path().join("s.toml"), &Catalogue).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(case.geometry.outline, Some(vec![[0.0, 0.0, 6.0], [5.0, 0.5, 5.5], [10.0, 0.0, 6.0]]));
}

/// Every section, with numbers that do not survive a careless change of units.
const RICH: &str = r#"
name = "rich 'case' µ"
provenance = """synthetic:
two lines"""
parent = "runs/base"
[geometry]
length_mm = 10.1
width_mm = 6.3
thickness_um = 777.7
cut_mm = 1.1
path_y_mm = 4.7
outline_mm = [[0, 0, 6.3], [10.1, 0.1, 6]]
thickness_profile_mm = [[0, 0.7], [10.1, 0.8]]
[[tests]]
kind = "uniaxial"
data = "a.csv"
ends = "sliding"
rest_min = 7
force_sd_mN = 3.3
[[tests]]
kind = "tearing"
grips = "mouth"
fresh_piece = true
remount = false
tear_front_opening_um = 33
protocol = [{ to_mm = 1.7, rate_um_per_s = 13 }, { hold_s = 0.3 }, { to_mm = -1, rate_mm_per_min = 0.7 }]
[mesh]
path_size_mm = 0.07
layers = 3
[bulk]
mu_kPa = { start = 5.3, min = 0.7, fixed = true }
k1_Pa = 123457.1
k2 = { max = 30 }
gamma_deg = 38.53
kappa = 0.226
bulk_modulus_MPa = { start = 19.7, min = 3.3, fixed = false }
tension_only = false
fibre_invariants = "full"
[interface]
areas = 3
profile = "smooth"
gc_J_per_m2 = [230.7, { start = 113.3, max = 300 }, { fixed = true }]
sigma_c_kPa = 97.3
lambda = { start = 1, min = 0.3, fixed = false }
[effects.slack]
[effects.viscoelastic]
tau_min = { start = 0.7, min = 0.1, max = 60 }
branches = 2
[effects.gain]
test = "tearing"
[identify]
mode = "joint"
multi_start = 5
[identify.priors]
bulk.mu_kPa = { mean = 3.3, relative_sd = 0.5 }
interface.gc_N_per_mm = { mean = 0.1, relative_sd = 0.7 }
effects.viscoelastic.tau_s = { mean = 7.3, relative_sd = 1.1 }
[solver]
step_um = 51.3
control = "path"
integration = "nodal"
[output]
noise = 0.007
seed = 1
fields = false
figures = ["png", "svg"]
"#;

/// Beliefs of single parameters, the literature's left alone, and of what a complete model leaves.
const BELIEFS: &str = r#"[identify]
prior.bulk.mu_kPa = { value = 3.3, factor = 2 }
prior.interface.gc_N_per_mm = { mean = 0.1, relative_sd = 0.7 }
[diagnose]
rest = 0.03
practice = 0.05
"#;

#[test]
fn a_factor_is_that_of_one_standard_deviation() {
    let case = good(&format!("{STRIP}{BELIEFS}"));
    let prior = case.identify.priors.given["bulk.mu"];
    assert!((prior.mean - 3.3e-3).abs() < 1e-12);
    assert!(((1.0 + prior.relative_sd.powi(2)).ln().sqrt() - 2f64.ln()).abs() < 1e-12);
    assert_eq!(case.identify.priors.literature, None);
    assert_eq!((case.diagnose.rest, case.diagnose.practice), (0.03, 0.05));
}

#[test]
fn what_is_resolved_reads_back_to_the_last_bit() {
    let beliefs = format!("{STRIP}{BELIEFS}");
    for text in [STRIP, RICH, &beliefs] {
        let folder = folder(&[("case.toml", text), ("a.csv", RECORD)]);
        let case = read_case(&folder.path().join("case.toml"), &Catalogue).unwrap_or_else(|e| panic!("{e}"));
        let (resolved, elsewhere) = (resolved_toml(&case), tempfile::tempdir().expect("a folder"));
        let run = elsewhere.path().join("run.toml");
        fs::write(&run, &resolved).expect("written");
        let again = read_case(&run, &Catalogue).unwrap_or_else(|e| panic!("{e}\n{resolved}"));
        assert!(again.same_input(&case), "{resolved}");
        assert_eq!(resolved_toml(&again), resolved);
    }
}

#[test]
fn a_run_directory_may_name_its_own_copy_of_a_record() {
    let case = good(&STRIP.replace("protocol = [{ to_mm = 4.0, rate_mm_per_s = 0.05 }]", "data = \"a.csv\""));
    let text = resolved_toml_with(&case, |record| {
        PathBuf::from("data").join(record.path.file_name().unwrap_or_default())
    });
    assert!(text.contains("data = \"data/a.csv\""), "{text}");
}

#[test]
fn warnings_do_not_stop_a_case() {
    let text = STRIP.replace("protocol = [{ to_mm = 4.0", "data = \"a.csv\"\nprotocol = [{ to_mm = 4.0");
    let case = good(&text);
    assert_eq!(case.warnings.len(), 1);
    assert!(case.warnings[0].to_string().contains("warning"), "{}", case.warnings[0]);
}

#[test]
fn every_number_of_the_table_is_accepted_in_every_spelling() {
    for key in keys() {
        let (input::Kind::Number { limits, .. } | input::Kind::Parameter { limits, .. }) = key.kind else {
            continue;
        };
        let section = key.section.as_ref();
        if ["geometry", "tests", "tests.protocol", "tests.weights"].contains(&section) {
            continue;
        }
        for (spelling, factor) in key.spellings() {
            let middle = if limits.upper > 1.0 { 0.3 } else { limits.upper / 3.0 };
            let text = format!("{STRIP}[{section}]\n{spelling} = {:?}\n", middle / factor);
            let result = read(&text);
            assert!(result.is_ok(), "{text}\n{}", result.err().unwrap_or_default());
        }
    }
}

/// Of a file that is asked for its dimensions alone, what is left out is no fault, and what is given must be right.
#[test]
fn a_geometry_may_be_a_part() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("g.toml");
    let told = |text: &str| {
        fs::write(&file, text).expect("written");
        input::check_geometry(&file).map_err(|e| e.to_string()).err().unwrap_or_default()
    };
    for good in ["[geometry]\nlength_mm = 10\n", STRIP, "[geometry]\n"] {
        assert_eq!(told(good), "", "{good}");
    }
    assert!(told("[geometry]\nwidth_mm = 0\n").contains("expected a number from 0.0001 to 10000"));
    let cut = told("[geometry]\nwidth_mm = 5\ncut_mm = 6\n");
    assert!(cut.contains("expected a cut shorter than the width"), "{cut}");
    assert!(told("name = \"a/b\"\n[geometry]\n").contains("expected a name for files and folders"));
    assert!(told("name = \"a\"\n").contains("missing key `geometry`"));
    // Once, although two checks look at the table.
    assert_eq!(told("[geometry]\nlenght_mm = 1\n").matches("unknown key").count(), 1);
}
