//! The text of a file or a workbook's sheet, and what parts its cells.

use crate::bytes::Content;
use crate::choices::Choices;
use crate::dialects::{self, Hints};
use crate::text::Text;
use crate::trouble::Trouble;
use crate::{encoding, sniff, workbook};

/// Text and where it came from.
pub(crate) struct Source {
    pub text: Text,
    pub encoding: String,
    /// Why this encoding.
    pub because: &'static str,
    /// Name of the sheet, of a workbook.
    pub sheet: Option<String>,
    /// Whether the sheet's cells are numbers themselves.
    numbers: bool,
}

impl Source {
    pub(crate) fn of(content: Content, choices: &Choices) -> Result<Self, Trouble> {
        match content {
            Content::Text(bytes) => {
                let decoded =
                    encoding::decode(&bytes, choices.encoding.as_deref()).map_err(Trouble::NotARecord)?;
                let encoding = decoded.encoding.to_owned();
                Ok(Self {
                    text: Text::new(decoded.text),
                    encoding,
                    because: decoded.why,
                    sheet: None,
                    numbers: false,
                })
            }
            Content::Workbook(bytes) => {
                let sheet = workbook::read(bytes, choices.sheet.as_deref())?;
                Ok(Self {
                    text: Text::new(sheet.text),
                    encoding: "workbook".into(),
                    because: "its first bytes",
                    sheet: Some(sheet.name),
                    numbers: sheet.numbers,
                })
            }
        }
    }

    /// The program that wrote it, and what it says of its files.
    pub(crate) fn hints(&self) -> (&'static str, Hints) {
        let (dialect, mut hints) = dialects::recognise(&self.text);
        if self.sheet.is_some() {
            hints.delimiter = Some('\t');
            hints.decimal = self.numbers.then_some('.');
        }
        (dialect, hints)
    }

    /// What stands between its cells: said by the user (not of a sheet), known of the program, else seen.
    pub(crate) fn delimiter(&self, choices: &Choices, hints: &Hints) -> Result<char, Trouble> {
        match choices.delimiter.filter(|_| self.sheet.is_none()).or(hints.delimiter) {
            Some(said) => Ok(said),
            None => sniff::delimiter(&self.text).map_err(|q| q.map_or(Trouble::NoTable, Trouble::from)),
        }
    }
}
