// The recorded source. It contains packed samples of a motion. Values between two samples are interpolated linearly.

const LARGEST_CODE = 32767; // Largest integer code of a velocity or force.
const SHOWN_RATE = 240; // Number of steps with which the user can step through the complete motion.

class Recorded {
  /** @param {any} data of the page, each of whose lanes has a `recorded` motion */
  constructor(data) {
    /** @type {false} */ this.live = false;
    this.scales = { ...data.scales, force: data.lanes.map(() => data.scales.force), deepest: data.lanes.map(() => []) };
    this.motions = data.lanes.map((lane) => decoded(lane, data.scales));
    this.nows = this.motions.map((motion) => emptyNow(motion.contacts));
    this.motions.forEach((motion, k) => {
      this.scales.deepest[k] = motion.overlap.map((column) => column.reduce((most, depth) => Math.max(most, depth), 0));
    });
    this.begun = Math.max(...this.motions.map(({ time }) => time[0]));
    this.last = Math.max(...this.motions.map(({ time }) => time.at(-1)));
    const closed = this.motions.flatMap((motion) => motion.closed.flat()).map(([time]) => time);
    const hit = closed.length ? Math.min(...closed) : this.begun;
    this.begun = Math.max(this.begun, hit - BEFORE_HIT * (this.last - hit));
    this.slowest = data.slow;
    this.setPace(1);
    this.time = this.begun;
    this.touched = this.open = false;
    this.followed = true;
    this.hand = this.parted = null;
    this.branch = 0;
  }

  setPace(pace) { this.slow = this.slowest / pace; }

  get over() { return this.time >= this.last; }

  get apart() { return this.over && this.motions.every((motion) => motion.closed.flat().every((span) => span[1] !== null)); }

  advance(seconds) { this.go(this.time + Math.min(seconds, LONGEST) / this.slow); }

  go(time) {
    if (time < this.time) this.branch += 1;
    this.time = Math.min(Math.max(time, this.begun), this.last);
    return true;
  }

  step(direction) { this.go(this.time + direction * (this.last - this.begun) / SHOWN_RATE); }

  values(lane) { return valuesAt(this.motions[lane], this.time, this.nows[lane]); }

  // Return the values of a lane at the sample with the largest force.
  peak(lane) {
    const motion = this.motions[lane], { force, time } = motion;
    const largest = Array.from(time, (_, row) => Math.max(...force.map((column) => column[row])));
    const now = valuesAt(motion, time[largest.indexOf(Math.max(...largest))], emptyNow(motion.contacts));
    now.time = time[largest.indexOf(Math.max(...largest))];
    return now;
  }

  // Call `visit(time, now)` for the samples of a lane, at most `most` times.
  each(lane, most, visit) {
    const motion = this.motions[lane], every = Math.ceil(motion.time.length / most), now = emptyNow(motion.contacts);
    for (let row = 0; row < motion.time.length; row += every) visit(motion.time[row], valuesAt(motion, motion.time[row], now));
  }

  // Pass the times and values of a lane up to the current time to a chart, like the live source. All samples are passed, because there are
  // only a few.
  trace(lane, channel, _most, since, visit) {
    const motion = this.motions[lane], { [channel]: columns } = motion, begin = Math.max(since, this.begun);
    const at = (time) => visit(time, Float64Array.from(valuesAt(motion, time, this.nows[lane])[channel]), 0);
    at(Math.min(begin, this.time));
    for (let k = placeOf(motion.time, begin).row; k < motion.time.length && motion.time[k] < this.time; k++) {
      if (motion.time[k] > begin) visit(motion.time[k], columns.map((column) => column[k]), 0);
    }
    at(this.time);
  }
}

function decoded(lane, scales) {
  const { data, rows, depth, anchor, closed } = lane.recorded;
  const bytes = Uint8Array.from(atob(data), (letter) => letter.charCodeAt(0));
  const beads = lane.spec.mass.length, contacts = beads - 1;
  const floats = new Float32Array(bytes.buffer, 0, rows * (4 + contacts));
  const codes = new Int16Array(bytes.buffer, floats.byteLength, rows * (beads + contacts));
  const column = (values, k) => values.subarray(k * rows, (k + 1) * rows);
  const fastest = Math.max(...scales.velocity.map(Math.abs));
  const scaled = (values, largest) => Float64Array.from(values, (code) => largest * code / LARGEST_CODE);
  const each = (count, make) => Array.from({ length: count }, (_, k) => make(k));
  return { contacts, anchor, closed, time: column(floats, 0), position: column(floats, 1), stored: column(floats, 2),
    absorbed: column(floats, 3), ends: lane.ends.map(Number),
    overlap: each(contacts, (k) => Float64Array.from(column(floats, 4 + k), (part) => part * depth[k])),
    force: each(contacts, (k) => scaled(column(codes, beads + k), scales.force)),
    velocity: each(beads, (k) => scaled(column(codes, k), fastest)) };
}

/** Write the values of a recorded lane at `time` to `now`. @param {any} motion @param {number} time @param {Now} now */
function valuesAt(motion, time, now) {
  const { row, share } = placeOf(motion.time, time);
  const at = (column) => column[row] + share * (column[Math.min(row + 1, column.length - 1)] - column[row]);
  const { contacts, anchor } = motion, place = at(motion.position);
  for (let k = 0; k < contacts; k++) {
    now.overlap[k] = at(motion.overlap[k]);
    now.force[k] = at(motion.force[k]);
    const closed = motion.closed[k].some(([begin, end]) => time >= begin && (end === null || time < end));
    const touches = closed || now.overlap[k] === 0 ? "touching" : "open";
    now.state[k] = now.force[k] < 0 ? "pulled" : now.overlap[k] > 0 && closed ? "loaded" : touches;
  }
  for (let k = 0; k <= contacts; k++) now.velocity[k] = at(motion.velocity[k]);
  now.position[anchor] = place;
  for (let k = anchor - 1; k >= 0; k--) now.position[k] = now.position[k + 1] + now.overlap[k];
  for (let k = anchor; k < contacts; k++) now.position[k + 1] = now.position[k] - now.overlap[k];
  now.stored = at(motion.stored);
  now.absorbed = at(motion.absorbed);
  now.ends.set(motion.ends);
  return now;
}

// Return the number of the last sample at or before `time`. Also return the position of `time` between this sample and the next one, from 0
// to 1.
function placeOf(times, time) {
  let low = 0, high = times.length - 1;
  if (time >= times[high]) return { row: high, share: 0 };
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (times[middle] <= time) low = middle; else high = middle;
  }
  return { row: low, share: Math.max(0, (time - times[low]) / (times[low + 1] - times[low])) };
}
