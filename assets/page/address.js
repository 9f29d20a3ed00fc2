// The experiment. It consists of the settings that the user can change, their limits, and their encoding in the address of the page.

/**
 * The settings that the user can change. The scene defines the ranges of numbers. Text from an address is never used as markup or code.
 * @typedef {{law: string, alpha: number, strikers: number, targets: number, speed: number, friction: number, loss: number, pace: number,
 *   beside: string, shown: string[]}} Experiment
 */

const LAWS = ["scene", "soft", "gear", "steel"];
const BESIDE = ["none", "steel", "soft", "gear"];
const PACES = [0.05, 0.1, 0.25, 0.5, 1, 2, 4];
const SHOWN = ["forces", "loupes", "balance", "charts"];
const LEAST_ALPHA = 1 / 40, MOST_ALPHA = 1.5;
const MOST_STRIKERS = 10, MOST_TARGETS = 49;
const KEYS = { law: "law", alpha: "a", strikers: "m", targets: "n", speed: "v", friction: "mu", loss: "loss", pace: "pace", beside: "with" };

// Return the limits of each number for a scene with the initial settings `own`.
function limitsOf(data, own) {
  const slides = data.speed ** 2 / (2 * GRAVITY * data.length);
  return {
    alpha: [LEAST_ALPHA, MOST_ALPHA], strikers: [1, MOST_STRIKERS], targets: [1, MOST_TARGETS],
    speed: [0.2 * own.speed, 1.4 * own.speed], friction: [0, Math.max(slides, 1.5 * own.friction)], loss: [0, 0.9],
  };
}

/** @param {number} value @param {number[]} limits */
const clamped = (value, [low, high]) => Math.min(Math.max(value, low), high);

const nearest = (value, list) => list.reduce((best, one) => (Math.abs(one - value) < Math.abs(best - value) ? one : best));

const NUMBER = /^-?(\d{1,9}\.?\d{0,17}|\.\d{1,17})(e-?\d{1,2})?$/;
// Limits of a notice about invalid entries: the number of characters repeated from each entry, and the number of entries.
const LONGEST_WISH = 24, MOST_WISHES = 6;

// Return the number in a text such as 0.05, 0,05 or 1/20. Return NaN for any other text.
function numberOf(text) {
  const parts = String(text ?? "").trim().replace(",", ".").split("/"), value = Number(parts[0]) / Number(parts[1] ?? 1);
  return parts.length < 3 && parts.every((part) => NUMBER.test(part)) && Number.isFinite(value) ? value : NaN;
}

// Return the entries of an address by key, in lower case. If a key occurs twice, the first entry is used.
function entries(fragment) {
  const found = new Map();
  for (const [key, value] of new URLSearchParams(fragment.slice(1, 400))) {
    if (!found.has(key.toLowerCase())) found.set(key.toLowerCase(), value);
  }
  return found;
}

// Return true if the page has a control with this name. The control of the exponent exists only if the contact law has a variable exponent.
const settable = (name) => !part(name).closest(".never, body:not(.live) .live-only");
const hasAlpha = (data, law) => (law === "scene" ? data.soft : law === "soft");

// Return true if a setting differs from the setting of the scene. An exponent that the contact law does not use never differs.
const differs = (data, experiment, own, name) => experiment[name] !== own[name] && (name !== "alpha" || hasAlpha(data, experiment.law));

/**
 * Read the experiment from the fragment of an address. An entry may be missing, invalid or not offered by the page. Its setting is then
 * taken from `own`.
 * @param {string} fragment @param {Experiment} own @param {Record<string, number[]>} limits @param {any} data @returns {Experiment}
 */
function readAddress(fragment, own, limits, data) {
  const given = entries(fragment), found = { ...own }, shown = given.get("show");
  for (const [name, words] of Object.entries({ law: LAWS, beside: BESIDE })) {
    const word = given.get(KEYS[name])?.toLowerCase();
    if (words.includes(word) && settable(name)) found[name] = word;
  }
  for (const name of ["alpha", "strikers", "targets", "speed", "friction", "loss", "pace"]) {
    const value = numberOf(given.get(KEYS[name]));
    if (Number.isNaN(value) || !settable(name) || (name === "alpha" && !hasAlpha(data, found.law))) continue;
    if (name === "pace") found.pace = nearest(value, PACES);
    else found[name] = clamped(name === "strikers" || name === "targets" ? Math.round(value) : value, limits[name]);
  }
  const kinds = compared(data, found, own);
  if (!kinds.includes(found.beside)) found.beside = given.has(KEYS.beside) || kinds.length === 1 ? "none" : contrastTo(kinds);
  if (shown !== undefined) found.shown = SHOWN.filter((name) => shown.toLowerCase().split(".").includes(name));
  return found;
}

/**
 * List the entries of an address that could not be used. `experiment` was read from this address. An example is "n = 100 (here 49)".
 * @param {string} fragment @param {any} data @param {Experiment} experiment @param {number} last moment of the motion @returns {string[]}
 */
function unmetWishes(fragment, data, experiment, last) {
  const found = [];
  for (const [key, value] of entries(fragment)) {
    const name = Object.keys(KEYS).find((each) => KEYS[each] === key), has = name && experiment[name];
    const asked = typeof has === "number" ? numberOf(value) : value.toLowerCase();
    const known = has !== undefined && (name !== "alpha" || hasAlpha(data, experiment.law));
    const late = key === "t" && numberOf(value) > last;
    const met = known ? (typeof has === "number" ? Math.abs(Number(asked) - has) <= 1e-5 * Math.abs(has) : asked === has)
      : key === "show" ? asked === "" || asked === "nothing" || String(asked).split(".").every((one) => SHOWN.includes(one))
        : key === "embed" ? true : key === "lang" ? languageIn([value]) !== undefined : key === "t" && numberOf(value) >= 0 && !late;
    const wish = `${key}${value && " = "}${value}`, here = late ? last : known && typeof has === "number" && !Number.isNaN(asked) ? has : null;
    if (!met) found.push((wish.length > LONGEST_WISH ? `${wish.slice(0, LONGEST_WISH)}…` : wish) + (here === null ? "" : say("here", { value: plain(here, 4) })));
  }
  return found.length > MOST_WISHES ? [...found.slice(0, MOST_WISHES), "…"] : found;
}

/**
 * Return the fragment of an address that describes an experiment. It contains the settings that differ from `own`, and the language if it
 * is given.
 * @param {any} data @param {Experiment} experiment @param {Experiment} own @param {string|null} language @param {boolean} [embedded]
 */
function writeAddress(data, experiment, own, language, embedded = false) {
  const text = new URLSearchParams();
  for (const [name, key] of Object.entries(KEYS)) {
    const value = experiment[name];
    if (differs(data, experiment, own, name)) text.set(key, typeof value === "number" ? String(Number(value.toPrecision(6))) : value);
  }
  if (String(experiment.shown) !== String(own.shown)) text.set("show", experiment.shown.join(".") || "nothing");
  if (language) text.set("lang", language);
  if (embedded) text.set("embed", "1");
  return text.toString();
}

// Return true if an address requests an embedded page. Also return the language and the time that it requests.
const isEmbedded = (fragment) => entries(fragment).has("embed") && entries(fragment).get("embed") !== "0";
const addressLanguage = (fragment) => entries(fragment).get("lang");
function addressMoment(fragment) {
  const value = numberOf(entries(fragment).get("t"));
  return Number.isNaN(value) ? null : value;
}

const SOFT_DEPTH = 0.28, STEEL_DEPTH = 0.08; // Overlap of two beads that collide at the speed of the scene, in lengths of a bead.
const STEEL_SHARE = 0.3; // Largest overlap of steel balls as a fraction of the overlap of soft beads. Steel is harder.
// Stiffness relative to preload² / (mass speed²). With this value, only the struck contact of a row with up to five beads yields.
const GEAR_STIFFNESS = 0.5;

// Return the preload, the stiffness and the exponent of a contact law. They follow from the masses, speeds and lengths of a scene.
function lawRow(data, law, alpha) {
  const { mass, speed, length, strength } = data.matter, energy = 0.25 * mass * speed ** 2;
  const force = strength ?? energy / (SOFT_DEPTH * length);
  if (law === "gear") return [force, GEAR_STIFFNESS * force ** 2 / (mass * speed ** 2), 1];
  if (law === "steel") return [0, 2.5 * energy / Math.min(STEEL_DEPTH * length, STEEL_SHARE * energy / force) ** 2.5, 1.5];
  return [0, strength ?? (1 + alpha) * energy / (SOFT_DEPTH * length) ** (1 + alpha), alpha];
}

/**
 * Return the initial state and the contact laws of a lane of the scene in an experiment.
 * @param {any} data of the page @param {number} lane @param {Experiment} experiment @param {Experiment} own @returns {Spec}
 */
function specOf(data, lane, experiment, own) {
  const given = data.lanes[lane].spec, { strikers, targets, law, alpha } = experiment;
  const spec = structuredClone(given);
  if (data.uniform && (strikers !== own.strikers || targets !== own.targets)) {
    const n = strikers + targets - 1, { mass, law: row, approach } = data.uniform;
    Object.assign(spec, { mass: Array(n + 1).fill(mass), gap: Array(n).fill(0), velocity: Array(n + 1).fill(0), loss: Array(n).fill(own.loss) });
    spec.gap[strikers - 1] = approach;
    spec.velocity.fill(own.speed, 0, strikers);
    spec.law = Array(n).fill(row).flat();
  }
  const n = spec.gap.length;
  if (data.uniform && law !== "scene") spec.law = Array(n).fill(lawRow(data, law, alpha)).flat();
  else if (lane === 0 && alpha !== own.alpha) for (let i = 0; i < n; i++) if (isSoft(spec.law, i)) spec.law[3 * i + 2] = alpha;
  spec.velocity = spec.velocity.map((v) => v * experiment.speed / own.speed);
  if (experiment.friction !== own.friction) spec.friction = experiment.friction;
  if (experiment.loss !== own.loss) spec.loss = Array(n).fill(experiment.loss);
  // The speed scale of a row at rest is the speed of the page.
  spec.speed = (given.velocity.some(Boolean) ? given.speed : data.speed) * experiment.speed / own.speed;
  return spec;
}

const isSoft = (law, i) => law[3 * i] === 0 && law[3 * i + 1] > 0 && law[3 * i + 2] !== 1.5;

// List the kinds of rows with which the first row can be compared. They are rows with another contact law, the kind that the scene already
// uses for a comparison, and always "none".
function compared(data, experiment, own) {
  if (!settable("beside")) return ["none"];
  const spec = specOf(data, 0, experiment, own), named = ({ law }) => `${lawKind(law)} ${law[2]}`;
  const first = (kind) => kind === own.beside && experiment.law === own.law;
  return BESIDE.filter((kind) => kind === "none" || first(kind) || named(besideSpec(data, spec, kind)) !== named(spec));
}

// Choose the kind of row that the comparison button adds. It is a row of steel balls, or of soft beads if the first row consists of steel
// balls.
const contrastTo = (kinds) => (kinds.includes("steel") ? "steel" : "soft");

// Return the row that is compared with the first row. It has the same masses, positions and speeds, another contact law, and no loss.
function besideSpec(data, first, kind) {
  const n = first.gap.length, row = kind === "soft" ? lawRow(data, "soft", 0.1) : lawRow(data, kind, 0);
  return { ...first, law: Array(n).fill(row).flat(), loss: Array(n).fill(0) };
}
