//! The search while it runs: kept in `state.json` after every accepted step.

use crate::RunDir;
use crate::answer::{StageHistory, histories};
use analysis::{HistoryEntry, Progress};
use std::sync::Mutex;

/// Runs of a search so far.
pub struct SearchLog<'a> {
    dir: &'a RunDir,
    entries: Mutex<Vec<HistoryEntry>>,
}

impl<'a> SearchLog<'a> {
    /// An empty log that keeps itself in `dir`.
    pub fn new(dir: &'a RunDir) -> Self {
        Self { dir, entries: Mutex::new(Vec::new()) }
    }

    /// Adds a run. That the state cannot be stored is no reason to stop a search: the directory is
    /// written again at its end, and that tells.
    pub fn note(&self, p: &Progress) {
        let entry = HistoryEntry {
            stage: p.stage,
            coarse: p.coarse,
            iterate: p.iterate.clone(),
            paths: p.paths.to_vec(),
        };
        let history = {
            let Ok(mut entries) = self.entries.lock() else { return };
            entries.push(entry);
            if !p.iterate.accepted {
                return;
            }
            histories(&entries)
        };
        if let Ok(text) = serde_json::to_vec(&history) {
            let _ = self.dir.write("state.json", &text);
        }
    }

    /// All runs so far, by stage.
    pub fn history(&self) -> Vec<StageHistory> {
        self.entries.lock().map(|e| histories(&e)).unwrap_or_default()
    }
}
