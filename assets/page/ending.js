// The outcome of a motion in words. It describes which groups of beads move, and how two rigid bodies would have moved. The rule is the
// same as in sandbox/story/outcome.py.

/**
 * A group of beads that move together, or a moving wall. It has the numbers of its first and last bead and the velocity of its centre of
 * mass.
 * @typedef {{first: number, last: number, velocity: number, state: string, wall: boolean}} Group
 */

/**
 * Return the groups of a row from left to right. Walls at rest are omitted.
 * @param {(number|null)[]} mass null for a wall @param {ArrayLike<number>} start @param {ArrayLike<number>} velocity
 * @returns {Group[]}
 */
function groupsOf(mass, start, velocity) {
  const now = Array.from(velocity), begin = Array.from(start), change = now.map((v, k) => Math.abs(v - begin[k])), wall = (k) => mass[k] === null;
  const largest = (values) => Math.max(0, ...values.map(Math.abs)), speed = largest(begin) || largest(now);
  const finest = STORY.resolution * Math.max(largest(change.filter((_, k) => !wall(k))), STORY.equal * speed);
  // Return the sum of a function of mass and velocity over some beads.
  const sum = (value, first = 0, last = now.length - 1, row = now) => {
    let found = 0;
    for (let k = first; k <= last; k++) if (!wall(k)) found += value(mass[k], row[k]);
    return found;
  };
  const centre = (first, last) => sum((m, v) => m * v, first, last) / sum((m) => m, first, last);
  // Split a row without walls at the largest difference between the velocities of neighbours. Repeat this until the beads of each part move
  // together.
  const split = (first, last) => {
    const part = now.slice(first, last + 1), allowed = STORY.together * Math.min(...change.slice(first, last + 1));
    if (Math.max(...part) - Math.min(...part) <= Math.max(allowed, finest)) return [{ first, last }];
    const jumps = part.slice(1).map((v, k) => Math.abs(v - part[k])), widest = (1 - STORY.equal) * largest(jumps);
    // If several differences are equally large, use the difference nearest to the middle.
    const off = (k) => Math.abs(k - 0.5 * (jumps.length - 1));
    const at = first + [...jumps.keys()].filter((k) => jumps[k] >= widest).sort((a, b) => off(a) - off(b))[0];
    return [...split(first, at), ...split(at + 1, last)];
  };
  const groups = [];
  for (let first = 0, k = 0; k <= now.length; k++) {
    if (k < now.length && !wall(k)) continue;
    if (k > first) groups.push(...split(first, k - 1));
    if (k < now.length) groups.push({ first: k, last: k });
    first = k + 1;
  }
  // Starting with the least momentum, slow groups stand still while their total shares of momentum and energy are small.
  const heft = (m, v) => m * Math.abs(v), work = (m, v) => m * v * v, most = (value) => Math.max(sum(value), sum(value, 0, now.length - 1, begin));
  for (const group of groups) {
    const { first, last } = group;
    group.wall = wall(first);
    group.velocity = group.wall ? now[first] : centre(first, last);
    group.carried = Math.abs(sum((m, v) => m * v, first, last));
  }
  const slow = groups.filter((group) => !group.wall && Math.abs(group.velocity) <= STORY.slow * speed);
  slow.sort((a, b) => a.carried - b.carried);
  for (let next = 0, carried = 0, held = 0; next < slow.length;) {
    const limit = (1 + STORY.equal) * slow[next].carried, equal = slow.filter((group, k) => k >= next && group.carried <= limit);
    for (const group of equal) { carried += group.carried; held += sum(work, group.first, group.last); }
    if (carried > STORY.momentum * most(heft) || held > STORY.energy * most(work)) break;
    for (const group of equal) group.still = true; // Groups with the same momentum either all stand still or all move.
    next += equal.length;
  }
  const joined = [];
  for (const group of groups) {
    const { still, first, last } = group, other = joined.at(-1);
    if (still && other?.still && other.last === first - 1) {
      other.last = last;
      other.velocity = centre(other.first, last);
    } else joined.push(group);
  }
  const rests = ({ first, last }) => largest(now.slice(first, last + 1)) <= STORY.stands * speed;
  for (const group of joined) group.state = !group.still ? "moves" : rests(group) ? "still" : "nearly still";
  return joined.filter((group) => !group.wall || !rests(group));
}

/**
 * Return sentences about a row whose beads have separated.
 * @param {ArrayLike<number>} velocity @param {{mass: (number|null)[], velocity: number[]}} spec
 */
function whatHappened(velocity, spec) {
  const groups = groupsOf(spec.mass, spec.velocity, velocity), rest = groups.length - STORY.groups;
  const said = groups.slice(0, STORY.groups).map(groupWords);
  if (rest > 0) said.push(say(rest === 1 ? "more group" : "more groups", { n: rest }));
  return said.join(" ");
}

/** @param {Group} group */
function groupWords({ first, last, velocity, state, wall }) {
  const count = last - first + 1, kind = wall ? "wall" : count === 1 ? "bead" : "beads";
  const way = state !== "moves" ? state : velocity > 0 ? "right" : "left";
  const beads = count === 1 ? String(first) : say(count === 2 ? "two of" : "row of", { first, last });
  return say(`${kind} ${way}`, { beads, speed: speedText(Math.abs(velocity)) });
}

// Return a speed [m/s] with its unit.
const speedText = (v) => `${plain(v, STORY.digits)}\u00a0m/s`;

// Return a sentence with the velocities that two rigid bodies would have after their collision, or "". The sentence applies to two clusters
// of touching beads without external forces. Each cluster must have a single velocity at the start. The clusters must not approach each
// other with the current `velocity`.
function rigidWords(spec, { dissipative, driven, pulls }, length, velocity) {
  const meeting = spec.velocity.findIndex((v, k) => v > (spec.velocity[k + 1] ?? v));
  const before = spec.velocity.slice(0, meeting + 1), after = spec.velocity.slice(meeting + 1);
  if (meeting < 0 || spec.mass.includes(null) || before.some((v) => v !== before[0]) || after.some((v) => v !== after[0])) return "";
  // There are three or more clusters, or contacts are compressed at the start.
  if (spec.gap.some((wide, k) => (k === meeting ? -wide : Math.abs(wide)) > LEAST_GAP * length)) return "";
  if (dissipative || driven || pulls || velocity[meeting] - velocity[meeting + 1] > STORY.slow * spec.speed) return "";
  const sum = (masses) => masses.reduce((total, mass) => total + mass, 0);
  const left = sum(spec.mass.slice(0, meeting + 1)), right = sum(spec.mass.slice(meeting + 1));
  const centre = (left * before[0] + right * after[0]) / (left + right), reflected = (w) => 2 * centre - w;
  return say("if rigid", { left: plain(reflected(before[0]), STORY.digits), right: speedText(reflected(after[0])) });
}
