//! The reference pages that are made from the program: the JSON schema of the files for editors, the table of all
//! keys, the catalogue of effects. `just book` (UPDATE=1) writes them anew.

use crate::common;

use common::Tested;
use serde_json::Value;
use std::fmt::Write;
use std::fs;
use std::path::Path;

const DOCS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs");

const HEAD: &str = "# Keys of the TOML files\n\n\
    Written by `just book` from the program's own list of keys; the same as a JSON schema, for editors that complete\n\
    and check while one types: [fct.schema.json](fct.schema.json). With the extension *Even Better TOML* put\n\
    `#:schema path/to/fct.schema.json` on the first line of a file.\n\n\
    Units are in the key: every stress-like key takes `_Pa`, `_kPa` or `_MPa`, and so on; the table shows one of the\n\
    spellings. A parameter is a number, or a table `{ start = 2.0, min = 0.1, max = 50.0, fixed = true }`. A specimen and a\n\
    config take the same keys.\n";

#[test]
fn the_reference_is_what_the_program_reads() -> Tested {
    let schema = input::json_schema(&effects::catalogue());
    let mut page = String::from(HEAD);
    section(&mut page, "", &schema)?;
    held("book/src/reference/fct.schema.json", &format!("{schema}\n"))?;
    held("book/src/reference/keys.md", &page)
}

#[test]
fn fct_schema_prints_that_schema() -> Tested {
    let here = tempfile::tempdir()?;
    // By the library: the page may be on its way to the disk.
    let stored = format!("{}\n", input::json_schema(&effects::catalogue()));
    let out = common::fct(here.path(), &["schema"])?;
    assert!(out.status.success() && String::from_utf8(out.stdout)? == stored);
    assert_eq!(common::json(here.path(), &["schema"])?.1, serde_json::from_str::<Value>(&stored)?);
    Ok(())
}

#[test]
fn shells_and_man_read_what_is_written_for_them() -> Tested {
    let here = tempfile::tempdir()?;
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let out = common::fct(here.path(), &["completions", shell])?;
        let script = String::from_utf8(out.stdout)?;
        assert!(
            out.status.success() && script.contains("identify") && script.contains("campaign"),
            "{shell}"
        );
        fs::write(here.path().join(shell), script)?;
    }
    let bash = std::process::Command::new("bash").args(["-n", "bash"]).current_dir(here.path()).status();
    assert!(bash.is_ok_and(|s| s.success()) || cfg!(not(unix)));
    let page = |arguments: &[&str]| common::fct(here.path(), arguments).map(|o| String::from_utf8(o.stdout));
    let whole = page(&["man"])??;
    assert!(whole.contains(".TH fct 1") && whole.contains("identify"), "{whole}");
    let one = page(&["man", "campaign"])??;
    assert!(one.contains(".TH fct\\-campaign 1") || one.contains(".TH fct-campaign 1"), "{one}");
    assert!(one.contains("slurm"));
    Ok(())
}

#[test]
fn the_catalogue_page_is_what_the_cards_say() -> Tested {
    held("catalogue.md", &effects::card_text::markdown(&effects::catalogue()))
}

#[test]
fn the_page_of_laws_is_what_the_registry_says() -> Tested {
    held("book/src/reference/laws.md", &laws::text::markdown(&laws::registry()))
}

/// The file is what it should be, or becomes so with UPDATE=1.
fn held(name: &str, content: &str) -> Tested {
    let file = Path::new(DOCS).join(name);
    if std::env::var_os("UPDATE").is_some() {
        fs::write(&file, content)?;
    }
    let stands = fs::read_to_string(&file).unwrap_or_default();
    assert!(stands == content, "{} is out of date: `just book`", file.display());
    Ok(())
}

/// One table of keys, then those of the tables inside it.
fn section(page: &mut String, path: &str, schema: &Value) -> Tested {
    let Some(keys) = schema["properties"].as_object() else { return Ok(()) };
    let inner = |v: &Value| {
        let table = v["properties"].is_object();
        let list = v["items"]["properties"].is_object();
        table || list
    };
    let mut rows = String::new();
    let mut told: Vec<&str> = Vec::new();
    for (key, value) in keys.iter().filter(|(_, v)| !inner(v) || parameter(v)) {
        // Other units of the same key say the same.
        let description = value["description"].as_str().unwrap_or_default();
        if !description.is_empty() && told.contains(&description) {
            continue;
        }
        told.push(description);
        let default = match &value["default"] {
            Value::Null => String::new(),
            v => format!("`{v}`"),
        };
        writeln!(rows, "| `{key}` | {} | {default} |", description.replace('|', "\\|"))?;
    }
    if !rows.is_empty() {
        let name = if path.is_empty() { "Top level".to_owned() } else { format!("`{path}`") };
        write!(page, "\n## {name}\n\n| key | is | default |\n|---|---|---|\n{rows}")?;
    }
    for (key, value) in keys.iter().filter(|(_, v)| inner(v) && !parameter(v)) {
        let above = path.trim_matches(['[', ']']);
        let below = if above.is_empty() { key.clone() } else { format!("{above}.{key}") };
        if value["items"]["properties"].is_object() {
            section(page, &format!("[[{below}]]"), &value["items"])?;
        } else if value["properties"].is_object() {
            section(page, &format!("[{below}]"), value)?;
        }
    }
    Ok(())
}

/// A value that may also be a table of start and bounds is a key, not a section.
fn parameter(v: &Value) -> bool {
    v["properties"]["start"].is_object() || v["anyOf"].is_array() || v["oneOf"].is_array()
}
