// Puts the parts together, and the choices that all of them share.

function theme() {
  const root = document.documentElement;
  const next = { auto: "light", light: "dark", dark: "auto" };
  const button = el("button", { type: "button", class: "chip", onclick: () => {
    const now = next[root.dataset.theme || "auto"];
    root.dataset.theme = now;
    button.textContent = `Colours: ${now}`;
  } }, "Colours: auto");
  return button;
}

function head() {
  document.getElementById("top").replaceChildren(
    el("div", { class: "masthead" }, el("h1", {}, DATA.title), theme()),
    el("p", { class: "lead" }, DATA.about));
}

function chooser() {
  const one = section();
  const list = DATA.sections.map((held, n) => [n, held.title]);
  const bases = one.columns.slice(0, one.baselines).map((column, c) => [c, column.label]);
  if (list.length < 2 && !bases.length) return null;
  return el("div", { class: "controls choose" },
    list.length > 1 && labelled("Results", choice(list, state.section, (value) => {
      choose(Number(value)); writeAddress(null); draw();
    })),
    bases.length > 0 && labelled("Baseline", choice([[-1, "none"], ...bases], state.baseline, (value) => {
      state.baseline = Number(value); writeAddress(null); draw();
    })));
}

function facts(one) {
  return el("dl", { class: "facts line" }, one.facts.map(([name, value]) => el("div", {}, el("dt", {}, name), el("dd", {}, value))));
}

function notes(one) {
  const all = [...one.notes, ...DATA.notes];
  return all.length ? el("ul", { class: "notes" }, all.map((text) => el("li", {}, text))) : null;
}

function draw() {
  const main = document.getElementById("main");
  const one = section();
  redraw(main, () => [
    el("section", { class: "card", "aria-label": "Results" }, chooser(), facts(one), summaryTable(one), notes(one)),
    one.corruptions.length > 1 && el("section", { class: "card", "aria-label": "Heatmap" }, el("h2", {}, "By corruption"), heatmap(one)),
    curvesPart(), walksPart(),
  ].flat());
}

// Shows what the address names, and the cell if it names one.
function follow() {
  const asked = readAddress();
  document.querySelector("dialog")?.remove();
  draw();
  if (asked.agent === null || asked.corruption === null) return;
  const k = section().corruptions.findIndex((held) => held.name === asked.corruption);
  if (k >= 0) openCell(asked.agent, k);
}

head();
follow();
document.getElementById("end").append(el("p", { class: "facts" }, DATA.end));
window.addEventListener("hashchange", () => { if (location.hash.includes("=")) follow(); }); // not of the skip link
