//! Every package that is linked into `fct` may be used by anyone: its licence, as `cargo metadata` has it, offers at
//! least one choice that stands in docs/dependencies.md.

use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::process::Command;

/// Licences that ask for no more than a notice.
const ALLOWED: [&str; 9] = [
    "MIT",
    "Apache-2.0",
    "BSD-2-Clause",
    "BSD-3-Clause",
    "Zlib",
    "0BSD",
    "BSL-1.0",
    "Unlicense",
    "Unicode-3.0",
];

/// The platform this runs on: packages of others need not be there.
fn host() -> String {
    let out = Command::new("rustc").arg("-vV").output().expect("rustc runs");
    let text = String::from_utf8_lossy(&out.stdout).into_owned();
    text.lines().find_map(|l| l.strip_prefix("host: ")).expect("host").to_owned()
}

fn metadata() -> Value {
    let manifest = concat!(env!("CARGO_MANIFEST_DIR"), "/../Cargo.toml");
    let cargo = std::env::var("CARGO").unwrap_or_else(|_| "cargo".into());
    let out = Command::new(cargo)
        .args(["metadata", "--locked", "--offline", "--format-version", "1", "--manifest-path", manifest])
        .args(["--filter-platform", &host()])
        .output()
        .expect("cargo runs");
    assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
    serde_json::from_slice(&out.stdout).expect("cargo metadata is JSON")
}

/// Ids of what `fct-cli` links here, itself included.
fn linked(metadata: &Value) -> BTreeSet<String> {
    let nodes = metadata["resolve"]["nodes"].as_array().expect("nodes");
    let by_id: BTreeMap<&str, &Value> = nodes.iter().filter_map(|n| Some((n["id"].as_str()?, n))).collect();
    let normal =
        |d: &&Value| d["dep_kinds"].as_array().is_some_and(|k| k.iter().any(|k| k["kind"].is_null()));
    let root = by_id.keys().find(|id| id.contains("fct-cli")).expect("fct-cli");
    let mut found = BTreeSet::from([(*root).to_owned()]);
    let mut open = vec![*root];
    while let Some(node) = open.pop().and_then(|id| by_id.get(id)) {
        for d in node["deps"].as_array().into_iter().flatten().filter(normal) {
            let id = d["pkg"].as_str().expect("id");
            if found.insert(id.to_owned()) {
                open.push(id);
            }
        }
    }
    found
}

/// Whether an SPDX expression can be met with allowed licences: `AND` binds tighter than `OR`; `/` is the old `OR`.
fn can_be_met(expression: &str) -> bool {
    let flat = expression.replace('/', " OR ");
    let flat = flat.trim();
    if let Some((left, right)) = split_outside(flat, " OR ") {
        return can_be_met(left) || can_be_met(right);
    }
    if let Some((left, right)) = split_outside(flat, " AND ") {
        return can_be_met(left) && can_be_met(right);
    }
    match flat.strip_prefix('(').and_then(|s| s.strip_suffix(')')) {
        Some(inner) => can_be_met(inner),
        None => ALLOWED.contains(&flat.split(" WITH ").next().unwrap_or(flat)),
    }
}

/// Both sides of the first operator that stands outside brackets.
fn split_outside<'a>(text: &'a str, operator: &str) -> Option<(&'a str, &'a str)> {
    let depth = |at: usize| text[..at].matches('(').count() - text[..at].matches(')').count();
    let at = text.match_indices(operator).map(|(at, _)| at).find(|&at| depth(at) == 0)?;
    Some((&text[..at], &text[at + operator.len()..]))
}

#[test]
fn expressions_are_read_as_spdx_means_them() {
    for good in ["MIT", "MIT/Apache-2.0", "GPL-3.0 OR MIT", "(MIT OR GPL-2.0) AND Unicode-3.0"] {
        assert!(can_be_met(good), "{good}");
    }
    for bad in ["", "GPL-3.0", "MIT AND GPL-3.0", "(MIT OR Zlib) AND LGPL-2.1", "MPL-2.0"] {
        assert!(!can_be_met(bad), "{bad}");
    }
}

#[test]
fn everything_linked_is_free_to_use() {
    let metadata = metadata();
    let linked = linked(&metadata);
    assert!(linked.len() > 50, "{} packages", linked.len());
    let packages = metadata["packages"].as_array().expect("packages");
    let refused: Vec<String> = packages
        .iter()
        .filter(|p| p["id"].as_str().is_some_and(|id| linked.contains(id)))
        .filter(|p| !can_be_met(p["license"].as_str().unwrap_or_default()))
        .map(|p| format!("{} {}: {}", p["name"], p["version"], p["license"]))
        .collect();
    assert!(refused.is_empty(), "{refused:#?}");
}
