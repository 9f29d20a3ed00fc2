// The page: its controls, its one clock, and what is shown of the source of the motion.

const TEXT_RATE = 8; // times a second that texts and tables change while the motion plays
const WATCHED = 60; // pictures by whose median it is judged whether they are late
const LATE = 22; // ms from a picture to the next
const SOONER = 0.8; // of the time that it was: fewer pixels help
const SLIDER = 1000; // positions of a slider
const PULLED = 0.3; // bead lengths that a key pulls the hand
const part = (id) => /** @type {any} */ (document.getElementById(id));

class Page {
  /** @param {any} data @param {Live|Recorded} source */
  constructor(data, source) {
    this.data = data;
    this.source = source;
    /** @type {Experiment} */ this.own = data.own && { ...data.own, shown: [...data.own.shown] };
    this.limits = source.live ? limitsOf(data, this.own) : {};
    this.playing = false;
    /** @type {number|null} */ this.goal = null; // the moment to which pictures go as fast as they can
    this.textsAt = 0;
    this.firstWindow = 0;
    /** @type {{lane: number, bead: number}|null} */ this.chosen = null;
    this.unseen = new WeakSet(); // canvases scrolled out of sight, which are not drawn while the motion plays
    this.sight = new IntersectionObserver((changes) => {
      for (const { target, isIntersecting } of changes) this.unseen[isIntersecting ? "delete" : "add"](target);
    });
    this.most = Infinity; // pixels of a canvas to one of the page, at most
    this.waits = []; // ms from picture to picture
    this.late = null; // the median of these at which fewer pixels were tried; 0 once that is decided
    this.specs = data.lanes.map((lane) => lane.spec);
    this.open();
    listen(this);
  }

  // Begin what the address says.
  open() {
    const moment = addressMoment(location.hash);
    if (this.playing) this.pause();
    clearTimeout(this.writing); // of what was there before
    this.experiment = readAddress(location.hash, this.own, this.limits, this.data);
    this.speak(addressLanguage(location.hash) ?? this.language ?? navigator.language);
    this.restart();
    if (moment !== null) this.go(moment); else if (!reduced()) this.play();
  }

  // What the rows of the experiment start from.
  made() {
    const { data, experiment, own } = this, specs = data.lanes.map((_, lane) => specOf(data, lane, experiment, own));
    if (experiment.beside !== "none" && data.lanes.length === 1) specs.push(besideSpec(data, specs[0], experiment.beside));
    return specs;
  }

  // Begin the experiment anew.
  restart() {
    const { data, experiment, source } = this;
    if (source.live) {
      this.specs = this.made();
      source.begin(this.specs, experiment.pace);
    } else {
      source.setPace(experiment.pace);
      source.go(source.begun);
    }
    data.scales = source.scales;
    this.firstWindow = 0;
    this.build();
    this.controls();
    this.dress();
  }

  // The looks of each lane, and a canvas for each and its charts.
  build() {
    const { specs, experiment } = this, lanes = part("lanes"), charts = part("charts");
    this.looks = specs.map((spec, lane) => this.lookOf(spec, lane));
    const gears = this.looks.every((look) => look.gears.every(Boolean)), walls = specs.some(({ mass }) => mass.includes(null));
    this.data.height = walls ? WALL_HEIGHT : gears ? CYLINDER_HEIGHT : 1; // of the tallest body, in lengths of a bead
    const names = specs.map(({ law }) => lawName(law)), [one, other] = specs;
    if (specs.length > this.data.lanes.length && names[0] === names[1] && String(one.law) !== String(other.law)) {
      this.looks.forEach((look, lane) => { look.label += `, K = ${scientific(specs[lane].law[1], 2)}`; }); // which tells them apart
    }
    if (this.stages?.length !== specs.length) {
      this.stages = [];
      lanes.replaceChildren();
      this.stages = specs.map((_, lane) => new Stage(canvasOf(this, lane, lanes)));
      charts.replaceChildren();
      this.charts = specs.flatMap((_, lane) => ["velocity", "force"].map((channel) => new Chart(chartCanvas(this, charts), lane, channel)));
      this.sight.disconnect();
      for (const { canvas } of [...this.stages, ...this.charts]) this.sight.observe(canvas);
    }
    const keys = this.source.live ? ` ${say("bead keys")}` : "";
    this.stages.forEach(({ canvas }, lane) => canvas.setAttribute("aria-label", say("beads", { name: this.looks[lane].label || this.texts.title }) + keys));
    charts.hidden = !experiment.shown.includes("charts");
  }

  lookOf(spec, lane) {
    const { data, experiment, own, source } = this, given = data.lanes[lane], n = spec.gap.length;
    const whole = given && given.spec.mass.length === spec.mass.length;
    const same = whole && experiment.law === own.law && (lane > 0 || !differs(data, experiment, own, "alpha"));
    const gear = (i) => spec.law[3 * i] > 0 && spec.law[3 * i + 1] > 0;
    return { mass: spec.mass, contacts: n, label: same ? this.texts.labels[lane] : lawName(spec.law), massLabels: massLabels(spec.mass),
      gears: Array.from({ length: n }, (_, i) => (same ? given.gears[i] : gear(i))), pulls: Boolean(whole && given.pulls),
      solid: whole && given.solid ? given.solid : Array.from({ length: n }, () => [null, null]),
      marks: hasMarks(spec, data.length),
      dissipative: source.live ? spec.friction > 0 || spec.loss.some((loss) => loss > 0) : given.dissipative,
      driven: Boolean(given?.driven),
      deepest: this.source.scales.deepest[lane] };
  }

  // Draw everything anew: after another experiment, size or theme.
  dress() {
    const { data, stages, looks, experiment } = this, two = stages.length > 1, high = window.innerHeight;
    const narrow = part("lanes").clientWidth < 640, share = two ? (narrow ? 0.19 : 0.25) : narrow ? 0.28 : 0.4;
    const tall = Math.min(Math.max(share * high, two ? 150 : 214), two ? 330 : 460);
    const shown = narrow && two ? experiment.shown.filter((name) => name !== "balance") : experiment.shown; // no room for both
    const density = Math.min(window.devicePixelRatio || 1, this.most);
    this.theme = { ...currentTheme(data, Math.max(...looks.map(({ mass }) => mass.length))), density };
    stages.forEach((stage, lane) => stage.fit(looks[lane], data, this.theme, { tall, shown, force: data.scales.force[lane] }));
    if (experiment.shown.includes("charts")) {
      for (const chart of this.charts) {
        const name = chart.channel === "velocity" ? say("velocities") : say("forces chart", { unit: data.forceUnit.name });
        chart.fit(this.theme, two && looks[chart.lane].label ? `${name}: ${looks[chart.lane].label}` : name);
        chart.canvas.setAttribute("aria-label", chart.title);
      }
    }
    this.show(true, true);
  }

  // Draw the moment: `texts` too, and what is `unseen` as well if it is to be `whole`.
  show(texts, whole = !this.playing) {
    const { source, data, stages, chosen } = this, { hand } = source;
    const nows = stages.map((_, lane) => source.values(lane)), due = ({ canvas }) => whole || !this.unseen.has(canvas);
    if ((source.touched || !source.followed) && this.widen(nows)) { this.dress(); return; }
    stages.forEach((stage, lane) => {
      if (!due(stage)) return;
      const mine = hand && hand.lane === lane ? hand : document.activeElement === stage.canvas && chosen?.lane === lane ? chosen : null;
      stage.draw(nows[lane], mine && { bead: mine.bead, across: mine === hand ? this.acrossOf(stage, nows[lane]) : undefined });
    });
    if (this.experiment.shown.includes("charts")) {
      for (const chart of this.charts.filter(due)) chart.draw(source, data, chart.channel === "force" ? data.forceUnit.size : 1);
    }
    if (texts) this.tell(nows);
  }

  // Axes grow with what nobody has foreseen, the ground to four times its length; then it follows beads that it has room for.
  widen(nows) {
    const { scales } = this.source, { window: [low, high] } = scales;
    this.firstWindow ||= high - low;
    let grown = false;
    nows.forEach((now, lane) => { grown = widened(scales, lane, this.looks[lane].mass.map((m) => m ?? 0), now, this.data.length, 0.15) || grown; });
    if (scales.window[1] - scales.window[0] > 4 * this.firstWindow) {
      const left = Math.min(...nows.map(({ position }) => position[0]));
      const right = Math.max(...nows.map(({ position }) => position[position.length - 1] + position.length * this.data.length));
      const move = right - left < high - low && (left < low || right > high) ? (left + right - low - high) / 2 : 0;
      scales.window = [low + move, high + move];
    }
    return grown && (scales.window[0] !== low || scales.window[1] !== high || this.outgrown(scales));
  }

  outgrown(scales) {
    const size = [...scales.force, scales.energy, ...scales.velocity, ...scales.momentum].join();
    const changed = size !== this.sizes;
    this.sizes = size;
    return changed;
  }

  get decimals() { return Math.max(0, 2 - Math.floor(Math.log10((this.source.last - this.source.begun) / this.data.unit.size || 1))); }

  // Texts: the time, the end in words, the energy, the tables. The browser lays the page out anew for each of them.
  tell(nows) {
    const { source, specs, looks, data } = this, clock = `t = ${fixed(source.time / data.unit.size, this.decimals)} ${data.unit.name}`;
    part("clock").textContent = clock;
    part("time").value = String(Math.round(SLIDER * (source.time - source.begun) / (source.last - source.begun || 1)));
    part("time").setAttribute("aria-valuetext", clock);
    const ended = source.apart && (source.over || source.open) && !source.hand;
    const said = nows.map((now, lane) => {
      const name = looks.length > 1 && looks[lane].label ? `${looks[lane].label}: ` : "", rigid = lane || source.touched ? "" : ` ${rigidWords(specs[lane], looks[lane], data.length, now.velocity)}`;
      return name + whatHappened(now.velocity, specs[lane].mass, specs[lane].speed) + rigid;
    });
    const text = ended ? said.join("\n") : source.live ? say("hint") : "";
    if (part("words").textContent !== text) part("words").textContent = text;
    part("words").classList.toggle("ended", ended);
    if (source.live) {
      const { rows } = source, error = Math.max(...rows.map((row) => row.energyError())), parts = [say("energy", { value: plain(rows.reduce((sum, row) => sum + row.energy(), 0), 4) })];
      if (rows.every((row) => row.balanced)) parts.push(say("right", { error: error < 1e-17 ? "10⁻¹⁶" : scientific(error, 0) }));
      if (source.touched) parts.push(say("given", { value: plain(rows.reduce((sum, row) => sum + row.given, 0), 3) }));
      part("energy").textContent = parts.join(" · ");
    }
    if (part("numbers").open) fillTables(this, nows);
  }

  play() {
    this.goal = null;
    if (this.playing) return;
    if (this.source.over) this.restart();
    this.playing = true;
    this.last = undefined;
    this.label();
    this.next();
  }

  // One picture is due at a time, also where a pause was shorter than a picture.
  next() { this.due = requestAnimationFrame((now) => this.picture(now)); }

  pause() {
    cancelAnimationFrame(this.due);
    this.playing = false;
    this.label();
    this.show(true);
  }

  toggle() { if (this.playing) this.pause(); else this.play(); }

  again() { this.restart(); this.play(); }

  label() {
    const name = say(this.playing ? "pause" : "play");
    part("toggle").setAttribute("aria-label", name);
    part("toggle").title = name;
    part("toggle").classList.toggle("playing", this.playing);
  }

  picture(now) {
    if (this.goal !== null) {
      if (this.source.go(this.goal)) { this.pause(); return; }
    } else {
      this.source.advance((now - (this.last ?? now)) / 1000);
      if (this.last) this.spare(now - this.last);
    }
    this.last = now;
    this.follow();
    const texts = now - this.textsAt > 1000 / TEXT_RATE;
    if (texts) this.textsAt = now;
    if (this.source.over) { this.pause(); return; }
    this.show(texts);
    this.next();
  }

  // Where pictures are late, draw fewer pixels, unless that does not help: a screen may be slow by itself.
  spare(wait) {
    if (this.waits.push(wait) < WATCHED) return;
    const usual = this.waits.sort((a, b) => a - b)[WATCHED >> 1], { most } = this;
    this.waits = [];
    if (this.late) [this.most, this.late] = [usual < SOONER * this.late ? 1 : Infinity, 0];
    else if (this.late === null && usual > LATE && this.theme.density > 1) [this.most, this.late] = [1, usual];
    if (this.most !== most) this.dress();
  }

  // Show another moment; one that is far is gone to picture by picture, until somebody plays or pauses.
  go(time) {
    if (this.playing) this.pause();
    const there = this.source.go(time);
    this.show(true);
    if (!there) { this.play(); this.goal = time; }
  }

  step(direction) {
    if (this.playing) this.pause();
    this.source.step(direction);
    this.show(true);
  }

  grab(lane, bead, across) {
    const source = /** @type {Live} */ (this.source), offset = across === null ? 0 : across - this.stages[lane].middle(bead);
    source.forget();
    source.hand = { lane, bead, place: source.values(lane).position[bead], across, offset };
    this.play();
  }

  // The hand is where the pointer is, in metres in the place of the bead's position.
  follow() {
    const { hand } = this.source;
    if (!hand || hand.across === null) return;
    const stage = this.stages[hand.lane], now = this.source.values(hand.lane);
    stage.edges = leftEdges(now, stage.view, this.data);
    hand.place = now.position[hand.bead] + (hand.across - hand.offset - stage.middle(hand.bead)) / stage.view.scale;
  }

  acrossOf(stage, now) {
    const { hand } = this.source, edges = leftEdges(now, stage.view, this.data);
    return edges[hand.bead] + stage.view.size / 2 + (hand.place - now.position[hand.bead]) * stage.view.scale;
  }

  release() { this.source.hand = null; }

  throwChosen(direction) {
    const { chosen } = this, source = /** @type {Live} */ (this.source), row = source.rows[chosen.lane];
    source.change(() => row.throwBead(chosen.bead, direction * row.spec.speed));
    this.play();
  }

  // An edit that the motion can take as it runs, or else a new beginning.
  edit(name, value) {
    this.experiment[name] = value;
    const { source } = this, running = source.live && !source.over && source.time > source.begun;
    if (name === "pace") source.setPace(value);
    else if (name === "shown") { this.build(); this.dress(); }
    else if (source.live && running && LIVE_EDITS.includes(name)) {
      this.specs = this.made();
      source.change(() => source.rows.forEach((row, lane) => row.booked(() => row.follow(this.specs[lane]))));
      this.build();
      this.dress();
    } else { this.restart(); if (!reduced()) this.play(); }
    this.controls();
    clearTimeout(this.writing);
    this.writing = setTimeout(() => this.write(), 250);
  }

  write() {
    const fragment = writeAddress(this.data, this.experiment, this.own, addressLanguage(location.hash) && this.language);
    try {
      history.replaceState(null, "", fragment ? `#${fragment}` : location.pathname + location.search);
    } catch { /* a frame without an address */ }
  }

  speak(code) {
    this.language = knownLanguage(code);
    useLanguage(this.language);
    this.texts = this.data.texts[this.language] ?? this.data.texts.en;
    part("title").textContent = document.title = this.texts.title;
    part("source").textContent = this.texts.source;
    this.explain();
    for (const element of /** @type {NodeListOf<HTMLElement>} */ (document.querySelectorAll("[data-say]"))) element.textContent = say(element.dataset.say);
    for (const element of /** @type {NodeListOf<HTMLElement>} */ (document.querySelectorAll("[data-name]"))) {
      element.setAttribute("aria-label", say(element.dataset.name));
      element.title = say(element.dataset.name);
    }
    for (const tables of /** @type {NodeListOf<HTMLElement>} */ (document.querySelectorAll("#numbers > [lang]"))) tables.hidden = tables.lang !== this.language;
    part("language").value = this.language;
    for (const option of part("pace").options) option.textContent = paceText(Number(option.value));
  }

  // The text of the scene, while the row is the scene's.
  explain() {
    const same = !MADE.some((name) => differs(this.data, this.experiment, this.own, name));
    part("text").textContent = same ? this.texts.text : say("other numbers");
  }

  // Controls as the experiment is.
  controls() {
    const { experiment, limits, source, data } = this;
    part("pace").value = String(experiment.pace);
    for (const name of SHOWN) part(`show-${name}`).checked = experiment.shown.includes(name);
    this.explain();
    if (!source.live) return;
    for (const name of Object.keys(SLIDERS)) {
      part(name).value = String(Math.round(SLIDER * SLIDERS[name].to(experiment[name], limits[name])));
      const text = SLIDERS[name].text(experiment[name]);
      part(`${name}-value`).textContent = text;
      part(name).setAttribute("aria-valuetext", text);
    }
    part("law").value = experiment.law;
    part("beside").value = experiment.beside;
    part("alpha").closest("label").hidden = !hasAlpha(data, experiment.law);
    part("steel").textContent = say(experiment.beside === "none" ? "compare steel" : "alone");
    part("steel").setAttribute("aria-pressed", String(experiment.beside !== "none"));
  }
}

const MADE = ["law", "alpha", "strikers", "targets", "speed", "friction", "loss"]; // of the experiment: what the row is
const LIVE_EDITS = ["alpha", "friction", "loss"]; // what can change while the motion runs

// Sliders: from 0 to 1 and back within limits, and the text of a value.
const linear = { to: (value, [low, high]) => (value - low) / (high - low), from: (share, [low, high]) => low + share * (high - low) };
const whole = { to: linear.to, from: (share, limits) => Math.round(linear.from(share, limits)) };
const SLIDERS = {
  alpha: { to: (value, [low, high]) => Math.log(value / low) / Math.log(high / low), from: (share, [low, high]) => low * (high / low) ** share,
    text: alphaText },
  strikers: { ...whole, text: String }, targets: { ...whole, text: String },
  speed: { ...linear, text: (value) => `${plain(value, 3)} m/s` },
  friction: { ...linear, text: (value) => plain(value, 2) }, loss: { ...linear, text: (value) => `${Math.round(100 * value)} %` },
};

function paceText(pace) {
  if (pace === 1) return say("usual");
  return pace < 1 ? say("slower", { n: plain(1 / pace, 3) }) : say("faster", { n: plain(pace, 3) });
}

function lawName(law) {
  const [preload, stiffness, exponent] = law;
  if (law.some((value, k) => value !== law[k % 3])) return say("law mixed");
  if (preload > 0 && stiffness > 0) return say("law gear");
  if (exponent === 1.5) return say("law steel");
  return exponent === 1 ? say("law one") : say("law soft", { alpha: alphaText(exponent) });
}

// Whether there can be marks of rigid clusters: a cluster of two beads, and a contact at which it is struck.
function hasMarks({ gap, velocity, speed }, length) {
  const ends = gap.map((wide, k) => wide > LEAST_GAP * length || Math.abs(velocity[k] - velocity[k + 1]) > ALIKE * speed);
  return ends.length > 1 && ends.includes(true) && ends.includes(false);
}

// The colours of the style sheet, which knows light and dark; a long row has a ramp of its own.
function currentTheme(data, beads) {
  const style = getComputedStyle(document.documentElement), colour = (name) => style.getPropertyValue(`--${name}`).trim();
  const dark = matchMedia("(prefers-color-scheme: dark)").matches && !matchMedia("print").matches, few = beads <= data.fewBeads;
  const plainColours = Array.from({ length: data.fewBeads }, (_, k) => colour(`c${k}`)), last = data.ramp.length - 1;
  const along = (k) => {
    const place = last * k / (beads - 1), at = Math.min(Math.floor(place), last - 1), shade = mixed(data.ramp[at], data.ramp[at + 1], place - at);
    return dark ? mixed(shade, "#ffffff", 0.25) : shade;
  };
  const ramp = few ? plainColours : Array.from({ length: beads }, (_, k) => along(k));
  const names = ["paper", "card", "ink", "muted", "line", "strong", "steel"];
  return { ...Object.fromEntries(names.map((name) => [name, colour(name)])), dark, onBead: colour("on-bead"), bead: (k) => ramp[k % ramp.length] };
}

const reduced = () => matchMedia("(prefers-reduced-motion: reduce)").matches;
