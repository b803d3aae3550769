//! What `fct workbench` was given, the folder that this opens, and paths inside it.

use crate::BenchError;
use std::path::{Component, Path, PathBuf};

/// A folder that is open, and what is looked at in it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Opened {
    /// The folder, absolute, without symbolic links.
    pub root: PathBuf,
    /// The workbench's own folder in it, relative to it.
    pub home: PathBuf,
    /// What the first step shows.
    pub first: First,
}

/// What a workbench begins with; paths relative to the folder.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum First {
    /// An empty page.
    Nothing,
    /// A run directory.
    Run(String),
    /// A specimen or config.
    Config(String),
    /// Files of a testing machine.
    Raw(Vec<String>),
}

impl Opened {
    /// Opens the folder of what was named: a run directory, a specimen or config (`.toml`), files of a testing machine; a
    /// folder that is no run, or nothing, is an empty page in that folder.
    ///
    /// # Errors
    /// If a file is not there, or several are named that are not files of one folder.
    pub fn of(named: &[PathBuf]) -> Result<Self, BenchError> {
        let Some(first) = named.first() else { return Self::folder(Path::new(".")) };
        let all = named.iter().map(|p| whole(p)).collect::<Result<Vec<_>, _>>()?;
        let asked = |why: &str| BenchError::Asked(format!("{}: {why}", first.display()));
        if let [one] = all.as_slice() {
            if one.is_dir() && !one.join("run.toml").is_file() {
                return Self::folder(one);
            }
            let (root, name) = apart(one).ok_or_else(|| asked("this has no folder around it"))?;
            let stem = one.file_stem().map_or_else(|| name.clone(), |s| s.to_string_lossy().into_owned());
            if one.is_dir() {
                return Ok(Self { root, home: format!("{name}-workbench").into(), first: First::Run(name) });
            }
            if one.extension().is_some_and(|e| e.eq_ignore_ascii_case("toml")) {
                return Ok(Self {
                    root,
                    home: format!("{stem}-workbench").into(),
                    first: First::Config(name),
                });
            }
        }
        let parts: Vec<(PathBuf, String)> =
            all.iter().filter(|p| p.is_file()).filter_map(|p| apart(p)).collect();
        let root = parts.first().map(|p| p.0.clone()).filter(|r| parts.iter().all(|p| p.0 == *r));
        match root {
            Some(root) if parts.len() == all.len() => {
                Ok(Self { root, home: "workbench".into(), first: First::Raw(parts.into_iter().map(|p| p.1).collect()) })
            }
            _ => Err(BenchError::Asked(
                "expected one run directory, one specimen or config, or files of a testing machine in one folder".into(),
            )),
        }
    }

    fn folder(folder: &Path) -> Result<Self, BenchError> {
        Ok(Self { root: whole(folder)?, home: "workbench".into(), first: First::Nothing })
    }

    /// A file of the folder by its relative path; nothing outside, through no symbolic link.
    ///
    /// # Errors
    /// If the path leads elsewhere, or there is no such file.
    pub fn inside(&self, path: &str) -> Result<PathBuf, BenchError> {
        let not =
            || BenchError::Asked(format!("{}: no such file in the opened folder", input::visible(path)));
        let relative = Path::new(path);
        let plain = relative.components().all(|c| matches!(c, Component::Normal(_)));
        if path.is_empty() || !plain || path.contains(['\\', '\0', ':']) {
            return Err(not());
        }
        let real = self.root.join(relative).canonicalize().map_err(|_| not())?;
        if real.starts_with(&self.root) && real.is_file() { Ok(real) } else { Err(not()) }
    }

    /// The workbench's own folder.
    pub fn own(&self) -> PathBuf {
        self.root.join(&self.home)
    }
}

fn whole(path: &Path) -> Result<PathBuf, BenchError> {
    path.canonicalize().map_err(BenchError::io(path, "open"))
}

fn apart(path: &Path) -> Option<(PathBuf, String)> {
    Some((path.parent()?.to_owned(), path.file_name()?.to_str()?.to_owned()))
}

/// A dropped file's name as a name in the workbench's folder: its last part, of harmless letters, no hidden file.
pub fn file_name(name: &str) -> String {
    let last = name.rsplit(['/', '\\']).next().unwrap_or_default();
    let safe: String = last
        .chars()
        .map(|c| if c.is_alphanumeric() || "-_.+ ".contains(c) { c } else { '_' })
        .take(100)
        .collect();
    let safe = safe.trim_matches(['.', ' ', '-']).to_owned();
    if safe.is_empty() { "file".into() } else { safe }
}

#[cfg(test)]
mod tests {
    use super::*;

    type Tested = Result<(), Box<dyn std::error::Error>>;

    #[test]
    fn what_is_named_opens_its_folder() -> Tested {
        let folder = tempfile::tempdir()?;
        let here = folder.path().canonicalize()?;
        std::fs::create_dir_all(here.join("runs/base"))?;
        for file in ["runs/base/run.toml", "strip.toml", "a.csv", "b.csv"] {
            std::fs::write(here.join(file), "")?;
        }
        let of = |names: &[&str]| Opened::of(&names.iter().map(|n| here.join(n)).collect::<Vec<_>>());
        let run = of(&["runs/base"])?;
        assert_eq!((run.root, run.first), (here.join("runs"), First::Run("base".into())));
        let config = of(&["strip.toml"])?;
        assert_eq!(
            (config.home, config.first),
            ("strip-workbench".into(), First::Config("strip.toml".into()))
        );
        assert_eq!(of(&["a.csv", "b.csv"])?.first, First::Raw(vec!["a.csv".into(), "b.csv".into()]));
        assert_eq!(of(&["runs"])?.first, First::Nothing);
        for bad in [&["a.csv", "runs/base"][..], &["a.csv", "runs/base/run.toml"], &["none.csv"]] {
            assert!(of(bad).is_err(), "{bad:?}");
        }
        Ok(())
    }

    #[cfg(unix)]
    #[test]
    fn no_path_leads_out_of_the_folder() -> Tested {
        let (outer, folder) = (tempfile::tempdir()?, tempfile::tempdir()?);
        std::fs::write(outer.path().join("secret"), "x")?;
        std::fs::write(folder.path().join("own"), "y")?;
        std::os::unix::fs::symlink(outer.path(), folder.path().join("way"))?;
        std::os::unix::fs::symlink(outer.path().join("secret"), folder.path().join("link"))?;
        let opened = Opened::folder(folder.path())?;
        assert!(opened.inside("own").is_ok());
        let up = format!("../{}/secret", outer.path().file_name().unwrap_or_default().to_string_lossy());
        for bad in ["way/secret", "link", &up, "./../own", "/etc/passwd", "", "own\0", "..\\own", "."] {
            assert!(opened.inside(bad).is_err(), "{bad}");
        }
        Ok(())
    }

    #[test]
    fn a_dropped_name_is_a_plain_name() {
        for (given, kept) in [
            ("../../etc/passwd", "passwd"),
            ("a\\b\\Zug 1.TRA", "Zug 1.TRA"),
            (".bashrc", "bashrc"),
            ("..", "file"),
            ("-rf", "rf"),
            ("a<b>\n.csv", "a_b__.csv"),
        ] {
            assert_eq!(file_name(given), kept);
        }
    }
}
