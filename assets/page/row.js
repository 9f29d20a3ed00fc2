// A row of beads that moves. The module contains its contact laws, its energy balance, and the hand that pulls a bead.

const GRAVITY = 9.80665; // Gravitational acceleration in m/s².
// Smallest speed at which a closing contact counts as struck, as a fraction of the closing speed. A rigid cluster ends at a struck contact.
const STRUCK = 0.2;
// Largest difference between the initial velocities of neighbours that count as equal, as a fraction of the closing speed.
const ALIKE = 1e-6;
const FLOWN = 20; // Factor by which a frame of a row on strings may have more time steps. The steps without contact are computed together.
const HEAD = 8; // Number of values in a stored state before its lists.

/**
 * The initial state and the contact laws of a row. Masses, gaps and velocities are listed from left to right.
 * @typedef {{mass: (number|null)[], gap: number[], velocity: number[], law: number[], loss: number[], friction: number,
 *   drive: number[]|null, speed: number, swing: number, strings: number|null}} Spec
 */

class Row {
  /** @param {WebAssembly.Instance} instance @param {any} sizes @param {Spec} spec */
  constructor(instance, sizes, spec) {
    const n = spec.gap.length, weights = spec.mass.map((mass) => mass ?? Infinity);
    this.spec = spec;
    this.kernel = new Kernel(instance, sizes, n, weights.indexOf(Math.max(...weights)));
    this.kernel.inverseMass.set(weights.map((mass) => 1 / mass));
    this.mass = weights.map((mass) => (mass === Infinity ? 0 : mass));
    // The energy balance does not include the work of a moving wall.
    this.balanced = !spec.mass.some((mass, k) => mass === null && spec.velocity[k]);
    this.position = new Float64Array(n + 1);
    this.velocity = new Float64Array(n + 1);
    this.before = new Float64Array(n + 1);
    this.rateBefore = new Float64Array(n);
    this.wasClosed = new Uint8Array(n);
    this.ends = new Uint8Array(n); // The value is 1 for a contact at which a cluster ends because the contact was struck.
    this.begin();
  }

  // Reset the row to its initial state.
  begin() {
    const { kernel, spec, mass } = this, { n, anchorBead } = kernel;
    kernel.law.set(spec.law);
    kernel.loss.set(spec.loss);
    kernel.bed.set(mass.map((m) => (m > 0 ? spec.friction * GRAVITY : 0)));
    const place = new Float64Array(n + 1);
    for (let i = 0; i < n; i++) {
      place[i + 1] = place[i] + spec.gap[i];
      kernel.overlap[i] = -spec.gap[i] || 0;
      kernel.rate[i] = spec.velocity[i] - spec.velocity[i + 1];
      kernel.force[i] = spec.gap[i] < 0 ? this.lawForce(i) : 0;
    }
    kernel.anchor.set([place[anchorBead], spec.velocity[anchorBead]]);
    kernel.rest.set([...kernel.overlap, place[anchorBead]]);
    kernel.swing = spec.swing;
    this.place = place;
    kernel.absorbed.fill(0);
    kernel.time = 0;
    for (let i = 0; i < n; i++) this.ends[i] = Math.abs(kernel.rate[i]) > ALIKE * spec.speed ? 1 : 0;
    this.begun = this.energy();
    this.given = this.driven = this.still = 0; // Work of the hand, work of the drive, and number of frames in which nothing moved.
  }

  lawForce(i) {
    const { law, overlap } = this.kernel;
    return overlap[i] > 0 ? law[3 * i] + law[3 * i + 1] * overlap[i] ** law[3 * i + 2] : 0;
  }

  stored(i) {
    const { law, overlap } = this.kernel, d = overlap[i];
    return d > 0 ? (law[3 * i] + law[3 * i + 1] * d ** law[3 * i + 2] / (1 + law[3 * i + 2])) * d : 0;
  }

  energy() {
    const { kernel, mass } = this, { n, absorbed } = kernel, velocity = kernel.rebuilt(kernel.rate, kernel.anchor[1], this.velocity);
    let sum = absorbed[0] + absorbed[1];
    for (let j = 0; j <= n; j++) sum += 0.5 * mass[j] * velocity[j] ** 2;
    for (let i = 0; i < n; i++) sum += this.stored(i);
    return sum + this.hanging();
  }

  // Return the potential energy of beads on strings, relative to their positions at rest.
  hanging() {
    const { kernel, mass, place } = this, { swing } = kernel;
    if (!swing) return 0;
    const position = kernel.rebuilt(kernel.overlap, kernel.anchor[0], this.position);
    return mass.reduce((sum, m, j) => sum + 0.5 * swing * m * (position[j] - place[j]) ** 2, 0);
  }

  // Return the error of the energy balance, relative to the sum of the initial energy and the external work.
  energyError() {
    const wanted = this.begun + this.given + this.driven;
    return Math.abs(this.energy() - wanted) / Math.max(Math.abs(wanted), this.begun, Number.MIN_VALUE);
  }

  // Return the number of time steps in a frame of `duration` [s]. It depends on the contact laws and the closing speed. The window uses the
  // same rule.
  stepsOf(duration) {
    const { n, law, inverseMass } = this.kernel, { speed } = this.spec;
    let shortest = Infinity;
    for (let i = 0; i < n; i++) {
      const [F, K, a] = law.subarray(3 * i, 3 * i + 3), energy = 0.5 * speed ** 2 / (inverseMass[i] + inverseMass[i + 1]);
      shortest = Math.min(shortest, 2 * Math.min(energy / F, ((1 + a) * energy / K) ** (1 / (1 + a))) / speed);
    }
    const most = Math.max(1, Math.floor(STORY.frameCost * (this.spec.swing ? FLOWN : 1) / (STORY.stepCost * n)));
    return Math.max(1, Math.min(Math.ceil(duration * STORY.contactSteps / shortest - 1e-9), most));
  }

  /**
   * Advance the row by one frame. The force of the hand is constant during the frame.
   * @param {number} duration of the frame [s]
   * @param {number} steps to the frame
   * @param {number} slow seconds of wall time per second of the motion
   * @param {{bead: number, place: number}|null} hand at `place` [m]
   */
  frame(duration, steps, slow, hand) {
    const { kernel } = this, { n, force, rate } = kernel, { drive, speed } = this.spec;
    for (let i = 0; i < n; i++) this.wasClosed[i] = force[i] > 0 ? 1 : 0;
    this.rateBefore.set(rate);
    const pushed = drive !== null || hand !== null;
    let pull = 0;
    if (pushed) {
      this.before.set(kernel.rebuilt(kernel.overlap, kernel.anchor[0], this.position));
      if (drive) kernel.push.set(drive); else kernel.push.fill(0);
      if (hand) { pull = this.pull(hand, slow); kernel.push[hand.bead] += pull; }
    }
    kernel.advance(duration, duration / steps, pushed);
    if (pushed) {
      kernel.rebuilt(kernel.overlap, kernel.anchor[0], this.position);
      const way = (j) => this.position[j] - this.before[j];
      if (drive) drive.forEach((push, j) => { this.driven += push * way(j); });
      if (hand) this.given += pull * way(hand.bead);
    }
    kernel.rebuilt(rate, kernel.anchor[1], this.velocity);
    this.still = this.velocity.every((v) => Math.abs(v) < STORY.atRest * speed) ? this.still + 1 : 0;
    for (let i = 0; i < n; i++) {
      if (this.wasClosed[i] && !(force[i] > 0)) this.ends[i] = 0;
      else if (!this.wasClosed[i] && force[i] > 0) this.ends[i] = this.rateBefore[i] > STRUCK * speed ? 1 : 0;
    }
  }

  // Return the force of the spring between the hand and a bead. The spring is critically damped.
  pull({ bead, place }, slow) {
    const { kernel } = this, frequency = STORY.handFrequency * slow, reach = 2 * STORY.handSpeed * this.spec.speed / frequency;
    kernel.rebuilt(kernel.rate, kernel.anchor[1], this.velocity);
    const stretch = Math.min(Math.max(place - this.position[bead], -reach), reach);
    return (frequency * frequency * stretch - 2 * frequency * this.velocity[bead]) * this.mass[bead];
  }

  // Throw a bead by giving it another velocity at once. The change of its energy counts as external work.
  throwBead(bead, velocity) {
    const { kernel } = this, before = this.energy(), change = velocity - kernel.rebuilt(kernel.rate, kernel.anchor[1], this.velocity)[bead];
    if (bead > 0) kernel.rate[bead - 1] -= change;
    if (bead < kernel.n) kernel.rate[bead] += change;
    if (bead === kernel.anchorBead) kernel.anchor[1] += change;
    this.given += this.energy() - before;
    this.still = 0;
  }

  // True if no contact is closed or can close, or if all beads are at rest. A single frame without motion is not sufficient, because it may
  // be a turning point.
  get apart() {
    const { n, overlap, rate, force } = this.kernel, least = STORY.atRest * this.spec.speed;
    if (this.spec.swing) return false; // Beads on strings meet again after they have separated.
    if (this.still > 1) return true;
    // A moving wall can reach beads that friction has stopped.
    if (this.spec.drive || (this.spec.friction > 0 && !this.balanced)) return false;
    for (let i = 0; i < n; i++) if (force[i] > 0 || overlap[i] > 0 || rate[i] > least) return false;
    return true;
  }

  // Time [s] until friction stops a row whose beads have separated. It is 0 without friction.
  get sliding() {
    const { friction } = this.spec, fastest = Math.max(...this.velocity.map((v, k) => (this.mass[k] ? Math.abs(v) : 0)));
    return friction > 0 && this.still < 2 ? fastest / (friction * GRAVITY) : 0;
  }

  /** Write the values that are needed for drawing to `now`. @param {Now} now */
  read(now) {
    const { kernel } = this, { n, overlap, force, absorbed } = kernel;
    kernel.rebuilt(overlap, kernel.anchor[0], now.position);
    kernel.rebuilt(kernel.rate, kernel.anchor[1], now.velocity);
    now.overlap.set(overlap);
    now.force.set(force);
    now.stored = 0;
    for (let i = 0; i < n; i++) {
      now.state[i] = overlap[i] > 0 ? "loaded" : overlap[i] === 0 ? "touching" : "open";
      now.stored += this.stored(i);
    }
    now.stored += this.hanging();
    now.absorbed = absorbed[0] + absorbed[1];
    now.ends.set(this.ends);
    return now;
  }

  // Number of values in a stored state. The first HEAD values are time, external work, work of the drive, frames at rest, anchor and
  // absorbed energy. The lists of overlaps, rates, forces, velocities and ends of clusters follow.
  get width() { return 5 * this.kernel.n + HEAD + 1; }

  keep(into, at) {
    const { kernel } = this, { n } = kernel, begin = at + HEAD;
    into.set([kernel.time, this.given, this.driven, this.still, ...kernel.anchor, ...kernel.absorbed], at);
    into.set(kernel.overlap, begin);
    into.set(kernel.rate, begin + n);
    into.set(kernel.force, begin + 2 * n);
    into.set(kernel.rebuilt(kernel.rate, kernel.anchor[1], this.velocity), begin + 3 * n);
    into.set(this.ends, begin + 4 * n + 1);
  }

  // Restore a stored state.
  restore(from, at) {
    const { kernel } = this, { n } = kernel, begin = at + HEAD, list = (first, count) => from.subarray(first, first + count);
    [kernel.time, this.given, this.driven, this.still] = list(at, 4);
    kernel.anchor.set(list(at + 4, 2));
    kernel.absorbed.set(list(at + 6, 2));
    kernel.overlap.set(list(begin, n));
    kernel.rate.set(list(begin + n, n));
    kernel.force.set(list(begin + 2 * n, n));
    this.ends.set(list(begin + 4 * n + 1, n));
  }
}

/**
 * The values of a row at one time.
 * @typedef {{position: Float64Array, velocity: Float64Array, overlap: Float64Array, force: Float64Array, state: string[], stored: number,
 *   absorbed: number, ends: Uint8Array, time?: number, contacts?: number[]}} Now
 */
const emptyNow = (n) => ({ position: new Float64Array(n + 1), velocity: new Float64Array(n + 1), overlap: new Float64Array(n),
  force: new Float64Array(n), state: new Array(n).fill("open"), stored: 0, absorbed: 0, ends: new Uint8Array(n) });
