// Episodes that agents ran again for this page: a picture of the paths, and the results.

const WALKS_ABOUT = "Run again for this page with the keys of the rows, by the named weights. The episodes show each outcome and "
  + "each corruption in turn and are no sample; how often each outcome comes is in the tables.";
const walkView = { kind: "all", corruption: "all" };

// The number of the card that shows the walk of a row of a cell, null if none does.
function walkOf(one, column, k, row) {
  const name = one.corruptions[k].name, clean = name === "clean";
  const own = (walk) => walk.clean === clean && one.columns[column].agents.includes(walk.hash);
  const found = DATA.walks.findIndex((card) => card.episode === row.id && card.seed === row.seed
    && card.split === one.split && card.rule === one.rule
    && (clean || (card.corruption === name && card.severity === one.severity)) && card.walks.some(own));
  return found < 0 ? null : found;
}

function walksPart() {
  if (!DATA.walks.length) return null;
  const place = el("div", {});
  const show = () => redraw(place, () => [walkControls(show), walkCards()]);
  show();
  return el("section", { class: "card", id: "walks", "aria-label": "Walks" }, el("h2", {}, "Walks"),
    el("p", { class: "facts" }, WALKS_ABOUT), place);
}

function walkControls(show) {
  const count = (test) => DATA.walks.filter(test).length;
  const kinds = [...new Set(DATA.walks.map((walk) => walk.kind))].map((kind) => [kind, `${kind} (${count((w) => w.kind === kind)})`]);
  const met = [...new Map(DATA.walks.map((walk) => [walk.corruption, walk.title]))];
  return el("div", { class: "controls" },
    chips("Outcome", [["all", `all (${DATA.walks.length})`], ...kinds], walkView.kind, (value) => { walkView.kind = value; show(); }),
    labelled("Corruption", choice([["all", "all"], ...met], walkView.corruption, (value) => { walkView.corruption = value; show(); })));
}

const walkName = (walk) => `${walk.agent}, ${walk.clean ? "clean" : "corrupted"}`;

function walkCards() {
  const kept = DATA.walks.map((walk, n) => [walk, n]).filter(([walk]) =>
    (walkView.kind === "all" || walk.kind === walkView.kind) && (walkView.corruption === "all" || walk.corruption === walkView.corruption));
  if (!kept.length) return el("p", {}, "No walk of this kind.");
  return el("div", { class: "walks" }, kept.map(([walk, n]) => walkCard(walk, n)));
}

function walkCard(walk, n) {
  const said = walk.heard !== walk.instruction ? ["Heard: ", el("q", {}, walk.heard), " for ", el("q", {}, walk.instruction)] : el("q", {}, walk.instruction);
  return el("article", { class: "walk", id: `walk-${n}`, tabindex: "-1" },
    el("h3", {}, walk.title, el("span", { class: "facts" }, ` severity ${walk.severity} \u00b7 `), el("span", { class: "tag" }, walk.kind)),
    el("p", { class: "facts" }, `episode ${walk.episode}`),
    el("img", { class: "plan", src: walk.picture, alt: `Paths of episode ${walk.episode}, and its first view`, loading: "lazy" }),
    el("ul", { class: "ends" }, walk.walks.map(walkEnd)), el("p", { class: "said" }, said));
}

function walkEnd(walk) {
  const left = walk.left === null ? "" : `, ${walk.left} m from the goal`;
  const steps = walk.steps === null || walk.steps === undefined ? "" : `, ${walk.steps} steps`;
  return el("li", {}, walkName(walk), ": ",
    el("span", { class: walk.won ? "won" : "lost" }, walk.won ? "\u2713 won" : "\u2717 lost"), left, steps,
    walk.agrees === false && el("strong", {}, " \u2013 its row says otherwise"),
    walk.agrees === null && el("span", { class: "facts" }, " (no row)"));
}

function showWalk(n) {
  walkView.kind = walkView.corruption = "all";
  draw();
  const card = document.getElementById(`walk-${n}`);
  card?.scrollIntoView({ block: "start" });
  card?.focus({ preventScroll: true });
}
