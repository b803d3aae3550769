// Dropped files: what was understood, what is open, the dimensions beside a drawing of the strip.
import { byId, el, fill, percent, show, svg } from "./dom.js";
import { upload } from "./server.js";

let ask = () => {}, tell = () => {}, request = empty(), shownFor = "", experiments = ["uniaxial", "tearing"];

// Corrections that a switch asks for, whatever the file looks like.
const switches = [["zero", "displacement begins at 0 (preload left out)"], ["tare", "force begins at 0"], ["flip", "pulling is negative in the file: turn the sign"],
  ["true-measures", "the file holds true stress and strain"]];

function empty() {
  return { files: [], kinds: [], flags: {}, geometry: {}, name: "" };
}

// As `fct import` takes a file without --kind.
const guess = file => experiments.filter(kind => file.split("/").at(-1).toLowerCase().includes(kind)).sort((a, b) => b.length - a.length)[0]
  ?? (/tear|riss|tore|dechir/i.test(file.split("/").at(-1)) ? "tearing" : experiments[0]);
const send = () => ask({ do: "import", ...request });

async function dropped(files) {
  try {
    for (const file of files) {
      const kept = await upload(file);
      if (!request.files.includes(kept)) {
        request.files.push(kept);
        request.kinds.push(guess(kept));
      }
    }
    if (files.length) await send();
  } catch (e) {
    tell(e.message);
  }
}

export function begin(sender, teller) {
  [ask, tell] = [sender, teller];
  const drop = byId("drop"), input = byId("files");
  input.addEventListener("change", () => { dropped([...input.files]); input.value = ""; });
  // A file that misses the field would open in place of the page.
  for (const event of ["dragover", "drop"]) document.addEventListener(event, e => e.preventDefault());
  document.addEventListener("dragover", () => drop.classList.add("over"));
  for (const event of ["dragleave", "drop"]) document.addEventListener(event, () => drop.classList.remove("over"));
  document.addEventListener("drop", e => dropped([...(e.dataTransfer?.files ?? [])]));
}

export function set(state) {
  doctor(state);
  experiments = state.experiments ?? experiments;
  const stamp = JSON.stringify([state.import, state.specimen?.geometry, state.specimen?.name]);
  if (stamp === shownFor) return;
  shownFor = stamp;
  request = { ...empty(), ...structuredClone(state.import?.request ?? {}) };
  while (request.kinds.length < request.files.length) request.kinds.push(guess(request.files[request.kinds.length]));
  fill(byId("import"), state.import ? [files(state.import), corrections(), questions(state.import), understood(state.import.answer)] : null,
    geometry(state));
}

function files(said) {
  const rows = request.files.map((file, k) => el("li", {},
    el("b", {}, file.split("/").at(-1)), " ",
    el("label", {}, "is ", el("select", { id: `kind${k}`, "aria-label": `what ${file} is`, onchange: e => { request.kinds[k] = e.target.value; send(); } },
      experiments.map(kind => el("option", { value: kind, selected: request.kinds[k] === kind }, kind)))), " ",
    el("button", { type: "button", "aria-label": `leave ${file} out`, onclick: () => {
      request.files.splice(k, 1); request.kinds.splice(k, 1); request.flags = {};
      if (request.files.length) send(); else fill(byId("import"));
    } }, "leave out"),
    head(said.heads?.[file])));
  const again = said.answer || said.failed ? null : el("button", { type: "button", class: "main", onclick: send }, "Read these files");
  return [el("ul", { class: "files" }, rows), again];
}

function corrections() {
  if (!request.files.length) return null;
  return el("details", { id: "corrections", open: switches.some(([flag]) => flag in request.flags) }, el("summary", {}, "Corrections"), switches.map(([flag, about]) =>
    el("label", {}, el("input", { type: "checkbox", id: `c-${flag}`, checked: flag in request.flags, onchange: e => {
      if (e.target.checked) request.flags[flag] = ""; else delete request.flags[flag];
      send();
    } }), ` ${about}`)));
}

// What the records are good for: one sentence a record, doubts with their remedies, what they fix, show and hide.
function doctor(state) {
  const place = byId("doctor"), d = state.doctor;
  place.hidden = !state.specimen;
  if (place.hidden) return;
  const doubts = (d?.records ?? []).flatMap(r => r.advice.map(a => el("li", { class: "bad" }, `${r.test}: ${a.found}. ${a.remedy}.`)));
  const rows = (d?.records ?? []).map(r => el("li", {}, `${r.test}: ${r.rows} rows${r.points < r.rows ? `, averaged to ${r.points} points` : ""}; `
    + (r.noise_N === null ? "noise unknown" : `noise ${show(r.noise_N, 2)} N, ${percent(r.noise_N / r.peak_N)} of the peak`) + (r.tears ? "; it tears" : "")));
  const names = list => list.join(", ") || "none", f = d?.shows;
  const shows = f ? [...[["fixed", "fix"], ["uncertain", "may fix"], ["open", "leave open"]].map(([how, words]) =>
    el("li", {}, `parameters they ${words}: ${names(f.parameters.filter(p => p.expected === how).map(p => p.path))}`)),
    el("li", {}, `effects they show at a plausible size: ${names(f.effects.filter(e => e.shown === "shown").map(e => e.effect))}`),
    el("li", {}, `effects they hide at that size: ${names(f.effects.filter(e => e.shown === "hidden").map(e => e.effect))}`)] : [];
  fill(place, el("div", { class: "tools" }, el("button", { type: "button", id: "check", onclick: () => ask({ do: "check" }) }, "What are these records good for?")),
    d ? el("ul", {}, rows, doubts, shows, d.shows_not ? el("li", {}, d.shows_not) : null) : null);
}

const head = lines => lines?.length
  ? el("details", {}, el("summary", {}, "first lines"), el("pre", { tabindex: "0" }, lines.join("\n"))) : null;

// What the importer asks is a field each; what it refuses is told with the remedy.
function questions(said) {
  if (!said.failed) return null;
  const all = said.failed.json?.error?.files ?? [], out = [];
  for (const file of all) {
    const name = String(file.file ?? "").split("/").at(-1);
    if (file.reason) out.push(el("p", { class: "bad" }, `${name}: ${file.reason}`));
    for (const f of file.faults ?? []) out.push(el("p", { class: "bad" }, `${name}${f.row ? `, row ${f.row}` : ""}: ${f.message}. ${f.remedy}`));
    for (const q of file.questions ?? []) out.push(question(name, q));
  }
  return el("div", { id: "questions" }, out.length ? out : el("p", { class: "bad" }, said.failed.message));
}

function question(file, q) {
  const answer = value => {
    const before = request.flags[q.flag];
    // Units are given channel by channel.
    request.flags[q.flag] = q.flag === "units" && before ? `${before},${value}` : value;
    send();
  };
  const other = el("input", { type: "text", "aria-label": `another value of --${q.flag}` });
  return el("fieldset", {}, el("legend", {}, `${file}: ${q.what}`),
    q.options.map(o => el("button", { type: "button", onclick: () => answer(o.value) }, `${o.value}: ${o.meaning}`)),
    el("span", {}, other, el("button", { type: "button", onclick: () => other.value.trim() && answer(other.value.trim()) }, "use this")));
}

function understood(answer) {
  if (!answer) return null;
  return answer.files.map(f => el("div", { class: "understood" },
    el("p", {}, `${f.file.split("/").at(-1)}: ${f.reading.dialect}, ${f.reading.encoding}, cells separated by ${f.reading.delimiter}, decimal mark ${f.reading.decimal}`),
    el("table", {}, el("thead", {}, el("tr", {}, ["what", "column", "name", "unit"].map(h => el("th", { scope: "col" }, h)))),
      el("tbody", {}, f.reading.columns.map(c => el("tr", {}, [String(c.role).toLowerCase(), c.column, c.name, c.unit].map(x => el("td", {}, String(x))))))),
    el("ul", {}, [...f.done, ...f.remarks].map(t => el("li", {}, t)), f.faults.map(t => el("li", { class: "bad" }, `${t.rule}: ${t.what}. ${t.remedy}`)),
      f.tests.map(told))));
}

function told(test) {
  const rows = test.file_rows[1] - test.file_rows[0] + 1;
  return [el("li", {}, `${test.name}: ${rows} rows, noise of the force ${show(test.force_sd_of_rows_N, 2)} N`),
    test.done.map(t => el("li", {}, t)), test.faults.map(t => el("li", { class: "bad" }, `${t.rule}: ${t.what}. ${t.remedy}`)),
    test.proposals.map(p => el("li", {}, p.why, " ", p.flag ? el("button", { type: "button", onclick: () => {
      const [flag, value = ""] = p.flag.replace(/^--/, "").split(/[ =](.*)/);
      request.flags[flag] = value; send();
    } }, `do it: ${p.flag}`) : null))].flat();
}

const sides = [["length", "between the clamps, along the load"], ["width", "along the tear"], ["thickness", "through the strip"], ["cut", "initial cut from the edge"]];

function geometry(state) {
  const known = state.specimen?.geometry ?? {}, header = state.import?.answer?.geometry ?? {};
  if (!state.import?.answer && !state.specimen) return null;
  const editable = Boolean(state.import?.answer), drawing = svg("svg", { viewBox: "0 0 260 244", role: "img", class: "strip" });
  const value = side => request.geometry[side] ?? known[side] ?? header[side] ?? "";
  const inputs = Object.fromEntries(sides.map(([side, about]) => [side, el("input", { id: `g-${side}`, type: "number", min: "0", step: "any",
    required: side !== "cut", value: String(value(side)), readOnly: !editable, title: about, oninput: () => sketch(drawing, read(inputs)) })]));
  const name = el("input", { id: "g-name", type: "text", value: request.name || state.specimen?.name || header.name || "", readOnly: !editable });
  sketch(drawing, read(inputs));
  const fields = sides.map(([side, about]) => el("label", { for: `g-${side}` }, `${side}, mm `, inputs[side], el("small", {}, about)));
  return el("form", { id: "geometry", onsubmit: e => {
    e.preventDefault();
    const read_ = Object.entries(read(inputs)).filter(x => Number.isFinite(x[1]));
    [request.geometry, request.name] = [Object.fromEntries(read_), name.value];
    if (!("cut" in request.geometry)) request.geometry.cut = 0;
    send();
  } }, el("h3", {}, "The strip"), el("div", { class: "beside" }, el("div", {}, el("label", { for: "g-name" }, "name ", name), fields,
    editable ? el("button", { type: "submit", class: "main" }, state.specimen ? "Use these dimensions" : "Take these dimensions") : null), drawing));
}

const read = inputs => Object.fromEntries(sides.map(([s]) => [s, inputs[s].value === "" ? NaN : Number(inputs[s].value)]));

// The strip from the front: load upwards (y), tear to the right (x); it moves with the numbers.
function sketch(drawing, g) {
  const [L, W] = [g.length > 0 ? g.length : 10, g.width > 0 ? g.width : 6], scale = Math.min(150 / L, 150 / W);
  const [w, h] = [W * scale, L * scale], x = 30 + (150 - w) / 2, y = 26 + (150 - h) / 2, cut = Math.min(W, g.cut > 0 ? g.cut : 0) * scale;
  const line = (x1, y1, x2, y2, name) => svg("line", { x1, y1, x2, y2, class: name });
  const text = (tx, ty, told, anchor = "middle") => { const t = svg("text", { x: tx, y: ty, "text-anchor": anchor }); t.textContent = told; return t; };
  const said = side => Number.isFinite(g[side]) ? `${show(g[side])} mm` : `${side}?`;
  drawing.setAttribute("aria-label", `Strip of length ${said("length")}, width ${said("width")}, thickness ${said("thickness")}, cut ${said("cut")}`);
  drawing.replaceChildren(
    svg("rect", { x: x - 6, y: y - 12, width: w + 12, height: 12, class: "clamp" }), svg("rect", { x: x - 6, y: y + h, width: w + 12, height: 12, class: "clamp" }),
    svg("rect", { x, y, width: w, height: h, class: "tissue" }), line(x, y + h / 2, x + w, y + h / 2, "path"), line(x, y + h / 2, x + cut, y + h / 2, "cut"),
    line(x + w + 14, y, x + w + 14, y + h, "size"), text(x + w + 20, y + h / 2 + 4, said("length"), "start"),
    line(x, y + h + 22, x + w, y + h + 22, "size"), text(x + w / 2, y + h + 38, `width ${said("width")}`),
    text(x + w / 2, y + h / 2 - 7, `cut ${said("cut")}`), text(130, 238, `thickness ${said("thickness")}; load ↕ y, tear → x`));
}
