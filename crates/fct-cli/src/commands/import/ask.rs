//! Questions on a terminal.

use crate::session::Session;
use records::{Choices, Question, visible};
use std::io::{BufRead, IsTerminal, Write};
use std::path::Path;

/// Whether somebody is there to answer.
pub fn can(session: &Session) -> bool {
    let common = &session.common;
    std::io::stdin().is_terminal() && std::io::stderr().is_terminal() && !common.json && !common.quiet
}

/// Asks one question until its answer can be one; `None` where an empty line, or the end of the input, leaves it open.
/// The answer is the flag's value.
pub fn one(path: &Path, question: &Question, choices: &mut Choices, session: &Session) -> Option<String> {
    let mut err = std::io::stderr();
    let _ = writeln!(err, "{}: {}", visible(&path.display().to_string()), question.what);
    for o in &question.options {
        let _ = writeln!(err, "  {}   {}", visible(&o.value), o.meaning);
    }
    loop {
        let mut line = String::new();
        let read = session.waiting(|| {
            let _ = write!(err, "--{} (empty: stop) ", question.flag);
            let _ = err.flush();
            std::io::stdin().lock().read_line(&mut line)
        });
        let value = value(&line, &question.flag);
        if read.is_err() || value.is_empty() {
            // The next message begins on a line of its own.
            if !line.ends_with('\n') {
                let _ = writeln!(err);
            }
            return None;
        }
        match choices.answer(&question.flag, value) {
            Ok(()) => return Some(value.to_owned()),
            Err(why) => {
                let _ = writeln!(err, "  {why}");
            }
        }
    }
}

/// What was typed, which may be the whole flag.
fn value<'a>(line: &'a str, flag: &str) -> &'a str {
    let line = line.trim();
    let Some(rest) = line.strip_prefix("--").and_then(|l| l.strip_prefix(flag)) else { return line };
    match rest.strip_prefix(['=', ' ']) {
        Some(rest) => rest.trim().trim_matches(['\'', '"']),
        None => line,
    }
}

#[cfg(test)]
mod tests {
    use super::value;

    #[test]
    fn the_flag_may_be_typed_too() {
        for typed in ["Load [kN]\n", " --force 'Load [kN]'\r\n", "--force=Load [kN]", "--force \"Load [kN]\""]
        {
            assert_eq!(value(typed, "force"), "Load [kN]", "{typed}");
        }
        assert_eq!((value("\n", "force"), value("--forces 3", "force")), ("", "--forces 3"));
    }
}
