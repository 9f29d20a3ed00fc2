// A chain in the memory of kernels.wasm. The module contains the arrays of the chain and the call that advances it by one frame.

const MOST_STEPS = 100000; // Largest number of time steps per call of the kernel.
const NEVER = 0x40000000; // High word of a step count that is never reached. With it, the kernel makes no checkpoint.
const DONE = 0; // Status that the kernel returns if the end of the time interval was reached.
const COUNTER_WORDS = 2; // Number of 32-bit words per counter.

class Kernel {
  /**
   * @param {WebAssembly.Instance} instance of kernels.wasm whose memory is used only by this chain
   * @param {{beadRows: number, workRows: number, counters: number}} sizes numbers of rows in the work arrays, and of counters
   * @param {number} n number of contacts
   * @param {number} anchorBead index of the bead whose position and velocity are stored
   */
  constructor(instance, sizes, n, anchorBead) {
    const { memory, __heap_base: base, march, march_lossy: marchLossy } = /** @type {any} */ (instance.exports);
    let at = (base.value + 15) & ~15;
    const place = (Kind, size) => {
      const room = at + size * Kind.BYTES_PER_ELEMENT - memory.buffer.byteLength;
      // Enlarge the memory before any array is created. Enlarging it later would detach the existing arrays.
      if (room > 0) memory.grow(Math.ceil(room / 65536));
      const found = { Kind, at, size };
      at = (at + size * Kind.BYTES_PER_ELEMENT + 7) & ~7;
      return found;
    };
    const doubles = (size) => place(Float64Array, size);
    const places = {
      law: doubles(3 * n), inverseMass: doubles(n + 1), push: doubles(n + 1), overlap: doubles(n), rate: doubles(n), anchor: doubles(2),
      force: doubles(n), absorbed: doubles(2), closed: place(Uint8Array, n), counter: place(Int32Array, COUNTER_WORDS * sizes.counters),
      plan: place(Int32Array, 6), beads: doubles(sizes.beadRows * (n + 1)), work: doubles(sizes.workRows * n), reached: doubles(1),
      result: place(Int32Array, 2), loss: doubles(n), bed: doubles(n + 1), rest: doubles(n + 1),
    };
    const array = (name) => { const { Kind, at: from, size } = places[name]; return new Kind(memory.buffer, from, size); };
    this.n = n;
    this.anchorBead = anchorBead;
    this.march = march;
    this.marchLossy = marchLossy;
    /** @type {Float64Array} */ this.law = array("law");
    /** @type {Float64Array} */ this.inverseMass = array("inverseMass");
    /** @type {Float64Array} */ this.push = array("push");
    /** @type {Float64Array} */ this.overlap = array("overlap");
    /** @type {Float64Array} */ this.rate = array("rate");
    /** @type {Float64Array} */ this.anchor = array("anchor");
    /** @type {Float64Array} */ this.force = array("force");
    /** @type {Float64Array} */ this.absorbed = array("absorbed");
    /** @type {Float64Array} */ this.loss = array("loss");
    /** @type {Float64Array} */ this.bed = array("bed");
    /** @type {Float64Array} */ this.rest = array("rest"); // Overlaps and position of the anchor bead of a row on strings at rest.
    this.swing = 0; // Squared angular frequency of beads on strings in 1/s²; 0 without strings.
    this.closed = array("closed");
    this.counter = array("counter");
    this.reached = array("reached");
    this.result = array("result");
    array("plan").set([0, 0, 0, NEVER, 0, 0]);
    const names = ["law", "inverseMass", "push", "overlap", "rate", "anchor", "force", "absorbed", "reached", "reached", "closed",
      "counter", "plan", "beads", "work", "reached", "rest"];
    this.arrays = names.map((name) => places[name].at);
    this.lossArrays = [places.loss.at, places.bed.at];
    this.time = 0;
  }

  // Advance the chain by `duration` in time steps of `step`. If `pushed` is true, the forces in `push` act on the beads. Return true if the
  // end was reached.
  advance(duration, step, pushed) {
    const { n, overlap, force, closed } = this, slides = this.bed.some((value) => value > 0);
    this.counter.fill(0);
    for (let i = 0; i < n; i++) closed[i] = overlap[i] > 0 || (overlap[i] === 0 && force[i] > 0) ? 1 : 0;
    const numbers = [this.result.byteOffset, this.result.byteOffset + 4, n, this.anchorBead, pushed ? 1 : 0, 0, MOST_STEPS, step,
      this.time, this.time + duration, this.swing];
    const lossy = slides || this.loss.some((value) => value > 0);
    const failed = lossy ? this.marchLossy(...numbers, ...this.arrays, ...this.lossArrays, slides ? n + 1 : 0)
      : this.march(...numbers, ...this.arrays);
    if (failed) throw new Error("a kernel has raised an exception");
    this.time = this.reached[0];
    return this.result[0] === DONE;
  }

  // Compute the positions or velocities (n+1) from the differences between neighbours and the value of the anchor bead. Write them to
  // `found`.
  rebuilt(differences, value, found) {
    const b = this.anchorBead;
    found[b] = value;
    for (let j = b - 1; j >= 0; j--) found[j] = found[j + 1] + differences[j];
    for (let j = b; j < this.n; j++) found[j + 1] = found[j] - differences[j];
    return found;
  }
}
