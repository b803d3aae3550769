// The staircase of the error, and what is missing.
import { byId, el, fill, percent, probability, show } from "./dom.js";
import { draw } from "./plot.js";
import * as curves from "./curves.js";

let ask = () => {}, tell = () => {}, cards = new Map(), open = null;

export function begin(send, teller) {
  [ask, tell] = [send, teller];
  byId("diagnose").addEventListener("click", () => ask({ do: "diagnose" }));
  byId("discover").addEventListener("click", () => ask({ do: "discover" }));
  byId("add").addEventListener("click", () => ask({ do: "add", effect: byId("effect").value }));
}

// One button per step; its bar is the misfit, as a share of the largest.
function stairs(state) {
  const most = Math.max(...state.steps.map(s => s.fit?.rms_N ?? 0), Number.MIN_VALUE);
  const steps = state.steps.map((step, k) => {
    const fit = step.fit, bar = el("span", { class: "bar", "aria-hidden": "true" }, el("span", {}));
    bar.firstChild.style.height = `${fit ? Math.max(2, 100 * fit.rms_N / most) : 0}%`;
    const words = fit ? [`misfit ${show(fit.rms_N)} N`, `${percent(fit.share_of_peak)} of the peak`, `χ² ${show(fit.reduced_chi2)}`] : ["no model yet"];
    return el("li", {}, el("button", { type: "button", class: k > state.cursor ? "undone" : "", "data-step": String(k),
      "aria-current": k === state.cursor ? "step" : null, "data-rms": fit ? String(fit.rms_N) : null, onclick: () => ask({ do: "go", step: k }) },
      bar, el("b", {}, step.title), words.map(w => el("span", {}, w))),
      step.run && k !== state.cursor ? el("button", { type: "button", class: "over", "data-over": String(k), "aria-pressed": String(curves.laid(k)),
        "aria-label": `lay the curves of step ${k + 1}, ${step.title}, over the present ones`, onclick: async e => {
          await curves.lay(k, step.title, tell); e.target.setAttribute("aria-pressed", String(curves.laid(k)));
        } }, "overlay") : null);
  });
  fill(byId("stairs").querySelector("ol"), steps);
  byId("stairs").hidden = steps.length === 0;
}

// Effects in question, the most probable first: by the probabilities of the search where there are any, else by the share of χ²
// that the screen expects each to take. What these records cannot tell apart stands together.
export function ranked(d, present = []) {
  const by = d.posterior?.effects, screen = new Map((d.screen ?? []).map(r => [r.effect, r]));
  const names = by ? [...new Set([...Object.keys(by), ...screen.keys()])] : [...screen.keys()];
  const amount = name => Math.max(0, Math.min(1, (by ? by[name] : screen.get(name)?.expected_fall) ?? 0));
  const rows = names.filter(n => !present.includes(n)).map(n => ({ effect: n, share: amount(n), row: screen.get(n) ?? null }));
  if (by) rows.sort((a, b) => b.share - a.share);
  const out = [], alike = (a, b) => a.row?.look_alikes.includes(b.effect) || b.row?.look_alikes.includes(a.effect);
  const shown = rows.slice(0, 12).filter(r => !by || r.share >= 0.005 || r.row?.significant);
  while (shown.length) {
    const group = [shown.shift()];
    // Only what is called for has look-alikes worth a name.
    const wanted = by ? group[0].share >= 0.02 : group[0].row?.significant;
    for (let k = 0; wanted && k < shown.length;) if (alike(group[0], shown[k])) group.push(...shown.splice(k, 1)); else k++;
    out.push(group);
  }
  return out;
}

function share(part) {
  const bar = el("span", { class: "share", "aria-hidden": "true" }, el("span", {}));
  bar.firstChild.style.width = `${100 * Math.max(0, Math.min(1, part))}%`;
  return bar;
}

// What the numbers beside the bars are.
const meaning = d => d?.posterior ? "How probable it is that an effect is missing." : d ? "How much of χ² each effect would take, as the screen expects." : "";

function bars(state) {
  const d = state.diagnosis, present = state.specimen?.effects ?? [], posterior = d?.posterior;
  const dropping = present.map(e => el("li", { class: "present" }, el("b", {}, e), el("span", { class: "muted" }, "in the model"),
    el("button", { type: "button", "data-drop": e, onclick: () => ask({ do: "drop", effect: e }) }, `Take ${e} away`)));
  const one = ({ effect, share: part, row }) => {
    const told = posterior ? `probability ${probability(part)}` : `${percent(part)} of χ²`;
    const look = on => () => curves.hover(on ? effect : null);
    return el("li", { class: (posterior ? part >= 0.1 : row.significant) ? "" : "faint", "data-effect": effect, onmouseenter: look(true), onmouseleave: look(false),
      onfocusin: look(true), onfocusout: look(false) },
      el("button", { type: "button", class: "name", title: "its card", "data-card": effect, onclick: () => card(effect) }, el("b", {}, effect)), share(part), el("span", { class: "muted" }, told),
      el("button", { type: "button", "data-add": effect, "aria-label": `Add ${effect}`, onclick: () => ask({ do: "add", effect }) }, "Add"),
      row ? el("p", {}, row.sentence) : null);
  };
  const groups = (d ? ranked(d, present) : []).map(group => group.length === 1 ? one(group[0])
    : el("li", { class: "group" }, el("p", {}, "These records cannot tell apart:"), el("ol", {}, group.map(one))));
  const others = posterior ? [["nothing is missing", posterior.nothing], ["something else", posterior.something_else]] : [];
  const rest = others.filter(o => Number.isFinite(o[1])).map(([name, p]) => el("li", { "data-other": name }, el("b", {}, name), share(p),
    el("span", { class: "muted" }, `probability ${probability(p)}`)));
  byId("meaning").textContent = meaning(d);
  fill(byId("effects"), dropping, groups, rest);
  fill(byId("words"), [...(d?.words ?? []).filter(w => !d.screen?.some(r => r.sentence === w)), ...swings(posterior)].map(w => el("li", {}, w)));
}

// How far probabilities move where what was assumed is doubled or halved.
function swings(posterior) {
  const words = { amplitude_x2: "twice the usual amplitudes", amplitude_half: "half the usual amplitudes", rest_x2: "twice the rest of a good model", rest_half: "half the rest of a good model" };
  return Object.entries(posterior?.sensitivity ?? {}).flatMap(([key, now]) => {
    const effects = now?.effects ?? now;
    if (!effects || typeof effects !== "object") return [];
    const moved = Object.entries(effects).map(([e, p]) => [e, p, posterior.effects?.[e] ?? 0]).filter(([, p, was]) => Number.isFinite(p) && Math.abs(p - was) > 0.1);
    return moved.length ? [`With ${words[key] ?? key}: ${moved.map(([e, p]) => `${e} ${probability(p)}`).join(", ")}.`] : [];
  });
}

// The card of an effect: its law, where it shows, what looks like it; its picture is what it would add to these records.
function card(name) {
  open = open === name ? null : name;
  const c = cards.get(open), place = byId("card"), row = document.querySelector(`[data-effect="${open}"]`);
  place.hidden = !c;
  if (row) row.append(place);
  if (!c) return;
  const rows = [["law", c.law], ["shows in", c.shows_in.join(", ")], ["looks like", c.look_alikes.join(", ")],
    ["told apart by", c.separated_by], ["ordinary size", c.ordinary], ["needs", c.needs.join(", ")], ["reference", c.reference]];
  const pictures = curves.tests().filter(t => curves.added(t.test, c.name)).map(t => [t, el("canvas", { role: "img", class: "misfit",
    "aria-label": `what ${c.name} would add to ${t.test}, on its misfit` })]);
  fill(place, el("h3", {}, c.name), el("p", {}, c.summary),
    pictures.map(([t, canvas]) => el("figure", { "aria-label": t.test }, el("figcaption", {}, `${t.test}: misfit (dots), and what ${c.name} would add beyond the base parameters (line)`), canvas)),
    el("dl", {}, rows.filter(r => r[1]).map(([k, v]) => [el("dt", {}, k), el("dd", {}, v)])),
    el("button", { type: "button", onclick: () => card(open) }, "Close the card"));
  for (const [t, canvas] of pictures) {
    draw(canvas, { x: t.t, series: [{ y: t.f.map((f, i) => f - t.m[i]), kind: "dots", colour: "model" },
      { y: curves.added(t.test, c.name), kind: "line", colour: "accent" }], xlabel: "time, s", ylabel: "N" });
  }
}

function nextTest(n) {
  byId("next").hidden = !n;
  if (!n) return;
  const power = Number.isFinite(n.expected_power) ? ` Expected power ${probability(n.expected_power)}.` : "";
  byId("next").querySelector("p").textContent = `${n.proposal} It separates ${n.separates.join(" and ")}.${power} (${n.basis})`;
}

export function set(state) {
  cards = new Map(state.effects.map(e => [e.name, e]));
  open = null;
  byId("card").hidden = true;
  byId("missing").insertBefore(byId("card"), byId("next"));
  nextTest(state.diagnosis?.next_test);
  stairs(state);
  bars(state);
  const fitted = Boolean(state.run && state.answer), select = byId("effect"), chosen = select.value;
  byId("missing").hidden = !state.specimen;
  byId("diagnose").disabled = !fitted;
  const others = state.effects.filter(e => !(state.specimen?.effects ?? []).includes(e.name));
  fill(select, others.map(e => el("option", { value: e.name, title: e.summary, selected: e.name === chosen }, e.name)));
}
