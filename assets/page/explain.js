// The question before a collision, the verdict after it, and the explanation at the moment of the largest force.

const GUESSES = ["last", "together", "spread"]; // possible answers to the question
// Smallest fraction of the kinetic energy that the last beads must carry. Above this value, the answer "only the last ones fly off" is
// right.
const CARRIED = 0.75;
const EXPLAINED = 4; // Largest number of contacts that an explanation names.
// Smallest force of a contact that the push has reached, as a fraction of its force in a solid block.
const ARRIVED = 0.25;
const STEEP = 0.1; // Largest ratio of the last to the first overlap at which the overlaps count as decaying along the chain.

// Return the number of equal bodies that hit other equal bodies, or 0. The other bodies are at least two and are at rest.
function strikersOf({ mass, velocity, gap, drive }) {
  const m = velocity.findIndex((v) => v !== velocity[0]);
  const alike = Math.max(...mass) <= EQUAL_MASSES * Math.min(...mass) && !mass.includes(null) && !isTrain(mass);
  if (!alike || m < 1 || mass.length - m < 2 || velocity[0] <= 0 || drive || gap.some((wide) => wide < 0)) return 0;
  return velocity.slice(m).some(Boolean) ? 0 : m;
}

// Return the index of the row that the question is about. It is the first row of soft beads or draft gears, or otherwise the first row.
const subjectOf = (specs) => Math.max(0, specs.findIndex(({ law }) => ["soft", "gear"].includes(lawKind(law))));

// Return the question above the beads. Return "" if the beads of the row are not struck.
function leadWords(specs) {
  const one = specs[subjectOf(specs)], m = strikersOf(one), kind = lawKind(one.law);
  if (!m || !["soft", "gear", "steel"].includes(kind)) return "";
  const known = kind === "steel" ? [] : [say(m === 1 ? "lead one" : "lead many")];
  return [...known, say(`lead ${kind}`)].join(" ");
}

/**
 * Return which answer of GUESSES describes the motion of a struck row. For "together", also return the number of struck beads in its
 * largest group.
 * @param {Spec} spec @param {ArrayLike<number>} velocity after the collision @returns {{kind: string, count: number}}
 */
function outcomeOf(spec, velocity) {
  const { mass } = spec, m = strikersOf(spec), energies = mass.map((one, k) => one * velocity[k] ** 2);
  const sum = (list) => list.reduce((total, one) => total + one, 0);
  if (sum(energies.slice(-m)) >= CARRIED * sum(energies)) return { kind: "last", count: m };
  const moving = groupsOf(mass, spec.velocity, velocity).filter(({ state, velocity: v }) => state === "moves" && v > 0);
  const count = Math.max(0, ...moving.map(({ first, last }) => last - Math.max(first, m) + 1));
  return { kind: count >= 2 && count >= (mass.length - m) / 2 ? "together" : "spread", count };
}

/**
 * Return the sentence about a guess. Without a guess, return only the outcome.
 * @param {Spec[]} specs @param {ArrayLike<number>[]} velocities @param {string} guess
 */
function verdictWords(specs, velocities, guess) {
  const lane = subjectOf(specs), spec = specs[lane], m = strikersOf(spec), n = spec.mass.length - m;
  const { kind, count } = outcomeOf(spec, velocities[lane]), said = guess ? [say(guess === kind ? "guess right" : "guess wrong")] : [];
  const all = kind === "together" && count === n ? " all" : kind === "last" && m > 1 ? " many" : "";
  said.push(say(`verdict ${kind}${all}`, { n: countWord(n), K: capital(countWord(count)) }));
  const steel = specs.findIndex(({ law }, k) => k !== lane && lawKind(law) === "steel");
  const last = steel >= 0 && kind !== "last" && outcomeOf(specs[steel], velocities[steel]).kind === "last";
  if (last) said.push(say(m > 1 ? "steel last many" : "steel last"));
  return said.join(" ");
}

/**
 * Explain the state of a struck row at its largest force. Return the contacts from the struck contact to the end, and a sentence.
 * @param {Spec} spec @param {Now} now @returns {{contacts: number[], words: string}}
 */
function explanationOf(spec, now) {
  const force = Array.from(now.force), largest = Math.max(...force), first = force.indexOf(largest), n = force.length - first;
  const shown = Math.min(n, EXPLAINED), apart = (n - 1) / Math.max(shown - 1, 1);
  const contacts = Array.from({ length: shown }, (_, k) => first + Math.round(k * apart));
  const arrived = force.slice(first).every((one, k) => one > ARRIVED * largest * (n - k) / n);
  const steep = now.overlap[force.length - 1] < STEEP * now.overlap[first], kind = lawKind(spec.law);
  const names = listed(contacts.map((k) => `${k}-${k + 1}`)), some = shown < force.length;
  const values = { depths: listed(contacts.map((k) => lengthText(now.overlap[k], 1))),
    forces: listed(contacts.map((k) => shareText(force[k] / largest))),
    contacts: say(some ? "contacts named" : "the contacts", { names }) };
  const so = !arrived ? "so wave" : kind === "soft" && steep ? "so evanescent" : "so solid";
  return { contacts, words: `${say(arrived ? "pushes still" : "pushes", values)} ${say(so)}` };
}
