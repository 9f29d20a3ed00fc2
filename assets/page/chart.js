// A chart shows the velocities or the forces of a lane over time. The curves have labels at the current time.

const CHART_LEFT = 44, CHART_RIGHT = 34, CHART_TOP = 26, CHART_BOTTOM = 24;
// Height of a chart in pixels, and largest number of points of a curve. In rows of many beads, the curves have fewer points.
const CHART_HEIGHT = 190, MOST_POINTS = 420;
// Largest deviation of the time axis from the known time range, as a fraction of the axis. It is used while the end of a motion is unknown.
const SPARE = 0.3;
const PIECE = 24; // Length in pixels of the parts of curves that are copied to the layer in one step.
const SPREAD = 5; // Distance in pixels by which dots and the ends of curves extend beyond their position.
const MOST_LABELLED = 7, LABEL_PITCH = 13; // Largest number of curves with labels, and distance between two labels in pixels.

class Chart {
  /** @param {HTMLCanvasElement} canvas @param {number} lane @param {string} channel "velocity" or "force" */
  constructor(canvas, lane, channel) {
    this.canvas = canvas;
    this.lane = lane;
    this.channel = channel;
    this.first = channel === "velocity" ? 0 : 1; // A contact has the colour of the bead on its right.
    this.low = this.high = this.begin = this.end = this.branch = 0;
    this.drawn = -Infinity; // Time up to which the layer contains the curves.
    this.dirty = [0, 0]; // Horizontal range in pixels in which the canvas differs from the layer.
    this.pen = canvas.getContext("2d");
    this.layer = document.createElement("canvas").getContext("2d"); // The layer contains everything that is the same in every frame.
  }

  /** @param {any} theme @param {string} title @param {number[][]} ghost time and values of each point of the previous run */
  fit(theme, title, ghost = []) {
    const { canvas } = this, { density } = theme, width = Math.max(canvas.parentElement.clientWidth, LEAST_WIDTH);
    canvas.width = this.layer.canvas.width = Math.round(width * density);
    canvas.height = this.layer.canvas.height = Math.round(CHART_HEIGHT * density);
    canvas.style.height = `${CHART_HEIGHT}px`;
    this.density = density;
    this.theme = theme;
    this.title = title;
    this.ghost = ghost;
    this.ghostRange = [0, 0];
    for (const [, ...values] of ghost) this.ghostRange = [Math.min(this.ghostRange[0], ...values), Math.max(this.ghostRange[1], ...values)];
    this.right = width - CHART_RIGHT;
    this.foot = CHART_HEIGHT - CHART_BOTTOM;
    this.branch = NaN; // The value NaN means that the layer is empty.
  }

  /** @param {any} source @param {any} data of the page @param {any} unit of the values */
  draw(source, data, unit) {
    const { layer, density } = this, { scales } = source;
    const known = this.channel === "velocity" ? padded(scales.velocity) : [scales.pull, scales.force[this.lane]];
    const low = Math.min(known[0], this.ghostRange[0]), high = Math.max(known[1], this.ghostRange[1]);
    if (this.outlived(source) || low !== this.low || high !== this.high || this.branch !== source.branch) {
      Object.assign(this, { low, high, branch: source.branch, drawn: -Infinity });
      layer.setTransform(density, 0, 0, density, 0, 0);
      layer.clearRect(0, 0, this.right + CHART_RIGHT, CHART_HEIGHT);
      this.grid(data, unit);
      if (this.ghost.length) this.haunt();
      this.dirty = [0, this.right + CHART_RIGHT];
    }
    const now = source.values(this.lane)[this.channel], x = Math.min(this.across(source.time), this.right);
    const end = this.curves(source, now.length);
    this.labels(now, x);
    this.dirty = [Math.min(x, this.across(this.drawn)) - SPREAD, Math.max(x + CHART_RIGHT, end) + SPREAD];
  }

  // Draw the curves of the previous run in grey.
  haunt() {
    const { layer: pen, theme, right } = this, inside = this.ghost.filter(([time]) => time >= this.begin && time <= this.end);
    pen.lineWidth = 1.2;
    pen.strokeStyle = theme.strong;
    for (let k = 1; k < this.ghost[0].length; k++) {
      pen.beginPath();
      for (const point of inside) pen.lineTo(this.across(point[0]), this.down(point[k]));
      pen.stroke();
    }
    write(pen, say("ghost"), right + CHART_RIGHT - 4, 15, 12, theme.muted, "right");
  }

  // Return true if the layer must be drawn again, and set its time axis. If the end of the motion is unknown, the axis extends beyond the
  // known time.
  outlived({ begun, last, open }) {
    const span = this.end - this.begin, late = begun - this.begin, room = this.end - last;
    const holds = open ? late >= 0 && late < SPARE * span && room >= 0 && room < SPARE * span : !late && !room;
    if (!holds) { this.begin = begun; this.end = open ? last + 0.5 * SPARE * (last - begun) : last; }
    return !holds;
  }

  across(time) { return CHART_LEFT + (this.right - CHART_LEFT) * (time - this.begin) / (this.end - this.begin || 1); }

  down(value) { return this.foot - (this.foot - CHART_TOP) * (value - this.low) / (this.high - this.low); }

  timeAt(x) { return this.begin + (this.end - this.begin) * (x - CHART_LEFT) / (this.right - CHART_LEFT); }

  grid(data, unit) {
    const { layer: pen, theme } = this;
    write(pen, this.title, CHART_LEFT, 15, 13, theme.ink, "left", true);
    for (const { value, text } of ticksOf(this.low / unit, this.high / unit, 4)) {
      const y = Math.round(this.down(value * unit));
      pen.fillStyle = value === 0 ? theme.strong : theme.line;
      pen.fillRect(CHART_LEFT, y, this.right - CHART_LEFT, 1);
      write(pen, text, CHART_LEFT - 6, y + 4, 12, theme.muted, "right", false, CHART_LEFT - 8);
    }
    for (const { value, text } of this.end > this.begin ? ticksOf(this.begin / data.unit.size, this.end / data.unit.size, 5) : []) {
      write(pen, text, this.across(value * data.unit.size), this.foot + 17, 12, theme.muted, "center");
    }
    write(pen, data.unit.name, this.right + CHART_RIGHT - 4, this.foot + 17, 12, theme.muted, "right");
  }

  // Draw the part of the curves that the layer does not contain, and return its end. Long parts are drawn on the layer. This makes the
  // joints between parts invisible.
  curves(source, count) {
    const most = Math.max(40, Math.min(MOST_POINTS, Math.floor(6000 / count))), points = [];
    source.trace(this.lane, this.channel, most, this.drawn, (time, values, at) => points.push([time, values, at]));
    const last = points.at(-1)[0], end = this.across(last), from = this.across(this.drawn), long = end - from > PIECE;
    if (long) { this.stroke(this.layer, points, count); this.drawn = last; }
    this.restore(long ? Math.min(from - SPREAD, this.dirty[0]) : this.dirty[0], Math.max(end + SPREAD, this.dirty[1]));
    if (!long) this.stroke(this.pen, points, count);
    return end;
  }

  // Copy a horizontal range of the layer to the canvas.
  restore(from, to) {
    const { pen, density, layer: { canvas } } = this, left = Math.max(0, Math.floor(from * density));
    const wide = Math.min(canvas.width, Math.ceil(to * density)) - left;
    pen.setTransform(1, 0, 0, 1, 0, 0);
    pen.clearRect(left, 0, wide, canvas.height);
    pen.drawImage(canvas, left, 0, wide, canvas.height, left, 0, wide, canvas.height);
    pen.setTransform(density, 0, 0, density, 0, 0);
  }

  stroke(pen, points, count) {
    pen.lineJoin = pen.lineCap = "round";
    pen.lineWidth = count > MOST_LABELLED ? 1.2 : 1.9;
    for (let k = count - 1; k >= 0; k--) {
      pen.strokeStyle = this.theme.bead(k + this.first);
      pen.beginPath();
      for (const [time, values, at] of points) pen.lineTo(this.across(time), this.down(values[at + k]));
      pen.stroke();
    }
  }

  // Draw a dot at the end of each curve, and a label next to the dot. Labels that would overlap are moved apart.
  labels(now, x) {
    const { pen, theme, first } = this;
    pen.fillStyle = theme.strong;
    pen.fillRect(Math.round(x), CHART_TOP - 4, 1, this.foot - CHART_TOP + 4);
    if (now.length > MOST_LABELLED) return;
    const places = Array.from(now, (value, k) => ({ k, y: this.down(value), at: this.down(value) })).sort((a, b) => a.y - b.y);
    places.forEach((place, i) => { if (i) place.at = Math.max(place.at, places[i - 1].at + LABEL_PITCH); });
    const over = Math.max(0, (places.at(-1)?.at ?? 0) - this.foot);
    for (let i = places.length - 1, least = this.foot; over && i >= 0; i--, least -= LABEL_PITCH) places[i].at = Math.min(places[i].at, least);
    for (const { k, y, at } of places) {
      const colour = theme.bead(k + first), text = textColour(colour, theme), name = this.channel === "velocity" ? String(k) : `${k}-${k + 1}`;
      pen.beginPath();
      pen.arc(x, y, 3.5, 0, 2 * Math.PI);
      pen.fillStyle = colour;
      pen.fill();
      write(pen, name, x + 8, at + 4, 12, text, "left", true);
    }
  }
}

function padded([low, high]) {
  const room = 0.08 * (high - low);
  return [low < 0 ? low - room : low, high + room];
}
