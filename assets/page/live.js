// The live source. It computes several rows with a common clock frame by frame. The states of the last minute are stored, and the user can
// return to them.

const LONGEST = 0.1; // Longest pause of the page for which the motion catches up, in seconds of wall time.
const BUDGET = 10; // Largest computing time per picture in milliseconds of wall time.
const REMEMBERED = 3600; // Number of stored states. They cover one minute.
const FRAMES_KEPT = 2; // Number of frames between two stored states.
const LOOK_AHEAD = 60; // Longest motion that is computed in advance before it is played, in seconds of wall time.
// Largest number of contacts times steps that are computed in advance. They take half a second on a slow computer.
const MOST_LOOKED = 1.5e6;
// Limits per picture when the user moves to another time: contacts times steps, and frames.
const MOST_AT_ONCE = 3e5, FRAMES_AT_ONCE = 3600;
const TAIL = 1.5; // Duration of the motion that is shown after all rows have separated or stopped, in seconds of wall time.
const LONGEST_SLIDE = 30; // Longest slide after a collision that is shown until friction stops the beads, in seconds of wall time.
const LINGER = 6; // Duration of the motion that is shown after the separation if its end was unknown, in seconds of wall time.
const BEFORE_HIT = 0.25; // Longest free flight that is played before the first hit, as a fraction of the time from the hit to the end.

class Live {
  /** @param {any} data @param {WebAssembly.Module} module */
  constructor(data, module) {
    this.data = data;
    this.instances = [0, 1].map(() => new WebAssembly.Instance(module));
    /** @type {true} */ this.live = true;
    /** @type {Row[]} */ this.rows = [];
    this.hand = null;
    this.pace = 1;
    this.branch = 0;
  }

  /** Start an experiment. @param {Spec[]} specs one per row @param {number} pace playback speed relative to the scene */
  begin(specs, pace) {
    this.rows = specs.map((spec, k) => new Row(this.instances[k], this.data.kernel, spec));
    this.nows = specs.map((spec) => emptyNow(spec.gap.length));
    this.setPace(1); // The length and the end of the motion computed in advance do not depend on the playback speed.
    this.scales = this.lookAhead();
    for (const row of this.rows) row.begin();
    const flight = Math.max(0, Math.floor((this.hit - BEFORE_HIT * (this.end - this.hit)) / this.frameTime));
    for (let k = 0; k < flight; k++) this.frame(null);
    this.setPace(pace);
    const before = this.kept ?? [], rooms = this.rows.map((row) => row.width * REMEMBERED);
    this.kept = rooms.map((room, lane) => (before[lane]?.length === room ? before[lane] : new Float64Array(room)));
    this.branch += 1; // A new branch number makes the charts discard the curves of the previous run.
    // Numbers of the stored states. The oldest state has the number `first`, and the newest has the number `count - 1`.
    this.first = this.count = 0;
    this.shown = 0;
    this.touched = false;
    this.hand = null;
    this.due = this.sinceKept = this.apartFor = 0;
    this.keep();
  }

  setPace(pace) {
    this.pace = pace;
    this.slow = this.data.slow / pace;
    this.frameTime = 1 / (STORY.frameRate * this.slow);
    this.steps = Math.max(...this.rows.map((row) => row.stepsOf(this.frameTime)));
  }

  get time() { return this.rows[0].kernel.time; }

  get begun() { return this.timeOf(this.first); }

  // True if the end of the motion is unknown. The user has intervened, or the computation in advance has not reached the end.
  get open() { return this.touched || !(this.followed || this.data.duration); }

  // The end of the motion if it is known. Otherwise the newest computed time.
  get last() { return Math.max(this.touched ? 0 : this.end, this.timeOf(this.count - 1)); }

  timeOf(number) { return this.kept[0][(number % REMEMBERED) * this.rows[0].width]; }

  frame(hand) {
    this.rows.forEach((row, lane) => row.frame(this.frameTime, this.steps, this.slow, hand && hand.lane === lane ? hand : null));
  }

  // Return the number of frames whose number of contacts times steps is `work`.
  framesOf(work) {
    const each = this.rows.reduce((sum, row) => sum + row.kernel.n / (row.spec.swing ? FLOWN : 1), 0);
    return Math.ceil(work / (this.steps * each));
  }

  // Compute the motion in advance to find its axes and its length, within a time limit. The rows must be reset to the start afterwards.
  lookAhead() {
    const { rows, nows } = this, most = Math.min(LOOK_AHEAD * STORY.frameRate, this.framesOf(MOST_LOOKED)), { duration } = this.data;
    this.peaks = rows.map((row) => ({ force: 0, state: new Float64Array(row.width) }));
    const scales = startScales(this.data, rows), limit = duration ? Math.ceil(duration / this.frameTime) : Infinity;
    let apart = 0, k = 0;
    this.hit = -1;
    // State at the time when the rows separated. It is used if friction stops the rows later.
    /** @type {{time: number, velocity: number[][]}|null} */ this.parted = null;
    for (; k < limit && k < most && apart < TAIL * STORY.frameRate; k++) {
      this.frame(null);
      rows.forEach((row, lane) => {
        const now = row.read(nows[lane]), peak = this.peaks[lane], force = Math.max(...now.force);
        widened(scales, lane, row.mass, now, this.data.length, 0);
        if (force > peak.force) { peak.force = force; row.keep(peak.state, 0); }
      });
      if (this.hit < 0 && nows.some((now) => now.force.some((f) => f > 0))) this.hit = rows[0].kernel.time;
      apart = this.apart ? apart + 1 : 0;
      const sliding = apart && this.slow * Math.max(...rows.map((row) => row.sliding));
      if (sliding && duration) apart = 0; // If beads are sliding, the motion is computed up to the duration of the scene.
      if (!sliding || duration || sliding > LONGEST_SLIDE) continue;
      this.parted ??= { time: rows[0].kernel.time, velocity: nows.map(({ velocity }) => Array.from(velocity)) };
      apart = 0;
    }
    this.hit = Math.max(this.hit, 0);
    this.followed = k >= limit || apart >= TAIL * STORY.frameRate; // If this is false, the time limit was reached before the end.
    this.end = this.followed || !duration ? rows[0].kernel.time : duration;
    shareForces(scales);
    scales.magnify = this.data.magnify ?? magnified(scales, this.data.length);
    return scales;
  }

  // Advance the motion by `seconds` of wall time. Advance it by less if the computation takes too long.
  advance(seconds) {
    this.forget();
    this.due += Math.min(seconds, LONGEST) * STORY.frameRate;
    const count = Math.round(this.due), started = performance.now();
    this.due -= count;
    for (let k = 0; k < count && !this.over && (k === 0 || performance.now() - started < BUDGET); k++) this.next();
  }

  next() {
    this.frame(this.hand);
    if (this.hand) this.touched = true;
    this.sinceKept += 1;
    this.apartFor = this.apart && !this.hand ? this.apartFor + 1 / STORY.frameRate : 0;
    if (this.sinceKept >= FRAMES_KEPT || this.over) this.keep();
  }

  // True if all rows have separated or stopped.
  get apart() { return this.rows.every((row) => row.apart); }

  get over() {
    if (this.hand) return false;
    return this.open ? this.apartFor > LINGER : this.time >= this.end - 0.5 * this.frameTime;
  }

  keep() {
    if (this.count && this.time === this.timeOf(this.count - 1)) return;
    this.rows.forEach((row, lane) => row.keep(this.kept[lane], (this.count % REMEMBERED) * row.width));
    this.shown = this.count;
    this.count += 1;
    this.first = Math.max(this.first, this.count - REMEMBERED);
    this.sinceKept = 0;
  }

  // Discard the states after the current one. They are invalid if the motion is continued or changed at this time.
  forget() {
    if (this.shown >= this.count - 1) return;
    this.count = this.shown + 1;
    this.branch += 1;
  }

  // Move to another time. The state is restored from the stored states, or computed in parts, one part per call. Return true when the time
  // is reached.
  go(time) {
    if (time <= this.timeOf(this.count - 1)) { this.restore(this.numberAt(time)); return true; }
    this.restore(this.count - 1);
    const end = Math.min(time, this.last) - 0.5 * this.frameTime, most = Math.min(FRAMES_AT_ONCE, this.framesOf(MOST_AT_ONCE));
    for (let k = 0; k < most && this.time < end; k++) this.next();
    this.keep();
    return this.time >= end;
  }

  // Return the number of the last stored state at or before `time`. If there are only later states, return the number of the first one.
  numberAt(time) {
    let low = this.first, high = this.count - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (this.timeOf(middle) <= time) low = middle; else high = middle - 1;
    }
    return low;
  }

  restore(number) {
    this.rows.forEach((row, lane) => row.restore(this.kept[lane], (number % REMEMBERED) * row.width));
    this.shown = number;
    this.sinceKept = this.apartFor = 0;
  }

  // Move one stored state forwards or backwards.
  step(direction) {
    if (direction > 0 && this.shown >= this.count - 1) { for (let k = 0; k < FRAMES_KEPT; k++) this.next(); this.keep(); }
    else this.restore(Math.min(Math.max(this.shown + direction, this.first), this.count - 1));
  }

  // Change the rows by hand with `edit`. The later states are discarded.
  change(edit) {
    this.forget();
    edit();
    this.touched = true;
    this.apartFor = 0;
    this.setPace(this.pace); // The number of time steps depends on the current contact laws.
  }

  values(lane) { return this.rows[lane].read(this.nows[lane]); }

  // Return the state of a row at the largest force of the motion that was computed in advance.
  peak(lane) {
    const row = this.rows[lane], now = emptyNow(row.kernel.n);
    this.aside(row, () => {
      row.restore(this.peaks[lane].state, 0);
      row.read(now);
      now.time = row.kernel.time;
    });
    return now;
  }

  // Call `visit(time, now)` for the stored states of a row, at most `most` times.
  each(lane, most, visit) {
    const row = this.rows[lane], every = Math.ceil((this.count - this.first) / most);
    this.aside(row, () => {
      for (let k = this.first; k < this.count; k += every) {
        row.restore(this.kept[lane], (k % REMEMBERED) * row.width);
        visit(row.kernel.time, row.read(this.nows[lane]));
      }
    });
  }

  // Do some work that moves a row. Restore the current state of the row afterwards.
  aside(row, work) {
    const present = new Float64Array(row.width);
    row.keep(present, 0);
    work();
    row.restore(present, 0);
  }

  // Pass times and values of a lane to a chart by calling `visit(time, array, index of the first value)`, at most `most` times. The chart
  // already knows the values up to the time `since`, which is the time of the first call.
  trace(lane, channel, most, since, visit) {
    const row = this.rows[lane], { n } = row.kernel, from = HEAD + (channel === "velocity" ? 3 * n : 2 * n), kept = this.kept[lane];
    const every = Math.max(1, Math.ceil((this.count - this.first) / most)), end = this.count - 1, begin = Math.max(this.first, this.numberAt(since));
    for (let k = begin; k <= end; k = k === end ? k + 1 : Math.min(every * Math.floor(k / every + 1), end)) {
      const at = (k % REMEMBERED) * row.width;
      visit(kept[at], kept, at + from);
    }
  }
}

// Return the axes before the motion is computed.
function startScales(data, rows) {
  const speed = Math.max(...rows.map((row) => row.spec.speed));
  const scales = { window: [Infinity, -Infinity], velocity: [0, 0], force: rows.map(() => 0), pull: 0, energy: 0, momentum: [0, 0], magnify: 1,
    deepest: rows.map((row) => new Array(row.kernel.n).fill(0)) };
  rows.forEach((row, lane) => widened(scales, lane, row.mass, row.read(emptyNow(row.kernel.n)), data.length, 0));
  scales.energy = Math.max(scales.energy, ...rows.map((row) => row.begun));
  scales.velocity = [Math.min(scales.velocity[0], -0.1 * speed), Math.max(scales.velocity[1], 0.1 * speed)];
  return scales;
}

// Enlarge the axes of `scales` to contain the state `now`. The margin is the fraction `spare` of the length of an axis. Return true if the
// axes have changed.
function widened(scales, lane, mass, now, length, spare) {
  const last = now.position.length - 1, factor = 1 + spare;
  let grown = false, energy = now.stored + now.absorbed, left = 0, right = 0;
  for (let j = 0; j <= last; j++) {
    const v = now.velocity[j], momentum = mass[j] * v;
    energy += 0.5 * momentum * v;
    if (momentum > 0) right += momentum; else left += momentum;
    if (v > scales.velocity[1]) { scales.velocity[1] = factor * v; grown = true; }
    if (v < scales.velocity[0]) { scales.velocity[0] = factor * v; grown = true; }
  }
  for (let i = 0; i < last; i++) {
    const force = FORCE_MARGIN * Math.abs(now.force[i]);
    if (force > scales.force[lane]) { scales.force[lane] = factor * force; grown = true; }
  }
  if (energy > scales.energy) { scales.energy = factor * energy; grown = true; }
  if (left < scales.momentum[0]) { scales.momentum[0] = factor * left; grown = true; }
  if (right > scales.momentum[1]) { scales.momentum[1] = factor * right; grown = true; }
  const margin = 0.4 * length, low = now.position[0] - margin, high = now.position[last] + (last + 1) * length + margin;
  const beyond = spare * (scales.window[1] - scales.window[0]) || 0;
  if (low < scales.window[0]) { scales.window[0] = low - beyond; grown = true; }
  if (high > scales.window[1]) { scales.window[1] = high + beyond; grown = true; }
  const deepest = scales.deepest[lane];
  for (let i = 0; i < last; i++) if (now.overlap[i] > deepest[i]) deepest[i] = now.overlap[i];
  return grown;
}

// Use a common force axis for all lanes, unless the force bars of a lane would become too low.
function shareForces(scales) {
  const most = Math.max(...scales.force), least = Math.min(...scales.force.filter((force) => force > 0), most);
  scales.force = scales.force.map((force) => (most < READABLE * least ? most : force) || 1e-12);
}

const READABLE = 3; // Largest ratio of the force axes of two lanes at which they share one axis.
// Largest drawn overlap in lengths of a bead, and largest magnification of overlaps. Films use the same values.
const DRAWN_OVERLAP = 0.22, MOST_MAGNIFIED = 1e6;

function magnified(scales, length) {
  const deepest = Math.max(...scales.deepest.flat()), wanted = deepest > 0 ? DRAWN_OVERLAP * length / deepest : 1;
  return wanted > 1 && wanted < MOST_MAGNIFIED ? roundDown(wanted) : 1;
}
