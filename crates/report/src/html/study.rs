//! The page of a study: sections of words, tables and pictures in the same dress as the page of a run.

use super::{Cell, document, escape, picture, table};
use serde_json::json;

/// Characters of a cell that may be broken into lines.
const SENTENCE: usize = 60;

/// One section of the page.
#[derive(Clone, Debug, Default)]
pub struct StudySection {
    /// Its title.
    pub title: String,
    /// Paragraphs above the pictures.
    pub words: Vec<String>,
    /// SVG with a caption.
    pub pictures: Vec<(String, String)>,
    /// Tables below them.
    pub tables: Vec<StudyTable>,
    /// A paragraph to be copied.
    pub to_copy: Option<String>,
}

/// A table; columns of numbers are aligned at the right.
#[derive(Clone, Debug, Default)]
pub struct StudyTable {
    /// Heads of the columns.
    pub header: Vec<&'static str>,
    /// Rows.
    pub rows: Vec<Vec<String>>,
    /// Indices of columns that hold numbers.
    pub numbers: Vec<usize>,
}

/// The top of the page.
#[derive(Clone, Debug, Default)]
pub struct StudyHead {
    /// Name of the study.
    pub name: String,
    /// What stands beside it (`synthetic records`); may be empty.
    pub badge: String,
    /// One sentence.
    pub lead: String,
    /// Whether all is well.
    pub good: bool,
}

/// The page, self-contained.
pub fn page(head: &StudyHead, sections: &[StudySection]) -> String {
    let badge = match head.badge.as_str() {
        "" => String::new(),
        text => format!("<span class=\"badge\">{}</span>", escape(text)),
    };
    let class = if head.good { "good" } else { "bad" };
    let body: String = sections.iter().map(section).collect();
    let body = format!(
        "<h1>{}{badge}</h1>\n<p class=\"lead {class}\">{}</p>\n{body}",
        escape(&head.name),
        escape(&head.lead)
    );
    let nothing = json!({ "tests": [], "rungs": [], "shown": 0, "convergence": null });
    document(&format!("{} – fct campaign", head.name), &body, &nothing)
}

fn section(s: &StudySection) -> String {
    let words: String = s.words.iter().map(|w| format!("<p>{}</p>\n", escape(w))).collect();
    let pictures: String = s
        .pictures
        .iter()
        .map(|(svg, caption)| {
            format!(
                "<figure class=\"strip\"><div class=\"scroll\">{}</div><figcaption>{}</figcaption></figure>\n",
                picture(svg, caption),
                escape(caption)
            )
        })
        .collect();
    let tables: String = s.tables.iter().map(one).collect();
    // Lines stay lines.
    let lines = |t: &String| t.lines().map(escape).collect::<Vec<_>>().join("\n");
    let copy = s.to_copy.as_ref().map_or(String::new(), |t| format!("<pre>{}</pre>\n", lines(t)));
    format!("<section><h2>{}</h2>\n{words}{pictures}{tables}{copy}</section>\n", escape(&s.title))
}

fn one(t: &StudyTable) -> String {
    let cell = |(i, text): (usize, &String)| {
        match t.numbers.contains(&i) {
            true => Cell::number(text.as_str()),
            // A reason is read to its end, not scrolled to.
            false if text.chars().count() > SENTENCE => Cell { class: "wrap", ..Cell::left(text.as_str()) },
            false => Cell::left(text.as_str()),
        }
    };
    table(&t.header, t.rows.iter().map(|row| row.iter().enumerate().map(cell).collect()))
}
