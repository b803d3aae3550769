//! The house has floors, and arrows go down only: docs/architecture.md held against `cargo metadata`.

use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::process::Command;

/// Each crate with what it may see. A crate not listed here fails the test.
const MAY_SEE: &[(&str, &[&str])] = &[
    // 0
    ("params", &[]),
    ("mesh", &[]),
    ("records", &[]),
    // 1
    ("constitutive", &["params"]),
    ("input", &["params"]),
    ("inverse", &["params"]),
    // 2
    ("hgo", &["constitutive", "params"]),
    ("cohesive", &["constitutive", "params"]),
    ("laws", &["cohesive", "constitutive", "hgo", "input", "params"]),
    ("fem", &["constitutive", "mesh", "params"]),
    // Supports are `fem`'s, strips are `mesh`'s, cards and tests are `input`'s.
    ("experiments", &["fem", "input", "mesh"]),
    ("diagnose", &["inverse", "params"]),
    ("evidence", &["inverse", "params"]),
    // 3
    (
        "model",
        &["cohesive", "constitutive", "experiments", "fem", "input", "inverse", "laws", "mesh", "params"],
    ),
    // 4
    ("effects", &["cohesive", "constitutive", "input", "model", "params"]),
    ("analysis", &["constitutive", "diagnose", "evidence", "fem", "input", "inverse", "model", "params"]),
    // cohesive, constitutive, fem: the fields it writes (stress, damage) are computed from states.
    (
        "report",
        &[
            "analysis",
            "cohesive",
            "constitutive",
            "diagnose",
            "fem",
            "input",
            "inverse",
            "mesh",
            "model",
            "params",
        ],
    ),
    // 5
    ("campaign", &["analysis", "input", "inverse", "model", "report"]),
    // 5. The commands themselves are handed to it: it runs none by itself.
    ("workbench", &["analysis", "input", "model", "params", "report"]),
    // 6
    (
        "fct-cli",
        &[
            "analysis",
            "campaign",
            "diagnose",
            "effects",
            "input",
            "inverse",
            "model",
            "params",
            "records",
            "report",
            "workbench",
        ],
    ),
    ("fct-python", &["analysis", "campaign", "effects", "input", "model", "records", "report"]),
    // See all.
    ("hidden-suite", &["*"]),
    ("workspace-tests", &["*"]),
];

/// What tests, benches and examples may see besides: never part of the shipped graph.
const TESTS_MAY_SEE: &[(&str, &[&str])] = &[
    ("fem", &["hgo", "cohesive"]),
    ("input", &["experiments", "laws", "model"]),
    ("experiments", &["analysis", "effects", "model"]),
    ("effects", &["experiments", "hgo", "laws", "mesh"]),
    ("fct-cli", &["laws"]),
    ("workbench", &["effects"]),
    ("diagnose", &["params"]),
    ("analysis", &["effects", "experiments"]),
    ("model", &["effects"]),
];

type Graph = BTreeMap<String, (BTreeSet<String>, BTreeSet<String>)>;

/// Workspace crates: (normal and build dependencies, dev-dependencies) inside the workspace.
fn graph() -> Graph {
    let manifest = concat!(env!("CARGO_MANIFEST_DIR"), "/../Cargo.toml");
    let cargo = std::env::var("CARGO").unwrap_or_else(|_| "cargo".into());
    let out = Command::new(cargo)
        .args(["metadata", "--no-deps", "--offline", "--format-version", "1", "--manifest-path", manifest])
        .output()
        .expect("cargo runs");
    assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
    let metadata: Value = serde_json::from_slice(&out.stdout).expect("cargo metadata is JSON");
    let packages = metadata["packages"].as_array().expect("packages");
    let names: BTreeSet<&str> = packages.iter().filter_map(|p| p["name"].as_str()).collect();
    let mut graph = Graph::new();
    for p in packages {
        let entry = graph.entry(p["name"].as_str().expect("name").into()).or_default();
        for d in p["dependencies"].as_array().expect("dependencies") {
            let name = d["name"].as_str().expect("name");
            if names.contains(name) && d["path"].is_string() {
                let set = if d["kind"] == "dev" { &mut entry.1 } else { &mut entry.0 };
                set.insert(name.into());
            }
        }
    }
    graph
}

fn allowed(list: &[(&str, &[&str])], name: &str) -> BTreeSet<String> {
    list.iter().filter(|(n, _)| *n == name).flat_map(|(_, a)| a.iter().map(|s| s.to_string())).collect()
}

#[test]
fn crates_see_only_the_floors_below() {
    let mut faults = Vec::new();
    for (name, (normal, dev)) in graph() {
        if !MAY_SEE.iter().any(|(n, _)| *n == name) {
            faults.push(format!(
                "{name} has no place in the architecture: give it one here and in docs/architecture.md"
            ));
            continue;
        }
        let below = allowed(MAY_SEE, &name);
        if below.contains("*") {
            continue;
        }
        let in_tests: BTreeSet<String> = below.union(&allowed(TESTS_MAY_SEE, &name)).cloned().collect();
        faults.extend(normal.difference(&below).map(|d| format!("{name} must not see {d}")));
        faults.extend(dev.difference(&in_tests).map(|d| format!("tests of {name} must not see {d}")));
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

/// The table above must itself be free of circles: every crate stands after all it may see.
#[test]
fn the_floors_are_in_order() {
    for (k, (name, below)) in MAY_SEE.iter().enumerate() {
        for b in below.iter().filter(|b| **b != "*") {
            assert!(MAY_SEE[..k].iter().any(|(n, _)| n == b), "{name} stands before {b}");
        }
    }
}

fn reaches(graph: &Graph, from: &str) -> BTreeSet<String> {
    let (mut seen, mut open) = (BTreeSet::new(), vec![from.to_owned()]);
    while let Some(name) = open.pop() {
        for d in &graph[&name].0 {
            if seen.insert(d.clone()) {
                open.push(d.clone());
            }
        }
    }
    seen
}

#[test]
fn finite_elements_know_no_material() {
    let seen = reaches(&graph(), "fem");
    assert!(!seen.contains("hgo") && !seen.contains("cohesive"), "{seen:?}");
}

#[test]
fn statistics_know_no_mechanics() {
    let graph = graph();
    for name in ["inverse", "diagnose", "evidence"] {
        let seen = reaches(&graph, name);
        for mechanics in ["constitutive", "hgo", "cohesive", "mesh", "fem", "model", "effects"] {
            assert!(!seen.contains(mechanics), "{name} reaches {mechanics}");
        }
    }
}

#[test]
fn ground_floor_sees_nothing() {
    let graph = graph();
    for name in ["params", "mesh", "records"] {
        assert!(graph[name].0.is_empty(), "{name}: {:?}", graph[name].0);
    }
}
