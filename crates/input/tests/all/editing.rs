//! Adding and dropping effects keeps what the user wrote; the schema follows the table of keys.

use crate::common;

use common::{Catalogue, STRIP};
use input::{edit, json_schema, keys, read_case};
use std::collections::HashSet;
use std::fs;
use std::path::Path;

const CONFIG: &str = "\
# my strip
specimen = \"strip.toml\"   # made in May

[bulk]
k1_kPa = 938.8              # from the uniaxial test
mu_kPa = 5.1

# tried on Monday
[effects.slack]
u0_mm = 0.1

[solver]
step_mm = 0.05
";

const PARAMETERS: [edit::NewParameter<'_>; 2] = [("g", 0.21, "from the screen"), ("tau_s", 12.0, "")];

#[test]
fn an_effect_is_added_after_the_others_and_nothing_else_changes() {
    let text = edit::add_effect(CONFIG, "viscoelastic", &PARAMETERS, "the hold relaxes:\nχ² falls by 83 %")
        .expect("added");
    let block = "\n# the hold relaxes: χ² falls by 83 %\n[effects.viscoelastic]\ng = 0.21  # from the screen\ntau_s = 12.0\n";
    let expected = CONFIG.replace("u0_mm = 0.1\n", &format!("u0_mm = 0.1\n{block}"));
    assert_eq!(text, expected);
    assert_eq!(edit::drop_effect(&text, "viscoelastic", "").expect("dropped"), CONFIG);
    assert!(edit::add_effect(&text, "viscoelastic", &[], "").is_err());
    assert!(edit::drop_effect(CONFIG, "gain", "").is_err());
}

#[test]
fn every_way_to_write_effects_stays_readable() {
    let forms = [
        "",
        "effects = { slack = { u0_mm = 0.1 } }\n",
        "effects.slack.u0_mm = 0.1\n",
        "effects.slack = { u0_mm = 0.1 }\n",
        "[effects]\nslack = { u0_mm = 0.1 }\n",
        "[effects]\nslack.u0_mm = 0.1\n",
    ];
    for form in forms {
        let text = if form.starts_with('[') { format!("{STRIP}{form}") } else { format!("{form}{STRIP}") };
        let added = edit::add_effect(&text, "viscoelastic", &PARAMETERS, "a reason").expect("added");
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("c.toml");
        fs::write(&path, &added).expect("written");
        let case = read_case(&path, &Catalogue).unwrap_or_else(|e| panic!("{e}\n{added}"));
        assert_eq!(case.effects.len(), if form.is_empty() { 1 } else { 2 }, "{added}");
        assert!(added.contains("# a reason"), "{added}");
        let dropped = edit::drop_effect(&added, "viscoelastic", "it does not pay").expect("dropped");
        fs::write(&path, &dropped).expect("written");
        let case = read_case(&path, &Catalogue).unwrap_or_else(|e| panic!("{e}\n{dropped}"));
        assert!(case.effect("viscoelastic").is_none());
        assert!(dropped.ends_with("# effect `viscoelastic` taken out: it does not pay\n"), "{dropped}");
    }
}

#[test]
fn a_config_that_moves_keeps_pointing_to_its_files() {
    let moved = edit::rebase(CONFIG, Path::new("/data"), Path::new("/elsewhere"), false).expect("moved");
    assert_eq!(moved, CONFIG.replace("\"strip.toml\"", "\"/data/strip.toml\""));
    let specimen = "[geometry]\noutline = \"o.csv\"\n[[tests]]\ndata = \"a.csv\" # first\n[[tests]]\ndata = \"/b.csv\"\n";
    let moved = edit::rebase(specimen, Path::new("/d"), Path::new("/e"), false).expect("moved");
    assert_eq!(moved, specimen.replace("\"a.csv", "\"/d/a.csv").replace("\"o.csv", "\"/d/o.csv"));
    assert_eq!(edit::rebase(CONFIG, Path::new("/d"), Path::new("/d"), false).expect("same"), CONFIG);
    let with_parent = edit::set_parent(CONFIG, "runs/a").expect("set");
    assert!(with_parent.contains("made in May\nparent = \"runs/a\"\n"), "{with_parent}");
}

#[test]
fn every_key_is_described_once() {
    assert_eq!(serde_json::to_value(keys()).expect("JSON")[0]["name"], "name");
    let mut seen = HashSet::new();
    for key in keys() {
        assert!(
            !key.description.is_empty() && !key.description.ends_with('.'),
            "{}.{}",
            key.section,
            key.name
        );
        for (spelling, factor) in key.spellings() {
            assert!(factor > 0.0);
            assert!(seen.insert((key.section.clone(), spelling.clone())), "{spelling} twice");
        }
    }
}

#[test]
fn the_schema_has_every_section_effect_and_spelling() {
    let schema = json_schema(&Catalogue);
    let properties = &schema["properties"];
    assert_eq!(properties["bulk"]["properties"]["kappa"]["anyOf"][0]["maximum"], 1.0 / 3.0);
    assert_eq!(properties["bulk"]["properties"]["mu_kPa"]["anyOf"][0]["minimum"], 1e-6);
    assert_eq!(properties["output"]["properties"]["noise"]["minimum"], 0.0);
    assert_eq!(properties["interface"]["properties"]["areas"]["default"], 1);
    assert!(properties["effects"]["properties"]["viscoelastic"]["properties"]["tau_min"].is_object());
    assert_eq!(properties["effects"]["properties"]["viscoelastic"]["properties"]["branches"]["maximum"], 4);
    assert!(
        properties["tests"]["items"]["properties"]["protocol"]["items"]["properties"]["to_mm"].is_object()
    );
    assert_eq!(schema["additionalProperties"], false);
}

/// What moves as a whole keeps its paths; what lies elsewhere is named from the root.
#[test]
fn paths_are_relative_where_that_is_near() {
    let text = "specimen = \"../strip/specimen.toml\"\n[[tests]]\ndata = \"/study/strip/tearing.csv\"\n";
    let near =
        |from: &str, to: &str, ours| edit::rebase(text, Path::new(from), Path::new(to), ours).expect("moved");
    let users = near("/study/configs", "/study", false);
    assert_eq!(users, text.replace("../strip", "strip"));
    let ours = near("/study/runs/base", "/study/runs", true);
    assert!(
        ours.contains("specimen = \"strip/specimen.toml\"")
            && ours.contains("data = \"../strip/tearing.csv\""),
        "{ours}"
    );
    let far = near("/study/configs", "/home/me", true);
    assert!(
        far.contains("\"/study/strip/specimen.toml\"") && far.contains("\"/study/strip/tearing.csv\""),
        "{far}"
    );
    let deep = near("/study/configs", "/study/a/b/c", false);
    assert!(deep.contains("\"/study/strip/specimen.toml\""), "{deep}");
}
