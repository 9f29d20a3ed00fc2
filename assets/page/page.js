// The page. It contains the controls, the clock, and the drawing of the motion of a source.

const TEXT_RATE = 8; // Number of updates of texts and tables per second while the motion is playing.
const WATCHED = 60; // Number of pictures from which the median interval between two pictures is computed.
const LATE = 22; // Smallest median interval between two pictures, in milliseconds, at which the pictures count as late.
const SOONER = 0.8; // Largest ratio of the intervals with fewer and with all pixels at which fewer pixels count as an improvement.
const SLIDER = 1000; // Number of positions of the time slider.
// Height of the window [px] below which the beads scroll with the settings. Above it, the beads stay visible. page.css has the same value.
const SHORT = 560;
const NARROW = 640; // width of the window [px] below which the settings are below the beads, as in page.css
const BAR_HEIGHT = 116; // height [px] of the transport bar and of the space between two rows
const LEAST_ROW = 110; // smallest height [px] of a row of beads
const LANE_SPACE = 9; // height [px] of the space below a row
// Heights [px] of a row with magnifiers. Below the first height, the texts are brief. Below the second height, the magnifiers are small.
const LOW_ROW = 240, LOWEST_ROW = 170;
const LEAST_GHOST = 0.2; // Smallest fraction of a run after which its curves are kept as grey curves of the previous run.
const GHOST_POINTS = 200; // Largest number of points of a grey curve of the previous run.
const PULLED = 0.3; // Distance by which one key press pulls the hand, in lengths of a bead.
const part = (id) => /** @type {any} */ (document.getElementById(id));

class Page {
  /** @param {any} data @param {Live|Recorded} source @param {string} why reason why the page does not compute its motion, or "" */
  constructor(data, source, why) {
    this.data = data;
    this.source = source;
    this.why = why;
    this.asked = ""; // fragment of the address with which the page was opened; empty after a change by the user
    /** @type {Experiment} */ this.own = data.own && { ...data.own, shown: [...data.own.shown] };
    this.limits = source.live ? limitsOf(data, this.own) : {};
    if (data.uniform) { // At first, a row of soft beads and a row of steel balls are shown side by side.
      const kinds = compared(data, this.own, this.own);
      if (kinds.length > 1) this.own.beside = contrastTo(kinds);
    }
    this.playing = false;
    this.asking = false; // true while the page waits for an answer to the question
    this.guess = ""; // answer of the user, one of GUESSES
    /** @type {number[][]|null} */ this.after = null; // velocities of the rows after the collision, once they are known
    /** @type {Now[]|null} */ this.peaks = null; // states of the rows at their largest forces while they are explained
    this.ghosts = []; // curves of the previous run for each chart
    /** @type {(() => void)|null} */ this.report = null; // reports each change of the state to a host
    /** @type {number|null} */ this.goal = null; // Time to which the page is winding forward as fast as possible.
    this.textsAt = 0;
    this.firstWindow = 0;
    /** @type {{lane: number, bead: number}|null} */ this.chosen = null;
    this.unseen = new WeakSet(); // canvases that are scrolled out of sight; they are not drawn while the motion is playing
    this.sight = new IntersectionObserver((changes) => {
      for (const { target, isIntersecting } of changes) this.unseen[isIntersecting ? "delete" : "add"](target);
    });
    this.most = Infinity; // Largest number of canvas pixels per pixel of the page.
    this.waits = []; // Intervals between pictures in milliseconds.
    this.late = null; // Median interval at the time when fewer pixels were tried. It is 0 after the decision.
    this.specs = data.lanes.map((lane) => lane.spec);
    this.open();
    listen(this);
  }

  // Start the experiment that an address describes. If the experiment has a question, wait for the answer.
  open(fragment = location.hash) {
    const moment = addressMoment(fragment);
    if (this.playing) this.pause();
    this.guess = "";
    this.ghosts = [];
    this.asking = moment === null;
    clearTimeout(this.writing); // Cancel the pending update of the previous address.
    document.body.classList.toggle("embed", isEmbedded(fragment));
    this.experiment = readAddress(fragment, this.own, this.limits, this.data);
    this.speak(languageIn([addressLanguage(fragment), this.language, ...navigator.languages]) ?? "en");
    this.restart();
    this.asked = fragment;
    this.notify();
    // The possible answers fit only the standard question of the page, not the question of a scene.
    this.asking &&= !this.texts.question && Boolean(leadWords(this.specs));
    if (moment !== null) this.go(moment); else if (!this.asking && !reduced()) this.play();
    this.story();
  }

  // Apply settings of the site that embeds the page. They are named as in an address. The other settings do not change.
  obey(settings, play) {
    const present = new URLSearchParams(this.write());
    for (const [key, value] of Object.entries(settings)) present.set(key.toLowerCase(), String(value));
    this.open(`#${present}`);
    this.write();
    if (play) this.play(); else if (play === false && this.playing) this.pause();
  }

  // Show one line with notices. They say that the motion is a recording, and list the entries of the address that the page cannot follow.
  notify() {
    const { source, why, asked } = this;
    const unmet = asked && unmetWishes(asked, this.data, this.experiment, source.open ? Infinity : source.last);
    const said = [why && say(why), unmet?.length > 0 && say("unmet", { list: unmet.join(", ") })];
    part("notice").textContent = said.filter(Boolean).join(" ");
    part("notice").hidden = !part("notice").textContent;
  }

  // Return the initial states and contact laws of the rows of the experiment.
  made() {
    const { data, experiment, own } = this, specs = data.lanes.map((_, lane) => specOf(data, lane, experiment, own));
    if (experiment.beside !== "none" && data.lanes.length === 1) specs.push(besideSpec(data, specs[0], experiment.beside));
    return specs;
  }

  // Start the experiment again.
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
    // Number of decimals of the displayed time.
    this.decimals = Math.max(0, 2 - Math.floor(Math.log10((source.last - source.begun) / data.unit.size || 1)));
    this.firstWindow = 0;
    this.after = this.peaks = null;
    this.build();
    this.controls();
    this.dress();
  }

  // Compute the appearance of each lane, and create canvases for the lanes and their charts.
  build() {
    const { specs, experiment } = this, lanes = part("lanes"), charts = part("charts");
    this.looks = specs.map((spec, lane) => this.lookOf(spec, lane));
    const gears = this.looks.every((look) => look.gears.every(Boolean)), walls = specs.some(({ mass }) => mass.includes(null));
    this.data.height = walls ? WALL_HEIGHT : gears ? CYLINDER_HEIGHT : 1; // Height of the tallest body in lengths of a bead.
    if (useBodies(this.looks[subjectOf(specs)].body)) this.relabel();
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
    const named = (lane) => (specs.length > 1 && this.looks[lane].label) || this.texts.title;
    this.stages.forEach(({ canvas }, lane) => canvas.setAttribute("aria-label", say("beads", { name: named(lane) }) + keys));
    charts.hidden = !experiment.shown.includes("charts");
  }

  lookOf(spec, lane) {
    const { data, experiment, own, source } = this, given = data.lanes[lane], n = spec.gap.length;
    const compares = this.specs.length > data.lanes.length;
    const whole = given && given.spec.mass.length === spec.mass.length;
    const same = whole && experiment.law === own.law && (lane > 0 || !differs(data, experiment, own, "alpha"));
    const gear = (i) => spec.law[3 * i] > 0 && spec.law[3 * i + 1] > 0;
    const gears = Array.from({ length: n }, (_, i) => (same ? given.gears[i] : gear(i)));
    const body = isTrain(spec.mass) ? "wagon" : gears.every(Boolean) ? "cylinder" : "bead";
    const label = same && !compares ? this.texts.labels[lane] : lawName(spec.law);
    return { mass: spec.mass, contacts: n, body, label, massLabels: massLabels(spec.mass), gears, pulls: Boolean(whole && given.pulls),
      solid: whole && given.solid ? given.solid : Array.from({ length: n }, () => [null, null]),
      marks: !source.touched && hasMarks(spec, data.length), // If the user has thrown a bead, the initial clusters have changed.
      dissipative: source.live ? spec.friction > 0 || spec.loss.some((loss) => loss > 0) : given.dissipative,
      driven: Boolean(given?.driven), drive: spec.drive?.some(Boolean) ? spec.drive : null, strings: spec.strings, rest: restOf(spec.gap),
      deepest: this.source.scales.deepest[lane] };
  }

  // Redraw everything after a change of experiment, size or theme.
  dress() {
    const { data, looks, experiment, peaks } = this, two = looks.length > 1, high = window.innerHeight, wide = window.innerWidth;
    const narrow = part("lanes").clientWidth < NARROW, beside = high < SHORT && wide >= NARROW;
    document.body.classList.toggle("why", peaks !== null);
    this.story();
    const density = Math.min(window.devicePixelRatio || 1, this.most);
    this.theme = { ...currentTheme(data, Math.max(...looks.map(({ mass }) => mass.length))), density };
    if (peaks) this.dressPeaks(narrow); else {
      const room = this.room(), usual = two ? (narrow ? clamped(0.33 * high - 0.5 * BAR_HEIGHT, [LEAST_ROW, 150]) : 150) : 214;
      // The window is too small for two rows with their bars of energy and momentum.
      const small = two && (narrow || room < usual + BARS_HEIGHT), most = two ? 330 : 460;
      const shown = small ? experiment.shown.filter((name) => name !== "balance") : experiment.shown;
      const free = room - (shown.includes("balance") ? BARS_HEIGHT : 0);
      const least = two ? clamped(free, [LEAST_ROW, usual]) : usual;
      const tall = beside ? clamped(free, [LEAST_ROW, most]) : high < SHORT ? clamped(0.45 * high, [LEAST_ROW, usual])
        : clamped((two ? (narrow ? 0.19 : 0.25) : narrow ? 0.28 : 0.4) * high, [least, most]);
      this.stages.forEach((stage, lane) => stage.fit(looks[lane], data, this.theme, { tall, shown, force: data.scales.force[lane] }));
    }
    if (experiment.shown.includes("charts")) {
      for (const [k, chart] of this.charts.entries()) {
        const name = chart.channel === "velocity" ? say("velocities") : say("forces chart", { unit: data.forceUnit.name });
        chart.fit(this.theme, two && looks[chart.lane].label ? `${name}: ${looks[chart.lane].label}` : name, this.ghosts[k]);
        chart.canvas.setAttribute("aria-label", `${chart.title}. ${say("chart values")}`);
      }
    }
    this.show(true, true);
    const bench = part("bench"); // The beads stay visible above the scrolling settings if enough of the window is left for the settings.
    bench.classList.remove("still");
    bench.classList.toggle("still", bench.offsetHeight > Number(getComputedStyle(bench).getPropertyValue("--share")) * high);
    // A control that gets the focus is scrolled until it is not covered by the beads.
    document.documentElement.style.scrollPaddingTop = !beside && getComputedStyle(bench).position === "sticky" ? `${bench.offsetHeight}px` : "";
  }

  // Return the height that is available for each row. It is the height of the window between the story and the transport bar.
  room() {
    const top = part("lanes").getBoundingClientRect().top + window.scrollY, below = document.body.classList.contains("embed") && window.innerWidth < NARROW;
    const settings = below ? part("settings").offsetHeight : 0;
    return (window.innerHeight - top - part("transport").offsetHeight - settings) / this.looks.length - LANE_SPACE;
  }

  // Fit the explanation into the window. Each row with magnifiers has its own scale and is below the sentences.
  dressPeaks(narrow) {
    const { data, looks, peaks, specs } = this, lanes = part("lanes"), room = this.room();
    this.stages.forEach((stage, lane) => {
      const { force, time } = peaks[lane], { contacts } = explanationOf(specs[lane], peaks[lane]), { label } = looks[lane];
      const lenses = loupeRow(looks[lane], Math.max(lanes.clientWidth, LEAST_WIDTH), contacts, narrow || room < LOW_ROW, room < LOWEST_ROW);
      const look = { ...looks[lane], label: `${label && `${label}, `}${this.clock(time)}` };
      stage.fit(look, data, this.theme, { tall: clamped(room - lenses.height, [56, 330]), shown: ["forces"], lenses, force: FORCE_MARGIN * Math.max(...force) });
    });
  }

  // Draw the current state. If `texts` is true, also update the texts. If `whole` is true, also draw canvases outside the window.
  show(texts, whole = !this.playing) {
    const { source, data, stages, chosen } = this, { hand } = source;
    const nows = this.peaks ?? stages.map((_, lane) => source.values(lane)), due = ({ canvas }) => whole || !this.unseen.has(canvas);
    if (source.touched && this.looks.some(({ marks }) => marks)) { this.build(); this.dress(); return; }
    if (!this.peaks && (source.touched || !source.followed) && this.widen(nows)) { this.dress(); return; }
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

  // Enlarge the axes if values exceed them. The ground becomes at most four times as long. If the beads move farther, the ground moves with
  // them, provided that they fit into it.
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

  // Update the texts: time, outcome, energy and tables. Each change of a text makes the browser lay out the page again.
  tell(nows) {
    const { source, specs, looks, data } = this, clock = this.clock(source.time);
    part("clock").textContent = clock;
    part("time").value = String(Math.round(SLIDER * (source.time - source.begun) / (source.last - source.begun || 1)));
    part("time").setAttribute("aria-valuetext", clock);
    const { parted } = source, left = !source.touched && parted && source.time >= parted.time ? parted.velocity : null;
    const ended = (source.apart && (source.over || source.open || left !== null)) && !source.hand;
    if (ended && !source.touched && !this.after && !this.peaks && strikersOf(specs[subjectOf(specs)])) {
      this.after = nows.map((now, lane) => Array.from(left?.[lane] ?? now.velocity));
      this.story();
    }
    const said = nows.map((now, lane) => {
      useBodies(looks[lane].body);
      const name = looks.length > 1 && looks[lane].label ? `${looks[lane].label}: ` : "", velocity = left?.[lane] ?? now.velocity;
      const rigid = lane || source.touched ? "" : ` ${rigidWords(specs[lane], looks[lane], data.length, velocity)}`;
      return name + whatHappened(velocity, specs[lane]) + rigid;
    });
    useBodies(looks[subjectOf(specs)].body);
    if (left && source.over) said.push(say("stopped"));
    const cut = source.over && !ended, text = ended ? said.join("\n") : cut ? say("followed", { time: `${plain(source.last / data.unit.size, 3)} ${data.unit.name}` })
      : source.live ? say("hint") : "";
    if (part("words").textContent !== text) part("words").textContent = text;
    part("words").classList.toggle("ended", ended);
    if (source.live) part("energy").textContent = source.rows.map((row, lane) => this.ledger(row, lane)).join("\n");
    if (part("numbers").open) fillTables(this, nows);
    this.report?.();
  }

  clock(time) { return `t = ${fixed(time / this.data.unit.size, this.decimals)} ${this.data.unit.name}`; }

  // Update the text above the beads. It is the question with its answers, the sentence about the guess, or the explanation of each row.
  story() {
    const { specs, looks, texts, source, after, peaks, guess } = this, m = strikersOf(specs[subjectOf(specs)]);
    const named = (lane) => (looks.length > 1 && looks[lane].label ? `${looks[lane].label}: ` : "");
    const said = peaks ? peaks.map((now, lane) => named(lane) + explanationOf(specs[lane], now).words).join("\n")
      : after && !source.touched && !texts.question ? verdictWords(specs, after, guess) : texts.question || leadWords(specs);
    if (part("lead").textContent !== said) part("lead").textContent = said;
    part("guesses").hidden = !this.asking;
    for (const kind of GUESSES) part(`guess-${kind}`).textContent = say(`guess ${kind}${kind === "last" && m > 1 ? " many" : ""}`);
    part("explain").hidden = !after || source.touched;
    part("explain").setAttribute("aria-pressed", String(peaks !== null));
  }

  // Store the answer to the question and start the motion.
  answer(kind) {
    this.guess = kind;
    this.play();
    part("toggle").focus({ preventScroll: true });
  }

  // Stop the motion of each row at its largest force and explain it. If this has happened already, continue the motion.
  reveal() {
    if (this.peaks) { this.leave(); return; }
    if (this.playing) this.pause();
    const { source, specs } = this, peaks = specs.map((_, lane) => source.peak(lane)), { time } = peaks[subjectOf(specs)];
    if (time <= source.time) source.go(time);
    this.peaks = peaks;
    this.asking = false;
    window.scrollTo(0, 0);
    this.dress();
  }

  // Hide the question or the explanation, because the motion continues.
  leave() {
    if (!this.peaks && !this.asking) return;
    this.peaks = null;
    this.asking = false;
    this.dress();
  }

  // Describe the energy of a row. The text contains the total, the absorbed part, the digits of the balance, and the work of the hand.
  ledger(row, lane) {
    const { looks, source, data } = this, { absorbed } = row.kernel, lost = absorbed[0] + absorbed[1];
    const name = looks.length > 1 && looks[lane].label ? `${looks[lane].label}: ` : "", parts = [say("energy", { value: joules(row.energy()) })];
    const digits = Math.min(16, Math.floor(-Math.log10(row.energyError())));
    if (lost > 0) parts.push(say("absorbed", { value: joules(lost) }));
    if (row.balanced) parts.push(say(looks[lane].dissipative ? "right lossy" : "right", { digits }));
    if (source.touched && row.given) parts.push(say("given", { value: joules(row.given) }));
    return name + parts.join(" · ") + (lane === 0 && data.length === 1 && row.mass.every((m) => m === 1) ? ` · ${say("units")}` : "");
  }

  play() {
    this.leave();
    this.goal = null;
    if (this.playing) return;
    if (this.source.over) this.restart();
    this.playing = true;
    this.last = undefined;
    this.label();
    this.next();
  }

  // Request the next picture. Only one request is pending at a time, even after a pause that is shorter than a picture.
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

  // If the pictures are late, draw fewer pixels. If this does not help, the display itself is slow, and all pixels are drawn again.
  spare(wait) {
    if (this.waits.push(wait) < WATCHED) return;
    const usual = this.waits.sort((a, b) => a - b)[WATCHED >> 1], { most } = this;
    this.waits = [];
    if (this.late) [this.most, this.late] = [usual < SOONER * this.late ? 1 : Infinity, 0];
    else if (this.late === null && usual > LATE && this.theme.density > 1) [this.most, this.late] = [1, usual];
    if (this.most !== most) this.dress();
  }

  // Move to another time. A distant time is reached in the course of several pictures, unless the user plays or pauses the motion.
  go(time) {
    this.leave();
    if (this.playing) this.pause();
    const there = this.source.go(time);
    this.show(true);
    if (!there) { this.play(); this.goal = time; }
  }

  step(direction) {
    this.leave();
    if (this.playing) this.pause();
    this.source.step(direction);
    this.show(true);
  }

  grab(lane, bead, across) {
    const source = /** @type {Live} */ (this.source), offset = across === null ? 0 : across - this.stages[lane].middle(bead);
    this.leave();
    source.forget();
    source.hand = { lane, bead, place: source.values(lane).position[bead], across, offset };
    this.play();
  }

  // Move the hand to the pointer. The position of the hand is given in metres, like the position of a bead.
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

  // Apply an edit. If the edit changes a row, the motion starts again. The curves of the previous run are shown behind the new curves.
  edit(name, value) {
    const { source, experiment, data, own } = this;
    experiment[name] = value;
    const kinds = source.live ? compared(data, experiment, own) : [];
    if (name === "law" && !kinds.includes(experiment.beside)) experiment.beside = contrastTo(kinds);
    this.asked = "";
    this.notify();
    if (name === "pace") source.setPace(value);
    else if (name === "shown") { this.build(); this.dress(); }
    else {
      this.asking = false;
      this.haunt();
      this.restart();
      if (!reduced()) this.play();
    }
    this.controls();
    clearTimeout(this.writing);
    this.writing = setTimeout(() => this.write(), 250);
  }

  // Keep the curves of the current run as grey curves if the run is long enough. While a slider is dragged, the curves from before the drag
  // are kept.
  haunt() {
    const { source } = this;
    if (source.time - source.begun < LEAST_GHOST * (source.last - source.begun)) return;
    this.ghosts = this.charts.map(({ lane, channel }) => {
      const points = [], count = source.values(lane)[channel].length;
      source.trace(lane, channel, GHOST_POINTS, -Infinity, (time, values, at) => points.push([time, ...values.slice(at, at + count)]));
      return points;
    });
  }

  // Write the experiment into the address and return its fragment.
  write() {
    const embedded = document.body.classList.contains("embed");
    const fragment = writeAddress(this.data, this.experiment, this.own, addressLanguage(location.hash) && this.language, embedded);
    clearTimeout(this.writing);
    try {
      history.replaceState(null, "", fragment ? `#${fragment}` : location.pathname + location.search);
    } catch { /* a frame without an address */ }
    return fragment;
  }

  speak(code) {
    this.language = code;
    useLanguage(this.language);
    this.texts = this.data.texts[this.language] ?? this.data.texts.en;
    this.explain();
    this.relabel();
    this.notify();
    for (const tables of /** @type {NodeListOf<HTMLElement>} */ (document.querySelectorAll("#numbers > [lang]"))) tables.hidden = tables.lang !== this.language;
    part("language").value = this.language;
    for (const option of part("pace").options) option.textContent = paceText(Number(option.value));
  }

  // Fill in the texts of the document.
  relabel() {
    for (const element of /** @type {NodeListOf<HTMLElement>} */ (document.querySelectorAll("[data-say]"))) element.textContent = say(element.dataset.say);
    for (const element of /** @type {NodeListOf<HTMLElement>} */ (document.querySelectorAll("[data-name]"))) {
      element.setAttribute("aria-label", say(element.dataset.name));
      element.title = say(element.dataset.name);
    }
  }

  // Show the title, source, question and text of the scene. If a row has been changed, show a title with the changes and a note instead of
  // the text.
  explain() {
    const { data, experiment, own, texts } = this, other = (name) => differs(data, experiment, own, name), changed = MADE.some(other);
    const counted = data.uniform && ["law", "strikers", "targets"].some(other), { title } = texts;
    const now = !changed ? title : counted ? say("changed from", { now: countedTitle(experiment), title }) : say("changed", { title });
    part("title").textContent = document.title = now;
    part("source").textContent = changed ? "" : texts.source;
    // The height of the text is kept. Otherwise a slider could move away from under a finger.
    if (changed) part("text").style.minHeight = `${part("text").offsetHeight}px`;
    part("text").textContent = changed ? say("other numbers") : texts.text;
  }

  // Update the controls to show the settings of the experiment.
  controls() {
    const { experiment, limits, source, data, own } = this;
    part("pace").value = String(experiment.pace);
    for (const option of part("pace").options) option.textContent = paceText(Number(option.value));
    for (const name of SHOWN) part(`show-${name}`).checked = experiment.shown.includes(name);
    this.explain();
    if (!source.live) return;
    for (const name of Object.keys(SLIDERS)) {
      const { most, to, text } = SLIDERS[name], [low, high] = limits[name], input = part(name), value = text(experiment[name]);
      [input.min, input.max] = most ? ["0", String(most)] : [String(low), String(high)];
      input.value = String(Math.round(to(experiment[name], limits[name])));
      part(`${name}-value`).textContent = value;
      input.setAttribute("aria-valuetext", value);
    }
    const kinds = compared(data, experiment, own), contrast = contrastTo(kinds);
    part("law").value = experiment.law;
    part("beside").value = experiment.beside;
    for (const option of part("beside").options) option.hidden = option.disabled = !kinds.includes(option.value);
    part("alpha").closest(".field").hidden = !hasAlpha(data, experiment.law);
    part("contrast").textContent = say(experiment.beside === "none" ? `compare ${contrast}` : "alone");
    part("contrast").setAttribute("aria-pressed", String(experiment.beside !== "none"));
  }
}

const MADE = ["law", "alpha", "strikers", "targets", "speed", "friction", "loss"]; // settings that change the row of the scene

// Exponents that can be chosen with the slider. They are unit fractions for soft beads, and tenths up to the exponent of steel.
const ALPHAS = [...[40, 35, 30, 25, 20, 18, 16, 14, 12, 11, 10, 9, 8, 7, 6, 5, 4, 3, 2.5, 2].map((under) => 1 / under),
  0.6, 0.7, 0.8, 0.9, 1, 1.1, 1.2, 1.3, 1.4, 1.5];

// Properties of the sliders: the largest position or the limits of a whole number, the conversion of a value to a position and back, and
// the text of a value.
const whole = { to: (value) => value, from: (place) => place, text: String };
const steps = (most) => ({ most, to: (value, [low, high]) => most * (value - low) / (high - low),
  from: (place, [low, high]) => Number((low + place / most * (high - low)).toPrecision(12)) });
const SLIDERS = {
  alpha: { most: ALPHAS.length - 1, to: (value) => ALPHAS.indexOf(nearest(value, ALPHAS)), from: (place) => ALPHAS[place], text: alphaText },
  strikers: whole, targets: whole,
  speed: { ...steps(24), text: (value) => `${plain(value, 3)} m/s` },
  friction: { ...steps(50), text: (value) => plain(value, 2) }, loss: { ...steps(90), text: (value) => `${Math.round(100 * value)} %` },
};

function paceText(pace) {
  if (pace === 1) return say("usual");
  return pace < 1 ? say("slower", { n: plain(1 / pace, 3) }) : say("faster", { n: plain(pace, 3) });
}

// Return the kind of the contacts of a row.
function lawKind(law) {
  const [preload, stiffness, exponent] = law;
  if (law.some((value, k) => value !== law[k % 3])) return "mixed";
  if (preload > 0 && stiffness > 0) return "gear";
  return exponent === 1.5 ? "steel" : exponent === 1 ? "one" : "soft";
}

const lawName = (law) => say(`law ${lawKind(law)}`, { alpha: alphaText(law[2]) });

// Return true if all bodies that can move are at least as heavy as wagons.
const isTrain = (masses) => masses.every((mass) => mass === null || mass >= HEAVY);

// Write a number of bodies as a word, or as digits above twelve.
const countWord = (n) => say("count").split(" ")[n - 1] ?? String(n);
const countedTitle = ({ strikers, targets }) => capital(say(strikers > 1 ? "many on" : "one on", { m: countWord(strikers), n: countWord(targets) }));

// Return true if forces of rigid clusters can be marked. This requires a cluster of two beads and a contact at which the cluster is struck.
function hasMarks({ gap, velocity, speed }, length) {
  const ends = gap.map((wide, k) => wide > LEAST_GAP * length || Math.abs(velocity[k] - velocity[k + 1]) > ALIKE * speed);
  return ends.length > 1 && ends.includes(true) && ends.includes(false);
}

// Return the colours of the light or dark theme from the style sheet. A long row has a separate range of colours.
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
  return { ...Object.fromEntries(names.map((name) => [name, colour(name)])), dark, bead: (k) => ramp[k % ramp.length] };
}

const reduced = () => matchMedia("(prefers-reduced-motion: reduce)").matches;
