// The table of agents: measures with intervals, and differences to a baseline. Sorts by any column.

function summaryTable(one) {
  const sort = state.sort, base = state.baseline;
  const measured = (c, m) => one.values[c][m];
  const compared = (c, m) => difference(one, c, base, (pair) => pair.measures[m]);
  const key = (c) => {
    if (sort.key === -1) return c;
    if (sort.key === -2) return one.columns[c].label;
    if (base >= 0) return c === base ? 0 : compared(c, sort.key)?.[0] ?? null;
    return measured(c, sort.key)?.[0] ?? null;
  };
  const order = sorted(one.columns.map((_, c) => c), key, sort.key !== -1 && sort.down);
  const onsort = (found) => { state.sort = found; draw(); };
  const reach = one.measures.map((_, m) => bounds(one, m));
  const heads = one.measures.map((measure, m) =>
    sortHeading(measure.title + (measure.unit ? ` (${measure.unit})` : ""), m, sort, onsort, { class: "number" }));
  const about = base >= 0
    ? `Below each value: its paired difference to ${one.columns[base].label}, bold where the interval leaves out zero. Columns sort by it.`
    : one.baselines ? "Values with 95 % intervals. Choose a baseline to see paired differences." : "Values with 95 % intervals.";
  return [el("p", { class: "facts" }, about), el("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": "Table of agents" },
    el("table", { class: "agents" },
      el("thead", {}, el("tr", {},
        sortHeading("Agent", -2, sort, onsort, { class: "name", "data-first": "up" }), heads)),
      el("tbody", {}, order.map((c) => el("tr", { class: c === base ? "base" : null },
        agentHeading(one, c),
        one.measures.map((measure, m) =>
          el("td", { class: "number" }, valueCell(measured(c, m), measure.unit, reach[m]),
            base >= 0 && c !== base && changeLine(compared(c, m), measure.unit))))))))];
}

function agentHeading(one, c) {
  const column = one.columns[c];
  const facts = ["agents", "seeds"].map((name) => [el("dt", {}, name), el("dd", {}, column[name].join(", "))]);
  const keep = (event) => state.open[event.target.open ? "add" : "delete"](column.label);
  const about = el("details", { open: state.open.has(column.label), ontoggle: keep }, el("summary", {}, "details"), el("dl", {}, facts));
  return el("th", { scope: "row", class: "name" }, el("span", { class: "agent" }, breakable(column.label)),
    c === state.baseline && el("span", { class: "tag" }, "baseline"), about);
}

function valueCell(found, unit, [low, high]) {
  if (!found) return el("span", { class: "none" }, "\u2013");
  return [
    el("span", { class: "value" }, shown(found[0], unit), marksOf(found)),
    found[1] !== null && el("span", { class: "interval" }, interval(found, unit)),
    hasWidth(found) && whisker(found, low, high),
  ];
}

const marksOf = (found) => el("span", { class: "marks" }, found[3] ? ` ${found[3]}` : "");

function changeLine(found, unit) {
  if (!found || found[0] === null) return null;
  const clear = onOneSide(found);
  const kind = !clear ? "same" : found[0] > 0 ? "up" : "down";
  return el("span", { class: `change ${kind}` }, shown(found[0], unit, true), " ",
    el("span", { class: "interval" }, interval(found, unit, true)), marksOf(found));
}

// The lowest and highest bound of a measure, for the whiskers of its column.
function bounds(one, m) {
  const held = one.values.map((line) => line[m]).filter((found) => found && found[1] !== null);
  const low = Math.min(...held.map((found) => found[1])), high = Math.max(...held.map((found) => found[2]));
  return [low, high > low ? high : low + 1];
}

function whisker([value, low, high], least, most) {
  const at = (x) => (4 + 92 * (x - least) / (most - least)).toFixed(1);
  return svg("svg", { class: "whisker", viewBox: "0 0 100 8", preserveAspectRatio: "none", "aria-hidden": "true" },
    svg("line", { class: "track", x1: 0, x2: 100, y1: 4, y2: 4 }),
    svg("line", { class: "reach", x1: at(low), x2: at(high), y1: 4, y2: 4 }),
    svg("line", { class: "mid", x1: at(value), x2: at(value), y1: 0, y2: 8 }));
}
