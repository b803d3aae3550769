//! Rules of an accessible page, asked of the browser's own tree for screen readers and of what it draws.

use crate::driver::Page;
use serde_json::{Value, json};
use std::error::Error;

/// Roles that a screen reader announces by name, and says nothing of where they have none.
const NAMED: [&str; 15] = [
    "button",
    "link",
    "checkbox",
    "radio",
    "slider",
    "textbox",
    "spinbutton",
    "combobox",
    "listbox",
    "option",
    "image",
    "img",
    "canvas",
    "DisclosureTriangle",
    "figure",
];

/// Text that is hard to read: less contrast than 4.5 to 1 with what is behind it (WCAG 2.2, 1.4.3); what is disabled or
/// not seen does not count.
const CONTRAST: &str = r#"(() => {
  const parse = c => { const m = c.match(/[\d.]+/g).map(Number); return c.startsWith('color(srgb') ? [255 * m[0], 255 * m[1], 255 * m[2], m[3] ?? 1] : [m[0], m[1], m[2], m[3] ?? 1]; };
  const light = c => { const l = c.slice(0, 3).map(x => { x /= 255; return x <= 0.04045 ? x / 12.92 : ((x + 0.055) / 1.055) ** 2.4; }); return 0.2126 * l[0] + 0.7152 * l[1] + 0.0722 * l[2]; };
  const over = (a, b) => [0, 1, 2].map(k => a[3] * a[k] + (1 - a[3]) * b[k]).concat(1);
  const behind = e => { const all = []; for (; e; e = e.parentElement) all.push(parse(getComputedStyle(e).backgroundColor)); return all.reverse().reduce((b, c) => over(c, b), [255, 255, 255, 1]); };
  const bad = [];
  for (const e of document.querySelectorAll('body *')) {
    if (![...e.childNodes].some(n => n.nodeType === 3 && n.textContent.trim()) || e.closest('[disabled], svg, option, [hidden]') || !e.checkVisibility()) continue;
    let seen = 1;
    for (let p = e; p; p = p.parentElement) seen *= Number(getComputedStyle(p).opacity);
    const back = behind(e), ink = parse(getComputedStyle(e).color);
    ink[3] *= seen;
    const [a, b] = [light(over(ink, back)), light(back)], ratio = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
    if (ratio < 4.5) bad.push(`contrast ${ratio.toFixed(2)}: ${e.tagName} ${e.className} "${e.textContent.trim().slice(0, 40)}"`);
  }
  return bad;
})()"#;

/// Identifiers that stand twice, headings that skip a level, more or less than one main part, no language, text that is
/// cut off or wider than the window.
const STRUCTURE: &str = r#"(() => {
  const bad = [], ids = [...document.querySelectorAll('[id]')].map(e => e.id);
  for (const id of ids.filter((x, k) => ids.indexOf(x) !== k)) bad.push(`twice: #${id}`);
  let last = 0;
  for (const h of [...document.querySelectorAll('h1, h2, h3, h4')].filter(h => h.checkVisibility())) {
    const level = Number(h.tagName[1]);
    if (level > last + 1) bad.push(`heading skips a level: ${h.textContent}`);
    last = level;
  }
  if (document.querySelectorAll('main').length !== 1 || document.querySelectorAll('h1').length !== 1) bad.push('one main, one h1');
  if (!document.documentElement.lang || !document.title) bad.push('language and title');
  if (document.documentElement.scrollWidth > innerWidth) bad.push(`wider than the window: ${document.documentElement.scrollWidth}`);
  for (const e of document.querySelectorAll('[role=group]:not([aria-label], [aria-labelledby]), fieldset:not(:has(legend))')) bad.push(`no name: ${e.outerHTML.slice(0, 80)}`);
  for (const e of document.querySelectorAll('[tabindex]')) if (e.tabIndex > 0) bad.push(`order of its own: ${e.outerHTML.slice(0, 80)}`);
  for (const e of document.querySelectorAll('[aria-labelledby], [aria-describedby], label[for]')) {
    const names = `${e.getAttribute('aria-labelledby') ?? ''} ${e.getAttribute('aria-describedby') ?? ''} ${e.getAttribute('for') ?? ''}`;
    for (const id of names.split(/\s+/).filter(Boolean)) if (!document.getElementById(id)) bad.push(`names what is not there: ${id}`);
  }
  return bad;
})()"#;

/// What is wrong with the page as it stands.
pub fn faults(page: &mut Page) -> Result<Vec<String>, Box<dyn Error>> {
    page.call("Accessibility.enable", json!({}))?;
    let tree = page.call("Accessibility.getFullAXTree", json!({}))?;
    page.call("Accessibility.disable", json!({}))?;
    let nodes = tree["nodes"].as_array().cloned().unwrap_or_default();
    let role = |n: &Value| n["role"]["value"].as_str().unwrap_or_default().to_owned();
    let name = |n: &Value| n["name"]["value"].as_str().unwrap_or_default().trim().to_owned();
    let told = nodes.iter().filter(|n| n["ignored"] != true && NAMED.contains(&role(n).as_str()));
    let mut bad: Vec<String> = told
        .clone()
        .filter(|n| name(n).is_empty())
        .map(|n| format!("no name: {} {}", role(n), n["properties"]))
        .collect();
    // Two buttons of one name cannot be told apart by ear.
    let mut buttons: Vec<String> = told.filter(|n| role(n) == "button").map(name).collect();
    buttons.sort();
    bad.extend(
        buttons.windows(2).filter(|w| w[0] == w[1]).map(|w| format!("two buttons of one name: {}", w[0])),
    );
    for rule in [CONTRAST, STRUCTURE] {
        let found = page.ask(rule)?;
        bad.extend(found.as_array().into_iter().flatten().filter_map(|v| v.as_str()).map(str::to_owned));
    }
    Ok(bad)
}

/// Everything that can be pressed or filled in and that the tabulator does not come to.
pub fn unreached(page: &mut Page) -> Result<Vec<String>, Box<dyn Error>> {
    let all = "[...document.querySelectorAll('button, input, select, a[href], summary, [tabindex]')].filter(e => !e.disabled && e.checkVisibility())";
    page.ask(&format!(
        "{all}.forEach(e => delete e.dataset.reached); document.activeElement.blur(); window.scrollTo(0, 0)"
    ))?;
    let n = page.ask(&format!("{all}.length"))?.as_u64().unwrap_or(0);
    for _ in 0..n + 2 {
        page.press("Tab", 9, 0)?;
        page.ask("document.activeElement.dataset.reached = '1'")?;
    }
    let left =
        page.ask(&format!("{all}.filter(e => !e.dataset.reached).map(e => e.outerHTML.slice(0, 120))"))?;
    Ok(serde_json::from_value(left)?)
}
