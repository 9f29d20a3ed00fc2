// Charts: curves of the motion in the frames that the page has, a line at the time shown, and marks on the curves there.

const SVG = "http://www.w3.org/2000/svg";
const MARKS = [ // as in films: disc, square, triangle, diamond, triangle on its tip, of radius 1
  "M-1,0a1,1 0 1,0 2,0a1,1 0 1,0 -2,0", "M-.85-.85H.85V.85H-.85z", "M0-1.3L1.13.65H-1.13z", "M0-1.25L1.25 0 0 1.25-1.25 0z",
  "M0 1.3L1.13-.65H-1.13z",
];
const MARK_SIZE = 4.2, MOST_MARKED = 10;

class Chart {
  constructor(svg) {
    const numbers = (text) => text.split(" ").map(Number);
    this.svg = svg;
    [this.left, this.top, this.right, this.bottom] = numbers(svg.dataset.area);
    [this.begin, this.end] = numbers(svg.dataset.time);
    [this.low, this.high] = numbers(svg.dataset.value);
    this.logarithmic = "logarithmic" in svg.dataset;
    this.over = layerOver(svg);
    this.cursor = svg.querySelector(".cursor");
    this.veil = svg.querySelector(".veil");
    this.over.append(this.veil, this.cursor);
    this.group = svg.querySelector(".motion");
    this.marks = [];
  }

  across(time) { return this.left + (this.right - this.left) * (time - this.begin) / (this.end - this.begin); }

  down(value) {
    const height = this.logarithmic ? Math.log10(Math.max(value, 10 ** (this.low - 1))) : value;
    const share = Math.min(1.1, Math.max(-0.1, (height - this.low) / (this.high - this.low)));
    return this.bottom - (this.bottom - this.top) * share;
  }

  // Draw the curves of `motions`, those of all lanes.
  fill(motions, theme) {
    if (!this.group) return;
    const { lane, channel, first, count } = this.group.dataset;
    this.motion = motions[Number(lane)];
    this.channel = channel;
    this.group.replaceChildren();
    const clip = `area-${lane}-${channel}`;
    const inner = made("g", { "clip-path": `url(#${clip})` }, this.group);
    const path = made("clipPath", { id: clip }, this.group);
    made("rect", { x: this.left, y: this.top - 2, width: this.right - this.left, height: this.bottom - this.top + 4 }, path);
    this.marks = [];
    for (let k = Number(count) - 1; k >= 0; k--) {
      const stroke = theme.bead(k + Number(first)), columns = this.motion[channel][k];
      const points = Array.from(columns, (value, row) => `${this.across(this.motion.time[row]).toFixed(1)},${this.down(value).toFixed(1)}`);
      made("path", { class: "curve", d: `M${points.join("L")}`, stroke }, inner);
      if (Number(count) <= MOST_MARKED) this.marks[k] = made("path", { class: "mark", d: MARKS[k % MARKS.length], fill: stroke }, this.over);
    }
  }

  forget() { this.marks.forEach((mark) => mark.remove()); }

  show(time, values) {
    const inside = time >= this.begin && time <= this.end, x = this.across(time);
    for (const part of [this.cursor, this.veil, ...this.marks]) part.setAttribute("visibility", inside ? "visible" : "hidden");
    if (!inside) return;
    this.cursor.setAttribute("transform", `translate(${x})`);
    this.veil.setAttribute("transform", `translate(${x})`);
    this.veil.setAttribute("width", Math.max(0, this.right - x));
    this.marks.forEach((mark, k) => {
      const y = this.down(values[Number(this.group.dataset.lane)][this.channel][k]);
      mark.setAttribute("visibility", y > this.bottom + 1 || y < this.top - 1 ? "hidden" : "visible");
      mark.setAttribute("transform", `translate(${x} ${y}) scale(${MARK_SIZE})`);
    });
  }

  // The time under a pointer.
  timeAt(event) {
    const box = this.svg.getBoundingClientRect(), x = (event.clientX - box.left) * this.svg.viewBox.baseVal.width / box.width;
    return this.begin + (this.end - this.begin) * (x - this.left) / (this.right - this.left);
  }
}

// A layer of its own for what moves, so that the curves need not be drawn again in each frame.
function layerOver(svg) {
  const holder = document.createElement("div"), over = document.createElementNS(SVG, "svg");
  holder.className = "chart";
  over.setAttribute("viewBox", svg.getAttribute("viewBox"));
  over.setAttribute("aria-hidden", "true");
  svg.replaceWith(holder);
  holder.append(svg, over);
  return over;
}

function made(tag, attributes, parent) {
  const element = document.createElementNS(SVG, tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  parent.append(element);
  return element;
}
