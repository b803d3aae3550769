"use strict";
// Charts of a report. uPlot draws axes, grid and lines and follows the mouse; a record that goes back and
// forth is not sorted by displacement, so paths and the nearest point are our own.
const page = JSON.parse(document.getElementById("data").textContent);
const state = { rung: page.shown, axis: "u" };
const css = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
const colour = i => css("--c" + (i % 10));
const wide = figure => Math.max(260, figure.clientWidth - 16);
const show = (x, digits = 4) => x == null ? "–" : Number(x.toPrecision(digits)).toString();

// Least and greatest with a margin.
function span(lists, margin = 0.04) {
  let low = Infinity, high = -Infinity;
  for (const list of lists) for (const x of list) if (x != null) { if (x < low) low = x; if (x > high) high = x; }
  if (low > high) return [0, 1];
  const m = high > low ? margin * (high - low) : Math.abs(high) || 1;
  return [low - m, high + m];
}

// An axis in the page's colours.
function axis(label, more = {}) {
  return { label, stroke: css("--ink"), grid: { stroke: css("--line"), width: 1 }, ticks: { stroke: css("--line") },
    font: "12px system-ui, sans-serif", labelFont: "12px system-ui, sans-serif", labelSize: 18, labelGap: 2, ...more };
}
// Ticks of one axis have as many decimals each, and enough room not to overprint.
const even = ticks => {
  const step = ticks.length > 1 ? Math.abs(ticks[1] - ticks[0]) : 1;
  let digits = 0;
  while (digits < 9 && Math.abs(step * 10 ** digits - Math.round(step * 10 ** digits)) > 1e-6) digits++;
  return ticks.map(t => t == null ? "" : Math.abs(t) >= 1e5 || step < 1e-7 ? t.toExponential(1) : t.toFixed(digits));
};
const left = (label, space = 34) => axis(label, { size: 62, space, values: (u, ticks) => even(ticks) });

// Everything that is drawn by hand stays inside the axes.
function inside(u, draw) {
  const { left, top, width, height } = u.bbox, ctx = u.ctx;
  ctx.save(); ctx.beginPath(); ctx.rect(left, top, width, height); ctx.clip(); draw(ctx, uPlot.pxRatio || devicePixelRatio || 1); ctx.restore();
}
function dots(u, xs, ys, from, to, size) {
  const path = new Path2D(), many = xs.length > 3000, seen = new Set();
  for (let i = from; i < to; i++) {
    if (ys[i] == null) continue;
    const x = u.valToPos(xs[i], "x", true), y = u.valToPos(ys[i], "y", true);
    if (many) {
      // Of a big record one dot per place is drawn: the others could not be seen.
      const place = Math.round(x / size) * 65536 + Math.round(y / size);
      if (seen.has(place)) continue;
      seen.add(place); path.rect(x - size, y - size, 2 * size, 2 * size);
    } else { path.moveTo(x + size, y); path.arc(x, y, size, 0, 2 * Math.PI); }
  }
  return path;
}
function line(u, xs, ys) {
  const path = new Path2D();
  let open = false;
  for (const [x, y] of corners(u, xs, ys)) {
    if (x == null) { open = false; continue; }
    if (open) path.lineTo(x, y); else path.moveTo(x, y);
    open = true;
  }
  return path;
}
// Places on the screen, those left out that are less than a pixel from the one before; null: a gap.
function corners(u, xs, ys) {
  const out = [];
  let px = -9, py = -9;
  for (let i = 0; i < xs.length; i++) {
    if (ys[i] == null) { out.push([null]); px = -9; continue; }
    const x = u.valToPos(xs[i], "x", true), y = u.valToPos(ys[i], "y", true);
    if (Math.abs(x - px) < 0.8 && Math.abs(y - py) < 0.8 && i < xs.length - 1) continue;
    out.push([px = x, py = y]);
  }
  return out;
}
// The band of height ±h about a line that may go back and forth: one polygon per run in one direction, all
// of one winding, so that overlaps are not darker.
function band(u, xs, ys, h) {
  const path = new Path2D(), all = corners(u, xs, ys).filter(c => c[0] != null);
  for (let i = 0; i + 1 < all.length;) {
    const way = all[i + 1][0] >= all[i][0];
    let j = i + 1;
    while (j + 1 < all.length && (all[j + 1][0] >= all[j][0]) === way) j++;
    const up = way ? -h : h;
    path.moveTo(all[i][0], all[i][1] + up);
    for (let k = i + 1; k <= j; k++) path.lineTo(all[k][0], all[k][1] + up);
    for (let k = j; k >= i; k--) path.lineTo(all[k][0], all[k][1] - up);
    path.closePath();
    i = j;
  }
  return path;
}
// Index of the point nearest to the mouse on the screen, in any of the columns.
function nearest(u, xs, columns) {
  const { left, top } = u.cursor;
  let best = null, least = Infinity;
  const sx = u.bbox.width / devicePixelRatio / (u.scales.x.max - u.scales.x.min), sy = u.bbox.height / devicePixelRatio / (u.scales.y.max - u.scales.y.min);
  const cx = u.posToVal(left, "x"), cy = u.posToVal(top, "y");
  for (let i = 0; i < xs.length; i++) for (const c of columns) {
    if (c[i] == null) continue;
    const d = ((xs[i] - cx) * sx) ** 2 + ((c[i] - cy) * sy) ** 2;
    if (d < least) { least = d; best = i; }
  }
  return best;
}

// An entry of a legend. Names come from files: they are put on the page as text, never as markup.
function chip(colour, text, round) {
  const entry = document.createElement("span"), mark = document.createElement("i");
  mark.style.background = colour;
  if (round) mark.style.borderRadius = "50%"; else mark.style.height = "3px";
  entry.append(mark, text);
  return entry;
}

// A pair of scales that zooming changes; double click brings back the whole.
function zoomable(view, again) {
  return {
    cursor: { drag: { x: true, y: true, uni: 12, setScale: false }, bind: { dblclick: () => () => { view.reset(); again(); } } },
    hooks: { setSelect: [u => {
      const s = u.select;
      if (s.width < 8 && s.height < 8) return;
      if (s.width >= 8) view.x = [u.posToVal(s.left, "x"), u.posToVal(s.left + s.width, "x")];
      if (s.height >= 8 && s.height < u.over.clientHeight - 1) view.y[u.part] = [u.posToVal(s.top + s.height, "y"), u.posToVal(s.top, "y")];
      again();
    }] },
  };
}

// Kind of a segment: its name without the count.
const kindOf = name => name.replace(/ \d+$/, "");

// What a test is drawn against; of an intact strip, whose record knows no tear front, the displacement.
const labels = { u: "displacement (mm)", t: "time (s)", front: "tear front of the model (mm)" };
function against(test) {
  const front = page.rungs[state.rung].channels[test.name + ".tear_front"];
  return state.axis === "front" ? (front ? ["front", front] : ["u", test.u]) : [state.axis, test[state.axis]];
}

// Record, model with noise band, misfit coloured by segment underneath.
function testChart(figure) {
  const test = page.tests.find(t => t.name === figure.dataset.name);
  const measured = test.f.length > 0, main = figure.dataset.chart === "main";
  const kinds = [...new Set(test.segments.map(s => kindOf(s[0])))];
  const model = () => page.rungs[state.rung].force[test.name] || [];
  const moved = () => linearForce(test.name);
  const misfit = () => { const y = moved() ?? model(); return test.f.map((f, i) => f - y[i]); };
  const segment = i => { const s = test.segments.find(s => s[1] <= i && i < s[2]); return s ? s[0] : ""; };
  const along = () => against(test)[1];
  const view = { reset() { this.x = span([along()]); this.y = {}; } };
  view.reset();
  const box = document.createElement("div"), readout = document.createElement("p"), legend = document.createElement("p");
  readout.className = "readout"; readout.setAttribute("aria-live", "polite"); legend.className = "legend";
  figure.prepend(box, readout, legend);
  let plots = [], busy = false;
  const tell = i => {
    if (i == null) { readout.textContent = "\u00a0"; return; }
    const m = model()[i], f = test.f[i];
    figure.dataset.index = i;
    readout.textContent = `${show(test.u[i])} mm, ${show(test.t[i])} s: ` + (measured
      ? `record ${show(f)} N, model ${show(m)} N, misfit ${show(f - m, 3)} N = ${show((f - m) / test.noise, 2)} sd, ${segment(i)}`
      : `${show(m)} N`);
  };
  const follow = part => u => {
    if (busy) return;
    const i = u.cursor.left < 0 ? null : u.cursor.idxs[1];
    tell(i);
    busy = true;
    for (const other of plots) if (other !== u) other.setCursor(i == null ? { left: -10, top: -10 }
      : { left: other.valToPos(along()[i], "x"), top: other.valToPos(other.data[1][i], "y") }, false);
    busy = false;
  };
  function part(name, height, series, y, hooks, xLabel) {
    const xs = along(), z = zoomable(view, draw);
    const columns = series.map(s => s.data);
    const u = new uPlot({
      width: wide(figure), height, legend: { show: false }, padding: [8, 10, 0, 0],
      scales: { x: { time: false, min: view.x[0], max: view.x[1], range: (u, a, b) => [a, b] }, y: { auto: false, min: y[0], max: y[1], range: (u, a, b) => [a, b] } },
      axes: [xLabel ? axis(xLabel, { size: 30, space: 58 }) : axis("", { size: 6, labelSize: 0, values: () => [], label: null }), left(name, height < 180 ? 24 : 34)],
      cursor: { ...z.cursor, dataIdx: u => { if (!busy || u.at == null) u.at = nearest(u, xs, columns); return u.at; }, points: { size: 8, fill: css("--ink"), stroke: css("--paper") } },
      series: [{}, ...series.map(s => ({ stroke: s.colour, dash: s.dash, fill: s.dots ? s.colour : undefined, width: s.dots ? 0 : 2, points: { show: false }, spanGaps: true,
        paths: u => { if (s.hidden) return null; return s.dots ? { fill: dots(u, xs, s.data, 0, xs.length, 2 * devicePixelRatio), stroke: null } : { stroke: line(u, xs, s.data), fill: null }; } }))],
      hooks: { drawClear: [u => inside(u, ctx => hooks.under && hooks.under(u, ctx, xs))], draw: [u => inside(u, ctx => hooks.over && hooks.over(u, ctx, xs))],
        setSelect: z.hooks.setSelect, setCursor: [follow(name)] },
    }, [xs, ...columns], box);
    u.part = name;
    return u;
  }
  function draw() {
    plots.forEach(p => p.destroy());
    const xLabel = labels[against(test)[0]], m = model();
    const narrow = figure.clientWidth < 480;
    if (!measured) {
      plots = [part("force (N)", narrow ? 260 : 320, [{ data: m, colour: css("--model") }], view.y["force (N)"] || span([m]), {}, xLabel)];
      return;
    }
    const r = misfit(), most = r.reduce((a, x) => Math.max(a, Math.abs(x)), 3 * test.noise) * 1.08;
    const noise = { under(u, ctx, xs) {
      ctx.fillStyle = css("--band");
      ctx.fill(band(u, xs, m, Math.abs(u.valToPos(2 * test.noise, "y", true) - u.valToPos(0, "y", true))), "nonzero");
    } };
    const strip = {
      under(u, ctx) {
        const y = v => u.valToPos(v, "y", true);
        ctx.fillStyle = css("--band"); ctx.fillRect(u.bbox.left, y(2 * test.noise), u.bbox.width, y(-2 * test.noise) - y(2 * test.noise));
        ctx.fillStyle = css("--ink"); ctx.fillRect(u.bbox.left, y(0) - 0.5, u.bbox.width, 1);
      },
      over(u, ctx, xs) {
        for (const [name, from, to] of test.segments) { ctx.fillStyle = colour(kinds.indexOf(kindOf(name))); ctx.fill(dots(u, xs, r, from, to, 2 * devicePixelRatio)); }
      },
    };
    const linear = moved(), dashed = linear ? [{ data: linear, colour: css("--second"), dash: [6, 4] }] : [];
    const force = (height, xLabel) => part("force (N)", height, [{ data: test.f, colour: css("--record"), dots: true }, { data: m, colour: css("--model") }, ...dashed], view.y["force (N)"] || span([test.f, ...page.rungs.map(k => k.force[test.name] || [])]), noise, xLabel);
    plots = main ? [force(narrow ? 200 : 230, xLabel)] : [
      force(narrow ? 220 : 270, ""),
      part("misfit (N)", narrow ? 150 : 160, [{ data: r, colour: css("--ink"), hidden: true }], view.y["misfit (N)"] || [-most, most], strip, xLabel),
    ];
  }
  const redraw = () => {
    legend.replaceChildren(...(measured ? [chip(css("--record"), "record", true), chip(css("--model"), "model"), ...(moved() ? [chip(css("--second"), "straight-line estimate")] : []), chip(css("--band"), "± 2 sd", true), ...(main ? [] : kinds.map((k, i) => chip(colour(i), k, true)))] : []));
    tell(null); draw();
  };
  redraw();
  return { redraw, reset() { view.reset(); }, size: draw, hover: i => {
    const u = plots[0];
    u.setCursor({ left: u.valToPos(along()[i], "x"), top: u.valToPos(u.data[1][i], "y") });
  } };
}

// Values per area with intervals and published values.
function pathChart(figure) {
  const what = figure.dataset.name, box = document.createElement("div"), readout = document.createElement("p");
  readout.className = "readout"; readout.textContent = "\u00a0";
  figure.prepend(box, readout);
  let plot = null;
  function draw() {
    if (plot) plot.destroy();
    const rows = page.rungs[state.rung].path.filter(p => p[0] === what);
    if (!rows.length) { plot = null; return; }
    const xs = rows.map(r => r[1]), values = rows.map(r => r[2]), c = css(what === "gc" ? "--model" : "--second");
    const top = Math.max(...rows.flatMap(r => [r[2], r[5] || 0])), ends = rows.map(r => r[4]).filter(e => e != null && e < 3 * top);
    const high = 1.08 * Math.max(top, ...ends);
    plot = new uPlot({
      width: wide(figure), height: 240, legend: { show: false }, padding: [8, 10, 0, 0],
      scales: { x: { time: false, min: 0.5, max: xs.length + 0.5, range: (u, a, b) => [a, b] }, y: { auto: false, min: 0, max: high, range: (u, a, b) => [a, b] } },
      axes: [axis("area, from the cut", { size: 30, splits: () => xs, grid: { show: false } }), left(what === "gc" ? "Gc (N/mm)" : "σc (MPa)")],
      cursor: { drag: { x: false, y: false }, y: false, points: { show: false } },
      series: [{}, { paths: () => null, points: { show: false } }],
      hooks: {
        draw: [u => inside(u, (ctx, px) => rows.forEach(([, at, v, low, up, published, fixed]) => {
          const x = u.valToPos(at, "x", true), y = w => u.valToPos(Math.min(Math.max(w, 0), high * 1.2), "y", true);
          ctx.strokeStyle = ctx.fillStyle = c; ctx.lineWidth = 2 * px;
          ctx.beginPath(); ctx.moveTo(x, y(low ?? 0)); ctx.lineTo(x, y(up ?? 9 * high)); ctx.stroke();
          ctx.beginPath(); ctx.arc(x, y(v), 4.5 * px, 0, 7);
          if (fixed) ctx.fill(); else { ctx.fillStyle = css("--card"); ctx.fill(); ctx.stroke(); }
          if (published != null) {
            const [a, b, s] = [x + 9 * px, y(published), 5 * px];
            ctx.fillStyle = css("--published"); ctx.beginPath(); ctx.moveTo(a, b - s); ctx.lineTo(a + s, b); ctx.lineTo(a, b + s); ctx.lineTo(a - s, b); ctx.fill();
          }
        }))],
        setCursor: [u => {
          const r = u.cursor.idx == null || u.cursor.left < 0 ? null : rows[u.cursor.idx];
          readout.textContent = r ? `area ${r[1]}: ${show(r[2])}, 95 %: ${show(r[3])} – ${show(r[4])}` + (r[5] == null ? "" : `, published ${show(r[5])}`) + (r[6] ? "" : ", not fixed") : "\u00a0";
        }],
      },
    }, [xs, values], box);
  }
  draw();
  return { redraw: draw, size: draw };
}

// Lines over a sorted axis with uPlot's own legend.
function lines(figure, xs, series, xLabel, yLabel, { log = false, marks = [], ends = null } = {}) {
  const box = document.createElement("div");
  figure.prepend(box);
  let plot = null;
  function draw() {
    if (plot) plot.destroy();
    const list = typeof series === "function" ? series() : series;
    const dash = i => i >= 8 ? [6, 3] : i >= 16 ? [2, 2] : undefined;
    plot = new uPlot({
      width: wide(figure), height: 300, padding: [8, 10, 0, 0], legend: { live: figure.clientWidth > 480 },
      scales: { x: ends ? { time: false, range: ends } : { time: false }, y: log ? { distr: 3 } : {} },
      axes: [axis(xLabel, { size: 30 }), log ? axis(yLabel, { size: 58, values: (u, t) => t.map(v => v == null || Math.abs(Math.log10(v) % 1) > 1e-6 && v < 0.01 ? "" : show(v, 2)) }) : left(yLabel)],
      series: [{ label: xLabel }, ...list.map((s, i) => ({ label: s.name, stroke: colour(i), dash: dash(i), width: 2, spanGaps: false, points: { show: xs.length < 40, size: 5 }, value: (u, v) => show(v) }))],
      hooks: { draw: [u => inside(u, ctx => marks.forEach(m => { ctx.fillStyle = css("--muted"); ctx.fillRect(u.valToPos(m, "x", true), u.bbox.top, 1, u.bbox.height); }))] },
    }, [xs, ...list.map(s => s.data)], box);
  }
  draw();
  return { redraw: draw, size: draw };
}
function searchChart(figure) {
  const c = page.convergence, xs = c.objective.map((_, i) => i);
  const marks = xs.filter(i => i > 0 && c.stages[i] !== c.stages[i - 1]).map(i => i - 0.5);
  return figure.dataset.chart === "values"
    ? lines(figure, xs, c.names.map((name, i) => ({ name, data: c.values[i] })), "accepted step", "value / final value", { log: true, marks })
    : lines(figure, xs, [{ name: "f / f at start of the stage", data: c.objective }], "accepted step", "f / f at start", { log: true, marks });
}
// A camera channel against time, of the rung shown.
function channelChart(figure) {
  const [name, word] = figure.dataset.name.split(/\.(?=[^.]*$)/), test = page.tests.find(t => t.name === name);
  return lines(figure, test.t, () => [{ name: "record", data: test.channels[word] }, { name: "model", data: page.rungs[state.rung].channels[figure.dataset.name] || [] }], "time (s)", word.replaceAll("_", " ") + " (mm)");
}
function batchChart(figure) {
  // Areas divide the path into equal parts, whatever their number: a value stands in the middle of its part.
  const key = figure.dataset.name, place = (i, list) => (i + 0.5) / list.length;
  const xs = [...new Set(page.batch.flatMap(s => s[key].map((_, i) => place(i, s[key]))))].sort((a, b) => a - b);
  const data = list => xs.map(x => { const i = list.findIndex((_, i) => place(i, list) === x); return i < 0 ? undefined : list[i]; }); // undefined: no area there; null: not fixed, a gap
  return lines(figure, xs, page.batch.map(s => ({ name: s.name, data: data(s[key]) })), "place along the tear path (0: cut, 1: far edge)", key === "gc" ? "Gc (N/mm)" : "σc (MPa)", { ends: [0, 1] });
}
