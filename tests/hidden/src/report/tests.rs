use super::{Beside, Study, page};
use crate::forward::Fineness;
use crate::outcome::Outcome;
use serde_json::{Value, json};
use std::path::Path;

/// An answer that states `lag` with the probability `sure`, to a record with hidden `backlash`.
fn answer(name: &str, sure: f64, groups: &[&str]) -> Value {
    let step = json!({"effects": [], "objective": 2.0, "reduced_chi2_total": 1.0, "bic": 1.0, "rms_N": 0.1,
        "held_out_chi2": null, "structure_p": 0.5, "gc": 0.2, "explained": true});
    json!({
        "truth": {
            "name": name, "seed": 1, "protocol": "paper", "effects": ["backlash"], "strengths": [1.0],
            "effect_parameters": {"backlash": {"b": 0.04}},
            "tissue": {"around": "FCT5", "mu": 0.004, "k1": 3.6, "k2": 89.0, "gamma": 1.3, "kappa": 0.3,
                "gc": [0.2], "sigma_c": [0.2], "shrunk": 1.0},
            "noise_fraction": 0.01, "noise_ar1": 0.0, "noise_sd_N": {}, "camera": false,
            "effect_rms_over_noise": {}, "what_no_base_parameter_imitates_over_noise": 28.0,
            "each_over_noise": {"backlash": 28.0}, "mesh_error_rms_over_noise": {}, "computed_on": "a mesh"
        },
        "end": "answered", "verdict": "explained", "found": groups, "groups": [groups], "screen": [],
        "ladder": [step], "tried": [step], "failed": [],
        "stated": {"effects": {"lag": sure, "backlash": 0.01}, "nothing": 0.0, "something_else": 0.2, "rest": 0.013,
            "base_gc": [0.19, 0.185, 0.195], "averaged_gc": [0.19, 0.15, 0.21]},
        "forward_runs": 1, "seconds": 3.0
    })
}

fn outcome(v: &Value) -> Outcome {
    serde_json::from_value(v.clone()).expect("an outcome")
}

fn study(left_out: Vec<Outcome>) -> Study {
    Study { command: "-- all".into(), commit: None, planned: 1, fineness: Fineness::SMALL, left_out }
}

#[test]
fn a_name_in_place_of_the_effect_that_was_left_out_is_counted() {
    let all = [outcome(&answer("case-001", 0.97, &["lag"]))];
    let left_out = vec![all[0].clone(), outcome(&answer("case-002", 0.94, &["lag"]))];
    // Prose is folded.
    let text = page(&all, &study(left_out), None).replace('\n', " ");
    assert!(text.contains("Another effect was stated with 95 % or more in 1 of 2 (50 %)"), "{text}");
    let row = "| case-002 | Paper | backlash (1; 28) | explained | lag | lag 94 % | 20 % | 1.3 % |";
    assert!(text.contains(row), "{text}");
    let whole = page(&all, &study(Vec::new()), None);
    assert!(whole.starts_with("# Records with a hidden effect: small strips\n"));
    // Gc is 0.2 N/mm.
    let base =
        "base model's 95 % interval, something hidden | ≥ 85 % | 0 of 1 (0 %), ± 2.5 % (median) | **no** |";
    let averaged = "averaged over what may be missing, something hidden | ≥ 85 % | 1 of 1 (100 %), ± 15.0 % (median) | yes |";
    assert!(whole.contains(base) && whole.contains(averaged), "{whole}");
    assert!(!whole.contains("left out") && !whole.contains("These are the cases"));
    assert!(
        whole.contains("| mesh of the fit | 1.4 mm and 0.5 mm, one layer, Gauss points, 2 areas;"),
        "{whole}"
    );
    let part = page(&all, &Study { planned: 9, ..study(Vec::new()) }, None);
    assert!(part.contains("These are the cases 1; the others were not asked."), "{part}");
}

/// Another program's names become probabilities: 95 % in even shares of a group, the rest in even shares.
#[test]
fn names_of_another_program_are_scored_as_shares() {
    let folder = tempfile::tempdir().expect("a folder");
    let of = |name: &str| folder.path().join(name);
    let write = |path: &Path, v: &Value| {
        std::fs::create_dir_all(path).expect("made");
        std::fs::write(path.join("result.json"), v.to_string()).expect("written");
    };
    write(&of("case-001"), &answer("case-001", 0.5, &["lag", "backlash"]));
    let own = [outcome(&answer("case-001", 0.97, &["lag"])), outcome(&answer("case-002", 0.97, &["lag"]))];
    let beside = Beside::new("its", &own, folder.path());
    assert_eq!(beside.outcomes.len(), 1);
    let shares = &beside.outcomes[0].stated.as_ref().expect("stated").effects;
    assert_eq!((shares["lag"], shares["backlash"]), (0.475, 0.475));
    let text = page(&own, &study(Vec::new()), Some(&beside));
    let row = |start: &str| text.lines().find(|l| l.starts_with(start)).map(str::to_owned).expect("a row");
    let first = row("| visible effect, or its stated group, first |");
    assert!(first.ends_with("| 0 of 2 (0 %) | **no** | 1 of 1 (100 %) |"), "{first}");
}

/// A law of other people is answered right by its kind, and its names are no statements about the catalogue.
#[test]
fn a_foreign_law_asks_for_its_kind() {
    let of = |name: &str, word: &str, groups: &[&str]| {
        let mut v = answer(name, 0.97, groups);
        v["groups"] = if groups.is_empty() { json!([]) } else { json!([groups]) };
        v["truth"]["effects"] = json!([word]);
        v["truth"]["each_over_noise"] = json!({ word: if word.ends_with("noise") { 0.0 } else { 28.0 } });
        outcome(&v)
    };
    let all = [
        of("case-001", "foreign:energy_norm_damage", &["mullins"]),
        of("case-002", "foreign:energy_norm_damage", &["lag"]),
        of("case-003", "foreign:load_cell_noise", &[]),
        of("case-004", "foreign:load_cell_noise", &["lag"]),
    ];
    let text = page(&all, &study(Vec::new()), None).replace('\n', " ");
    assert!(text.contains("kind was named, and nothing else: 1 of 2 (50 %)"), "{text}");
    assert!(
        text.contains("given no name: 1 of 2 (50 %)") && text.contains("of all: 2 of 4 (50 %)"),
        "{text}"
    );
    assert!(!text.contains("## Stated probabilities"), "{text}");
    assert!(
        text.contains("| of effects stated with 90 % or more, true | ≥ 90 % | none to count |"),
        "{text}"
    );
}
