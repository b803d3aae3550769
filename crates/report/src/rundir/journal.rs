//! Finished parts of a search, kept while it runs: a run that was killed is taken up without doing them again.

use super::files::{self, write_atomic};
use std::path::PathBuf;

/// Largest entry, bytes: states of a very large mesh are not worth keeping.
const LARGEST_ENTRY: usize = 200_000_000;

/// One file per finished part, named by its key, with a checksum: what a kill cut off counts as not there.
#[derive(Clone, Debug)]
pub struct RunJournal {
    folder: PathBuf,
}

impl RunJournal {
    /// A journal in a folder, made when the first part is kept. One process at a time writes it.
    pub const fn new(folder: PathBuf) -> Self {
        Self { folder }
    }
}

impl analysis::Journal for RunJournal {
    fn get(&self, key: &str) -> Option<Vec<u8>> {
        let bytes = files::read(&self.folder.join(key), files::LARGEST).ok()?;
        let (sum, content) = bytes.split_at_checked(64)?;
        (input::sha256(content).as_bytes() == sum).then(|| content.to_vec())
    }

    fn put(&self, key: &str, content: &[u8]) {
        if content.len() <= LARGEST_ENTRY {
            let mut bytes = input::sha256(content).into_bytes();
            bytes.extend_from_slice(content);
            // A part that cannot be kept is done again by a run that is taken up: no reason to stop.
            let path = self.folder.join(key);
            let _ = files::make_folder_of(&path).and_then(|()| write_atomic(&path, &bytes));
        }
    }

    fn has(&self, key: &str) -> bool {
        self.folder.join(key).is_file()
    }
}
