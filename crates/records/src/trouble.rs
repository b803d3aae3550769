//! Why a file gives no tests, before its path is told.

use crate::error::{Fault, ImportError, Question};
use crate::workbook::Unopened;
use std::path::Path;

pub(crate) enum Trouble {
    /// It holds no table of numbers.
    NoTable,
    /// What it is instead of a record.
    NotARecord(String),
    /// Flags must decide.
    Ask(Vec<Question>),
    /// Flags, the table or its rows are wrong.
    Wrong(Vec<Fault>),
}

impl Trouble {
    /// The error of a file.
    pub(crate) fn of(self, path: &Path) -> ImportError {
        let path = path.to_owned();
        match self {
            Self::NoTable => {
                let reason =
                    "no table of numbers in this text; expected rows of time, displacement and force";
                ImportError::NotARecord { path, reason: reason.into() }
            }
            Self::NotARecord(reason) => ImportError::NotARecord { path, reason },
            Self::Ask(questions) => ImportError::Undecided { path, questions },
            Self::Wrong(faults) => ImportError::Faulty { path, faults },
        }
    }
}

impl From<Question> for Trouble {
    fn from(question: Question) -> Self {
        Self::Ask(vec![question])
    }
}

impl From<Vec<Fault>> for Trouble {
    fn from(faults: Vec<Fault>) -> Self {
        Self::Wrong(faults)
    }
}

impl From<Unopened> for Trouble {
    fn from(e: Unopened) -> Self {
        match e {
            Unopened::Bad(reason) => Self::NotARecord(reason),
            Unopened::Ask(question) => question.into(),
        }
    }
}
