// Sliders without a server: forces move along the derivatives at the fit, F + Σ ∂F/∂θ Δθ.
const knobs = rung => [...document.querySelectorAll(`#sliders [data-of="${rung}"] input`)];
const knob = input => {
  const d = input.dataset, [value, low, high] = [Number(d.value), Number(d.low), Number(d.high)], log = low > 0, s = Number(input.value) / 1000;
  const at = log ? low * (high / low) ** s : low + (high - low) * s;
  // A slider has a thousand places; the fit's own value need be none of them.
  return { path: d.path, value, now: input.dataset.touched ? at : value, home: Math.round(1000 * (log ? Math.log(value / low) / Math.log(high / low) : (value - low) / (high - low))),
    told: x => `${show(x * Number(d.factor))} ${d.unit}`.trim() };
};
// Changes of parameters, by path; `null` where nothing is moved.
function movedBy() {
  const all = knobs(state.rung).map(knob).filter(k => k.now !== k.value);
  return all.length ? new Map(all.map(k => [k.path, k.now - k.value])) : null;
}
// The forces of a test where the sliders stand; `null` where nothing is moved.
function linearForce(name) {
  const by = movedBy(), rung = page.rungs[state.rung], columns = rung.jacobian?.tests[name], m = rung.force[name];
  if (!by || !columns || !m) return null;
  const out = m.slice();
  rung.jacobian.paths.forEach((path, k) => {
    const step = by.get(path);
    if (step) for (let i = 0; i < out.length; i++) out[i] += step * (columns[k][i] ?? 0);
  });
  return out;
}
function tellMoved() {
  const all = knobs(state.rung);
  for (const input of all) {
    const k = knob(input);
    if (!input.dataset.touched) input.value = k.home;
    input.nextElementSibling.textContent = k.told(k.now);
    input.setAttribute("aria-valuetext", k.told(k.now));
  }
  const moved = all.map(knob).filter(k => k.now !== k.value), said = document.getElementById("moved"), command = document.getElementById("moved-command");
  said.textContent = moved.length ? page.tests.filter(t => t.f.length && linearForce(t.name)).map(t => {
    const rms = y => Math.sqrt(t.f.reduce((s, f, i) => s + (f - y[i]) ** 2, 0) / t.f.length);
    return `${t.name}: misfit ${show(rms(page.rungs[state.rung].force[t.name]), 3)} N at the fit, about ${show(rms(linearForce(t.name)), 3)} N here`;
  }).join("; ") : "";
  command.hidden = !moved.length;
  command.textContent = moved.length ? `fct set ${page.rungs[state.rung].run} ${moved.map(k => `${quoted(k.path)}=${k.now}`).join(" ")} --out moved.toml\nfct identify moved.toml --at-start` : "";
}
// A word that a shell takes as it is.
const quoted = word => /^[\w./=-]+$/.test(word) ? word : `'${word}'`;
function beginSliders() {
  if (!document.getElementById("sliders")) return;
  const all = document.querySelectorAll("#sliders input");
  for (const input of all) input.addEventListener("input", () => { input.dataset.touched = "1"; tellMoved(); redraw(); });
  document.getElementById("back").addEventListener("click", () => { for (const input of all) delete input.dataset.touched; tellMoved(); redraw(); });
  tellMoved();
}
