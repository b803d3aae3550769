//! Code and pages use the terms of the field, and pages describe the program as it is.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// Words that names in code may not be made of, and the term to use.
const NAMES: [(&str, &str); 20] = [
    ("arms", "asymmetric interval, side"),
    ("lean", "loading"),
    ("leans", "explained only with discretisation error"),
    ("reach", "step control, feasible start, limit"),
    ("bend", "geodesic acceleration, curvature"),
    ("untold", "indistinguishable"),
    ("strangers", "causes outside the catalogue"),
    ("rung", "candidate model, fitted model"),
    ("rungs", "candidate models, fitted models"),
    ("promise", "predicted reduction"),
    ("promises", "predicted reductions"),
    ("pays", "accepted"),
    ("sceptic", "conservative noise"),
    ("cautious", "conservative noise"),
    ("frees", "free parameters"),
    ("march", "load stepping"),
    ("blame", "error context"),
    ("tired", "at the smallest step"),
    ("stubborn", "at a short step"),
    ("carried", "carried over"),
];

/// Names that are not split into words: as they stand.
const WHOLE_NAMES: [(&str, &str); 7] = [
    ("How", "settings"),
    ("Said", "what it holds"),
    ("Slot", "data block"),
    ("by_hand", "analytic"),
    ("hand_tangent", "analytic_tangent"),
    ("fit_near_neutral_if_need_be", "restart"),
    ("again_from_the_beginning", "restart"),
];

/// Types of which there may be one each: one name, one thing.
const ONCE: [&str; 3] = ["Piece", "Search", "Shape"];

/// Phrases of pages and comments. `begin`, `reach`, `carry`, `standing` and `arm` (of a double cantilever beam) are
/// plain English or the field's own there, `rung` belongs to the ladder that users see: they are not in this list.
const PHRASES: [(&str, &str); 12] = [
    ("hand tangent", "analytic tangent"),
    ("tangent by hand", "analytic tangent"),
    ("tangents by hand", "analytic tangents"),
    ("sceptic", "conservative noise"),
    ("untold", "indistinguishable"),
    ("strangers", "causes outside the catalogue"),
    ("leans on the mesh", "explained only with discretisation error"),
    ("arms of the interval", "sides of an asymmetric interval"),
    ("standing actuator", "held actuator"),
    ("standing grip", "held grip"),
    ("tried and not kept", "a record in docs/decisions/"),
    ("until then", "what is so now"),
];

/// History is told in these alone; and this test names what it looks for.
const HISTORY: [&str; 3] = ["CHANGELOG.md", "docs/decisions", "tests/tests/all/words.rs"];

/// Longest line of a page outside tables, bytes, so that every tool counts alike.
const WIDTH: usize = 120;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Files below the project's folder with one of the endings, by their paths from there.
fn files(endings: &[&str]) -> BTreeMap<String, String> {
    let mut found = BTreeMap::new();
    let mut open = vec![root()];
    while let Some(folder) = open.pop() {
        for entry in fs::read_dir(&folder).expect("a folder").map(|e| e.expect("an entry").path()) {
            let name = entry.file_name().unwrap_or_default().to_string_lossy().into_owned();
            let hidden = name.starts_with('.') || ["target", "runs", "node_modules"].contains(&name.as_str());
            if entry.is_dir() && !hidden {
                open.push(entry);
            } else if endings.iter().any(|e| name.ends_with(e)) {
                let path = entry.strip_prefix(root()).expect("below").to_string_lossy().replace('\\', "/");
                found.insert(path, fs::read_to_string(&entry).expect("UTF-8"));
            }
        }
    }
    assert!(found.len() > 20, "the project's files: {}", found.len());
    found
}

fn below(path: &str, folders: &[&str]) -> bool {
    folders.iter().any(|f| path.strip_prefix(f).is_some_and(|rest| rest.is_empty() || rest.starts_with('/')))
}

/// Lines of Rust without comments and without what stands in quotes, raw ones and those over several lines included.
fn code(text: &str) -> Vec<String> {
    let chars: Vec<char> = text.chars().collect();
    let starts = |at: usize, what: &str| what.chars().enumerate().all(|(k, c)| chars.get(at + k) == Some(&c));
    let mut lines = vec![String::new()];
    let (mut at, mut quoted, mut raw) = (0, false, false);
    while at < chars.len() {
        let c = chars[at];
        let literal = |end: usize| starts(at, "'") && chars.get(at + end) == Some(&'\'');
        if c == '\n' {
            lines.push(String::new());
        } else if raw {
            raw = !starts(at, "\"#");
            at += usize::from(!raw);
        } else if quoted {
            at += usize::from(c == '\\' && chars.get(at + 1) != Some(&'\n'));
            quoted = c != '"';
        } else if starts(at, "//") {
            while chars.get(at + 1).is_some_and(|c| *c != '\n') {
                at += 1;
            }
        } else if starts(at, "r#\"") {
            (raw, at) = (true, at + 2);
        } else if starts(at, "'\\") && literal(3) {
            at += 3;
        } else if literal(2) {
            at += 2;
        } else if c == '"' {
            quoted = true;
        } else if let Some(line) = lines.last_mut() {
            line.push(c);
        }
        at += 1;
    }
    lines
}

#[test]
fn comments_and_quotes_are_no_code() {
    let text = "let a = \"b // \\\" c\nd\"; // e\nlet f = ('\"', '\\'', r#\"g \" h\"#);";
    assert_eq!(code(text), ["let a = ", "; ", "let f = (, , );"]);
}

/// Names in a line of code.
fn names(code: &str) -> Vec<&str> {
    code.split(|c: char| !c.is_alphanumeric() && c != '_').filter(|n| !n.is_empty()).collect()
}

fn report(faults: &[String]) {
    assert!(faults.is_empty(), "{} places:\n{}", faults.len(), faults.join("\n"));
}

#[test]
fn names_in_code_are_the_fields_words() {
    let mut faults = Vec::new();
    for (path, text) in files(&[".rs"]) {
        if below(&path, &HISTORY) {
            continue;
        }
        for (k, line) in code(&text).iter().enumerate() {
            for name in names(line) {
                let whole = WHOLE_NAMES.iter().find(|w| w.0 == name);
                let part = NAMES.iter().find(|w| name.to_lowercase().split('_').any(|p| p == w.0));
                if let Some((word, term)) = whole.or(part) {
                    faults.push(format!("{path}:{}: `{word}` in `{name}`: {term}", k + 1));
                }
            }
        }
    }
    report(&faults);
}

#[test]
fn one_name_is_one_thing() {
    let mut places: BTreeMap<&str, Vec<String>> = BTreeMap::new();
    for (path, text) in files(&[".rs"]) {
        for line in code(&text) {
            for pair in names(&line).windows(2) {
                if let (["struct" | "enum" | "trait" | "type", name], true) = (pair, !line.starts_with(' '))
                    && let Some(once) = ONCE.iter().find(|o| *o == name)
                {
                    places.entry(once).or_default().push(path.clone());
                }
            }
        }
    }
    report(&places.iter().filter(|p| p.1.len() > 1).map(|p| format!("{p:?}")).collect::<Vec<_>>());
}

#[test]
fn pages_and_comments_are_in_the_fields_words() {
    let mut faults = Vec::new();
    for (path, text) in files(&[".rs", ".md", ".toml", ".py"]) {
        if below(&path, &HISTORY) {
            continue;
        }
        for (k, line) in text.lines().enumerate() {
            let line = line.to_lowercase();
            for (phrase, term) in PHRASES.iter().filter(|p| line.contains(p.0)) {
                faults.push(format!("{path}:{}: {phrase}: {term}", k + 1));
            }
        }
    }
    report(&faults);
}

/// Whether a word before "session" makes a diary of it.
fn counts_sessions(word: &str) -> bool {
    let ordinals =
        ["first", "second", "third", "fourth", "fifth", "sixth", "seventh", "eighth", "ninth", "tenth"];
    let others = ["eleventh", "twelfth", "twentieth", "this", "last", "that"];
    ordinals.contains(&word) || others.contains(&word) || word.ends_with("teenth")
}

#[test]
fn pages_and_comments_tell_no_history() {
    let diary = |text: &str| {
        let lower = text.to_lowercase();
        let words: Vec<&str> =
            lower.split(|c: char| !c.is_alphanumeric()).filter(|w| !w.is_empty()).collect();
        words.windows(2).any(|w| ["session", "sessions"].contains(&w[1]) && counts_sessions(w[0]))
    };
    assert!(diary("as of the Fourteenth\nsession") && !diary("a session of the browser"));
    let tells = |(path, text): &(String, String)| !below(path, &HISTORY) && diary(text);
    let told = files(&[".rs", ".md", ".toml", ".py", "justfile"]).into_iter().filter(tells);
    report(&told.map(|f| f.0).collect::<Vec<_>>());
}

#[test]
fn lines_of_pages_fit_a_screen() {
    let mut faults = Vec::new();
    for (path, text) in files(&[".md"]) {
        for (k, line) in text.lines().enumerate() {
            if line.len() > WIDTH && !line.trim_start().starts_with('|') {
                faults.push(format!("{path}:{}: {} bytes", k + 1, line.len()));
            }
        }
    }
    report(&faults);
}
