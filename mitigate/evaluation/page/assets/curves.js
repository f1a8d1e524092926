// Success against severity: a small picture for each corruption, a line with its interval an agent.

const hiddenLines = new Set();

function curvesPart() {
  const shows = [];
  return DATA.curves.map((figure) => {
    const place = el("div", {});
    const show = () => redraw(place, () => [lineKey(figure, () => shows.forEach((one) => one())),
      el("div", { class: "panels" }, figure.panels.map((panel) => curvePanel(figure, panel)))]);
    shows.push(show);
    show();
    return el("section", { class: "card", "aria-label": "Severity curves" }, el("h2", {}, "Success against severity"),
      el("p", { class: "facts" }, `${figure.title}. All points of a line are over the same episodes, the clean one at 0 too; bands are 95 % intervals.`), place);
  });
}

const lineStyle = (n) => ({ stroke: LINES[n % LINES.length], "stroke-dasharray": DASHES[Math.floor(n / LINES.length) % DASHES.length] });

function lineKey(figure, show) {
  return el("div", { class: "chips", role: "group", "aria-label": "Agents" }, figure.columns.map((name, n) => el("button", {
    type: "button", class: "chip", "aria-pressed": String(!hiddenLines.has(name)),
    onclick: () => { hiddenLines.has(name) ? hiddenLines.delete(name) : hiddenLines.add(name); show(); },
  }, svg("svg", { viewBox: "0 0 26 10", class: "swatch", "aria-hidden": "true" },
    svg("line", { x1: 1, x2: 25, y1: 5, y2: 5, "stroke-width": 2.5, ...lineStyle(n) }), marker(n, 13, 5)), name)));
}

// Circle, square, triangle, diamond by turns, so that lines differ without colour.
function marker(n, x, y, words) {
  const fill = LINES[n % LINES.length], r = 3.2;
  const title = words ? [svg("title", {}, words)] : [];
  if (n % 4 === 0) return svg("circle", { cx: x, cy: y, r, fill }, title);
  if (n % 4 === 1) return svg("rect", { x: x - r, y: y - r, width: 2 * r, height: 2 * r, fill }, title);
  const corners = n % 4 === 2 ? [[0, -1.2], [1.1, 0.9], [-1.1, 0.9]] : [[0, -1.3], [1.3, 0], [0, 1.3], [-1.3, 0]];
  return svg("polygon", { points: corners.map(([a, b]) => `${x + a * r},${y + b * r}`).join(" "), fill }, title);
}

function curvePanel(figure, panel) {
  const [width, height, left, top, bottom] = [240, 168, 30, 10, 22];
  const x = (severity) => left + severity * (width - left - 8);
  const y = (share) => height - bottom - share * (height - top - bottom);
  const ticks = [0, 0.25, 0.5, 0.75, 1].map((share) => [
    svg("line", { class: "rule", x1: left, x2: width - 8, y1: y(share), y2: y(share) }),
    share * 4 % 2 === 0 && svg("text", { class: "tick", x: left - 4, y: y(share) + 3, "text-anchor": "end" }, `${100 * share}`)]);
  const below = [0, 0.5, 1].map((at) => svg("text", { class: "tick", x: x(at), y: height - 7, "text-anchor": "middle" }, `${at}`));
  const drawn = panel.lines.filter((line) => !hiddenLines.has(line.column)).map((line) => {
    const n = figure.columns.indexOf(line.column);
    const known = line.points.filter((point) => point.length > 2 && point[2] !== null);
    const band = [...known.map((p) => [x(p[0]), y(p[3])]), ...[...known].reverse().map((p) => [x(p[0]), y(p[2])])];
    return [
      svg("polygon", { points: band.map((p) => p.join(",")).join(" "), fill: LINES[n % LINES.length], opacity: 0.13 }),
      svg("polyline", { points: known.map((p) => `${x(p[0])},${y(p[1])}`).join(" "), fill: "none", "stroke-width": 1.8, ...lineStyle(n) }),
      known.map((p) => marker(n, x(p[0]), y(p[1]),
        `${line.column}, severity ${p[0]}: SR ${shown(p[1], "%")} % ${interval(p.slice(1), "%")}, ${line.count} episodes`)),
    ];
  });
  const counts = [...new Set(panel.lines.map((line) => line.count))].sort((a, b) => a - b).join(", ");
  return el("figure", { class: "panel" },
    el("figcaption", {}, panel.title, el("span", { class: "facts" }, ` N = ${counts}`)),
    svg("svg", { viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": `SR in % against severity, ${panel.title}` }, ticks, below, drawn));
}
