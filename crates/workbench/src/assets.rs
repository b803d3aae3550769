//! The files of the page, in the program.

/// Content type and content of a file of the page.
pub fn asset(name: &str) -> Option<(&'static str, &'static str)> {
    const SCRIPT: &str = "text/javascript; charset=utf-8";
    const STYLE: &str = "text/css; charset=utf-8";
    Some(match name {
        "style.css" => (STYLE, include_str!("../assets/style.css")),
        "main.js" => (SCRIPT, include_str!("../assets/main.js")),
        "dom.js" => (SCRIPT, include_str!("../assets/dom.js")),
        "server.js" => (SCRIPT, include_str!("../assets/server.js")),
        "plot.js" => (SCRIPT, include_str!("../assets/plot.js")),
        "record.js" => (SCRIPT, include_str!("../assets/record.js")),
        "curves.js" => (SCRIPT, include_str!("../assets/curves.js")),
        "sliders.js" => (SCRIPT, include_str!("../assets/sliders.js")),
        "stretch.js" => (SCRIPT, include_str!("../assets/stretch.js")),
        "strip.js" => (SCRIPT, include_str!("../assets/strip.js")),
        "missing.js" => (SCRIPT, include_str!("../assets/missing.js")),
        _ => return None,
    })
}

/// The page.
pub const PAGE: &str = include_str!("../assets/index.html");
/// What stands there for whoever has no token.
pub const NO_TOKEN: &str = "This page opens with the address that `fct workbench` printed, token included.\n";
