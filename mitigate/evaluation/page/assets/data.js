// What the file holds: the numbers as JSON, the episodes of cells packed, see page/model.py.

const DATA = JSON.parse(document.getElementById("data").textContent);
const MISSING = 65535, SCALE = 1000;
const state = { section: DATA.first, baseline: -1, metric: "SR", show: "value", sort: { key: -1, down: false }, intervals: false, open: new Set() };

const packed = (() => {
  let values = null;
  return () => {
    if (values) return values;
    const text = atob(document.getElementById("packed").textContent.trim());
    values = new Uint16Array(text.length / 2);
    for (let i = 0; i < values.length; i++) values[i] = text.charCodeAt(2 * i) | (text.charCodeAt(2 * i + 1) << 8);
    return values;
  };
})();

const section = () => DATA.sections[state.section];

function choose(n) {
  state.section = n;
  state.baseline = -1;
  state.sort = { key: -1, down: false };
}

// Difference of column i to column j of a section: [value, low, high, marks] by `pick`, or null.
function difference(one, i, j, pick) {
  if (i === j || j < 0) return null;
  const straight = one.pairs[`${i}-${j}`];
  const found = straight ? pick(straight) : one.pairs[`${j}-${i}`] && pick(one.pairs[`${j}-${i}`]);
  if (!found || straight) return found || null;
  const minus = (x) => (x === null ? null : -x);
  return [minus(found[0]), minus(found[2]), minus(found[1]), ...found.slice(3)];
}

function cellKey(one, column, k, seed) {
  const { name, at } = one.corruptions[k];
  return `${one.columns[column].place}|${name}|${at}|${seed}`;
}

// Whether the episodes of a cell are in the file, of all its seeds.
const opens = (one, column, k) => one.columns[column].seeds.every(
  (seed) => DATA.grids[one.grid].cells[cellKey(one, column, k, seed)] !== undefined);

// The episodes of a cell: {seed, index, id, success, spl, steps}; null if they are not in the file.
function episodesOf(one, column, k) {
  if (!opens(one, column, k)) return null;
  const grid = DATA.grids[one.grid];
  const count = grid.episodes.length;
  const rows = [];
  for (const seed of one.columns[column].seeds) {
    const begin = grid.cells[cellKey(one, column, k, seed)];
    const values = packed().subarray(3 * begin, 3 * (begin + count));
    for (let n = 0; n < count; n++) {
      if (values[n] === MISSING) continue;
      const steps = values[2 * count + n];
      rows.push({ seed, index: n, id: grid.episodes[n], success: values[n] / SCALE,
        spl: values[count + n] / SCALE, steps: steps === MISSING ? null : steps });
    }
  }
  return rows;
}

// The address after # says which section, baseline and cell are shown.
function readAddress() {
  const given = new URLSearchParams(location.hash.slice(1));
  const whole = (name, most) => {
    const found = given.get(name);
    return found !== null && /^\d+$/.test(found) && Number(found) < most ? Number(found) : null;
  };
  const chosen = whole("section", DATA.sections.length);
  if (chosen !== null) choose(chosen);
  state.baseline = whole("baseline", section()?.baselines ?? 0) ?? -1;
  return { agent: whole("agent", section()?.columns.length ?? 0), corruption: given.get("corruption") };
}

function writeAddress(cell) {
  const held = new URLSearchParams({ section: state.section });
  if (state.baseline >= 0) held.set("baseline", state.baseline);
  if (cell) { held.set("agent", cell.column); held.set("corruption", section().corruptions[cell.k].name); }
  try { history.replaceState(null, "", "#" + held); } catch { /* an address that may not change */ }
}
