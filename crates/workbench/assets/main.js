// The page: one state from the server, shown by every part; what happens there is heard as it happens.
import { byId, el, fill, percent, probability, show } from "./dom.js";
import { ask as post, link, listen, state as fetchState } from "./server.js";
import { sparkline } from "./plot.js";
import * as curves from "./curves.js";
import * as missing from "./missing.js";
import * as record from "./record.js";
import * as sliders from "./sliders.js";
import * as strip from "./strip.js";

let now = null, busy = false, objective = [], linear = null;
const models = new Map();

const tell = text => { byId("told").textContent = text ?? ""; };

// Every request of the page; what goes wrong is told.
async function ask(action) {
  tell("");
  linear = action.do === "set" ? curves.shown() : null;
  try {
    await post(action);
  } catch (e) {
    tell(e.message);
  }
}

async function load() {
  try {
    now = await fetchState();
  } catch (e) {
    return tell(e.message);
  }
  render();
}

function render() {
  byId("name").textContent = now.specimen?.name ?? "fct workbench";
  document.title = `${now.specimen?.name ?? "fct"} – workbench`;
  lead();
  for (const part of [record, curves, sliders, missing, strip]) part.set(now);
  model();
  kept();
  byId("undo").disabled = now.cursor === 0;
  byId("redo").disabled = now.cursor + 1 >= now.steps.length;
  byId("fit").disabled = !now.config;
  byId("record").classList.toggle("lone", !now.specimen);
  byId("linear").textContent = "";
  if (linear && now.answer) {
    const off = curves.difference(linear, now.curves), noise = Math.max(...now.curves.map(c => c.noise ?? 0));
    if (off > 0) byId("linear").textContent = `The exact run differs from the linear curve by up to ${show(off)} N${off > 2 * noise ? ", more than the noise" : ""}.`;
    linear = null;
  }
  if (now.faults.length) tell(now.faults.join("\n"));
  working(now.busy);
}

// Gc and σc: a value with its interval, the mean along the path with its, or the range over the areas.
function strength(name, word) {
  const all = (now.answer?.parameters ?? []).filter(p => p.path.endsWith(`.${name}`) && p.path.startsWith("interface.area["));
  if (!all.length) return null;
  const values = all.map(p => p.value), unit = all[0].unit, mean = now.answer.path_means?.[name];
  if (all.length > 1 && mean) {
    return el("div", {}, el("dt", {}, `${word}, mean`), el("dd", {}, `${show(mean.value)} ${unit}`,
      el("small", {}, ` 95 %: ${show(mean.interval_95[0])} … ${show(mean.interval_95[1])}`)));
  }
  const told = all.length > 1 ? `${show(Math.min(...values))} … ${show(Math.max(...values))} ${unit}` : `${show(values[0])} ${unit}`;
  const [low, high] = all.length > 1 ? [null, null] : all[0].interval_95;
  return el("div", {}, el("dt", {}, word), el("dd", {}, told, low !== null && high !== null ? el("small", {}, ` 95 %: ${show(low)} … ${show(high)}`) : null));
}

// The effects in question in a few words.
function probable() {
  const present = now.specimen?.effects ?? [], by = now.diagnosis?.posterior?.effects;
  const names = by ? Object.entries(by).filter(e => e[1] >= 0.1).sort((a, b) => b[1] - a[1]).map(([e, p]) => [e, ` ${probability(p)}`])
    : (now.diagnosis?.screen ?? []).filter(r => r.significant).map(r => [r.effect, ""]);
  return names.filter(e => !present.includes(e[0])).slice(0, 3).map(e => e.join(""));
}

function lead() {
  const fit = now.steps[now.cursor]?.fit, found = probable();
  fill(byId("key"), strength("gc", "fracture energy Gc"), strength("sigma_c", "strength σc"),
    fit ? el("div", {}, el("dt", {}, "misfit"), el("dd", { id: "rest" }, `${percent(fit.share_of_peak)} of the peak`)) : null,
    found.length ? el("div", {}, el("dt", {}, now.diagnosis.posterior ? "probably missing" : "called for"), el("dd", {}, found.join(", "))) : null);
  const said = now.import?.failed ? "The files leave something open: see beneath."
    : now.import?.answer && !now.specimen ? "Say which file is which test, and give the dimensions of the strip."
    : !now.specimen ? "Drop a record to begin. Nothing leaves this machine."
    : !fit ? "Fit the model, or move its parameters."
    : fit.explained ? "The model explains the records to their noise."
    : `The model misses the records: χ² is ${show(fit.reduced_chi2)} per degree of freedom.${now.diagnosis ? "" : " Ask what is missing."}`;
  byId("lead").textContent = said;
}

// Mesh and areas: before a fit, or for another one.
function model() {
  const s = now.specimen, form = byId("model");
  form.hidden = !s;
  if (!s || form.dataset.of === JSON.stringify([s.mesh, s.areas])) return;
  form.dataset.of = JSON.stringify([s.mesh, s.areas]);
  const input = (id, value, least) => el("input", { id, type: "number", min: String(least), step: "1", value: String(value ?? "") });
  const d = s.mesh.divisions ?? ["", "", ""], along = ["x, along the tear", "y, along the load", "z, through"];
  fill(form, el("details", { id: "mesh" }, el("summary", {}, `Model: ${s.bulk_law}, ${s.interface_law}, ${s.areas} area${s.areas > 1 ? "s" : ""}`),
    el("p", { class: "muted" }, s.mesh.divisions ? "" : `Elements of ${show(s.mesh.bulk_size)} mm, ${show(s.mesh.path_size)} mm along the tear; a coarser mesh answers sooner.`),
    along.map((a, k) => el("label", { for: `d${k}` }, `elements along ${a} `, input(`d${k}`, d[k], 1))),
    el("label", { for: "areas" }, "areas along the tear ", input("areas", s.areas, 1)),
    el("button", { type: "submit" }, "Use this")));
}

function remodel(event) {
  event.preventDefault();
  const divisions = [0, 1, 2].map(k => parseInt(byId(`d${k}`).value, 10)), areas = parseInt(byId("areas").value, 10);
  const action = { do: "set" };
  if (divisions.every(Number.isInteger)) action.divisions = divisions;
  if (areas !== now.specimen.areas) action.areas = areas;
  if (action.divisions || action.areas) ask(action);
}

function kept() {
  const links = [[now.config, "config"], [now.run && `${now.run}/report.html`, "report"], [now.run && `${now.run}/summary.json`, "answer as JSON"]];
  fill(byId("links"), links.filter(l => l[0]).map(([path, word]) => [el("a", { href: link(path), download: path.split("/").at(-1) }, word), " "]).flat(),
    el("span", { class: "muted" }, `in ${now.folder}`));
  byId("commands").textContent = [`cd '${now.folder.replaceAll("'", "'\\''")}'`, ...now.commands].join("\n");
  byId("export").hidden = now.steps.length === 0;
}

function working(is, what) {
  busy = is;
  byId("busy").hidden = !is;
  if (what) byId("doing").textContent = what;
  document.body.classList.toggle("working", is);
}

function hear(event, data) {
  if (event === "begun") { objective = []; models.clear(); queued(); working(true, `${data.what} …`); }
  if (event === "note") { byId("doing").textContent = data.text; noted(data.text); }
  if (event === "iterate") iterate(data);
  if (event === "failed") tell(data.stopped ? "Stopped." : data.message);
  if (event === "ended" || event === "state") load();
}

// A search tells of each model that it fits: `drift: iteration 3, χ² 120.5`. The newest word of each stands in the list.
function noted(text) {
  const parts = /^([^:]{1,80}): (.*)$/.exec(text);
  if (!parts) return;
  models.set(parts[1], parts[2]);
  queued();
}

function queued() {
  byId("queue").hidden = models.size === 0;
  fill(byId("queue").querySelector("ul"), [...models].map(([name, word]) => el("li", {}, el("b", {}, name), `: ${word}`)));
}

function iterate(p) {
  if (p.accepted && p.objective > 0) objective.push(p.objective);
  byId("doing").textContent = `${p.stage}${p.coarse ? ", coarse mesh" : ""}: step ${p.iteration}, objective ${show(p.objective, 4)}`;
  sliders.follow(p.paths, p.theta);
  if (p.accepted) curves.follow(p.forces);
  if (objective.length > 1) sparkline(byId("fall"), objective);
}

// Two in a row are two, though the state of the first is still on its way.
const go = by => {
  const step = now.cursor + by;
  if (step < 0 || step >= now.steps.length) return;
  now.cursor = step;
  ask({ do: "go", step });
};

// Back to the last step whose values were found, not set by hand.
function reset() {
  let k = now.cursor;
  while (k > 0 && now.steps[k].kind === "set") k--;
  if (k !== now.cursor) ask({ do: "go", step: k }); else sliders.set(now), curves.move(null);
}

function keys(event) {
  const typing = event.target.matches("input[type=text], input[type=number], select");
  if (event.key === "Escape" && busy) ask({ do: "stop" });
  if (typing || !(event.ctrlKey || event.metaKey) || event.key.toLowerCase() !== "z") return;
  event.preventDefault();
  go(event.shiftKey ? 1 : -1);
}

record.begin(ask, tell);
missing.begin(ask, tell);
sliders.begin(ask);
curves.begin(ask);
strip.begin();
byId("reset").addEventListener("click", reset);
byId("fit").addEventListener("click", () => ask({ do: "fit" }));
byId("stop").addEventListener("click", () => ask({ do: "stop" }));
byId("undo").addEventListener("click", () => go(-1));
byId("redo").addEventListener("click", () => go(1));
byId("model").addEventListener("submit", remodel);
byId("copy").addEventListener("click", () => navigator.clipboard?.writeText(byId("commands").textContent));
document.addEventListener("keydown", keys);
listen(hear, away => tell(away ? "The server does not answer: is `fct workbench` still running?" : ""));
load();
