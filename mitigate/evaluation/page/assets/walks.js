// Walks from above: the first agent clean and corrupted, the others corrupted, over the plan.

const WALKS_ABOUT = "Walked again for this page with the keys of the rows, by weights that were at hand. Episodes are taken by turns of "
  + "outcomes and corruptions, to look at; how often each outcome comes is in the tables. Circles mark the ends (filled: "
  + "won), the black square the start, the star the goal, the grey dots the reference path.";
const walkView = { kind: "all", corruption: "all", layers: new Set() };

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
    labelled("Corruption", choice([["all", "all"], ...met], walkView.corruption, (value) => { walkView.corruption = value; show(); })),
    el("div", { class: "chips", role: "group", "aria-label": "Walks shown" }, DATA.walks[0].walks.map((walk, n) => el("button", {
      type: "button", class: "chip", "aria-pressed": String(!walkView.layers.has(n)),
      onclick: () => { walkView.layers.has(n) ? walkView.layers.delete(n) : walkView.layers.add(n); show(); },
    }, el("span", { class: "dot", style: { "background-color": WALKS[n % WALKS.length] } }), layerName(walk)))));
}

const layerName = (walk) => `${walk.agent}, ${walk.clean ? "clean" : "corrupted"}`;

function walkCards() {
  const kept = DATA.walks.map((walk, n) => [walk, n]).filter(([walk]) =>
    (walkView.kind === "all" || walk.kind === walkView.kind) && (walkView.corruption === "all" || walk.corruption === walkView.corruption));
  if (!kept.length) return el("p", {}, "No walk of this kind.");
  return el("div", { class: "walks" }, kept.map(([walk, n]) => walkCard(walk, n)));
}

function walkCard(walk, n) {
  const said = walk.heard !== walk.instruction ? ["Heard: ", el("q", {}, walk.heard), " for ", el("q", {}, walk.instruction)] : el("q", {}, walk.instruction);
  const views = walk.views.map((address, k) => el("img", { src: address, alt: k ? "first view, corrupted" : "first view, clean", loading: "lazy" }));
  return el("article", { class: "walk", id: `walk-${n}`, tabindex: "-1" },
    el("h3", {}, walk.title, el("span", { class: "facts" }, ` severity ${walk.severity} \u00b7 `), el("span", { class: "tag" }, walk.kind)),
    el("p", { class: "facts" }, `episode ${walk.episode}`),
    walkPicture(walk), el("ul", { class: "ends" }, walk.walks.map((one, k) => walkEnd(one, k))),
    views.length ? el("div", { class: "views" }, views) : null, el("p", { class: "said" }, said));
}

function walkEnd(walk, k) {
  const left = walk.left === null ? "" : `, ${walk.left} m from the goal`;
  const steps = walk.steps === null || walk.steps === undefined ? "" : `, ${walk.steps} steps`;
  return el("li", {}, el("span", { class: "dot", style: { "background-color": WALKS[k % WALKS.length] } }), layerName(walk), ": ",
    el("span", { class: walk.won ? "won" : "lost" }, walk.won ? "\u2713 won" : "\u2717 lost"), left, steps,
    walk.agrees === false && el("strong", {}, " \u2013 its row says otherwise"),
    walk.agrees === null && el("span", { class: "facts" }, " (no row)"));
}

function corners(walk) {
  if (walk.corners) return walk.corners;
  const all = [...walk.walks.flatMap((one) => one.points), ...walk.goals, ...walk.reference];
  const xs = all.map((p) => p[0]), ys = all.map((p) => p[1]);
  return [Math.min(...xs) - 1, Math.min(...ys) - 1, Math.max(...xs) + 1, Math.max(...ys) + 1];
}

function walkPicture(walk) {
  const [x0, y0, x1, y1] = corners(walk);
  const at = ([x, y]) => `${(x - x0).toFixed(2)},${(y1 - y).toFixed(2)}`;
  const line = (points, props) => svg("polyline", { points: points.map(at).join(" "), fill: "none", "vector-effect": "non-scaling-stroke", "stroke-linejoin": "round", ...props });
  const drawn = walk.walks.map((one, k) => {
    if (walkView.layers.has(k)) return null;
    const colour = WALKS[k % WALKS.length], [ex, ey] = at(one.points[one.points.length - 1]).split(",").map(Number);
    return [line(one.points, { stroke: "#fff", "stroke-width": 5, opacity: 0.8 }),
      line(one.points, { stroke: colour, "stroke-width": 2.5, "stroke-dasharray": one.clean ? "5 3" : null }),
      svg("circle", { cx: ex, cy: ey, r: 0.2, fill: one.won ? colour : "#fff", stroke: colour, "stroke-width": 2, "vector-effect": "non-scaling-stroke" },
        svg("title", {}, `${layerName(one)}: ${one.won ? "won" : "lost"}`))];
  });
  const stars = walk.goals.map((goal) => svg("polygon", { points: star(...at(goal).split(",").map(Number)), class: "goal" }, svg("title", {}, "goal")));
  const [sx, sy] = at(walk.walks[0].points[0]).split(",").map(Number);
  return svg("svg", { class: "plan", viewBox: `0 0 ${(x1 - x0).toFixed(2)} ${(y1 - y0).toFixed(2)}`, role: "img", "aria-label": `Plan with the walks of episode ${walk.episode}` },
    walk.plan && svg("image", { href: walk.plan, x: 0, y: 0, width: x1 - x0, height: y1 - y0 }),
    walk.reference.length ? line(walk.reference, { stroke: "#666", "stroke-width": 1.5, "stroke-dasharray": "2 3" }) : null,
    drawn, stars, svg("rect", { x: sx - 0.16, y: sy - 0.16, width: 0.32, height: 0.32, class: "start" }, svg("title", {}, "start")));
}

function star(x, y) {
  return Array.from({ length: 10 }, (_, n) => {
    const r = n % 2 ? 0.16 : 0.38, a = Math.PI * n / 5;
    return `${(x + r * Math.sin(a)).toFixed(2)},${(y - r * Math.cos(a)).toFixed(2)}`;
  }).join(" ");
}

function showWalk(n) {
  walkView.kind = walkView.corruption = "all";
  draw();
  const card = document.getElementById(`walk-${n}`);
  card?.scrollIntoView({ block: "start" });
  card?.focus({ preventScroll: true });
}
