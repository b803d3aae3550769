// A stretch of a record that counts less, or not at all: dragged in a chart, or typed. The fit leaves it out; every answer says so.
import { byId, el, fill, show } from "./dom.js";

let ask = () => {}, paint = () => {}, tests = [], curves = [], picked = null, drag = null;
const places = new WeakMap();

export function begin(send, painter) {
  [ask, paint] = [send, painter];
}

// Factor of what was measured at a time; of stretches that overlap the later one holds.
export function weight(test, time) {
  const all = tests.find(t => t.name === test)?.weights ?? [];
  for (let k = all.length - 1; k >= 0; k--) if (all[k].from_s <= time && time <= all[k].to_s) return all[k].weight;
  return 1;
}

// Rows of a test that are picked at present.
export const chosen = test => picked?.test === test ? picked.rows : null;

// The chart of a curve, so that what is dragged over it can be found.
export function place(canvas, curve, x, scales) {
  if (!places.has(canvas)) listen(canvas);
  places.set(canvas, { curve, x, scales });
}

function listen(canvas) {
  canvas.addEventListener("pointerdown", e => { if (e.button === 0) { canvas.setPointerCapture(e.pointerId); drag = { canvas, from: [e.offsetX, e.offsetY] }; } });
  canvas.addEventListener("pointermove", e => { if (drag?.canvas === canvas) inside(canvas, drag.from, [e.offsetX, e.offsetY]); });
  canvas.addEventListener("pointerup", () => { if (drag?.canvas === canvas) drag = null; });
}

// Points in the dragged box, as stretches of time: a record that goes back and forth may have several there.
function inside(canvas, a, b) {
  const { curve, x, scales } = places.get(canvas);
  if (!scales || Math.abs(a[0] - b[0]) < 4) return;
  const tall = Math.abs(a[1] - b[1]) > 12, within = (v, p, q) => v >= Math.min(p, q) && v <= Math.max(p, q);
  const rows = new Set(x.flatMap((v, i) => v !== null && within(scales.X(v), a[0], b[0]) && (!tall || within(scales.Y(curve.f[i]), a[1], b[1])) ? [i] : []));
  pick(curve, rows);
}

function pick(curve, rows) {
  const ranges = [];
  for (const i of rows) {
    const last = ranges.at(-1);
    if (last && last[1] === i - 1) last[1] = i; else ranges.push([i, i]);
  }
  // Half-way to the neighbours: times on the page are rounded.
  const t = curve.t, between = (i, j) => Number(((t[i] + t[j]) / 2).toPrecision(8)), first = i => i ? between(i - 1, i) : Math.max(0, t[0] - 1);
  picked = rows.size ? { test: curve.test, rows, ranges: ranges.map(([i, j]) => [first(i), j + 1 < t.length ? between(j, j + 1) : t[j] + 1]) } : null;
  tell();
  paint();
}

function typed() {
  const curve = curves.find(c => c.test === byId("w-test").value), [from, to] = ["w-from", "w-to"].map(id => byId(id).value === "" ? NaN : Number(byId(id).value));
  if (!curve || !(from <= to)) return;
  picked = { test: curve.test, rows: new Set(curve.t.flatMap((t, i) => from <= t && t <= to ? [i] : [])), ranges: [[from, to]] };
  told();
  paint();
}

function tell() {
  byId("stretches").open = true;
  if (picked) {
    byId("w-test").value = picked.test;
    [byId("w-from").value, byId("w-to").value] = picked.ranges[0].map(t => Number(t.toPrecision(6)));
  }
  told();
}

function told() {
  const n = picked?.rows.size ?? 0;
  byId("w-told").textContent = picked ? `${picked.test}, ${picked.ranges.map(([a, b]) => `${show(a, 4)} s to ${show(b, 4)} s`).join("; ")}: ${n} point${n === 1 ? "" : "s"}` : "";
  for (const id of ["w-out", "w-less"]) byId(id).disabled = !n;
}

function weigh(factor) {
  if (!picked?.rows.size) return;
  ask({ do: "set", weigh: picked.ranges.map(([from, to]) => ({ test: picked.test, from, to, weight: factor })) });
}

export function set(state) {
  [tests, curves, picked] = [state.specimen?.tests ?? [], state.curves, null];
  const form = byId("weigh"), open = byId("stretches")?.open ?? false, named = tests.filter(t => t.weights?.length);
  const field = (id, word) => el("label", { for: id }, `${word} `, el("input", { id, type: "number", min: "0", step: "any", oninput: typed }), " s ");
  fill(form, el("details", { id: "stretches", open: open || named.length > 0 }, el("summary", {}, "Leave a stretch out, or let it count less"),
    el("p", { class: "muted" }, "Drag over points of a force curve, or type times."),
    el("div", { class: "tools" }, el("label", { for: "w-test" }, "Test ", el("select", { id: "w-test", onchange: typed }, curves.map(c => el("option", { value: c.test }, c.test)))),
      field("w-from", "from"), field("w-to", "to")),
    el("p", { id: "w-told", role: "status" }),
    el("div", { class: "tools" }, el("button", { id: "w-out", type: "button", disabled: true, onclick: () => weigh(0) }, "Leave it out"),
      el("button", { id: "w-less", type: "button", disabled: true, onclick: () => weigh(Number(byId("w-by").value)) }, "Let it count"),
      el("label", { for: "w-by" }, "by a factor of ", el("input", { id: "w-by", type: "number", min: "0", max: "100", step: "any", value: "0.25" }))),
    el("ul", {}, named.map(t => el("li", {}, `${t.name}: ${t.weights.map(w => `${show(w.from_s, 4)} s to ${show(w.to_s, 4)} s ${w.weight ? `counts ${show(w.weight)} times` : "is left out"}`).join("; ")} `,
      el("button", { type: "button", "data-unweigh": t.name, onclick: () => ask({ do: "set", unweigh: [t.name] }) }, `All points of ${t.name} count again`))))));
  form.onsubmit = e => e.preventDefault();
  form.hidden = !state.config || !curves.length;
}
