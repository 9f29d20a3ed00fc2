// What happened, in words: who goes where, and what two rigid bodies would have done.

const TOGETHER = 0.15; // of the closing speed: beads whose velocities differ by less go together
const STANDS = 0.1; // of the closing speed: a slower bead nearly stands still
const MOST_GROUPS = 5; // that are named one by one

/**
 * The sentences for a row that has come apart; a wall that rests is not spoken of.
 * @param {Float64Array} velocity @param {(number|null)[]} mass null for a wall @param {number} speed the closing speed
 */
function whatHappened(velocity, mass, speed) {
  const groups = [];
  for (let k = 0; k < velocity.length; k++) {
    const group = groups.at(-1), way = wayOf(velocity[k], speed), isWall = mass[k] === null;
    if (isWall && !way) continue;
    const beside = group?.at(-1) === k - 1 && !isWall && mass[k - 1] !== null, first = beside ? velocity[group[0]] : NaN;
    if (Math.abs(velocity[k] - first) < TOGETHER * speed && way === wayOf(first, speed)) group.push(k); else groups.push([k]);
  }
  const said = groups.slice(0, MOST_GROUPS).map((group) => groupWords(group, velocity, mass, speed));
  if (groups.length > MOST_GROUPS) said.push(say("more groups", { n: groups.length - MOST_GROUPS }));
  return said.join(" ");
}

// 1 to the right, -1 to the left, 0 for a bead that nearly stands still.
const wayOf = (v, speed) => (Math.abs(v) < STANDS * speed ? 0 : Math.sign(v));

function groupWords(group, velocity, mass, speed) {
  const speeds = group.map((k) => Math.abs(velocity[k])), one = mass[group[0]] === null ? "wall" : group.length === 1 ? "bead" : "beads";
  const way = wayOf(velocity[group[0]], speed);
  const beads = group.length === 1 ? String(group[0]) : say(group.length === 2 ? "two of" : "row of", { first: group[0], last: group.at(-1) });
  if (!way) return say(`${one} still`, { beads });
  const [low, high] = [Math.min(...speeds), Math.max(...speeds)].map((v) => speedText(v, speed));
  const value = low === high ? low : say("from to", { low, high });
  return say(`${one} ${way > 0 ? "right" : "left"}`, { beads, speed: value });
}

const speedText = (v, speed) => fixed(v, Math.max(0, 2 - Math.floor(Math.log10(speed) + 1e-9)));

// The velocities of two rigid bodies after they have met, where two clusters of touching beads, each with one velocity, are left alone
// and do not come nearer by their present `velocity`.
function rigidWords(spec, { dissipative, driven, pulls }, length, velocity) {
  const meeting = spec.velocity.findIndex((v, k) => v > (spec.velocity[k + 1] ?? v));
  const before = spec.velocity.slice(0, meeting + 1), after = spec.velocity.slice(meeting + 1);
  if (meeting < 0 || spec.mass.includes(null) || before.some((v) => v !== before[0]) || after.some((v) => v !== after[0])) return "";
  if (spec.gap.some((wide, k) => (k === meeting ? -wide : Math.abs(wide)) > LEAST_GAP * length)) return ""; // three, or pressed at the start
  if (dissipative || driven || pulls || velocity[meeting] - velocity[meeting + 1] > STANDS * spec.speed) return "";
  const sum = (masses) => masses.reduce((total, mass) => total + mass, 0);
  const left = sum(spec.mass.slice(0, meeting + 1)), right = sum(spec.mass.slice(meeting + 1));
  const centre = (left * before[0] + right * after[0]) / (left + right), reflected = (w) => speedText(2 * centre - w, spec.speed);
  return say("if rigid", { left: reflected(before[0]), right: reflected(after[0]) });
}
