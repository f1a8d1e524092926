// Agents against corruptions. A cell opens the list of its episodes; arrow keys go between cells.

function heatmap(one) {
  const readout = el("p", { class: "readout", "aria-live": "polite" }, HINT);
  const names = one.columns.map((column, c) => el("th", { scope: "col", class: c === state.baseline ? "base" : null },
    el("span", {}, breakable(column.label))));
  const lines = [];
  let block = "";
  one.corruptions.forEach((corruption, k) => {
    if (corruption.block !== block) {
      block = corruption.block;
      lines.push(el("tr", { class: "block" }, el("th", { scope: "colgroup", colspan: one.columns.length + 1 }, block)));
    }
    lines.push(el("tr", {}, el("th", { scope: "row" }, corruption.title),
      one.columns.map((_, c) => heatCell(one, c, k, readout))));
  });
  const table = el("table", { class: "heat", onkeydown: arrows, "aria-label": `${state.metric} by agent and corruption` },
    el("thead", {}, el("tr", {}, el("td", {}), names)), el("tbody", {}, lines));
  const first = table.querySelector("button");
  if (first) first.tabIndex = 0;
  return [heatControls(one), el("div", { class: "scroll" }, table), readout, legend()];
}

const HINT = "Click a cell, or press Enter on it, to list its episodes. Arrow keys go from cell to cell.";

function heatControls(one) {
  const shows = [["value", "values"], ["kept", "share of own clean"]];
  if (state.baseline >= 0) shows.push(["change", `difference to ${one.columns[state.baseline].label}`]);
  else if (state.show === "change") state.show = "value";
  const box = el("input", { type: "checkbox", checked: state.intervals, onchange: (event) => { state.intervals = event.target.checked; draw(); } });
  return el("div", { class: "controls" },
    chips("Measure", [["SR", "SR"], ["SPL", "SPL"]], state.metric, (value) => { state.metric = value; draw(); }),
    chips("Shown", shows, state.show, (value) => { state.show = value; draw(); }),
    el("label", { class: "check" }, box, "intervals"));
}

function heatCell(one, c, k, readout) {
  const [sr, spl, have] = one.cells[c][k];
  const own = state.metric === "SR" ? sr : spl;
  if (!own) return el("td", { class: "none" }, "\u2013");
  const unit = state.metric === "SR" ? "%" : "";
  const look = heatLook(one, c, k, own, unit);
  const star = have < one.wanted ? "*" : "";
  const where = `${one.columns[c].label}, ${one.corruptions[k].title}`;
  const words = `${where}: ${state.metric} ${shown(own[0], unit)} ${interval(own, unit)}, ${have} episodes`;
  const inner = [el("span", { class: look.clear ? "strong" : null }, look.text + star),
    state.intervals && el("span", { class: "interval" }, look.range)];
  const tell = () => { readout.textContent = words; };
  if (!opens(one, c, k)) return el("td", { style: look.paint, title: words, onmouseenter: tell }, inner);
  return el("td", { style: look.paint }, el("button", {
    type: "button", tabindex: "-1", "data-at": `${c}/${k}`, "aria-label": `${words}. List the episodes.`,
    onclick: () => openCell(c, k), onfocus: tell, onmouseenter: tell,
  }, inner));
}

function heatLook(one, c, k, own, unit) {
  if (state.show === "change") {
    const found = c === state.baseline ? [0, 0, 0] : difference(one, c, state.baseline, (pair) => pair[state.metric][k]);
    if (!found) return { text: "\u2013", range: "", paint: {} };
    if (c === state.baseline) return { text: "0", range: "", paint: paint(APART, 0.5) };
    return { text: shown(found[0], unit, true), range: interval(found, unit, true), clear: onOneSide(found),
      paint: paint(APART, 0.5 + found[0] / 0.8) };
  }
  if (state.show === "kept") {
    const share = one.cells[c][k][state.metric === "SR" ? 3 : 4];
    return { text: shown(share, ""), range: "", paint: share === null ? {} : paint(CIVIDIS, share) };
  }
  return { text: shown(own[0], unit), range: interval(own, unit), paint: paint(CIVIDIS, own[0]) };
}

function legend() {
  if (state.show === "change") return scaleBar(APART, `${MINUS}40 points`, "+40 points; bold: the interval leaves out zero");
  return scaleBar(CIVIDIS, "0", state.show === "kept" ? "1 (all of the clean value) or more" : state.metric === "SR" ? "100 %" : "1");
}

function arrows(event) {
  const step = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
  const at = event.target.closest("[data-at]");
  if (!step || !at) return;
  event.preventDefault();
  const [c, k] = at.dataset.at.split("/").map(Number), one = section();
  let [x, y] = [c + step[0], k + step[1]];
  while (x >= 0 && y >= 0 && x < one.columns.length && y < one.corruptions.length) {
    const next = event.currentTarget.querySelector(`[data-at="${x}/${y}"]`);
    if (next) { at.tabIndex = -1; next.tabIndex = 0; next.focus(); return; }
    [x, y] = [x + step[0], y + step[1]];
  }
}
