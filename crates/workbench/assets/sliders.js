// A slider per parameter. While it moves, the curve follows by the Jacobian; on release the exact run replaces it.
import { byId, el, fill, show } from "./dom.js";
import * as curves from "./curves.js";

const STEPS = 1000;
let rows = [], ask = () => {};

// The range of a slider: the bounds, or where they are far apart a factor of ten, or four times the value, about it.
function range(p) {
  if (p.log) {
    const [low, high] = [Math.max(p.low, p.value / 10), Math.min(p.high, p.value * 10)];
    return high / low > 1.01 ? [low, high] : [p.low, p.high];
  }
  const wide = 3 * Math.max(Math.abs(p.value), 1e-12), [low, high] = [Math.max(p.low, p.value - wide), Math.min(p.high, p.value + wide)];
  return high > low ? [low, high] : [p.low, p.high];
}
const toSlider = (r, x) => STEPS * (r.p.log ? Math.log(x / r.low) / Math.log(r.high / r.low) : (x - r.low) / (r.high - r.low));
const fromSlider = (r, s) => r.p.log ? r.low * (r.high / r.low) ** (s / STEPS) : r.low + (r.high - r.low) * s / STEPS;
const told = (r, x) => `${show(x * r.p.factor, 4)} ${r.p.unit}`.trim();

// Values that were moved; the others are the run's.
const values = () => Object.fromEntries(rows.filter(r => r.now !== r.p.value).map(r => [r.p.path, r.now]));

function moved() {
  const all = rows.filter(r => r.now !== r.p.value).map(r => [r.p.path, r.now - r.p.value]);
  return all.length ? Object.fromEntries(all) : null;
}

function place(r, x) {
  r.now = x;
  r.number.value = show(x * r.p.factor, 4);
  r.slider.value = Math.round(toSlider(r, x));
  r.slider.setAttribute("aria-valuetext", told(r, x));
}

function release() {
  if (moved()) ask({ do: "set", values: values() });
}

function row(p, k) {
  const [low, high] = range(p), r = { p, low, high, now: p.value }, id = `p${k}`;
  r.slider = el("input", { type: "range", min: "0", max: String(STEPS), id, disabled: !Number.isFinite(p.value),
    "aria-label": `${p.path}, ${p.about}`, title: p.about });
  r.number = el("input", { type: "text", inputmode: "decimal", id: `${id}n`, "aria-label": `${p.path} in ${p.unit || "no unit"}` });
  r.slider.addEventListener("input", () => { place(r, fromSlider(r, Number(r.slider.value))); curves.move(moved()); });
  r.slider.addEventListener("change", release);
  r.number.addEventListener("change", () => {
    const x = Number(r.number.value) / p.factor;
    if (Number.isFinite(x) && r.number.value.trim() !== "") { place(r, Math.min(p.high, Math.max(p.low, x))); release(); } else place(r, r.now);
  });
  const held = el("input", { type: "checkbox", id: `${id}h`, checked: !p.free, "aria-label": `hold ${p.path}`,
    onchange: e => ask({ do: "set", values: values(), fixed: { [p.path]: e.target.checked } }) });
  const track = el("span", { class: "track" }, r.slider);
  if (p.interval?.every(x => x !== null)) {
    const [from, to] = p.interval.map(x => Math.min(100, Math.max(0, toSlider(r, Math.max(x, p.log ? r.low : -Infinity)) / STEPS * 100)));
    const bar = el("span", { class: "interval", title: "95 % interval" });
    bar.style.left = `calc(8px + (100% - 16px) * ${from / 100})`;
    bar.style.width = `calc((100% - 16px) * ${Math.max(0.005, (to - from) / 100)})`;
    track.prepend(bar);
  }
  const note = p.at_bound ? "at its bound" : p.identifiable === false ? "the records do not fix it"
    : p.interval?.every(x => x !== null) ? `${show(p.interval[0] * p.factor)} … ${show(p.interval[1] * p.factor)}` : "";
  place(r, p.value);
  return [r, el("div", { class: `parameter${p.free ? "" : " held"}`, "data-path": p.path },
    el("label", { for: id, title: p.about }, p.path.replace("interface.", "").replace("effects.", "")), track,
    el("span", { class: "number" }, r.number, el("span", { class: "unit" }, p.unit)),
    el("label", { class: "hold" }, held, "held"), el("span", { class: "note" }, note))];
}

export function set(state) {
  const made = state.parameters.filter(p => Number.isFinite(p.value)).map(row);
  rows = made.map(m => m[0]);
  const free = made.filter(m => m[0].p.free).map(m => m[1]), held = made.filter(m => !m[0].p.free).map(m => m[1]);
  const open = byId("held")?.open ?? false;
  fill(byId("sliders"), free, held.length ? el("details", { id: "held", open }, el("summary", {}, `${held.length} held`), held) : null);
  byId("parameters").hidden = made.length === 0;
}

// A search moves the sliders while it runs.
export function follow(paths, theta) {
  for (const r of rows) {
    const k = paths.indexOf(r.p.path);
    if (k >= 0 && Number.isFinite(theta[k])) {
      r.slider.value = Math.round(toSlider(r, Math.max(theta[k], r.p.log ? r.low : -Infinity)));
      r.number.value = show(theta[k] * r.p.factor, 4);
    }
  }
}

export function begin(send) {
  ask = send;
}
