//! Claims: one worker at a time, whoever is gone is not waited for, three losses set a task aside.

use campaign::ClaimState::{Free, Held, SetAside};
use campaign::{ATTEMPTS, Claim, Folder, claim_state};
use std::error::Error;
use std::fs;
use std::sync::atomic::{AtomicUsize, Ordering};
use tempfile::TempDir;

const KEY: &str = "0123";

fn folder() -> Result<(TempDir, Folder), Box<dyn Error>> {
    let place = tempfile::tempdir()?;
    let folder = Folder::new(place.path().join("study"));
    Ok((place, folder))
}

/// A claim whose process ended: its start is another's.
fn lose(folder: &Folder, attempt: u32) -> Result<(), Box<dyn Error>> {
    let lost = attempt - 1;
    let claim = Claim::take(folder, KEY, lost)?.ok_or("taken")?;
    let path = folder.claims().join(format!("{KEY}.{attempt}"));
    let text = fs::read_to_string(&path)?;
    drop(claim);
    let (head, _) = text.rsplit_once("\"began\":\"").ok_or("no start in the claim")?;
    fs::write(path, format!("{head}\"began\":\"1\"}}"))?;
    Ok(())
}

#[test]
fn of_many_threads_one_gets_the_task() -> Result<(), Box<dyn Error>> {
    let (_place, folder) = folder()?;
    assert_eq!(claim_state(&folder, KEY), Free(0));
    let (won, gate) = (AtomicUsize::new(0), std::sync::Barrier::new(8));
    let claims: Vec<Option<Claim>> = std::thread::scope(|s| {
        let one = || {
            gate.wait();
            Claim::take(&folder, KEY, 0).ok().flatten().inspect(|_| {
                won.fetch_add(1, Ordering::SeqCst);
            })
        };
        let threads: Vec<_> = (0..8).map(|_| s.spawn(one)).collect();
        threads.into_iter().filter_map(|t| t.join().ok()).collect()
    });
    assert_eq!(won.load(Ordering::SeqCst), 1);
    assert_eq!(claim_state(&folder, KEY), Held);
    drop(claims);
    assert_eq!(claim_state(&folder, KEY), Free(0), "a claim that is let go is no loss");
    Ok(())
}

#[cfg(target_os = "linux")]
#[test]
fn a_task_that_took_three_workers_is_set_aside() -> Result<(), Box<dyn Error>> {
    let (_place, folder) = folder()?;
    for attempt in 1..=ATTEMPTS {
        lose(&folder, attempt)?;
        let expected = if attempt < ATTEMPTS { Free(attempt) } else { SetAside };
        assert_eq!(claim_state(&folder, KEY), expected);
    }
    Ok(())
}

#[cfg(target_os = "linux")]
#[test]
fn who_comes_after_a_lost_worker_holds_the_task_alone() -> Result<(), Box<dyn Error>> {
    let (_place, folder) = folder()?;
    lose(&folder, 1)?;
    let second = Claim::take(&folder, KEY, 1)?.ok_or("free, but not to be had")?;
    assert_eq!(claim_state(&folder, KEY), Held);
    assert!(Claim::take(&folder, KEY, 1)?.is_none(), "two workers took the same attempt");
    second.done(&folder, KEY);
    assert_eq!(claim_state(&folder, KEY), Free(0), "claims of the lost stay behind");
    Ok(())
}

/// A worker on another machine, whose processes mean nothing here, is alive as long as it was heard of.
#[test]
fn a_claim_from_elsewhere_is_held_while_it_is_fresh() -> Result<(), Box<dyn Error>> {
    let (_place, folder) = folder()?;
    let path = folder.claims().join(format!("{KEY}.1"));
    fs::create_dir_all(folder.claims())?;
    fs::write(&path, r#"{"place":"elsewhere","pid":1,"began":"7"}"#)?;
    assert_eq!(claim_state(&folder, KEY), Held);
    let long_ago = std::time::SystemTime::now() - 2 * campaign::SILENCE;
    fs::File::options().write(true).open(&path)?.set_modified(long_ago)?;
    assert_eq!(claim_state(&folder, KEY), Free(1));
    Ok(())
}
