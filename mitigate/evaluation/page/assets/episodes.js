// The episodes of a cell, in a dialog: success, SPL and steps, beside clean and beside the baseline.

const PAGE = 500; // lines that are drawn at once

function openCell(column, k) {
  const one = section();
  const rows = episodesOf(one, column, k);
  if (!rows) return;
  const clean = k > 0 ? lookup(episodesOf(one, column, 0)) : null;
  const other = state.baseline >= 0 && state.baseline !== column ? state.baseline : -1;
  const base = other >= 0 ? lookup(episodesOf(one, other, k)) : null;
  const seeds = one.columns[column].seeds.length, held = byEpisode(rows);
  for (const row of rows) {
    row.whole = held.get(row.index).length === seeds;
    row.clean = clean?.get(`${row.seed}/${row.index}`) ?? null;
    row.base = base?.get(`${row.seed}/${row.index}`) ?? null;
    row.walk = walkOf(one, column, k, row);
  }
  const view = { filter: "both", sort: { key: "id", down: false }, search: "", most: PAGE };
  let walk = null; // that the dialog leads to
  const see = (n) => { walk = n; dialog.close(); };
  const kinds = el("div", {}), list = el("div", {});
  const search = el("input", { type: "search", placeholder: "episode id", "aria-label": "Search episodes",
    oninput: () => { view.search = search.value; view.most = PAGE; show(); } });
  const dialog = el("dialog", { class: "cell", "aria-labelledby": "cell-title" }, el("div", { class: "inside" },
    el("header", {}, el("h2", { id: "cell-title" }, one.columns[column].label, " \u00b7 ", one.corruptions[k].title),
      el("button", { type: "button", class: "close", onclick: () => dialog.close() }, "Close")),
    el("p", { class: "facts" }, one.title), el("div", { class: "controls" }, kinds, search), list));
  const others = { clean, base, other, column, see };
  const show = () => {
    redraw(kinds, () => cellKinds(one, rows, view, others, show));
    redraw(list, () => cellList(one, rows, view, others, show));
  };
  dialog.addEventListener("close", () => {
    dialog.remove();
    writeAddress(null);
    if (walk !== null) showWalk(walk);
    else document.querySelector(`[data-at="${column}/${k}"]`)?.focus();
  });
  dialog.addEventListener("click", (event) => { if (event.target === dialog) dialog.close(); });
  document.body.append(dialog);
  show();
  dialog.showModal();
  writeAddress({ column, k });
}

function byEpisode(rows) {
  const held = new Map();
  for (const row of rows) held.set(row.index, [...(held.get(row.index) ?? []), row]);
  return held;
}

const lookup = (rows) => rows && new Map(rows.map((row) => [`${row.seed}/${row.index}`, row]));

const FILTERS = {
  both: ["both", () => true],
  won: ["won", (row) => row.success >= 0.5],
  lost: ["lost", (row) => row.success < 0.5],
  harmed: ["lost, won when clean", (row) => row.clean && row.success < 0.5 && row.clean.success >= 0.5],
  gained: ["won, lost by BASE", (row) => row.base && row.success >= 0.5 && row.base.success < 0.5],
  given: ["lost, won by BASE", (row) => row.base && row.success < 0.5 && row.base.success >= 0.5],
};

function cellKinds(one, rows, view, others, show) {
  const kinds = Object.entries(FILTERS).filter(([name]) =>
    name === "harmed" ? others.clean : name === "gained" || name === "given" ? others.base : true);
  const named = (text) => text.replace("BASE", () => one.columns[others.other].label);
  const counted = kinds.map(([name, [text, test]]) => [name, `${named(text)} (${rows.filter(test).length})`]);
  return chips("Episodes", counted, view.filter, (value) => { view.filter = value; view.most = PAGE; show(); });
}

function cellList(one, rows, view, others, show) {
  const wanted = view.search.trim().toLowerCase();
  const kept = rows.filter(FILTERS[view.filter][1]).filter((row) => row.id.toLowerCase().includes(wanted));
  const order = sorted(kept, (row) => row[view.sort.key]?.success ?? (["clean", "base"].includes(view.sort.key) ? null : row[view.sort.key]), view.sort.down);
  return [
    el("p", { class: "readout", "aria-live": "polite" }, cellSummary(kept, one.columns[others.column].seeds.length)),
    cellTable(one, order, view, others, show),
    order.length > view.most && el("button", { type: "button", class: "chip", onclick: () => { view.most += 4 * PAGE; show(); } },
      `Show more (${order.length - view.most} left)`),
  ];
}

// Counts and means of rows. Each episode counts as the mean of its walks, if each seed has one, as in the cells.
function cellSummary(rows, seeds) {
  if (!rows.length) return "No such episode.";
  const episodes = [...byEpisode(rows).values()], whole = episodes.filter(([row]) => row.whole);
  const mean = (list, value) => list.reduce((sum, one) => sum + value(one), 0) / list.length;
  const measure = (name) => (whole.length ? mean(whole, (own) => mean(own, (row) => row[name])) : null);
  const count = seeds > 1 ? `${rows.length} walks of ${episodes.length} episodes` : `${rows.length} episodes`;
  const over = whole.length < episodes.length ? `, over the ${whole.length} that each seed has` : "";
  return `${count}: SR ${shown(measure("success"), "%")} %, SPL ${shown(measure("spl"), "")}${over}`;
}

function cellTable(one, order, view, others, show) {
  const onsort = (found) => { view.sort = found; show(); };
  const head = (text, key, props) => sortHeading(text, key, view.sort, onsort, props);
  const several = one.columns[others.column].seeds.length > 1;
  const walks = order.some((row) => row.walk !== null);
  const heads = [head("Episode", "id", { "data-first": "up" }), several && head("Seed", "seed", { "data-first": "up", class: "number" }),
    head("Result", "success"), head("SPL", "spl", { class: "number" }), head("Steps", "steps", { class: "number" }),
    others.clean && head("When clean", "clean"), others.base && head(`By ${one.columns[others.other].label}`, "base"),
    walks && el("th", { scope: "col" }, "Walk")];
  const lines = order.slice(0, view.most).map((row) => el("tr", {},
    el("th", { scope: "row" }, row.id), several && el("td", { class: "number" }, row.seed), outcome(row),
    el("td", { class: "number" }, shown(row.spl, "")), el("td", { class: "number" }, row.steps ?? "\u2013"),
    others.clean && outcome(row.clean), others.base && outcome(row.base),
    walks && el("td", {}, row.walk !== null && el("button", { type: "button", class: "link", onclick: () => others.see(row.walk) }, "see"))));
  return el("div", { class: "scroll tall" }, el("table", { class: "episodes" },
    el("thead", {}, el("tr", {}, heads)), el("tbody", {}, lines)));
}

function outcome(row) {
  if (!row) return el("td", { class: "none" }, "\u2013");
  const won = row.success >= 0.5;
  return el("td", {}, el("span", { class: won ? "won" : "lost" }, won ? "\u2713 won" : "\u2717 lost"));
}
