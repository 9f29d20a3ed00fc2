// The player: one clock for beads, charts and tables; buttons, keys, sliders and drags move it.

const BEFORE_HIT = 0.25; // of the time from the first hit to the end: the longest flight that is played before it
const REST = 0.9; // seconds for which the end stays before the motion begins again
const TABLE_RATE = 12; // times a second that tables change while the motion plays
const KEY_STEP = 1 / 240; // of the whole motion, for an arrow key
const part = (id) => document.getElementById(id);

class Player {
  constructor(data) {
    this.data = data;
    this.stages = [...document.querySelectorAll("canvas.stage")].map((canvas) => new Stage(canvas, data));
    this.charts = [...document.querySelectorAll("svg[data-time]")].map((svg) => new Chart(svg));
    this.cells = [...document.querySelectorAll("[data-now]")];
    this.slow = data.slow;
    this.members = data.members.map(() => null);
    this.playing = false;
    this.loops = true;
    this.rest = 0;
    this.tablesAt = 0;
    this.time = -Infinity;
    this.choose(data.first);
    listen(this);
  }

  // Take the motions of member `k` of the family.
  choose(k) {
    this.member = k;
    this.members[k] ??= this.data.members[k].lanes.map((lane) => {
      const motion = decoded(lane, this.data.scales);
      motion.deepest = motion.overlap.map((column) => Math.max(0, column.reduce((most, depth) => Math.max(most, depth), 0)));
      return motion;
    });
    this.motions = this.members[k];
    this.span = [Math.min(...this.motions.map(({ time }) => time[0])), Math.max(...this.motions.map(({ time }) => time.at(-1)))];
    this.switches = switchTimes(this.motions);
    this.time = this.time === -Infinity ? this.opening() : Math.min(Math.max(this.time, this.span[0]), this.span[1]);
    for (const table of document.querySelectorAll(".member")) table.hidden = Number(table.dataset.member) !== k;
    this.shownCells = this.cells.filter((cell) => !cell.closest("[hidden]"));
    if (part("member")) part("member").value = this.data.members[k].name;
    this.dress();
  }

  // Where playing begins: at most a fifth of what is played comes before the first hit, however long the flight before it.
  opening() {
    const [begin, end] = this.span, hit = this.switches.find((time) => time > begin) ?? begin;
    return Math.max(begin, hit - BEFORE_HIT * (end - hit));
  }

  // Draw everything anew: after another member, size or theme.
  dress() {
    this.theme = currentTheme(this.data.palette);
    this.stages.forEach((stage, lane) => stage.fit(this.motions[lane], this.theme));
    for (const chart of this.charts) { chart.forget(); chart.fill(this.motions, this.theme); }
    contactStrip(document.querySelector(".strip"), this.motions, this.theme, this.span);
    this.show(true);
  }

  show(tables) {
    const values = this.motions.map((motion) => valuesAt(motion, this.time));
    this.stages.forEach((stage, lane) => stage.draw(values[lane]));
    for (const chart of this.charts) chart.show(this.time, values);
    const { size, name } = this.data.unit, [begin, end] = this.span;
    const decimals = Math.max(0, 3 - Math.floor(Math.log10((end - begin) / size)));
    const clock = `t = ${fixed(this.time / size, decimals)} ${name}`;
    part("clock").textContent = clock;
    part("time").value = String(Math.round(1e5 * (this.time - begin) / (end - begin)));
    if (tables) {
      part("time").setAttribute("aria-valuetext", clock);
      for (const cell of this.shownCells) cell.textContent = cellText(cell, values[Number(cell.dataset.lane)], this.data.scales);
    }
  }

  go(time) {
    this.time = Math.min(Math.max(time, this.span[0]), this.span[1]);
    this.rest = 0;
    this.show(true);
  }

  step(parts) { this.pause(); this.go(this.time + parts * KEY_STEP * (this.span[1] - this.span[0])); }

  // To the switch of a contact before (-1) or after (1) the time shown.
  jump(direction) {
    this.pause();
    const near = 1e-7 * (this.span[1] - this.span[0]);
    const found = direction > 0 ? this.switches.find((time) => time > this.time + near)
      : this.switches.findLast((time) => time < this.time - near);
    this.go(found ?? this.span[direction > 0 ? 1 : 0]);
  }

  play() {
    if (this.time >= this.span[1]) this.time = this.opening();
    this.playing = true;
    this.last = undefined;
    this.label();
    requestAnimationFrame((now) => this.frame(now));
  }

  pause() { if (this.playing) { this.playing = false; this.label(); this.show(true); } }

  toggle() { if (this.playing) this.pause(); else this.play(); }

  label() {
    const button = part("play"), name = this.playing ? "pause" : "play";
    button.setAttribute("aria-label", name);
    button.title = name;
    button.classList.toggle("playing", this.playing);
  }

  frame(now) {
    if (!this.playing) return;
    const passed = Math.min((now - (this.last ?? now)) / 1000, 0.1);
    this.last = now;
    if (this.time < this.span[1]) this.time = Math.min(this.time + passed / this.slow, this.span[1]);
    else if (!this.loops) { this.pause(); return; }
    else if ((this.rest += passed) > REST) { this.rest = 0; this.time = this.opening(); }
    const tables = now - this.tablesAt > 1000 / TABLE_RATE;
    if (tables) this.tablesAt = now;
    this.show(tables);
    requestAnimationFrame((next) => this.frame(next));
  }
}

// A value as exact as it was recorded: velocities and forces to about a thousandth of their axes.
function cellText(cell, values, scales) {
  const channel = cell.dataset.now, k = Number(cell.dataset.index), value = values[channel][k];
  if (channel === "state") { cell.className = `now ${value}`; return value; }
  if (channel === "overlap") return overlapText(value, values.state[k]);
  const largest = channel === "force" ? scales.force : Math.max(...scales.velocity.map(Math.abs));
  return fixed(value, Math.min(12, Math.max(0, 3 - Math.floor(Math.log10(largest)))));
}

// The colours of the style sheet, which knows light and dark; a long chain has a ramp of its own.
function currentTheme(palette) {
  const style = getComputedStyle(document.documentElement), colour = (name) => style.getPropertyValue(`--${name}`).trim();
  const dark = matchMedia("(prefers-color-scheme: dark)").matches && !matchMedia("print").matches;
  const beads = palette.length ? palette.map((shade) => (dark ? mixed(shade, "#ffffff", 0.25) : shade))
    : Array.from({ length: 7 }, (_, k) => colour(`c${k}`));
  const names = ["paper", "card", "ink", "muted", "line", "strong", "steel"];
  return { ...Object.fromEntries(names.map((name) => [name, colour(name)])), dark, onBead: colour("on-bead"), bead: (k) => beads[k % beads.length] };
}

function listen(player) {
  const keys = { " ": () => player.toggle(), PageUp: () => player.jump(-1), PageDown: () => player.jump(1),
    Home: () => { player.pause(); player.go(player.span[0]); }, End: () => { player.pause(); player.go(player.span[1]); } };
  const inPlayer = (event) => event.target === document.body || part("player").contains(event.target);
  document.addEventListener("keydown", (event) => {
    const own = event.target.closest("select, summary, #family, button") && !event.key.startsWith("Page");
    if (!inPlayer(event) || event.ctrlKey || event.metaKey || event.altKey || own) return;
    const direction = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    if (direction) player.step(direction * (event.shiftKey ? 10 : 1)); else if (keys[event.key]) keys[event.key](); else return;
    event.preventDefault();
  });
  part("play").addEventListener("click", () => player.toggle());
  part("back").addEventListener("click", () => player.jump(-1));
  part("ahead").addEventListener("click", () => player.jump(1));
  part("loop").addEventListener("click", (event) => {
    player.loops = !player.loops;
    event.currentTarget.setAttribute("aria-pressed", String(player.loops));
  });
  part("speed").addEventListener("change", (event) => { player.slow = Number(event.target.value); });
  part("time").addEventListener("input", (event) => {
    player.pause();
    player.go(player.span[0] + (player.span[1] - player.span[0]) * Number(event.target.value) / 1e5);
  });
  part("family")?.addEventListener("input", (event) => player.choose(Number(event.target.value)));
  for (const chart of player.charts) drag(chart.svg, (event) => { player.pause(); player.go(chart.timeAt(event)); });
  for (const { canvas } of player.stages) dragBy(player, canvas);
  for (const query of ["(prefers-color-scheme: dark)", "print"]) matchMedia(query).addEventListener("change", () => player.dress());
  let width = part("player").clientWidth;
  new ResizeObserver(() => {
    if (part("player").clientWidth !== width) { width = part("player").clientWidth; player.dress(); }
  }).observe(part("player"));
}

// A press and every move after it; a finger that moves up or down still scrolls the page.
function drag(element, move, press = move) {
  element.addEventListener("pointerdown", (event) => { element.setPointerCapture(event.pointerId); press(event); });
  element.addEventListener("pointermove", (event) => { if (element.hasPointerCapture(event.pointerId)) move(event); });
}

// A drag over the beads winds the motion on or back: its width is the whole motion. A tap plays or pauses.
function dragBy(player, canvas) {
  let start;
  drag(canvas, (event) => {
    const moved = event.clientX - start.x;
    start.dragged ||= Math.abs(moved) > 4;
    if (!start.dragged) return;
    player.pause();
    player.go(start.time + (player.span[1] - player.span[0]) * moved / canvas.clientWidth);
  }, (event) => { start = { x: event.clientX, time: player.time, dragged: false }; });
  canvas.addEventListener("pointerup", () => { if (!start.dragged) player.toggle(); });
}

const player = new Player(JSON.parse(part("data").textContent));
const still = location.hash.match(/^#t=([-+.e\d]+)$/); // a link to a moment: page.html#t=1.88, in seconds of motion
if (still) player.go(Number(still[1]));
else if (matchMedia("(prefers-reduced-motion: reduce)").matches) player.go(player.data.still);
else player.play();
