// Elements, numbers, colours. Text from files is only ever put on the page as text.
export const byId = id => document.getElementById(id);

// An element with attributes, listeners (`onclick`) and children; `null` children are left out.
export function el(tag, attributes = {}, ...children) {
  const out = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value === null || value === undefined || value === false) continue;
    if (name.startsWith("on")) out.addEventListener(name.slice(2), value);
    else if (name in out && typeof value !== "string") out[name] = value;
    else out.setAttribute(name, value === true ? "" : value);
  }
  out.append(...children.flat(Infinity).filter(c => c !== null && c !== undefined));
  return out;
}

export function svg(tag, attributes = {}, ...children) {
  const out = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(attributes)) out.setAttribute(name, value);
  out.append(...children);
  return out;
}

// A number of so many significant digits, as people write it.
export const show = (x, digits = 3) => {
  if (x === null || x === undefined || !Number.isFinite(x)) return "–";
  const size = Math.abs(x);
  return size !== 0 && (size < 1e-4 || size >= 1e6) ? x.toExponential(digits - 1) : String(Number(x.toPrecision(digits)));
};
export const percent = x => `${show(100 * x, 2)} %`;
// A probability, in the words of the terminal.
export const probability = p => p > 0.99 ? "> 99 %" : p < 0.01 ? "< 1 %" : `${Math.round(100 * p)} %`;
export const colour = name => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();

// Fills an element anew; what had the focus has it again where it is still there.
export function fill(element, ...children) {
  const id = element.contains(document.activeElement) ? document.activeElement.id : "";
  element.replaceChildren(...children.flat(Infinity).filter(c => c !== null && c !== undefined));
  if (id) byId(id)?.focus();
}
