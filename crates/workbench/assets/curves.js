// Record, model and misfit of every test.
import { byId, el, fill, show } from "./dom.js";
import { overlay } from "./server.js";
import { draw } from "./plot.js";
import * as stretch from "./stretch.js";

const axes = { u: "displacement, mm", t: "time, s", front: "tear front of the model, mm" };
let axis = "u", curves = [], jacobian = null, shift = null, live = {}, adds = null, hovered = null, cursor = null, run = "";
const over = new Map(), overColours = ["over1", "over2", "over3"];

// The force of a test where parameters are moved by `shift` (path → change): the linear response.
export function linear(curve, moved = shift) {
  const columns = jacobian?.tests?.[curve.test];
  if (!moved || !columns || !curve.m) return null;
  const out = curve.m.slice();
  jacobian.paths.forEach((path, k) => {
    const step = moved[path];
    if (step) for (let i = 0; i < out.length; i++) out[i] += step * (columns[k][i] ?? 0);
  });
  return out;
}

export const canMove = path => jacobian?.paths?.includes(path) ?? false;

export function move(moved) {
  shift = moved;
  paint();
}

// What an effect would add, onto the misfit; `null`: nothing.
export function hover(effect) {
  hovered = effect;
  paint();
}

export const added = (test, effect) => adds?.tests?.[test]?.[adds.paths.indexOf(effect)] ?? null;
export const tests = () => curves;

// Where the strip is drawn: travels of its pictures in the order of time, and which is shown.
export function mark(test, at, travels) {
  const curve = curves.find(c => c.test === test);
  if (!curve) return;
  let row = 0;
  // In the order of time; of rows as near, the first after the picture before.
  for (let k = 0; k <= at; k++) {
    let best = row;
    const end = k + 1 < travels.length && travels[k + 1] < travels[k] ? curve.u.indexOf(Math.max(...curve.u)) + 1 : curve.u.length;
    for (let i = row; i < Math.max(end, row + 1); i++) if (Math.abs(curve.u[i] - travels[k]) < Math.abs(curve.u[best] - travels[k]) - 1e-9) best = i;
    row = best;
  }
  cursor = { test, row };
  paint();
}

// The curves of another step, laid over these or taken away.
export async function lay(step, title, tell) {
  if (over.has(step)) over.delete(step);
  else if (over.size < overColours.length) {
    try { over.set(step, await overlay(step)); } catch (e) { return tell(e.message); }
  } else return tell(`At most ${overColours.length} models are laid over one another.`);
  legend();
  paint();
}
export const laid = step => over.has(step);

function legend() {
  fill(byId("overlays"), [...over.values()].map((o, k) => [el("i", { class: overColours[k] }), `${o.title} `]));
}

// What the exact run says otherwise than the linear curve did, N.
export function difference(before, after) {
  let most = 0;
  for (const curve of after) {
    const was = before[curve.test];
    if (was && curve.m) for (let i = 0; i < Math.min(was.length, curve.m.length); i++) most = Math.max(most, Math.abs(was[i] - curve.m[i]));
  }
  return most;
}

// The model's forces as a running search has them now (test → list).
export function follow(forces) {
  if (Object.keys(forces).length === 0) return;
  Object.assign(live, forces);
  requestAnimationFrame(paint);
}

export function shown() {
  return Object.fromEntries(curves.map(c => [c.test, linear(c)]).filter(c => c[1]));
}

export function set(state) {
  [curves, jacobian, shift, live, adds] = [state.curves, state.jacobian, null, {}, state.adds];
  if (run !== state.run) [run, cursor, hovered] = [state.run, null, null];
  legend();
  const charts = byId("charts"), wanted = curves.map(c => c.test).join("\n");
  if (charts.dataset.tests !== wanted) {
    charts.dataset.tests = wanted;
    fill(charts, curves.map(c => el("figure", { "data-test": c.test, "aria-label": c.test },
      el("figcaption", {}, c.test),
      el("canvas", { class: "force", role: "img" }),
      el("canvas", { class: "misfit", role: "img" }))));
  }
  byId("curves").hidden = curves.length === 0;
  stretch.set(state);
  for (const button of byId("axis").children) {
    button.disabled = button.dataset.axis === "front" && !curves.some(c => c.front);
  }
  paint();
}

export function paint() {
  for (const figure of byId("charts").children) {
    const curve = curves.find(c => c.test === figure.dataset.test);
    if (curve) paintOne(figure, curve);
  }
}

function paintOne(figure, curve) {
  const begun = performance.now(), x = curve[axis] ?? curve.u, label = curve[axis] ? axes[axis] : axes.u;
  const now = live[curve.test]?.length === curve.f.length ? live[curve.test] : null;
  const moved = now ?? linear(curve), series = [], out = curve.t.map(t => stretch.weight(curve.test, t) === 0), some = out.includes(true);
  const only = (y, left) => some ? y.map((v, i) => out[i] === left ? v : null) : left ? [] : y;
  if (curve.noise) series.push({ y: curve.f, kind: "band", colour: "band", half: 2 * curve.noise });
  series.push({ y: only(curve.f, false), kind: "dots", colour: "record" });
  if (some) series.push({ y: only(curve.f, true), kind: "dots", colour: "line" });
  if (curve.m) series.push({ y: curve.m, kind: now ? "dash" : "line", colour: "model" });
  if (now) series.push({ y: now, kind: "line", colour: "linear" });
  else if (moved) series.push({ y: moved, kind: "dash", colour: "linear" });
  [...over.values()].forEach((o, k) => {
    const other = o.curves.find(c => c.test === curve.test);
    if (other?.m?.length === x.length) series.push({ y: other.m, kind: "thin", colour: overColours[k] });
  });
  const here = cursor?.test === curve.test ? cursor.row : null;
  if (here !== null) series.push({ y: x.map((_, i) => i === here ? (moved ?? curve.m ?? curve.f)[i] : null), kind: "ring", colour: "ink" });
  const [force, misfit] = figure.querySelectorAll("canvas");
  const chosen = stretch.chosen(curve.test);
  if (chosen) series.push({ y: curve.f.map((v, i) => chosen.has(i) ? v : null), kind: "dots", colour: "accent" });
  stretch.place(force, curve, x, draw(force, { x, series, xlabel: label, ylabel: "force, N" }));
  misfit.hidden = !curve.m && !now;
  const rest = (moved ?? curve.m)?.map((m, i) => curve.f[i] - m);
  if (rest) {
    const zero = rest.map(() => 0), band = { y: zero, kind: "band", colour: "band", half: 2 * curve.noise };
    const more = hovered && added(curve.test, hovered);
    figure.dataset.hovered = more ? hovered : "";
    draw(misfit, { x, series: [band, { y: only(rest, false), kind: "dots", colour: moved ? "linear" : "model" }, { y: only(rest, true), kind: "dots", colour: "line" },
      ...more ? [{ y: more, kind: "line", colour: "accent" }] : []],
      least: [[-2 * curve.noise, 2 * curve.noise]], xlabel: label, ylabel: "misfit, N" });
    const used = only(rest, false).filter(r => r !== null), rms = Math.sqrt(used.reduce((s, r) => s + r * r, 0) / Math.max(1, used.length));
    misfit.setAttribute("aria-label", `Misfit of ${curve.test}: root mean square ${show(rms)} N, noise ${show(curve.noise)} N`);
    figure.dataset.rms = rms;
  }
  const peak = Math.max(...curve.f.map(Math.abs));
  force.setAttribute("aria-label", `${curve.test}: ${curve.f.length} points, largest force ${show(peak)} N${curve.m ? ", with the model's curve" : ""}`);
  figure.dataset.ms = performance.now() - begun;
}

export function begin(ask) {
  stretch.begin(ask, paint);
  for (const button of byId("axis").children) button.addEventListener("click", () => {
    axis = button.dataset.axis;
    for (const b of byId("axis").children) b.setAttribute("aria-pressed", b === button);
    paint();
  });
  new ResizeObserver(() => paint()).observe(byId("charts"));
  // What is taller than the window stays with its lower end in sight: there are the misfits.
  const stick = () => { const all = byId("curves"); all.style.top = `${Math.min(document.querySelector("header").offsetHeight + 10, innerHeight - all.offsetHeight - 10)}px`; };
  new ResizeObserver(stick).observe(byId("curves"));
  addEventListener("resize", stick);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", paint);
}
