// The live source: rows under one clock, computed frame by frame; it remembers the last minute, so that one can wind back.

const FRAME_RATE = 120; // model frames in a second of the wall, as in the window
const LONGEST = 0.1; // wall seconds that are caught up after a pause of the page
const BUDGET = 10; // wall milliseconds of physics in a picture
const REMEMBERED = 3600; // kept states, a minute of them
const FRAMES_KEPT = 2; // frames from one kept state to the next
const LOOK_AHEAD = 60; // seconds of the wall that a run is followed before it is played
const MOST_LOOKED = 1.5e6; // contacts times steps for that: half a second on a slow machine
const MOST_AT_ONCE = 3e5, FRAMES_AT_ONCE = 3600; // the same for a picture on the way to another moment, and frames
const TAIL = 1.5; // seconds of the wall after the rows have come apart or to rest
const LONGEST_SLIDE = 30; // longest time of sliding to rest that a run includes, in seconds of the wall
const LINGER = 6; // the same where the end was not known
const BEFORE_HIT = 0.25; // of the time from the first hit to the end: the longest flight that is played before it

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

  /** Begin anew. @param {Spec[]} specs a row each @param {number} pace seconds of motion for those that the scene plays */
  begin(specs, pace) {
    this.rows = specs.map((spec, k) => new Row(this.instances[k], this.data.kernel, spec));
    this.nows = specs.map((spec) => emptyNow(spec.gap.length));
    this.setPace(1); // how far the run is followed, and where it ends, is the same at every pace
    this.scales = this.lookAhead();
    for (const row of this.rows) row.begin();
    const flight = Math.max(0, Math.floor((this.hit - BEFORE_HIT * (this.end - this.hit)) / this.frameTime));
    for (let k = 0; k < flight; k++) this.frame(null);
    this.setPace(pace);
    const before = this.kept ?? [], rooms = this.rows.map((row) => row.width * REMEMBERED);
    this.kept = rooms.map((room, lane) => (before[lane]?.length === room ? before[lane] : new Float64Array(room)));
    this.branch += 1; // what charts have drawn of another one is not true of this one
    this.first = this.count = 0; // of kept states: the oldest is number `first`, the newest `count - 1`
    this.shown = 0;
    this.touched = false;
    this.hand = null;
    this.due = this.sinceKept = this.apartFor = 0;
    this.keep();
  }

  setPace(pace) {
    this.pace = pace;
    this.slow = this.data.slow / pace;
    this.frameTime = 1 / (FRAME_RATE * this.slow);
    this.steps = Math.max(...this.rows.map((row) => row.stepsOf(this.frameTime)));
  }

  get time() { return this.rows[0].kernel.time; }

  get begun() { return this.timeOf(this.first); }

  // Whether the end is not known: somebody has touched the run, or it was not followed so far.
  get open() { return this.touched || !(this.followed || this.data.duration); }

  // The end of the run, as far as it is known.
  get last() { return Math.max(this.touched ? 0 : this.end, this.timeOf(this.count - 1)); }

  timeOf(number) { return this.kept[0][(number % REMEMBERED) * this.rows[0].width]; }

  frame(hand) {
    this.rows.forEach((row, lane) => row.frame(this.frameTime, this.steps, this.slow, hand && hand.lane === lane ? hand : null));
  }

  // Frames that take so many steps of contacts.
  framesOf(work) { return Math.ceil(work / (this.steps * this.rows.reduce((sum, row) => sum + row.kernel.n, 0))); }

  // Follow the run to its end, if patience lasts, for its axes and its length; rows are moved, and begin again afterwards.
  lookAhead() {
    const { rows, nows } = this, most = Math.min(LOOK_AHEAD * FRAME_RATE, this.framesOf(MOST_LOOKED)), { duration } = this.data;
    const scales = startScales(this.data, rows), limit = duration ? Math.ceil(duration / this.frameTime) : Infinity;
    let apart = 0, k = 0;
    this.hit = -1;
    /** @type {{time: number, velocity: number[][]}|null} */ this.parted = null; // moment at which rows came apart that friction stops later
    for (; k < limit && k < most && apart < TAIL * FRAME_RATE; k++) {
      this.frame(null);
      rows.forEach((row, lane) => widened(scales, lane, row.mass, row.read(nows[lane]), this.data.length, 0));
      if (this.hit < 0 && nows.some((now) => now.force.some((f) => f > 0))) this.hit = rows[0].kernel.time;
      apart = this.apart ? apart + 1 : 0;
      const sliding = apart && this.slow * Math.max(...rows.map((row) => row.sliding));
      if (sliding && duration) apart = 0; // beads that friction slows are followed to the duration of the scene
      if (!sliding || duration || sliding > LONGEST_SLIDE) continue;
      this.parted ??= { time: rows[0].kernel.time, velocity: nows.map(({ velocity }) => Array.from(velocity)) };
      apart = 0;
    }
    this.hit = Math.max(this.hit, 0);
    this.followed = k >= limit || apart >= TAIL * FRAME_RATE; // or else patience has ended before the run
    this.end = this.followed || !duration ? rows[0].kernel.time : duration;
    shareForces(scales);
    scales.magnify = this.data.magnify ?? magnified(scales, this.data.length);
    return scales;
  }

  // Move on by wall seconds, at most as far as there is time for.
  advance(seconds) {
    this.forget();
    this.due += Math.min(seconds, LONGEST) * FRAME_RATE;
    const count = Math.round(this.due), started = performance.now();
    this.due -= count;
    for (let k = 0; k < count && !this.over && (k === 0 || performance.now() - started < BUDGET); k++) this.next();
  }

  next() {
    this.frame(this.hand);
    if (this.hand) this.touched = true;
    this.sinceKept += 1;
    this.apartFor = this.apart && !this.hand ? this.apartFor + 1 / FRAME_RATE : 0;
    if (this.sinceKept >= FRAMES_KEPT || this.over) this.keep();
  }

  // Whether all rows have come apart or to rest.
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

  // What came after the moment shown is not kept once the motion goes on from there, or is changed.
  forget() {
    if (this.shown >= this.count - 1) return;
    this.count = this.shown + 1;
    this.branch += 1;
  }

  // Show another moment: one that is kept, or computed on the way to it, a part at a time. Whether it is there.
  go(time) {
    if (time <= this.timeOf(this.count - 1)) { this.restore(this.numberAt(time)); return true; }
    this.restore(this.count - 1);
    const end = Math.min(time, this.last) - 0.5 * this.frameTime, most = Math.min(FRAMES_AT_ONCE, this.framesOf(MOST_AT_ONCE));
    for (let k = 0; k < most && this.time < end; k++) this.next();
    this.keep();
    return this.time >= end;
  }

  // The number of the last kept state that is not after `time`, or the first one.
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

  // One kept state on, or back.
  step(direction) {
    if (direction > 0 && this.shown >= this.count - 1) { for (let k = 0; k < FRAMES_KEPT; k++) this.next(); this.keep(); }
    else this.restore(Math.min(Math.max(this.shown + direction, this.first), this.count - 1));
  }

  // Change rows by hand: the future is another one.
  change(edit) {
    this.forget();
    edit();
    this.touched = true;
    this.apartFor = 0;
    this.setPace(this.pace); // in the steps of the laws that hold now
  }

  values(lane) { return this.rows[lane].read(this.nows[lane]); }

  // Times and values of a lane for a chart, at most `most` of them: (time, array, place of the first value in it). The first is the one
  // at `since`, up to which they are known.
  trace(lane, channel, most, since, visit) {
    const row = this.rows[lane], { n } = row.kernel, from = HEAD + (channel === "velocity" ? 3 * n : 2 * n), kept = this.kept[lane];
    const every = Math.max(1, Math.ceil((this.count - this.first) / most)), end = this.count - 1, begin = Math.max(this.first, this.numberAt(since));
    for (let k = begin; k <= end; k = k === end ? k + 1 : Math.min(every * Math.floor(k / every + 1), end)) {
      const at = (k % REMEMBERED) * row.width;
      visit(kept[at], kept, at + from);
    }
  }
}

// Axes before anything has moved.
function startScales(data, rows) {
  const speed = Math.max(...rows.map((row) => row.spec.speed));
  const scales = { window: [Infinity, -Infinity], velocity: [0, 0], force: rows.map(() => 0), pull: 0, energy: 0, momentum: [0, 0], magnify: 1,
    deepest: rows.map((row) => new Array(row.kernel.n).fill(0)) };
  rows.forEach((row, lane) => widened(scales, lane, row.mass, row.read(emptyNow(row.kernel.n)), data.length, 0));
  scales.energy = Math.max(scales.energy, ...rows.map((row) => row.begun));
  scales.velocity = [Math.min(scales.velocity[0], -0.1 * speed), Math.max(scales.velocity[1], 0.1 * speed)];
  return scales;
}

// Let the axes of `scales` hold `now`, with `spare` of their length beyond; whether they had to grow.
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

// Lanes have one axis of forces, but where one would then be too low to be read.
function shareForces(scales) {
  const most = Math.max(...scales.force), least = Math.min(...scales.force.filter((force) => force > 0), most);
  scales.force = scales.force.map((force) => (most < READABLE * least ? most : force) || 1e-12);
}

const READABLE = 3; // times as high is another lane's axis at most
const DRAWN_OVERLAP = 0.22, MOST_MAGNIFIED = 1e6; // of a bead's length; as in films

function magnified(scales, length) {
  const deepest = Math.max(...scales.deepest.flat()), wanted = deepest > 0 ? DRAWN_OVERLAP * length / deepest : 1;
  return wanted > 1 && wanted < MOST_MAGNIFIED ? roundDown(wanted) : 1;
}
