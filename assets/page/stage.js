// The stage shows the beads of one lane on the ground and a force bar above each contact. Loupes and the bars of energy and momentum are
// below.

// Largest height of a bead, and smallest height if the force bars need space. Both are fractions of the height of the drawing.
const TALLEST_BEAD = 0.4, LEAST_BEAD = 0.22;
const CAPTION = 22, CAPTIONS = 40; // Heights in pixels of one line and of two lines of captions.
// Distances in pixels: from the captions to the highest force bar, and from the tallest body to the axis of the bars.
const BAR_NUMBER = 20, BAR_LIFT = 8;
const LEAST_BAR = 18; // Smallest height in pixels of the force bar of the largest force. Beads become smaller to make space for it.
// Distance in pixels between the ground line and the lower edge of the drawing. The second value is used for low drawings.
const GROUND = 30, LOW_GROUND = 20;
// Height of the drawing in pixels below which there is only one line of captions. This leaves some space for the force bars.
const LOW = 160;
const VISIBLE_FORCE = 0.01; // Smallest force with a number or a mark for rigid clusters, as a fraction of the force axis.
const PULL_RIM = 2.5; // Width in pixels of the outline of a hollow bar. A hollow bar shows a pulling force.
const FORCE_MARGIN = 1.12; // Upper end of the force axis, relative to the largest force.
const LEAST_GAP = 1e-9; // Largest gap, in lengths of a bead, at which neighbouring beads count as touching.
const EQUAL_MASSES = 1.02; // Largest ratio of two masses at which the beads look equal and their masses are not written.
const HEAVY = 1e4; // Smallest mass in kg that is written in tonnes.
const BARS_HEIGHT = 46; // Height of the bars of energy and momentum in pixels.
const LEAST_WIDTH = 200; // Smallest width of the stage in pixels. It is also the width in a hidden page.

// Return a label with the mass of each bead. Return an empty list if all masses are nearly equal.
function massLabels(mass) {
  const finite = mass.filter((m) => m !== null), greatest = Math.max(...finite), [size, unit] = greatest < HEAVY ? [1, "kg"] : [1e3, "t"];
  return greatest > EQUAL_MASSES * Math.min(...finite) ? mass.map((m) => (m === null ? say("wall") : `${plain(m / size, 3)} ${unit}`)) : [];
}

class Stage {
  /** @param {HTMLCanvasElement} canvas */
  constructor(canvas) {
    this.canvas = canvas;
    this.pen = canvas.getContext("2d");
    this.layer = document.createElement("canvas").getContext("2d"); // The layer contains everything that is the same in every frame.
  }

  /**
   * Use another motion, another size or another theme.
   * @param {any} motion constant properties: label, mass, massLabels, gears, solid, pulls, dissipative, contacts, deepest
   * @param {any} data of the page, with its `scales` @param {any} theme
   * @param {{tall: number, shown: string[], force: number, lenses?: any}} options height of the drawing of the beads, visible parts, force
   *   axis, and loupes of an explanation
   */
  fit(motion, data, theme, { tall, shown, force, lenses = null }) {
    const { canvas } = this, { density } = theme, width = Math.max(canvas.parentElement.clientWidth, LEAST_WIDTH);
    const narrow = width < 640, [low, high] = data.scales.window;
    const lines = tall < LOW ? 1 : 2, below = lines === 1 ? LOW_GROUND : GROUND;
    const room = Math.max(tall - (lines === 1 ? CAPTION : CAPTIONS) - BAR_NUMBER - LEAST_BAR - BAR_LIFT - below, LEAST_BEAD * tall);
    const tallest = Math.min(TALLEST_BEAD * tall, room), scale = Math.min(width / (high - low), tallest / (data.height * data.length));
    const size = data.length * scale;
    const loupeFit = lenses ?? (shown.includes("loupes") ? loupeRow(motion, width) : { height: 0, contacts: [] });
    const balance = shown.includes("balance") ? BARS_HEIGHT : 0, height = tall + loupeFit.height + balance;
    canvas.width = this.layer.canvas.width = Math.round(width * density);
    canvas.height = this.layer.canvas.height = Math.round(height * density);
    canvas.style.height = `${height}px`;
    const colours = motion.mass.map((mass, k) => (mass === null ? theme.muted : theme.bead(k)));
    const ground = tall - below, base = ground - Math.max(data.height * size, 12) - BAR_LIFT, forces = shown.includes("forces");
    const captions = captionPlaces(this.pen, motion, data, width - 24 - rulerLength(data, width, scale) * scale, width, forces, lines);
    this.data = data;
    this.view = { motion, theme, width, tall, scale, size, colours, ground, base, narrow, loupeFit, density, captions, forces, force, balance, lines,
      contactColours: motion.mass.slice(1).map((_, k) => theme.bead(k + 1)),
      digitColours: colours.map((colour, k) => digitOn(inner(motion, theme, colour, k))),
      barRoom: base - captions.bottom - BAR_NUMBER, origin: width / 2 - scale * (low + high) / 2 };
    this.layer.setTransform(density, 0, 0, density, 0, 0);
    backdrop(this.layer, this.view, data);
    if (balance) balanceFrames(this.layer, this.view, tall + loupeFit.height);
  }

  /** @param {Now} now @param {{bead: number, across?: number}|null} held the bead in the hand, and where the hand is */
  draw(now, held) {
    const { pen, view, data } = this;
    pen.setTransform(1, 0, 0, 1, 0, 0);
    pen.globalCompositeOperation = "copy";
    pen.drawImage(this.layer.canvas, 0, 0);
    pen.globalCompositeOperation = "source-over";
    pen.setTransform(view.density, 0, 0, view.density, 0, 0);
    const edges = this.edges = leftEdges(now, view, data);
    view.rises = risesOf(view, now);
    const faces = edges.slice(0, -1).map((x) => x + view.size);
    now.contacts = faces.map((face, k) => (face + edges[k + 1]) / 2);
    if (view.motion.strings) strings(pen, view, edges, now);
    bodies(pen, view, data, edges, faces);
    if (view.forces) forceBars(pen, view, data, now);
    arrows(pen, view, data, edges, now);
    if (view.motion.drive) drives(pen, view, edges);
    if (held) hold(pen, view, edges[held.bead], held.across, view.rises[held.bead]);
    if (view.loupeFit.contacts.length) loupes(pen, view.loupeFit, view, now, view.tall);
    if (view.balance) balances(pen, view, data, now, view.tall + view.loupeFit.height);
  }

  // Return the number of the bead at a point of the canvas. For a finger, return the nearest bead within its width. Return -1 if no bead is
  // near.
  beadAt(x, y) {
    const { view, edges } = this;
    if (y < view.ground - 1.6 * view.size - 24 - Math.max(...view.rises) || y > view.ground + 30) return -1;
    let found = -1, least = view.size / 2 + 22;
    edges.forEach((edge, k) => {
      const away = Math.abs(x - edge - view.size / 2);
      if (away < least && view.motion.mass[k] !== null) { found = k; least = away; }
    });
    return found;
  }

  middle(bead) { return this.edges[bead] + this.view.size / 2; }
}

// Draw a ring around the bead that is held or chosen. Draw a string from the held bead to the hand.
function hold(pen, view, edge, across, rise) {
  const x = edge + view.size / 2, y = view.ground - view.size / 2 - rise;
  pen.strokeStyle = pen.fillStyle = view.theme.ink;
  pen.lineWidth = 2;
  pen.beginPath();
  pen.arc(x, y, view.size / 2 + 4, 0, 2 * Math.PI);
  pen.stroke();
  if (across === undefined) return;
  pen.beginPath();
  pen.moveTo(x, y);
  pen.lineTo(across, y);
  pen.stroke();
  pen.beginPath();
  pen.arc(across, y, 5, 0, 2 * Math.PI);
  pen.fill();
}

// Return the positions of beads at rest. They follow from the gaps between the beads.
const restOf = (gap) => gap.reduce((found, one) => [...found, found[found.length - 1] + one], [0]);

// Distance in pixels from the captions to the lower edge of the bar to which the strings are attached.
const BAR_BELOW = 12;

// Return the drawn length of the strings. It is to scale, but the bar of the strings stays below the captions.
function stringOf({ motion, scale, ground, size, captions }) {
  return Math.min(scale * motion.strings, ground - size / 2 - captions.bottom - BAR_BELOW);
}

// Return the height at which each bead is drawn above the ground. Beads on strings move along arcs.
function risesOf(view, now) {
  const { motion, scale } = view;
  if (!motion.strings) return Array.from(now.position, () => 0);
  const long = stringOf(view);
  return Array.from(now.position, (x, k) => long - Math.sqrt(long ** 2 - Math.min(Math.abs(scale * (x - motion.rest[k])), 0.99 * long) ** 2));
}

// Draw the strings of the beads, and the bar to which the strings are attached.
function strings(pen, view, edges, now) {
  const { motion, scale, size, ground, theme } = view, top = ground - size / 2 - stringOf(view);
  const ends = edges.map((x, k) => x + size / 2 - scale * (now.position[k] - motion.rest[k]));
  pen.fillStyle = pen.strokeStyle = theme.muted;
  pen.fillRect(ends[0] - size, top - 3, ends[ends.length - 1] - ends[0] + 2 * size, 3);
  pen.lineWidth = 1;
  pen.beginPath();
  ends.forEach((x, k) => {
    pen.moveTo(x, top);
    pen.lineTo(edges[k] + size / 2, ground - size / 2 - view.rises[k]);
  });
  pen.stroke();
}

// Return the left edges of the visible beads. Overlaps are magnified as the scene requires. The mean position of the beads does not change.
function leftEdges(now, view, data) {
  const shift = [0];
  now.overlap.forEach((depth, k) => shift.push(shift[k] + (1 - data.scales.magnify) * Math.max(depth, 0)));
  const mean = shift.reduce((sum, x) => sum + x, 0) / shift.length;
  return Array.from(now.position, (x, k) => view.origin + view.scale * (x + shift[k] - mean + data.length * k));
}

// Return the places of the label and of the captions of the force bars. They are on one or two lines to the left of the ruler and its text.
// Captions that do not fit are omitted. The bars end below all captions.
function captionPlaces(pen, motion, data, room, width, forces, lines) {
  const words = (text, weight = 400, size = 12.5) => { pen.font = `${weight} ${size}px ${FONT}`; return pen.measureText(text).width; };
  const stops = motion.solid.flat().some((force) => force !== null), half = words(scaleText(data)) / 2;
  const found = [], rooms = [room, width - 24 - 2 * half];
  let { label } = motion, x = 8, line = 0;
  while (label?.length > 1 && words(label, 600, 15) > room - 8) label = `${label.replace(/.…?$/, "")}…`;
  if (label) x += words(label, 600, 15);
  for (const key of ["force", motion.pulls && "hollow", stops && "dark", motion.marks && "rigid"].filter((one) => forces && one)) {
    const mark = key === "rigid" ? 20 : 0, text = say(key, { unit: data.forceUnit.name }), wide = mark + words(text);
    if (x > 8) x += mark ? 16 : 14;
    if (x + wide >= rooms[line]) { line++; x = 8; }
    if (line >= lines || x + wide >= rooms[line]) break;
    found.push({ text, x, y: 20 + 19 * line, mark });
    x += wide;
  }
  return { label, found, bottom: found.at(-1)?.y > 20 ? CAPTIONS : CAPTION, scale: { x: width - 12 - half, y: 39, half } };
}

function backdrop(pen, view, data) {
  const { theme, width, ground } = view;
  pen.fillStyle = theme.card;
  rounded(pen, 0, 0, width, view.tall, 8);
  const unit = data.forceUnit, most = Math.max(1, Math.min(4, Math.floor(view.barRoom / 26)));
  for (const { value, text } of view.forces ? ticksOf(0, view.force / FORCE_MARGIN / unit.size, most) : []) {
    const y = barTop(view, data, value * unit.size);
    pen.fillStyle = theme.line;
    pen.fillRect(0, Math.round(y), width, 1);
    if (y > view.captions.bottom + 15) write(pen, text, 8, y - 3, 12, theme.muted);
  }
  write(pen, view.captions.label, 8, 20, 15, theme.ink, "left", true);
  for (const { text, x, y, mark } of view.captions.found) {
    pen.fillStyle = theme.ink;
    pen.fillRect(x, y - 5, 0.7 * mark, 1.5);
    write(pen, text, x + mark, y, 12.5, theme.muted);
  }
  pen.fillStyle = theme.strong;
  pen.fillRect(0, Math.round(ground), width, 1.5);
  ruler(pen, view, data);
}

const scaleText = ({ scales: { magnify } }) => (magnify === 1 ? say("to scale") : say("magnified", { factor: factorText(magnify) }));
const rulerLength = (data, width, scale) => roundDown(Math.min(1.6 * data.length, 0.3 * width / scale));

function ruler(pen, view, data) {
  const { theme, width } = view, length = rulerLength(data, width, view.scale);
  const right = width - 12, left = right - length * view.scale;
  pen.fillStyle = theme.muted;
  pen.fillRect(left, 20, right - left, 1.5);
  for (const x of [left, right]) pen.fillRect(x - 0.75, 16, 1.5, 9);
  write(pen, `${scientific(length, 0)} m`, (left + right) / 2, 13, 12, theme.muted, "center");
  if (view.lines > 1) write(pen, scaleText(data), right, 39, 12.5, theme.muted, "right");
}

function bodies(pen, view, data, edges, faces) {
  const { motion, size, colours, theme } = view, last = motion.contacts - 1, grounds = view.rises.map((rise) => view.ground - rise);
  const isGear = (k) => motion.gears[Math.min(k, last)];
  const greatest = Math.max(...motion.mass), differ = motion.massLabels.length > 0;
  edges.forEach((x, k) => {
    if (!isGear(k) || motion.mass[k] === null) return;
    const end = k < faces.length ? Math.min(faces[k], edges[k + 1]) : x + size;
    piston(pen, end, grounds[k], size, theme);
  });
  edges.forEach((x, k) => {
    if (motion.mass[k] === null) wall(pen, x, grounds[k], size, theme);
    else if (isGear(k)) cylinder(pen, x, grounds[k], size, colours[k], theme);
    else bead(pen, x, grounds[k], size, colours[k], differ ? 0.92 * Math.sqrt(motion.mass[k] / greatest) : 0, theme);
  });
  const digits = (data.height < 1 ? 0.31 * CYLINDER_HEIGHT : 0.36) * size;
  if (!data.numbered || digits < 8) return;
  edges.forEach((x, k) => {
    if (motion.mass[k] === null) return;
    const [across, up] = isGear(k) ? [0.5 * CYLINDER_LENGTH, 0.5 * CYLINDER_HEIGHT] : [0.5, 0.5];
    write(pen, String(k), x + across * size, grounds[k] - up * size + 0.36 * digits, digits, view.digitColours[k], "center", true);
  });
}

const barTop = (view, data, force) => view.base - view.barRoom * force / (view.force / FORCE_MARGIN);

/**
 * Return the force that each contact would have if all clusters were rigid, as in sandbox/draw/bodies.py. A contact inside a cluster
 * transmits a share of the force at an end of the cluster. The share is proportional to the mass beyond the contact. The returned force is
 * 0 at the ends of clusters.
 * @param {(number|null)[]} masses @param {Now} now @param {number} length of a bead
 */
function rigidForces(masses, now, length) {
  const n = now.force.length, found = new Float64Array(n), sum = (list) => list.reduce((total, mass) => total + mass, 0);
  let first = 0;
  for (let last = 0; last <= n; last++) {
    if (last < n && !now.ends[last] && now.overlap[last] >= -LEAST_GAP * length) continue;
    const mass = masses.slice(first, last + 1), whole = sum(mass);
    for (let k = first; k < last && !mass.includes(null); k++) {
      const beyond = sum(mass.slice(k - first + 1)) / whole;
      found[k] = (first > 0 ? now.force[first - 1] : 0) * beyond + (last < n ? now.force[last] : 0) * (1 - beyond);
    }
    first = last + 1;
  }
  return found;
}

// Draw a force bar for each contact. Draw a line across the bar at the force that the contact would have in a rigid cluster, Eq. (5).
function forceBars(pen, view, data, now) {
  const { motion, size, theme } = view, visible = VISIBLE_FORCE * view.force;
  const wide = Math.min(Math.max(0.26 * size, 3), 30), unit = data.forceUnit.size;
  const decimals = Math.max(0, 2 - Math.floor(Math.log10(view.force / unit)));
  const marked = view.captions.found.some(({ mark }) => mark); // Marks are drawn only if there is space for their legend.
  const rigid = marked ? rigidForces(motion.mass, now, data.length) : [];
  const high = size < 40 ? 11 : 13, numbers = [], text = (value) => (decimals > 4 ? scientific(value) : fixed(value, decimals));
  now.contacts.forEach((x, k) => {
    const force = now.force[k], top = barTop(view, data, Math.abs(force)), expected = rigid[k];
    pen.fillStyle = view.contactColours[k];
    pen.fillRect(x - wide / 2, top, wide, view.base - top);
    if (force < 0 && view.base - top > 2 * PULL_RIM) { // The bar is hollow because the contact pulls.
      pen.fillStyle = theme.card;
      pen.fillRect(x - wide / 2 + PULL_RIM, top + PULL_RIM, wide - 2 * PULL_RIM, view.base - top - 2 * PULL_RIM);
    }
    pen.fillStyle = theme.ink;
    // The dark part of a bar is the part of the force above the value at which the draft gear becomes solid.
    const solid = motion.solid[k][force < 0 ? 1 : 0];
    if (solid !== null && Math.abs(force) > solid) pen.fillRect(x - wide / 2, top, wide, barTop(view, data, solid) - top);
    let above = top;
    if (expected > visible && Math.abs(force) > visible) { // A mark on a contact without a visible bar would look like a missing bar.
      const reach = wide / 2 + (view.narrow ? 3 : 5), line = barTop(view, data, expected);
      pen.fillRect(x - reach, line - 0.75, 2 * reach, 1.5);
      // A mark near the number would cross it out. The number is then written above the mark.
      if (line > top - 20) above = Math.min(top, line);
    }
    if (Math.abs(force) > visible && size >= 28) numbers.push({ text: text(force / unit), x, y: above - 5, force: Math.abs(force) });
  });
  const taken = [view.captions.scale]; // The largest numbers are written first. A number that would cover another text is omitted.
  pen.font = `600 ${high}px ${FONT}`;
  for (const { text, x, y } of numbers.sort((a, b) => b.force - a.force)) {
    const half = pen.measureText(text).width / 2 + 1;
    if (taken.some((other) => Math.abs(other.x - x) < other.half + half && Math.abs(other.y - y) < high)) continue;
    taken.push({ x, y, half });
    write(pen, text, x, y, high, theme.ink, "center", true);
  }
}

// Return the colour behind the number of a bead. It is the colour of its cylinder, of its core if the masses differ, or of its disc.
function inner({ mass, massLabels: labels, gears, contacts }, theme, colour, k) {
  if (gears[Math.min(k, contacts - 1)]) return colour;
  return mixed(labels.length && mass[k] ? mixed(colour, "#000000", 0.22) : colour, theme.card, labels.length ? 0.05 : TRANSPARENT);
}

// Draw a velocity arrow below each bead. If the masses differ, write the mass below the arrow.
function arrows(pen, view, data, edges, now) {
  const fastest = Math.max(...data.scales.velocity.map(Math.abs)), { motion, size, ground, theme } = view;
  edges.forEach((x, k) => {
    const middle = x + size / 2;
    arrow(pen, middle, ground + 11, 0.85 * size * now.velocity[k] / fastest, outlineOf(view.colours[k], theme));
    if (motion.massLabels.length && size >= 40) write(pen, motion.massLabels[k], middle, ground + 26, 12, theme.muted, "center");
  });
}

// Draw the constant forces on beads as arrows. Each arrow is on the side from which the force comes.
function drives(pen, view, edges) {
  const { drive } = view.motion, { size, theme } = view, most = Math.max(...drive.map(Math.abs));
  edges.forEach((x, k) => {
    const way = Math.sign(drive[k]), long = Math.max(8, 0.7 * size * Math.abs(drive[k]) / most);
    if (way) arrow(pen, (way > 0 ? x : x + size) - way * (long + 3), view.ground - 0.85 * size, way * long, theme.ink);
  });
}

// Return the width of the energy bar and the momentum bar, and the left end of the momentum bar.
const balancePlaces = ({ width, narrow }) => ({ wide: (width - (narrow ? 12 : 24)) / 2, second: (width + (narrow ? 12 : 24)) / 2 });

function balanceFrames(pen, view, top) {
  const { motion, theme } = view, { wide, second } = balancePlaces(view), lossy = motion.dissipative ? " lossy" : "";
  pen.font = `400 12px ${FONT}`;
  const fitting = (keys) => keys.map((key) => say(key)).find((text, k) => pen.measureText(text).width < wide || k === keys.length - 1);
  write(pen, fitting([`energy${lossy || " bar"}`, `energy${lossy} brief`, "energy short"]), 0, top + 16, 12, theme.muted);
  write(pen, fitting(["momentum bar", "momentum short"]), second, top + 16, 12, theme.muted);
  pen.fillStyle = theme.line;
  for (const x of [0, second]) pen.fillRect(x, top + 23, wide, 11);
}

// Draw the bars of energy and momentum. They show the part of each bead and the total, which must not change.
function balances(pen, view, data, now, top) {
  const { motion, theme } = view, { wide, second } = balancePlaces(view), mass = motion.mass.map((m) => m ?? 0);
  const kinetic = mass.map((m, k) => 0.5 * m * now.velocity[k] ** 2), momentum = mass.map((m, k) => m * now.velocity[k]);
  let x = 0;
  [...kinetic, now.stored, now.absorbed].forEach((value, k) => {
    const part = Math.max(0, value / data.scales.energy * wide);
    pen.fillStyle = [...view.colours, theme.steel, theme.muted][k];
    pen.fillRect(x, top + 23, part, 11);
    x += part;
  });
  const [low, high] = data.scales.momentum, unit = wide / (high - low), zero = second - low * unit, ends = [zero, zero];
  momentum.forEach((value, k) => {
    const side = value > 0 ? 1 : 0, part = value * unit;
    pen.fillStyle = view.colours[k];
    pen.fillRect(Math.min(ends[side], ends[side] + part), top + 23, Math.abs(part), 11);
    ends[side] += part;
  });
  const total = zero + unit * momentum.reduce((sum, value) => sum + value, 0);
  for (const [at, colour] of [[zero, theme.muted], [total, theme.ink]]) {
    pen.fillStyle = colour;
    pen.fillRect(Math.min(Math.max(at - 0.75, second), second + wide - 1.5), top + 20, 1.5, 17);
  }
}
