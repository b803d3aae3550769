//! Searches that are stopped: no part of an answer passes for a whole one, and what was finished is not done again.
#![allow(missing_docs)]

use crate::small;

use analysis::{AnalysisError, Control, Identified, Journal, SimulateControl, identify};
use inverse::PredictError;
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};

fn case() -> (tempfile::TempDir, Arc<input::Case>) {
    let folder = tempfile::tempdir().unwrap();
    small::write_records(folder.path(), false);
    let file = folder.path().join("case.toml");
    std::fs::write(&file, small::STRIP.to_owned() + small::FIT).unwrap();
    let case = input::read_case(&file, &effects::catalogue()).unwrap();
    (folder, Arc::new(case))
}

/// A journal in memory that counts what was found in it.
#[derive(Default)]
struct Memory {
    kept: Mutex<BTreeMap<String, Vec<u8>>>,
    found: AtomicUsize,
}

impl Journal for Memory {
    fn get(&self, key: &str) -> Option<Vec<u8>> {
        let kept = self.kept.lock().unwrap().get(key).cloned();
        self.found.fetch_add(usize::from(kept.is_some()), Ordering::Relaxed);
        kept
    }

    fn put(&self, key: &str, content: &[u8]) {
        self.kept.lock().unwrap().insert(key.to_owned(), content.to_vec());
    }
}

fn search(
    case: &Arc<input::Case>,
    journal: &Memory,
    cancelled: &dyn analysis::Watch,
) -> Result<Identified, AnalysisError> {
    let control = Control { progress: &|_| {}, cancelled, journal };
    identify(case.clone(), &effects::catalogue(), &control)
}

/// Everything that an answer is made of, to the last bit.
fn bits(a: &Identified) -> String {
    format!("{:?} {:?} {:?} {:?} {}", a.theta, a.uncertainty, a.quality, a.history, a.forward_runs)
}

#[test]
fn a_replay_that_was_stopped_is_no_answer() {
    let (_folder, case) = case();
    let done = search(&case, &Memory::default(), &|| false).unwrap();
    let replay = |cancelled: &dyn analysis::Watch| {
        analysis::replay(&done, &SimulateControl { progress: &|_, _| {}, cancelled })
    };
    assert!(replay(&|| false).is_ok());
    let asked = AtomicUsize::new(0);
    let stopped = replay(&|| asked.fetch_add(1, Ordering::Relaxed) > 5);
    assert_eq!(stopped.err(), Some(AnalysisError::Predict(PredictError::Interrupted)));
}

#[test]
fn a_search_goes_on_where_it_was_stopped_and_ends_in_the_same_bits() {
    let (_folder, case) = case();
    let asked = AtomicUsize::new(0);
    let count = || {
        asked.fetch_add(1, Ordering::Relaxed);
        false
    };
    let whole = bits(&search(&case, &Memory::default(), &count).unwrap());
    let all = asked.load(Ordering::Relaxed);
    for share in [0.3, 0.9] {
        let journal = Memory::default();
        let (asked, limit) = (AtomicUsize::new(0), (share * all as f64) as usize);
        let stopped = search(&case, &journal, &|| asked.fetch_add(1, Ordering::Relaxed) > limit);
        assert!(stopped.is_err(), "{share}");
        let found = journal.found.load(Ordering::Relaxed);
        let asked_again = AtomicUsize::new(0);
        let end = search(&case, &journal, &|| {
            asked_again.fetch_add(1, Ordering::Relaxed);
            false
        });
        assert_eq!(bits(&end.unwrap()), whole, "{share}");
        if share > 0.7 {
            assert!(journal.found.load(Ordering::Relaxed) > found, "{share}: nothing was taken over");
            assert!(asked_again.load(Ordering::Relaxed) < all, "{share}: all was done again");
        }
    }
}

#[test]
fn another_record_is_another_search() {
    let (folder, case) = case();
    let journal = Memory::default();
    search(&case, &journal, &|| false).unwrap();
    // A search may ask for one fit twice.
    let own = journal.found.load(Ordering::Relaxed);
    let record = folder.path().join("tearing.csv");
    let text = std::fs::read_to_string(&record).unwrap().replace(",0.08", ",0.0801");
    std::fs::write(&record, text).unwrap();
    let file = folder.path().join("case.toml");
    let changed = Arc::new(input::read_case(&file, &effects::catalogue()).unwrap());
    assert_ne!(changed.inputs, case.inputs);
    search(&changed, &journal, &|| false).unwrap();
    assert_eq!(journal.found.load(Ordering::Relaxed), 2 * own);
}
