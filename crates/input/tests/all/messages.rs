//! Every wrong file of `tests/bad` gives exactly the messages in the `.stderr` beside it.
//!
//! `UPDATE=1 cargo test -p input messages::` writes them anew; read the difference before believing it.

use crate::common;

use common::{Catalogue, STRIP};
use input::read_case;
use std::fs;
use std::path::{Path, PathBuf};

/// What the command line would print for a file. Records are read through a specimen of their own.
fn messages(path: &Path) -> String {
    let is_toml = path.extension().is_some_and(|e| e == "toml");
    if is_toml {
        return match read_case(path, &Catalogue) {
            Ok(case) => format!("accepted, {} warnings\n", case.warnings.len()),
            Err(found) => format!("{found}\n"),
        };
    }
    let folder = tempfile::tempdir().expect("a temporary folder");
    let name = path.file_name().expect("a file");
    fs::copy(path, folder.path().join(name)).expect("copied");
    let outline = name.to_string_lossy().starts_with("outline");
    let geometry = STRIP.split("[[tests]]").next().unwrap_or_default();
    let text = match outline {
        true => STRIP.replace("cut_mm", &format!("outline = {name:?}\ncut_mm")),
        false => format!("{geometry}[[tests]]\nkind = \"tearing\"\ndata = {name:?}\n"),
    };
    let specimen = folder.path().join("specimen.toml");
    fs::write(&specimen, text).expect("written");
    let out = match read_case(&specimen, &Catalogue) {
        Ok(case) => case.warnings.iter().map(|w| format!("{w}\n")).collect(),
        Err(found) => format!("{found}\n"),
    };
    out.replace(&format!("{}/", folder.path().display()), "")
}

#[test]
fn every_wrong_file_gives_the_messages_beside_it() {
    let mut files: Vec<PathBuf> =
        fs::read_dir("tests/bad").expect("the folder").map(|e| e.expect("an entry").path()).collect();
    files.retain(|f| f.extension().is_some_and(|e| e == "toml" || e == "csv"));
    files.sort();
    assert!(files.len() >= 40, "only {} files", files.len());
    let mut wrong = Vec::new();
    for file in &files {
        let (found, beside) = (
            messages(file),
            file.with_extension(format!("{}.stderr", file.extension().unwrap_or_default().to_string_lossy())),
        );
        if std::env::var_os("UPDATE").is_some() {
            fs::write(&beside, &found).expect("written");
        }
        let expected = fs::read_to_string(&beside).unwrap_or_default();
        if found != expected {
            wrong.push(format!("--- {}\nexpected:\n{expected}\nfound:\n{found}", file.display()));
        }
        assert!(!found.contains('\u{1b}'), "{} lets a control character through", file.display());
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
