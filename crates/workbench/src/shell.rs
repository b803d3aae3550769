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

/// The line that writes a small text to a file.
pub fn written(text: &str, file: &str) -> String {
    let lines: Vec<String> = text.lines().map(|l| format!("'{}'", l.replace('\'', "'\\''"))).collect();
    format!("mkdir -p {} && printf '%s\\n' {} > {}", quoted(folder(file)), lines.join(" "), quoted(file))
}

fn folder(file: &str) -> &str {
    file.rsplit_once('/').map_or(".", |f| f.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_can_be_pasted() {
        let words = ["import", "raw/a b.csv", "--force=Load [N]", "--zero", "--out", "x"].map(str::to_owned);
        assert_eq!(line(&words), "fct import 'raw/a b.csv' --force='Load [N]' --zero --out x");
        let text = written("name = \"o'n\"\n[geometry]\n", "a/b.toml");
        assert_eq!(text, r#"mkdir -p a && printf '%s\n' 'name = "o'\''n"' '[geometry]' > a/b.toml"#);
    }
}
