//! Commands that are printed for people to paste.

use std::path::Path;

/// A word as a POSIX shell takes it: blanks, quotes and what else means something to a shell are quoted. A word
/// that begins with `-` would be taken for a flag by whoever reads it; as a path it is named from here.
pub fn quoted(word: &str) -> String {
    let word = if word.starts_with('-') { format!("./{word}") } else { word.to_owned() };
    let plain = |c: char| {
        c.is_ascii_alphanumeric() || "/._-+,:=@%".contains(c) || (!c.is_ascii() && c.is_alphanumeric())
    };
    if !word.is_empty() && word.chars().all(plain) {
        word
    } else {
        format!("'{}'", word.replace('\'', "'\\''"))
    }
}

/// A path as a shell takes it.
pub fn quoted_path(path: &Path) -> String {
    quoted(&path.display().to_string())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::process::Command;

    #[test]
    fn a_shell_reads_back_what_was_meant() -> Result<(), Box<dyn std::error::Error>> {
        let words = [
            "plain/run-1.toml",
            "two words",
            "it's",
            "$HOME",
            "a;b",
            "`x`",
            "\"q\"",
            "*",
            "~",
            "é ä",
            "#1",
            "!x",
        ];
        for word in words {
            let out = Command::new("sh").arg("-c").arg(format!("printf %s {}", quoted(word))).output()?;
            assert_eq!(String::from_utf8(out.stdout)?, word);
        }
        assert_eq!((quoted("plain/run-1.toml").as_str(), quoted("").as_str()), ("plain/run-1.toml", "''"));
        assert_eq!(quoted("-x.toml"), "./-x.toml");
        Ok(())
    }
}
