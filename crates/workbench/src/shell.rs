//! Commands as a shell takes them.

use report::quoted;

/// `fct ARGUMENTS`, to be pasted into a shell. Flags stay flags.
pub fn line(arguments: &[String]) -> String {
    let words = arguments.iter().map(|a| match a.split_once('=') {
        Some((flag, value)) if flag.starts_with("--") => format!("{flag}={}", value_quoted(value)),
        _ if a.starts_with("--") => a.clone(),
        _ => quoted(a),
    });
    std::iter::once("fct".to_owned()).chain(words).collect::<Vec<_>>().join(" ")
}

fn value_quoted(value: &str) -> String {
    // Behind `=` no dash is taken for a flag.
    quoted(value)
        .strip_prefix("./")
        .filter(|_| value.starts_with('-'))
        .map_or_else(|| quoted(value), str::to_owned)
}

/// A remark between the commands.
pub fn remark(text: &str) -> String {
    format!("# {}", text.replace(['\n', '\r'], " "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_can_be_pasted() {
        let words = ["import", "raw/a b.csv", "--force=Load [N]", "--zero", "--out", "x"].map(str::to_owned);
        assert_eq!(line(&words), "fct import 'raw/a b.csv' --force='Load [N]' --zero --out x");
        assert_eq!(remark("a\nfct drop x"), "# a fct drop x");
    }
}
