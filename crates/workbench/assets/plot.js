// A small plot on a canvas: axes, a band, dots, lines. Records go back and forth: nothing is sorted.
import { colour, show } from "./dom.js";

const LEFT = 58, RIGHT = 10, TOP = 8, BOTTOM = 34;

function span(lists) {
  let low = Infinity, high = -Infinity;
  for (const list of lists) for (const x of list ?? []) if (x !== null) { if (x < low) low = x; if (x > high) high = x; }
  if (low > high) return [0, 1];
  const margin = high > low ? 0.05 * (high - low) : Math.abs(high) || 1;
  return [low - margin, high + margin];
}

// Round ticks, at most `most` of them.
function ticks([low, high], most) {
  const raw = (high - low) / Math.max(1, most), unit = 10 ** Math.floor(Math.log10(raw));
  const step = unit * ([1, 2, 5, 10].find(s => s * unit >= raw) ?? 10), out = [];
  for (let k = Math.ceil(low / step); k * step <= high + 1e-9 * step; k++) out.push(k * step);
  const digits = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  const told = x => digits > 5 ? x.toExponential(1) : x.toFixed(digits);
  return out.map(x => [x, told(x)]);
}

// Draws `{ x, series: [{ y, kind: "dots" | "line" | "dash" | "band", colour, half }], xlabel, ylabel }`.
export function draw(canvas, plot) {
  const ratio = window.devicePixelRatio || 1, width = canvas.clientWidth, height = canvas.clientHeight;
  if (width < 80 || height < 60) return;
  canvas.width = Math.round(width * ratio);
  canvas.height = Math.round(height * ratio);
  const ctx = canvas.getContext("2d");
  ctx.scale(ratio, ratio);
  const xs = span([plot.x]), ys = span(plot.series.filter(s => s.kind !== "band").map(s => s.y).concat(plot.least ?? []));
  const X = x => LEFT + (width - LEFT - RIGHT) * (x - xs[0]) / (xs[1] - xs[0]);
  const Y = y => height - BOTTOM - (height - TOP - BOTTOM) * (y - ys[0]) / (ys[1] - ys[0]);
  axes(ctx, plot, xs, ys, X, Y, width, height);
  ctx.save();
  ctx.beginPath();
  ctx.rect(LEFT, TOP, width - LEFT - RIGHT, height - TOP - BOTTOM);
  ctx.clip();
  for (const s of plot.series) series(ctx, plot.x, s, X, Y);
  ctx.restore();
  return { X, Y };
}

function axes(ctx, plot, xs, ys, X, Y, width, height) {
  ctx.font = "12px system-ui, sans-serif";
  ctx.lineWidth = 1;
  ctx.fillStyle = colour("ink");
  ctx.strokeStyle = colour("line");
  ctx.textAlign = "center";
  for (const [x, text] of ticks(xs, (width - LEFT) / 90)) {
    ctx.beginPath(); ctx.moveTo(X(x), TOP); ctx.lineTo(X(x), height - BOTTOM); ctx.stroke();
    ctx.fillText(text, X(x), height - BOTTOM + 14);
  }
  ctx.textAlign = "right";
  for (const [y, text] of ticks(ys, (height - TOP - BOTTOM) / 36)) {
    ctx.beginPath(); ctx.moveTo(LEFT, Y(y)); ctx.lineTo(width - RIGHT, Y(y)); ctx.stroke();
    ctx.fillText(text, LEFT - 5, Y(y) + 4);
  }
  ctx.fillStyle = colour("muted");
  ctx.textAlign = "center";
  ctx.fillText(plot.xlabel, (LEFT + width - RIGHT) / 2, height - 4);
  ctx.save();
  ctx.translate(12, (TOP + height - BOTTOM) / 2);
  ctx.rotate(-Math.PI / 2);
  ctx.fillText(plot.ylabel, 0, 0);
  ctx.restore();
}

function series(ctx, xs, s, X, Y) {
  ctx.fillStyle = ctx.strokeStyle = colour(s.colour);
  const n = Math.min(xs.length, s.y.length);
  if (s.kind === "dots") {
    const size = n > 1500 ? 1 : 1.7;
    for (let i = 0; i < n; i++) if (s.y[i] !== null && xs[i] !== null) ctx.fillRect(X(xs[i]) - size, Y(s.y[i]) - size, 2 * size, 2 * size);
    return;
  }
  if (s.kind === "ring") {
    ctx.lineWidth = 2;
    for (let i = 0; i < n; i++) if (s.y[i] !== null && xs[i] !== null) { ctx.beginPath(); ctx.arc(X(xs[i]), Y(s.y[i]), 6, 0, 7); ctx.stroke(); }
    return;
  }
  const half = s.kind === "band" ? Math.max(1, Math.abs(Y(s.half) - Y(0))) : 0;
  ctx.lineWidth = s.kind === "band" ? 2 * half : s.kind === "thin" ? 1.3 : 2;
  // A record turns back on itself: round joins would bulge out of a band there.
  ctx.lineJoin = s.kind === "band" ? "bevel" : "round";
  ctx.setLineDash(s.kind === "dash" ? [6, 4] : []);
  ctx.beginPath();
  let open = false;
  for (let i = 0; i < n; i++) {
    if (s.y[i] === null || xs[i] === null) { open = false; continue; }
    if (open) ctx.lineTo(X(xs[i]), Y(s.y[i])); else ctx.moveTo(X(xs[i]), Y(s.y[i]));
    open = true;
  }
  ctx.stroke();
  ctx.setLineDash([]);
}

// A line of falling numbers, on a logarithmic scale, without axes.
export function sparkline(canvas, values) {
  const logs = values.filter(v => v > 0).map(Math.log10);
  const ratio = window.devicePixelRatio || 1, width = canvas.clientWidth, height = canvas.clientHeight;
  canvas.width = width * ratio; canvas.height = height * ratio;
  if (logs.length < 2) return;
  const ctx = canvas.getContext("2d"), [low, high] = span([logs]);
  ctx.scale(ratio, ratio);
  ctx.strokeStyle = colour("model");
  ctx.lineWidth = 2;
  ctx.beginPath();
  logs.forEach((v, i) => ctx.lineTo(2 + (width - 4) * i / (logs.length - 1), height - 2 - (height - 4) * (v - low) / (high - low)));
  ctx.stroke();
  canvas.setAttribute("aria-label", `Objective of the search: ${show(values[0])} at its start, ${show(values.at(-1))} now`);
}
