//! A whole document: style, script and data in it, and a policy that lets nothing else run.
//!
//! Whatever a record, a specimen or a stored run says, the page shows it as text. Should a place have been
//! forgotten where text is escaped, the Content-Security-Policy stops what comes of it: only this page's own
//! script and style, named by their SHA-256, are taken; pictures are only those in the page; nothing is fetched.

use super::escape;
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use serde_json::Value;
use sha2::{Digest, Sha256};
use std::fmt::Write;

const PLOT_CSS: &str = include_str!("../../assets/uPlot.min.css");
const STYLE: &str = include_str!("style.css");
const PLOT: &str = include_str!("../../assets/uPlot.iife.min.js");
const SCRIPT: &str = concat!(include_str!("charts.js"), include_str!("sliders.js"), include_str!("page.js"));

/// Stands in the head of every page.
const GENERATOR: &str = "<meta name=\"generator\" content=\"fct\">";

/// Whether a file is a page that this program made.
pub fn is_page(content: &[u8]) -> bool {
    let head = &content[..content.len().min(1000)];
    head.windows(GENERATOR.len()).any(|w| w == GENERATOR.as_bytes())
}

/// The document.
pub fn document(title: &str, body: &str, data: &Value) -> String {
    let style = format!("\n{PLOT_CSS}\n{STYLE}{}", shares());
    let script = format!("\n{PLOT}\n{SCRIPT}");
    let policy = format!(
        "default-src 'none'; style-src '{}'; script-src '{}'; img-src data:; base-uri 'none'; form-action 'none'",
        hash(&style),
        hash(&script)
    );
    // `<` could end the script element, or open a comment in it that hides its end.
    let data = seen(data).to_string().replace('<', "\\u003c");
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta http-equiv=\"Content-Security-Policy\" content=\"{policy}\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <meta name=\"color-scheme\" content=\"light dark\">\n{GENERATOR}\n\
         <title>{}</title>\n<style>{style}</style>\n</head>\n<body>\n<main>\n{body}</main>\n\
         <script type=\"application/json\" id=\"data\">{data}</script>\n<script>{script}</script>\n</body>\n</html>\n",
        escape(title)
    )
}

/// Data whose texts are safe to show: scripts put them on the page as text, and none turns others around.
fn seen(data: &Value) -> Value {
    match data {
        Value::String(s) => Value::String(input::visible(s)),
        Value::Array(a) => a.iter().map(seen).collect(),
        Value::Object(o) => o.iter().map(|(k, v)| (input::visible(k), seen(v))).collect(),
        other => other.clone(),
    }
}

/// How a policy names an element's content.
fn hash(content: &str) -> String {
    format!("sha256-{}", STANDARD.encode(Sha256::digest(content)))
}

/// The class of a share (of a bar, of a colour) in whole percent; style attributes would need a policy that allows
/// them all.
pub fn share_class(x: f64) -> String {
    // A number that is none is a bar of no length.
    format!("w{:.0}", (100.0 * x.clamp(0.0, 1.0)).round().max(0.0))
}

fn shares() -> String {
    (0..=100).fold(String::new(), |mut css, i| {
        // Writing to a String cannot fail.
        let _ = write!(css, ".w{i}{{--share:{}}}", f64::from(i) / 100.0);
        css
    }) + "\n"
}

/// A stored picture: an image, in which no script runs. On a dark page its paper is the page's own, and its text light.
pub fn picture(svg: &str, what: &str) -> String {
    const DARK: &str =
        "<style>@media (prefers-color-scheme: dark) { [fill=\"#222226\"] { fill: #e9e9ee } }</style>";
    let body = svg.find("<svg").map_or(svg, |at| &svg[at..]).replace("fill=\"#FFFFFF\"", "fill=\"none\"");
    let body = match body.find('>') {
        Some(at) => format!("{}{DARK}{}", &body[..=at], &body[at + 1..]),
        None => body,
    };
    format!("<img alt=\"{}\" src=\"data:image/svg+xml;base64,{}\">", escape(what), STANDARD.encode(body))
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn text_of_files_ends_no_element_and_the_policy_names_what_runs() {
        let evil = "</script><!--<script><img src=x onerror=alert(1)>\u{202e}";
        let page = document(evil, &escape(evil), &json!({ "name": evil }));
        assert_eq!(page.matches("<script").count(), 2, "the data and the script");
        assert!(!page.contains("<img") && !page.contains("<!--") && !page.contains('\u{202e}'));
        let script = page.rsplit_once("<script>").and_then(|(_, rest)| rest.split_once("</script>"));
        let named = hash(script.unwrap_or_default().0);
        assert!(page.contains(&format!("script-src '{named}'")) && !page.contains("unsafe"));
    }

    #[test]
    fn a_picture_is_an_image_whatever_it_holds() {
        let shown = picture("<svg width=\"1\"><script>alert(1)</script></svg>", "a \"strip\"");
        assert!(shown.starts_with("<img ") && !shown.contains("<script"), "{shown}");
    }

    #[test]
    fn shares_have_a_class_each() {
        assert_eq!([share_class(0.374), share_class(2.0), share_class(f64::NAN)], ["w37", "w100", "w0"]);
        assert!(shares().contains(".w37{--share:0.37}"));
    }
}
