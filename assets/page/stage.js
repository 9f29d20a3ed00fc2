// The stage: the beads of one lane on the ground, a force bar over each contact, loupes below, bars of energy and momentum.

const TALLEST_BEAD = 0.4, LEAST_BEAD = 0.22; // largest bead and least bead if bars need room, as fractions of the height of the drawing
const CAPTION = 22, CAPTIONS = 40; // height of one line of captions, and of two
const BAR_NUMBER = 20, BAR_LIFT = 8; // from captions to the highest bar, and from the tallest body to the axis of the bars
const LEAST_BAR = 18; // least height [px] of the highest bar; beads shrink for it
const GROUND = 30, LOW_GROUND = 20; // from the ground line to the lower edge of the drawing, and of a low one
const LOW = 160; // height [px] below which a drawing has one line of captions, so that bars keep some room
const VISIBLE_FORCE = 0.01; // of the force axis: lower bars have neither a number nor a line for rigid clusters
const PULL_RIM = 2.5; // pixels of the rim of the hollow bar of a force that pulls
const FORCE_MARGIN = 1.12; // upper end of the force axis over the greatest force
const LEAST_GAP = 1e-9; // of a bead's length: neighbours that are nearer touch
const EQUAL_MASSES = 1.02; // ratio of masses up to which beads look alike and no masses are written
const HEAVY = 1e4; // kg: masses from here on are written in tonnes
const BARS_HEIGHT = 46; // height [px] of the bars of energy and momentum
const LEAST_WIDTH = 200; // also while the page has none, as when it is hidden

// A label for each bead where masses differ visibly, else none.
function massLabels(mass) {
  const finite = mass.filter((m) => m !== null), greatest = Math.max(...finite), [size, unit] = greatest < HEAVY ? [1, "kg"] : [1e3, "t"];
  return greatest > EQUAL_MASSES * Math.min(...finite) ? mass.map((m) => (m === null ? say("wall") : `${plain(m / size, 3)} ${unit}`)) : [];
}

class Stage {
  /** @param {HTMLCanvasElement} canvas */
  constructor(canvas) {
    this.canvas = canvas;
    this.pen = canvas.getContext("2d");
    this.layer = document.createElement("canvas").getContext("2d"); // what stays from picture to picture
  }

  /**
   * Take another motion, size or theme.
   * @param {any} motion what does not move: label, mass, massLabels, gears, solid, pulls, dissipative, contacts, deepest
   * @param {any} data of the page, with its `scales` @param {any} theme
   * @param {{tall: number, shown: string[], force: number}} options height of the drawing of the beads, what is shown, and its axis of forces
   */
  fit(motion, data, theme, { tall, shown, force }) {
    const { canvas } = this, { density } = theme, width = Math.max(canvas.parentElement.clientWidth, LEAST_WIDTH);
    const narrow = width < 640, [low, high] = data.scales.window;
    const lines = tall < LOW ? 1 : 2, below = lines === 1 ? LOW_GROUND : GROUND;
    const room = Math.max(tall - (lines === 1 ? CAPTION : CAPTIONS) - BAR_NUMBER - LEAST_BAR - BAR_LIFT - below, LEAST_BEAD * tall);
    const tallest = Math.min(TALLEST_BEAD * tall, room), scale = Math.min(width / (high - low), tallest / (data.height * data.length));
    const size = data.length * scale;
    const loupeFit = shown.includes("loupes") ? loupeRow(motion, width) : { height: 0, count: 0 };
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
    const edges = this.edges = leftEdges(now, view, data), faces = edges.slice(0, -1).map((x) => x + view.size);
    now.contacts = faces.map((face, k) => (face + edges[k + 1]) / 2);
    bodies(pen, view, data, edges, faces);
    if (view.forces) forceBars(pen, view, data, now);
    arrows(pen, view, data, edges, now);
    if (view.motion.drive) drives(pen, view, edges);
    if (held) hold(pen, view, edges[held.bead], held.across);
    if (view.loupeFit.count) loupes(pen, view.loupeFit, view, now, view.tall);
    if (view.balance) balances(pen, view, data, now, view.tall + view.loupeFit.height);
  }

  // The bead under a point of the canvas, or the nearest one within a finger's width; -1 where there is none.
  beadAt(x, y) {
    const { view, edges } = this;
    if (y < view.ground - 1.6 * view.size - 24 || y > view.ground + 30) return -1;
    let found = -1, least = view.size / 2 + 22;
    edges.forEach((edge, k) => {
      const away = Math.abs(x - edge - view.size / 2);
      if (away < least && view.motion.mass[k] !== null) { found = k; least = away; }
    });
    return found;
  }

  middle(bead) { return this.edges[bead] + this.view.size / 2; }
}

// A ring around the bead that is held or chosen, and the string to the hand.
function hold(pen, view, edge, across) {
  const x = edge + view.size / 2, y = view.ground - view.size / 2;
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

// Where the left edge of each bead is drawn, overlaps as many times too large as the scene says; their mean is not moved.
function leftEdges(now, view, data) {
  const shift = [0];
  now.overlap.forEach((depth, k) => shift.push(shift[k] + (1 - data.scales.magnify) * Math.max(depth, 0)));
  const mean = shift.reduce((sum, x) => sum + x, 0) / shift.length;
  return Array.from(now.position, (x, k) => view.origin + view.scale * (x + shift[k] - mean + data.length * k));
}

// Place the label and the captions of the bars on one or two lines, left of the ruler and of the text below it. Captions without room are
// left out, and bars end below all of them.
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
  const { motion, size, ground, colours, theme } = view, last = motion.contacts - 1;
  const isGear = (k) => motion.gears[Math.min(k, last)];
  const greatest = Math.max(...motion.mass), differ = motion.massLabels.length > 0;
  edges.forEach((x, k) => {
    if (!isGear(k) || motion.mass[k] === null) return;
    const end = k < faces.length ? Math.min(faces[k], edges[k + 1]) : x + size;
    piston(pen, end, ground, size, theme);
  });
  edges.forEach((x, k) => {
    if (motion.mass[k] === null) wall(pen, x, ground, size, theme);
    else if (isGear(k)) cylinder(pen, x, ground, size, colours[k], theme);
    else bead(pen, x, ground, size, colours[k], differ ? 0.92 * Math.sqrt(motion.mass[k] / greatest) : 0, theme);
  });
  const digits = (data.height < 1 ? 0.31 * CYLINDER_HEIGHT : 0.36) * size;
  if (!data.numbered || digits < 8) return;
  edges.forEach((x, k) => {
    if (motion.mass[k] === null) return;
    const [across, up] = isGear(k) ? [0.5 * CYLINDER_LENGTH, 0.5 * CYLINDER_HEIGHT] : [0.5, 0.5];
    write(pen, String(k), x + across * size, ground - up * size + 0.36 * digits, digits, view.digitColours[k], "center", true);
  });
}

const barTop = (view, data, force) => view.base - view.barRoom * force / (view.force / FORCE_MARGIN);

/**
 * The force that each contact would have if clusters were rigid, as in sandbox/draw/bodies.py: those at the ends of a cluster, each
 * carried on by the share of the mass beyond; 0 where clusters end.
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

// Draw a bar for each contact, and a line across it at the force of rigid clusters, Eq. (5).
function forceBars(pen, view, data, now) {
  const { motion, size, theme } = view, visible = VISIBLE_FORCE * view.force;
  const wide = Math.min(Math.max(0.26 * size, 3), 30), unit = data.forceUnit.size;
  const decimals = Math.max(0, 2 - Math.floor(Math.log10(view.force / unit)));
  const marked = view.captions.found.some(({ mark }) => mark); // lines are drawn only with their legend
  const rigid = marked ? rigidForces(motion.mass, now, data.length) : [];
  const high = size < 40 ? 11 : 13, numbers = [], text = (value) => (decimals > 4 ? scientific(value) : fixed(value, decimals));
  now.contacts.forEach((x, k) => {
    const force = now.force[k], top = barTop(view, data, Math.abs(force)), expected = rigid[k];
    pen.fillStyle = view.contactColours[k];
    pen.fillRect(x - wide / 2, top, wide, view.base - top);
    if (force < 0 && view.base - top > 2 * PULL_RIM) { // hollow: it pulls
      pen.fillStyle = theme.card;
      pen.fillRect(x - wide / 2 + PULL_RIM, top + PULL_RIM, wide - 2 * PULL_RIM, view.base - top - 2 * PULL_RIM);
    }
    pen.fillStyle = theme.ink;
    const solid = motion.solid[k][force < 0 ? 1 : 0]; // dark: what is beyond the force at which the gear is solid
    if (solid !== null && Math.abs(force) > solid) pen.fillRect(x - wide / 2, top, wide, barTop(view, data, solid) - top);
    let above = top;
    if (expected > visible && Math.abs(force) > visible) { // a line without a bar would look like a bar that is missing
      const reach = wide / 2 + (view.narrow ? 3 : 5), line = barTop(view, data, expected);
      pen.fillRect(x - reach, line - 0.75, 2 * reach, 1.5);
      if (line > top - 20) above = Math.min(top, line); // a number stands above a line that would strike it through
    }
    if (Math.abs(force) > visible && size >= 28) numbers.push({ text: text(force / unit), x, y: above - 5, force: Math.abs(force) });
  });
  const taken = [view.captions.scale]; // the greatest first; a number that would lie on another text is left out
  pen.font = `600 ${high}px ${FONT}`;
  for (const { text, x, y } of numbers.sort((a, b) => b.force - a.force)) {
    const half = pen.measureText(text).width / 2 + 1;
    if (taken.some((other) => Math.abs(other.x - x) < other.half + half && Math.abs(other.y - y) < high)) continue;
    taken.push({ x, y, half });
    write(pen, text, x, y, high, theme.ink, "center", true);
  }
}

// Return the colour behind the number of a bead: its cylinder, its core if masses differ, or its disc.
function inner({ mass, massLabels: labels, gears, contacts }, theme, colour, k) {
  if (gears[Math.min(k, contacts - 1)]) return colour;
  return mixed(labels.length && mass[k] ? mixed(colour, "#000000", 0.22) : colour, theme.card, labels.length ? 0.05 : TRANSPARENT);
}

// A velocity arrow under each bead, and below it the mass where masses differ.
function arrows(pen, view, data, edges, now) {
  const fastest = Math.max(...data.scales.velocity.map(Math.abs)), { motion, size, ground, theme } = view;
  edges.forEach((x, k) => {
    const middle = x + size / 2;
    arrow(pen, middle, ground + 11, 0.85 * size * now.velocity[k] / fastest, outlineOf(view.colours[k], theme));
    if (motion.massLabels.length && size >= 40) write(pen, motion.massLabels[k], middle, ground + 26, 12, theme.muted, "center");
  });
}

// Draw the steady forces on beads as arrows, each on the side that the force comes from.
function drives(pen, view, edges) {
  const { drive } = view.motion, { size, theme } = view, most = Math.max(...drive.map(Math.abs));
  edges.forEach((x, k) => {
    const way = Math.sign(drive[k]), long = Math.max(8, 0.7 * size * Math.abs(drive[k]) / most);
    if (way) arrow(pen, (way > 0 ? x : x + size) - way * (long + 3), view.ground - 0.85 * size, way * long, theme.ink);
  });
}

// Return the width of the bars of energy and momentum, and the left end of the second bar.
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

// Bars of energy and of momentum: each bead's part, and a total that must not change.
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
