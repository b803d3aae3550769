// The deformed strip at the typical points of a curve, from the run's own VTU files; the pointer on it, or the slider, plays
// the tear.
import { byId, colour, el, fill, show } from "./dom.js";
import { link } from "./server.js";
import * as curves from "./curves.js";

let run = null, frames = [], at = 0, field = "S22", test = "", files = [];

// Arrays of a VTU file by name: numbers in base64 behind eight bytes of length.
function arrays(text) {
  const page = new DOMParser().parseFromString(text, "text/xml"), out = { points: {}, cells: {}, mesh: {} };
  const groups = { PointData: out.points, CellData: out.cells, Points: out.mesh, Cells: out.mesh };
  for (const [tag, into] of Object.entries(groups)) {
    for (const array of page.querySelectorAll(`${tag} > DataArray`)) {
      const bytes = Uint8Array.from(atob(array.textContent), c => c.charCodeAt(0)).slice(8);
      const kinds = { Float32: Float32Array, Int64: BigInt64Array, UInt8: Uint8Array };
      into[array.getAttribute("Name")] = new kinds[array.getAttribute("type")](bytes.buffer);
    }
  }
  return out;
}

// Nodes of the face that looks at us: the four of least z of each element.
function faces(grid) {
  const nodes = Array.from(grid.mesh.connectivity, Number), p = grid.mesh.position, size = nodes.length / grid.mesh.offsets.length;
  let front = Infinity;
  for (let i = 2; i < p.length; i += 3) front = Math.min(front, p[i]);
  const out = [];
  for (let cell = 0; cell * size < nodes.length; cell++) {
    const own = nodes.slice(cell * size, cell * size + size);
    const face = own.filter(n => Math.abs(p[3 * n + 2] - front) < 1e-6);
    if (face.length === 4) out.push([cell, face]);
  }
  return out;
}

async function one(name) {
  const answer = await fetch(link(`${run}/fields/${name}`));
  return answer.ok ? arrays(await answer.text()) : null;
}

// How far the upper clamp has moved, mm.
function travel(grid) {
  const p = grid.mesh.position, u = grid.points.displacement;
  let top = -Infinity, moved = 0;
  for (let i = 0; i < p.length; i += 3) if (p[i + 1] > top) { top = p[i + 1]; moved = u[i + 1]; }
  return moved;
}

async function loadTest(name) {
  test = name;
  const mine = files.filter(f => f.startsWith(`${name}-`) && /-\d+\.vtu$/.test(f) && !f.includes("-path-"))
    .filter(f => /^\d+\.vtu$/.test(f.slice(name.length + 1)));
  mine.sort((a, b) => parseInt(a.slice(name.length + 1), 10) - parseInt(b.slice(name.length + 1), 10));
  const wanted = run, all = [];
  for (const file of mine) {
    const grid = await one(file), n = file.slice(name.length + 1);
    if (wanted !== run || test !== name) return;
    const path = files.includes(`${name}-path-${n}`) ? await one(`${name}-path-${n}`) : null;
    if (grid) all.push({ grid, path, faces: faces(grid), travel: travel(grid) });
  }
  frames = all;
  at = frames.reduce((best, f, k) => f.travel > frames[best].travel ? k : best, 0);
  byId("frame").max = String(Math.max(0, frames.length - 1));
  paint();
}

// Dark blue, green, yellow: readable in grey, and for colour-blind eyes.
const shades = [[68, 1, 84], [59, 82, 139], [33, 145, 140], [94, 201, 98], [253, 231, 37]];
function shade(t) {
  const x = Math.min(0.9999, Math.max(0, t)) * (shades.length - 1), k = Math.floor(x), f = x - k;
  return `rgb(${shades[k].map((c, i) => Math.round(c + f * (shades[k + 1][i] - c))).join()})`;
}

const values = frame => field === "d" ? null : frame.grid.cells[field];

function range() {
  let [low, high] = [Infinity, -Infinity];
  for (const f of frames) for (const [cell] of f.faces) { const v = values(f)?.[cell]; if (v < low) low = v; if (v > high) high = v; }
  return field === "d" ? [0, 1] : low < high ? [low, high] : [low - 1, low + 1];
}

export function paint() {
  const canvas = byId("mesh-canvas"), frame = frames[at];
  if (!frame || canvas.clientWidth < 40) return;
  const ratio = window.devicePixelRatio || 1, [w, h] = [canvas.clientWidth, canvas.clientHeight];
  canvas.width = w * ratio; canvas.height = h * ratio;
  const ctx = canvas.getContext("2d"), [low, high] = range(), box = [Infinity, Infinity, -Infinity, -Infinity];
  ctx.scale(ratio, ratio);
  const place = (g, n) => [g.mesh.position[3 * n] + g.points.displacement[3 * n], g.mesh.position[3 * n + 1] + g.points.displacement[3 * n + 1]];
  for (const f of frames) for (const [, face] of f.faces) for (const n of face) {
    const [x, y] = place(f.grid, n);
    box[0] = Math.min(box[0], x); box[1] = Math.min(box[1], y); box[2] = Math.max(box[2], x); box[3] = Math.max(box[3], y);
  }
  const scale = Math.min((w - 90) / (box[2] - box[0]), (h - 16) / (box[3] - box[1]));
  const left = (w - 74 - (box[2] - box[0]) * scale) / 2, X = x => left + (x - box[0]) * scale, Y = y => h - 8 - (y - box[1]) * scale;
  ctx.lineWidth = 0.5;
  ctx.strokeStyle = colour("line");
  for (const [cell, face] of frame.faces) {
    const corners = face.map(n => place(frame.grid, n)), middle = [0, 1].map(k => corners.reduce((s, c) => s + c[k], 0) / 4);
    corners.sort((a, b) => Math.atan2(a[1] - middle[1], a[0] - middle[0]) - Math.atan2(b[1] - middle[1], b[0] - middle[0]));
    ctx.beginPath();
    corners.forEach(([x, y], k) => k ? ctx.lineTo(X(x), Y(y)) : ctx.moveTo(X(x), Y(y)));
    ctx.closePath();
    ctx.fillStyle = field === "d" ? colour("paper") : shade((values(frame)[cell] - low) / (high - low));
    ctx.fill(); ctx.stroke();
  }
  if (frame.path) damage(ctx, frame, X, Y);
  scaleBar(ctx, w, h, low, high);
  const said = { S22: "Cauchy stress along the load, MPa", stretch: "largest stretch", d: "damage of the tear path" }[field];
  byId("frame").value = String(at);
  byId("frame").setAttribute("aria-valuetext", `${show(frame.travel)} mm`);
  canvas.setAttribute("aria-label", `Strip of ${test} pulled by ${show(frame.travel)} mm; ${said}: ${show(low)} to ${show(high)}`);
  byId("frame-told").textContent = `${show(frame.travel)} mm, picture ${at + 1} of ${frames.length}; colour: ${said}`;
  curves.mark(test, at, frames.map(f => f.travel));
}

// The tear path where it is damaged: thicker the more.
function damage(ctx, frame, X, Y) {
  const g = frame.path, nodes = Array.from(g.mesh.connectivity, Number), d = g.cells.d;
  for (let cell = 0; cell < d.length; cell++) {
    if (field !== "d" && d[cell] < 0.01) continue;
    const own = nodes.slice(4 * cell, 4 * cell + 4), p = g.mesh.position, u = g.points.displacement;
    const xs = own.map(n => p[3 * n] + u[3 * n]), y = own.reduce((s, n) => s + p[3 * n + 1] + u[3 * n + 1], 0) / 4;
    ctx.strokeStyle = field === "d" ? shade(d[cell]) : colour("bad");
    ctx.lineWidth = field === "d" ? 6 : 1 + 3 * d[cell];
    ctx.beginPath(); ctx.moveTo(X(Math.min(...xs)), Y(y)); ctx.lineTo(X(Math.max(...xs)), Y(y)); ctx.stroke();
  }
}

function scaleBar(ctx, w, h, low, high) {
  const n = 40, top = 16, tall = h - 40;
  for (let k = 0; k < n; k++) { ctx.fillStyle = shade((k + 0.5) / n); ctx.fillRect(w - 70, top + tall * (1 - (k + 1) / n), 12, tall / n + 1); }
  ctx.fillStyle = colour("ink"); ctx.font = "12px system-ui, sans-serif"; ctx.textAlign = "left";
  ctx.fillText(show(high), w - 54, top + 8); ctx.fillText(show(low), w - 54, top + tall);
}

// The picture nearest to a displacement, the one in time order that is asked for where several are.
export function seek(name, share) {
  if (name !== test || !frames.length) return;
  at = Math.min(frames.length - 1, Math.max(0, Math.round(share * (frames.length - 1))));
  paint();
}

export function set(state) {
  const tests = state.curves.map(c => c.test).filter(t => state.fields.some(f => f === `${t}-1.vtu`));
  byId("strip").hidden = !tests.length;
  if (state.run === run && files.length === state.fields.length) return;
  [run, files, frames] = [state.run, state.fields, []];
  if (!tests.length) return;
  const torn = tests.find(t => state.fields.includes(`${t}-path-1.vtu`)) ?? tests[0];
  fill(byId("strip-test"), tests.map(t => el("option", { value: t, selected: t === torn }, t)));
  loadTest(torn);
}

export function begin() {
  byId("strip-test").addEventListener("change", e => loadTest(e.target.value));
  byId("strip-field").addEventListener("change", e => { field = e.target.value; paint(); });
  byId("frame").addEventListener("input", e => { at = Number(e.target.value); paint(); });
  const canvas = byId("mesh-canvas");
  const play = e => { if (e.buttons) seek(test, e.offsetX / canvas.clientWidth); };
  canvas.addEventListener("pointerdown", e => { canvas.setPointerCapture(e.pointerId); play(e); });
  canvas.addEventListener("pointermove", play);
  new ResizeObserver(() => paint()).observe(canvas);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", paint);
}
