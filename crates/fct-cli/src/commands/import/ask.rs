//! Questions on a terminal.

use crate::cli::Common;
use records::{Choices, Question};
use std::io::{BufRead, IsTerminal, Write};
use std::path::Path;

/// Whether somebody is there to answer.
pub fn can(common: &Common) -> bool {
    std::io::stdin().is_terminal() && std::io::stderr().is_terminal() && !common.json && !common.quiet
}

/// Asks; false if nothing was answered. Answers are kept as the flags they stand for.
pub fn all(path: &Path, questions: &[Question], choices: &mut Choices, answered: &mut Vec<String>) -> bool {
    let mut lines = std::io::stdin().lock().lines();
    questions.iter().all(|q| one(path, q, &mut lines, choices, answered))
}

fn one(
    path: &Path,
    question: &Question,
    lines: &mut impl Iterator<Item = std::io::Result<String>>,
    choices: &mut Choices,
    answered: &mut Vec<String>,
) -> bool {
    let mut err = std::io::stderr();
    let _ = writeln!(err, "{}: {}", path.display(), question.what);
    for o in &question.options {
        let _ = writeln!(err, "  {}   {}", o.value, o.meaning);
    }
    loop {
        let _ = write!(err, "--{} ", question.flag);
        let _ = err.flush();
        let Some(Ok(line)) = lines.next() else { return false };
        if line.trim().is_empty() {
            return false;
        }
        match choices.answer(&question.flag, &line) {
            Ok(()) => {
                answered.push(format!("--{} {}", question.flag, line.trim()));
                return true;
            }
            Err(why) => {
                let _ = writeln!(err, "  {why}");
            }
        }
    }
}
