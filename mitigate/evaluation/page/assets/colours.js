// Scales that colour-blind readers can read: cividis for values (Nunez et al., 2018, sampled at
// ninths), orange to blue for differences (PuOr's orange, RdBu's blue, of ColorBrewer), and Okabe
// and Ito's colours, with dashes, for lines.

const CIVIDIS = ["#00224e", "#1a386f", "#434e6c", "#61656f", "#7d7c78", "#9b9476", "#bbad6c", "#ddc958", "#fee838"];
const APART = ["#b35806", "#e08214", "#fdb863", "#fee0b6", "#f7f7f7", "#d1e5f0", "#92c5de", "#4393c3", "#2166ac"];
const LINES = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#8c564b", "#7f7f7f"];
const DASHES = ["", "6 3", "2 3", "8 3 2 3"];

const parts = (hex) => [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16));

function mixed(scale, share) {
  const at = Math.max(0, Math.min(1, share)) * (scale.length - 1);
  const low = Math.min(scale.length - 2, Math.floor(at));
  const [a, b] = [parts(scale[low]), parts(scale[low + 1])];
  return a.map((x, n) => Math.round(x + (b[n] - x) * (at - low)));
}

// Background and the better of black and white on it, by WCAG's relative luminance.
function paint(scale, share) {
  const rgb = mixed(scale, share);
  const linear = rgb.map((x) => (x / 255 <= 0.04045 ? x / 255 / 12.92 : ((x / 255 + 0.055) / 1.055) ** 2.4));
  const light = 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2];
  return { "background-color": `rgb(${rgb.join(" ")})`, color: light > 0.179 ? "#000" : "#fff" };
}

function scaleBar(scale, low, high) {
  const blocks = Array.from({ length: 24 }, (_, n) =>
    el("span", { style: { "background-color": paint(scale, n / 23)["background-color"] } }));
  return el("div", { class: "scale", "aria-hidden": "true" }, low, el("span", { class: "bar" }, blocks), high);
}
