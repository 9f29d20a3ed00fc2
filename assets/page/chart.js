// A chart: velocities or forces of a lane over time, each curve with its number at the moment shown.

const CHART_LEFT = 44, CHART_RIGHT = 34, CHART_TOP = 26, CHART_BOTTOM = 24;
const CHART_HEIGHT = 190, MOST_POINTS = 420; // points of a curve; rows of many beads have fewer
const MOST_LABELLED = 7, LABEL_PITCH = 13; // curves with a number at their end, and pixels between two of these

class Chart {
  /** @param {HTMLCanvasElement} canvas @param {number} lane @param {string} channel "velocity" or "force" */
  constructor(canvas, lane, channel) {
    this.canvas = canvas;
    this.lane = lane;
    this.channel = channel;
    this.begin = this.low = this.high = 0;
    this.span = 1;
    this.pen = canvas.getContext("2d");
  }

  fit(theme, title) {
    const { canvas } = this, density = window.devicePixelRatio || 1, width = Math.max(canvas.parentElement.clientWidth, LEAST_WIDTH);
    canvas.width = Math.round(width * density);
    canvas.height = Math.round(CHART_HEIGHT * density);
    canvas.style.height = `${CHART_HEIGHT}px`;
    this.density = density;
    this.theme = theme;
    this.title = title;
    this.right = width - CHART_RIGHT;
    this.foot = CHART_HEIGHT - CHART_BOTTOM;
  }

  /** @param {any} source @param {any} data of the page @param {any} unit of the values */
  draw(source, data, unit) {
    const { pen, density } = this, { scales } = source, { begun, last } = source;
    this.begin = begun;
    this.span = Math.max(last - begun, 1e-12);
    [this.low, this.high] = this.channel === "velocity" ? padded(scales.velocity) : [0, scales.force[this.lane]];
    pen.setTransform(density, 0, 0, density, 0, 0);
    pen.clearRect(0, 0, this.right + CHART_RIGHT, CHART_HEIGHT);
    this.grid(data, unit);
    this.curves(source);
  }

  across(time) { return CHART_LEFT + (this.right - CHART_LEFT) * (time - this.begin) / this.span; }

  down(value) { return this.foot - (this.foot - CHART_TOP) * (value - this.low) / (this.high - this.low); }

  timeAt(x) { return this.begin + this.span * (x - CHART_LEFT) / (this.right - CHART_LEFT); }

  grid(data, unit) {
    const { pen, theme } = this;
    write(pen, this.title, CHART_LEFT, 15, 13, theme.ink, "left", true);
    for (const { value, text } of ticksOf(this.low / unit, this.high / unit, 4)) {
      const y = Math.round(this.down(value * unit));
      pen.fillStyle = value === 0 ? theme.strong : theme.line;
      pen.fillRect(CHART_LEFT, y, this.right - CHART_LEFT, 1);
      write(pen, text, CHART_LEFT - 6, y + 4, 12, theme.muted, "right");
    }
    for (const { value, text } of ticksOf(this.begin / data.unit.size, (this.begin + this.span) / data.unit.size, 5)) {
      write(pen, text, this.across(value * data.unit.size), this.foot + 17, 12, theme.muted, "center");
    }
    write(pen, data.unit.name, this.right + CHART_RIGHT - 4, this.foot + 17, 12, theme.muted, "right");
  }

  curves(source) {
    const { pen, theme, channel } = this, now = source.values(this.lane)[channel], count = now.length;
    const first = channel === "velocity" ? 0 : 1, most = Math.max(40, Math.min(MOST_POINTS, Math.floor(6000 / count)));
    const paths = Array.from({ length: count }, () => new Path2D());
    let begun = false;
    source.trace(this.lane, channel, most, (time, values, at) => {
      const x = this.across(time);
      for (let k = 0; k < count; k++) {
        if (begun) paths[k].lineTo(x, this.down(values[at + k])); else paths[k].moveTo(x, this.down(values[at + k]));
      }
      begun = true;
    });
    pen.lineJoin = "round";
    pen.lineWidth = count > MOST_LABELLED ? 1.2 : 1.9;
    for (let k = count - 1; k >= 0; k--) {
      pen.strokeStyle = theme.bead(k + first);
      pen.stroke(paths[k]);
    }
    this.labels(now, Math.min(this.across(source.time), this.right), first);
  }

  // A dot at each curve's end, and its number beside it, apart from one another.
  labels(now, x, first) {
    const { pen, theme } = this;
    pen.fillStyle = theme.strong;
    pen.fillRect(Math.round(x), CHART_TOP - 4, 1, this.foot - CHART_TOP + 4);
    if (now.length > MOST_LABELLED) return;
    const places = Array.from(now, (value, k) => ({ k, y: this.down(value), at: this.down(value) })).sort((a, b) => a.y - b.y);
    places.forEach((place, i) => { if (i) place.at = Math.max(place.at, places[i - 1].at + LABEL_PITCH); });
    const over = Math.max(0, (places.at(-1)?.at ?? 0) - this.foot);
    for (let i = places.length - 1, least = this.foot; over && i >= 0; i--, least -= LABEL_PITCH) places[i].at = Math.min(places[i].at, least);
    for (const { k, y, at } of places) {
      const colour = theme.bead(k + first), name = this.channel === "velocity" ? String(k) : `${k}-${k + 1}`;
      pen.beginPath();
      pen.arc(x, y, 3.5, 0, 2 * Math.PI);
      pen.fillStyle = colour;
      pen.fill();
      write(pen, name, x + 8, at + 4, 12, colour, "left", true);
    }
  }
}

function padded([low, high]) {
  const room = 0.08 * (high - low);
  return [low < 0 ? low - room : low, high + room];
}

// Round values between `low` and `high`, about `most` of them.
function ticksOf(low, high, most) {
  const rough = (high - low) / most, power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((k) => k * power).find((k) => k >= rough * (1 - 1e-9)) ?? 10 * power;
  const decimals = Math.max(0, -Math.floor(Math.log10(step) + 1e-9)), found = [];
  const last = Math.floor(high / step + 1e-9);
  for (let k = Math.ceil(low / step - 1e-9); k <= last; k++) found.push({ value: k * step, text: fixed(k * step, decimals) });
  return found;
}
