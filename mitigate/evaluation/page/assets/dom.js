// Elements and numbers. Text goes in as text: nothing here or elsewhere reads HTML from data.

const SVG = "http://www.w3.org/2000/svg";

function fill(node, props, children) {
  for (const [name, value] of Object.entries(props || {})) {
    if (value === null || value === undefined || value === false) continue;
    if (name.startsWith("on")) node.addEventListener(name.slice(2), value);
    else if (name === "style") for (const [k, v] of Object.entries(value)) node.style.setProperty(k, v);
    else node.setAttribute(name, value === true ? "" : String(value));
  }
  for (const child of children.flat(3)) {
    if (child !== null && child !== undefined && child !== false) node.append(child);
  }
  return node;
}

const el = (tag, props, ...children) => fill(document.createElement(tag), props, children);
const svg = (tag, props, ...children) => fill(document.createElementNS(SVG, tag), props, children);

// A name that may break after a sign that joins words.
const breakable = (text) => String(text).split(/(?<=[_+.\/-])/).flatMap((part, n) => (n ? [el("wbr"), part] : [part]));

const MINUS = "\u2212";

// A positive number with some digits, a tie to the even one as Python writes it. A tie is an odd
// multiple of a power of two; toFixed, which is exact otherwise, takes the greater neighbour.
function fixed(x, digits) {
  const text = x.toFixed(digits), last = Number(text.slice(-1));
  const tie = (x * 2 ** (digits + 1)) % 2 === 1;
  return tie && last % 2 ? text.slice(0, -1) + (last - 1) : text;
}

// A number of a measure: SR in percent with one digit, all else with two.
function shown(value, unit, signed = false) {
  if (value === null || value === undefined) return "\u2013";
  const text = unit === "%" ? fixed(Math.abs(100 * value), 1) : fixed(Math.abs(value), 2);
  const zero = Number(text) === 0;
  if (value < 0 && !zero) return MINUS + text;
  return signed && !zero ? "+" + text : text;
}

// An interval without a width says nothing: there was one episode, or no resample differs.
const hasWidth = (found) => found[1] !== null && found[2] - found[1] > 1e-9;

const interval = (found, unit, signed = false) => (hasWidth(found)
  ? `[${shown(found[1], unit, signed)}, ${shown(found[2], unit, signed)}]` : "[\u2013]");

const onOneSide = (found) => hasWidth(found) && (found[1] > 0 || found[2] < 0);

function labelled(text, control) {
  return el("label", { class: "field" }, el("span", {}, text), control);
}

// A drop-down: pairs of value and text.
function choice(options, chosen, onchoose) {
  const made = options.map(([value, text]) =>
    el("option", { value, selected: String(value) === String(chosen) }, text));
  return el("select", { onchange: (event) => onchoose(event.target.value) }, made);
}

// Buttons of which one is on.
function chips(title, options, chosen, onchoose) {
  const made = options.map(([value, text]) => el("button", {
    type: "button", class: "chip", "aria-pressed": String(value === chosen),
    onclick: () => onchoose(value),
  }, text));
  return el("div", { class: "chips", role: "group", "aria-label": title }, made);
}

// A heading of a table that sorts it; sort is {key, down}.
function sortHeading(text, key, sort, onsort, props = {}) {
  const on = sort.key === key;
  const order = on ? (sort.down ? "descending" : "ascending") : "none";
  const arrow = on ? (sort.down ? " \u25be" : " \u25b4") : "";
  const click = () => onsort({ key, down: on ? !sort.down : props["data-first"] !== "up" });
  return el("th", { scope: "col", "aria-sort": order, ...props },
    el("button", { type: "button", class: "sort", "data-sort": key, onclick: click }, text, el("span", { class: "arrow" }, arrow)));
}

// Rows in the order of what `value` gives; what is missing comes last either way.
function sorted(rows, value, down) {
  const keyed = rows.map((row, place) => ({ row, place, key: value(row) }));
  const lacks = (key) => key === null || key === undefined;
  keyed.sort((a, b) => {
    if (lacks(a.key) || lacks(b.key)) return lacks(a.key) - lacks(b.key) || a.place - b.place;
    const order = typeof a.key === "string"
      ? a.key.localeCompare(b.key, "en", { numeric: true }) : a.key - b.key;
    return (down ? -order : order) || a.place - b.place;
  });
  return keyed.map((one) => one.row);
}

// Draws a part again and keeps the keyboard where it was.
function redraw(place, draw) {
  const active = document.activeElement;
  const inside = place.contains(active);
  const spot = inside ? [...place.querySelectorAll("button,select,input")].indexOf(active) : -1;
  place.replaceChildren(...[draw()].flat().filter(Boolean));
  if (spot >= 0) place.querySelectorAll("button,select,input")[spot]?.focus({ preventScroll: true });
}
