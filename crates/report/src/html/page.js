// What the page does: choosing a rung or an axis, colour scheme, size, printing.
const makers = { test: testChart, main: testChart, path: pathChart, values: searchChart, objective: searchChart, channel: channelChart, batch: batchChart };
const charts = [...document.querySelectorAll("[data-chart]")].filter(f => f.dataset.chart in makers).map(f => Object.assign(makers[f.dataset.chart](f), { figure: f }));
const redraw = () => charts.forEach(c => c.redraw());

function choose(rung) {
  state.rung = rung;
  // Another model's tear stands elsewhere.
  if (state.axis === "front") charts.forEach(c => c.reset && c.reset());
  document.querySelectorAll("[data-rung]").forEach(b => b.setAttribute("aria-pressed", b.dataset.rung === String(rung)));
  document.querySelectorAll("[data-of]").forEach(d => { d.hidden = d.dataset.of !== String(rung); });
  document.querySelectorAll("[data-shown]").forEach(s => { s.textContent = page.rungs[rung].name; });
  tellMoved();
  redraw();
}
document.querySelectorAll("[data-rung]").forEach(b => b.addEventListener("click", () => choose(Number(b.dataset.rung))));
document.querySelectorAll("[data-axis]").forEach(b => b.addEventListener("click", () => {
  state.axis = b.dataset.axis;
  document.querySelectorAll("[data-axis]").forEach(o => o.setAttribute("aria-pressed", o === b));
  charts.forEach(c => c.reset && c.reset());
  redraw();
}));

matchMedia("(prefers-color-scheme: dark)").addEventListener("change", redraw);
// Paper is white whatever the screen.
addEventListener("beforeprint", () => { document.documentElement.classList.add("paper"); redraw(); });
addEventListener("afterprint", () => { document.documentElement.classList.remove("paper"); redraw(); });
const widths = new Map();
const observer = new ResizeObserver(entries => entries.forEach(e => {
  const before = widths.get(e.target), now = e.contentRect.width;
  widths.set(e.target, now);
  if (before !== undefined && Math.abs(before - now) > 1) charts.find(c => c.figure === e.target)?.size();
}));
charts.forEach(c => observer.observe(c.figure));
beginSliders();
