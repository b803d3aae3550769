//! What the benches measured, as ratios within each group: `just bench` ends with it. Times of two machines, or of one
//! machine on two days, do not compare; ratios of one run do.
use serde_json::Value;
use std::collections::BTreeMap;
use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};

/// Folders named `new` below a folder: one per benchmark.
fn measured(folder: &Path, found: &mut Vec<PathBuf>) -> std::io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() && path.file_name().is_some_and(|n| n == "new") {
            found.push(path);
        } else if path.is_dir() {
            measured(&path, found)?;
        }
    }
    Ok(())
}

fn json(file: PathBuf) -> Result<Value, Box<dyn Error>> {
    Ok(serde_json::from_str(&fs::read_to_string(file)?)?)
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut found = Vec::new();
    let target = std::env::var_os("CARGO_TARGET_DIR")
        .map_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../target"), PathBuf::from);
    measured(&target.join("criterion"), &mut found)?;
    let mut groups: BTreeMap<String, Vec<(f64, String)>> = BTreeMap::new();
    for folder in found {
        let (id, times) = (json(folder.join("benchmark.json"))?, json(folder.join("estimates.json"))?);
        let nanoseconds = times["median"]["point_estimate"].as_f64().ok_or("no median")?;
        let name = id["function_id"].as_str().or(id["value_str"].as_str()).unwrap_or("").to_owned();
        groups.entry(id["group_id"].as_str().unwrap_or("").to_owned()).or_default().push((nanoseconds, name));
    }
    for (group, mut list) in groups {
        list.sort_by(|a, b| a.0.total_cmp(&b.0));
        println!("{group}");
        for (time, name) in &list {
            println!("  {:8.2} × the fastest  {:>12.3} µs  {name}", time / list[0].0, time * 1e-3);
        }
    }
    Ok(())
}
