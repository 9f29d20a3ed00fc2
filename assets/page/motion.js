// The recorded motion: decoding its samples, and its values at any time, by straight lines between two samples.

function decoded(lane, scales) {
  const bytes = Uint8Array.from(atob(lane.data), (letter) => letter.charCodeAt(0));
  const rows = lane.rows, beads = lane.mass.length, contacts = beads - 1;
  const floats = new Float32Array(bytes.buffer, 0, rows * (4 + contacts));
  const codes = new Int16Array(bytes.buffer, floats.byteLength, rows * (beads + contacts));
  const column = (values, k) => values.subarray(k * rows, (k + 1) * rows);
  const fastest = Math.max(...scales.velocity.map(Math.abs));
  const scaled = (values, largest) => Float64Array.from(values, (code) => largest * code / 32767);
  const motion = { ...lane, beads, contacts, time: column(floats, 0), position: column(floats, 1), stored: column(floats, 2),
    absorbed: column(floats, 3), overlap: [], velocity: [], force: [] };
  for (let k = 0; k < contacts; k++) {
    motion.overlap.push(Float64Array.from(column(floats, 4 + k), (part) => part * lane.depth[k]));
    motion.force.push(scaled(column(codes, beads + k), scales.force));
  }
  for (let k = 0; k < beads; k++) motion.velocity.push(scaled(column(codes, k), fastest));
  return motion;
}

// Values of a lane at `time`: arrays from left to right; `state` of a contact is "open", "touching" or "loaded".
function valuesAt(motion, time) {
  const { row, share } = place(motion.time, time);
  const at = (column) => column[row] + share * (column[Math.min(row + 1, column.length - 1)] - column[row]);
  const overlap = motion.overlap.map(at);
  const position = new Array(motion.beads);
  position[0] = 0;
  for (let k = 0; k < motion.contacts; k++) position[k + 1] = position[k] - overlap[k];
  const shift = at(motion.position) - position[motion.anchor];
  return {
    overlap, position: position.map((x) => x + shift), velocity: motion.velocity.map(at), force: motion.force.map(at),
    stored: at(motion.stored), absorbed: at(motion.absorbed),
    state: motion.closed.map((spans, k) => stateOf(spans, time, overlap[k], motion.preloads[k])),
  };
}

function stateOf(spans, time, overlap, preload) {
  const closed = spans.some(([begin, end]) => time >= begin && (end === null || time < end));
  return closed ? (overlap > 0 || preload === 0 ? "loaded" : "touching") : "open";
}

// The row at or before `time`, and how far `time` lies on the way to the next one, from 0 to 1.
function place(times, time) {
  let low = 0, high = times.length - 1;
  if (time >= times[high]) return { row: high, share: 0 };
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (times[middle] <= time) low = middle; else high = middle;
  }
  return { row: low, share: Math.max(0, (time - times[low]) / (times[low + 1] - times[low])) };
}

// The times at which contacts of any lane close or open, ascending.
function switchTimes(motions) {
  const found = motions.flatMap((motion) => motion.closed.flat(2)).filter((time) => time !== null);
  return [...new Set(found)].sort((a, b) => a - b);
}
