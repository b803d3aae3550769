use super::*;
use analysis::Journal;

type Tested = Result<(), Box<dyn std::error::Error>>;

fn begin(place: &Path) -> Result<RunDir, ReportError> {
    RunDir::begin(place, Begin::default())
}

/// A finished run with these files.
fn run(place: &Path, files: &[&str]) -> Tested {
    let run = begin(place)?;
    for name in files {
        run.write(name, name.as_bytes())?;
    }
    run.finish()?;
    Ok(())
}

fn names(folder: &Path) -> Vec<String> {
    let mut out: Vec<String> = fs::read_dir(folder)
        .into_iter()
        .flatten()
        .filter_map(|e| e.ok().map(|e| e.file_name().to_string_lossy().into_owned()))
        .collect();
    out.sort();
    out
}

#[test]
fn nothing_is_seen_before_the_end_and_files_of_the_user_stay() -> Tested {
    let folder = tempfile::tempdir()?;
    let place = folder.path().join("run");
    let first = begin(&place)?;
    first.write("curves/a.csv", b"1")?;
    assert!(!place.exists());
    assert!(matches!(begin(&place), Err(ReportError::Locked(_))));
    first.write("run.toml", b"")?;
    first.finish()?;
    fs::write(place.join("notes.txt"), "mine")?;
    fs::write(place.join("curves/raw_day1.csv"), "mine")?;
    fs::create_dir(place.join("figures"))?;
    fs::write(place.join("figures/photo.png"), "mine")?;
    run(&place, &["run.toml", "figures/b.svg"])?;
    assert!(!place.join("curves/a.csv").exists() && place.join("figures/b.svg").exists());
    for mine in ["notes.txt", "curves/raw_day1.csv", "figures/photo.png"] {
        assert_eq!(fs::read_to_string(place.join(mine))?, "mine");
    }
    assert_eq!(names(folder.path()), ["run"]);
    assert_eq!(names(&place), ["curves", "figures", MANIFEST, "notes.txt", "run.toml"]);
    Ok(())
}

#[test]
fn a_directory_of_the_user_is_left_alone() -> Tested {
    let folder = tempfile::tempdir()?;
    fs::write(folder.path().join("run.toml"), "mine")?;
    assert!(matches!(begin(folder.path()), Err(ReportError::Foreign(_))));
    assert!(matches!(begin(&folder.path().join("run.toml")), Err(ReportError::NotADirectory(_))));
    assert_eq!(names(folder.path()), ["run.toml"]);
    Ok(())
}

#[test]
fn with_force_only_files_of_the_same_name_are_replaced() -> Tested {
    let folder = tempfile::tempdir()?;
    fs::write(folder.path().join("run.toml"), "mine")?;
    fs::write(folder.path().join("thesis.tex"), "mine")?;
    let run = RunDir::begin(folder.path(), Begin { force: true, resume: false })?;
    run.write("run.toml", b"ours")?;
    run.finish()?;
    assert_eq!(fs::read_to_string(folder.path().join("run.toml"))?, "ours");
    assert_eq!(names(folder.path()), [MANIFEST, "run.toml", "thesis.tex"]);
    Ok(())
}

#[test]
fn a_file_that_the_user_changed_is_theirs() -> Tested {
    let folder = tempfile::tempdir()?;
    let place = folder.path().join("run");
    run(&place, &["run.toml", "summary.json"])?;
    fs::write(place.join("run.toml"), "changed by hand")?;
    assert!(matches!(begin(&place), Err(ReportError::Changed(_))));
    assert_eq!(fs::read_to_string(place.join("run.toml"))?, "changed by hand");
    Ok(())
}

#[test]
fn what_comes_in_the_way_while_a_run_goes_on_stays() -> Tested {
    let folder = tempfile::tempdir()?;
    let place = folder.path().join("run");
    run(&place, &["run.toml"])?;
    let second = begin(&place)?;
    second.write("run.toml", b"2")?;
    second.write("curves/a.csv", b"2")?;
    fs::write(place.join("curves"), "a file of the user's where a folder is to be")?;
    assert_eq!(second.finish()?, folder.path().join("run-2"));
    assert_eq!(fs::read_to_string(place.join("run.toml"))?, "run.toml");
    assert_eq!(fs::read_to_string(folder.path().join("run-2/curves/a.csv"))?, "2");
    Ok(())
}

#[test]
fn a_link_of_the_user_leads_nowhere() -> Tested {
    let folder = tempfile::tempdir()?;
    let (place, theirs) = (folder.path().join("run"), folder.path().join("theirs"));
    fs::create_dir(&theirs)?;
    fs::write(theirs.join("a.csv"), "mine")?;
    run(&place, &["run.toml"])?;
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink(&theirs, place.join("curves"))?;
        run(&place, &["run.toml", "curves/a.csv"])?;
        assert_eq!(fs::read_to_string(theirs.join("a.csv"))?, "mine");
    }
    Ok(())
}

#[test]
fn a_run_killed_while_it_is_put_in_its_place_is_put_there_by_the_next() -> Tested {
    let folder = tempfile::tempdir()?;
    let place = folder.path().join("run");
    run(&place, &["run.toml", "old.csv", "curves/a.csv"])?;
    // As a kill leaves it: all is written, the marker too, one file is in its place.
    let part = place.join(PART);
    for (name, content) in [("run.toml", "2"), ("curves/b.csv", "2")] {
        files::make_folder_of(&part.join(name))?;
        fs::write(part.join(name), content)?;
    }
    fs::write(part.join("commit.json"), Manifest::of(&part)?.bytes()?)?;
    fs::rename(part.join("run.toml"), place.join("run.toml"))?;
    settle(&place)?;
    assert_eq!(names(&place), ["curves", MANIFEST, "run.toml"]);
    assert_eq!(names(&place.join("curves")), ["b.csv"]);
    assert_eq!(Manifest::read(&place)?.ok_or("manifest")?.changed(&place)?, None);
    Ok(())
}

#[test]
fn finished_parts_are_found_again_after_a_kill_and_after_a_stop() -> Tested {
    let folder = tempfile::tempdir()?;
    let place = folder.path().join("run");
    let resume = Begin { resume: true, force: false };
    let killed = begin(&place)?;
    killed.journal().put("one", b"1");
    killed.write("half.csv", b"")?;
    // A killed run removes nothing.
    std::mem::forget(killed);
    fs::remove_file(sibling(&place, "lock"))?;
    let stopped = RunDir::begin(&place, resume)?;
    assert_eq!(stopped.journal().get("one").as_deref(), Some(&b"1"[..]));
    assert!(!stopped.part().join("half.csv").exists());
    stopped.journal().put("two", b"2");
    stopped.write("run.toml", b"")?;
    assert_eq!(stopped.finish_partial(true)?, Kept::At(place.clone()));
    let last = RunDir::begin(&place, resume)?;
    let both = ["one", "two"].map(|k| last.journal().get(k).is_some());
    assert_eq!(both, [true, true]);
    fs::write(last.part().join("resume/two"), "cut off")?;
    assert_eq!(last.journal().get("two"), None);
    last.write("run.toml", b"")?;
    last.finish()?;
    assert_eq!(names(&place), [MANIFEST, "run.toml"]);
    assert_eq!(names(folder.path()), ["run"]);
    Ok(())
}

#[test]
fn amending_keeps_the_rest_and_the_manifest_true() -> Tested {
    let folder = tempfile::tempdir()?;
    let place = folder.path().join("run");
    run(&place, &["run.toml", "report.html"])?;
    fs::write(place.join("notes.txt"), "mine")?;
    amend(&place, &[("report.html", b"new"), ("diagnosis.json", b"{}")])?;
    let manifest = Manifest::read(&place)?.ok_or("manifest")?;
    assert_eq!(manifest.files.keys().collect::<Vec<_>>(), ["diagnosis.json", "report.html", "run.toml"]);
    assert_eq!(manifest.changed(&place)?, None);
    assert!(amend(&place, &[("notes.txt", b"ours")]).is_err());
    assert_eq!(fs::read_to_string(place.join("notes.txt"))?, "mine");
    assert_eq!(names(&place), ["diagnosis.json", MANIFEST, "notes.txt", "report.html", "run.toml"]);
    Ok(())
}

#[test]
fn a_manifest_that_leads_elsewhere_is_damaged() -> Tested {
    let folder = tempfile::tempdir()?;
    for name in ["../thesis.tex", "/etc/passwd", ""] {
        let manifest = Manifest { files: [(name.to_owned(), String::new())].into(), ..Manifest::default() };
        fs::write(folder.path().join(MANIFEST), manifest.bytes()?)?;
        assert!(Manifest::read(folder.path()).is_err(), "{name}");
    }
    Ok(())
}

/// One file beside runs: what is there and not ours is only replaced when asked to.
#[test]
fn a_named_file_replaces_its_like_and_nothing_else() -> Tested {
    let folder = tempfile::tempdir()?;
    let place = folder.path().join("batch.html");
    let write = |content: &str, force| {
        write_named(&place, content.as_bytes(), force, |there| there.starts_with(b"ours"))
    };
    write("ours 1", false)?;
    write("ours 2", false)?;
    assert_eq!(fs::read_to_string(&place)?, "ours 2");
    fs::write(&place, "mine")?;
    assert!(matches!(write("ours 3", false), Err(ReportError::Exists(at)) if at == place));
    assert_eq!(fs::read_to_string(&place)?, "mine");
    write("mine", false)?;
    write("ours 3", true)?;
    assert_eq!(fs::read_to_string(&place)?, "ours 3");
    fs::remove_file(&place)?;
    fs::create_dir(&place)?;
    assert!(matches!(write("ours 4", true), Err(ReportError::Exists(_))));
    assert_eq!(names(folder.path()), ["batch.html"]);
    Ok(())
}
