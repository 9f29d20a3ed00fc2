// Drawing of bodies on a canvas: beads, draft gears, walls and arrows. All lengths are in CSS pixels.

// Length and height of the cylinder of a draft gear, and thickness of its plate, as fractions of the length of the gear.
const CYLINDER_LENGTH = 0.8, CYLINDER_HEIGHT = 0.66, PLATE_LENGTH = 0.055;
const WALL_HEIGHT = 1.2; // Height of a wall, in lengths of a bead.

// Return a mixture of `colour` (#rrggbb) and `other`. `share` (0 to 1) is the fraction of `other`.
function mixed(colour, other, share) {
  const parts = [1, 3, 5].map((k) => [parseInt(colour.slice(k, k + 2), 16), parseInt(other.slice(k, k + 2), 16)]);
  return `#${parts.map(([a, b]) => Math.round(a + share * (b - a)).toString(16).padStart(2, "0")).join("")}`;
}

const outlineOf = (colour, theme) => mixed(colour, theme.dark ? "#ffffff" : "#000000", theme.dark ? 0.25 : 0.35);
const TRANSPARENT = 0.17; // Transparency of a bead. With it, the outlines of two overlapping beads are both visible.
const translucent = (colour) => `${colour}${Math.round(255 * (1 - TRANSPARENT)).toString(16)}`;

// Compute the relative luminance of a colour. The next function computes the contrast ratio of two colours (WCAG 2.2).
function luminance(colour) {
  const linear = (c) => (c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4);
  const [r, g, b] = [1, 3, 5].map((k) => linear(parseInt(colour.slice(k, k + 2), 16) / 255));
  return 0.2126 * r + 0.7152 * g + 0.0722 * b;
}
function contrastOf(one, other) {
  const [low, high] = [luminance(one), luminance(other)].sort((a, b) => a - b);
  return (high + 0.05) / (low + 0.05);
}

const READ = 4.5; // Smallest contrast ratio between text and its background (WCAG 2.2, 1.4.3).
const DIGITS = ["#ffffff", "#000000"]; // Colours of the number on a bead. Every colour of a bead has enough contrast with one of them.

// Mix the text colour of the theme into `colour` until text of the mixed colour has enough contrast with the background.
function textColour(colour, theme) {
  let share = 0;
  while (share < 1 && contrastOf(mixed(colour, theme.ink, share), theme.paper) < READ) share += 0.05;
  return mixed(colour, theme.ink, Math.min(share, 1));
}
const digitOn = (colour) => DIGITS.find((digit) => contrastOf(digit, colour) >= READ) ?? DIGITS[1];

function disc(pen, x, y, radius, colour, rim, theme) {
  pen.beginPath();
  pen.arc(x, y, radius - rim / 2, 0, 2 * Math.PI);
  pen.fillStyle = translucent(colour);
  pen.fill();
  pen.lineWidth = rim;
  pen.strokeStyle = outlineOf(colour, theme);
  pen.stroke();
}

// Draw a bead. Its core shows its mass relative to the largest mass. The radius of the core is `core` times the radius of the bead.
function bead(pen, left, ground, size, colour, core, theme) {
  const radius = size / 2, rim = Math.min(Math.max(1, 0.03 * size), radius);
  disc(pen, left + radius, ground - radius, radius, colour, rim, theme);
  if (core > 0) {
    pen.beginPath();
    pen.arc(left + radius, ground - radius, core * (radius - rim), 0, 2 * Math.PI);
    pen.fillStyle = translucent(mixed(colour, "#000000", 0.22));
    pen.fill();
  }
}

function cylinder(pen, left, ground, size, colour, theme) {
  const wide = CYLINDER_LENGTH * size, tall = CYLINDER_HEIGHT * size, rim = Math.max(1, 0.03 * size), head = 0.07 * wide;
  pen.fillStyle = outlineOf(colour, theme);
  rounded(pen, left, ground - tall, wide, tall, 0.1 * tall);
  pen.fillStyle = colour;
  rounded(pen, left + rim, ground - tall + rim, wide - 2 * rim, tall - 2 * rim, 0.1 * tall);
  pen.fillStyle = outlineOf(colour, theme);
  pen.fillRect(left + wide - head, ground - tall, head, tall);
}

// Draw the rod and the plate of a draft gear. `end` is the horizontal position of the face of the plate.
function piston(pen, end, ground, size, theme) {
  const tall = 0.44 * size, top = ground - size * 0.5 * CYLINDER_HEIGHT - tall / 2, plate = Math.max(2, PLATE_LENGTH * size);
  pen.fillStyle = theme.steel;
  pen.fillRect(end - 0.5 * size, top + 0.34 * tall, 0.5 * size - plate, 0.32 * tall);
  pen.fillStyle = theme.muted;
  pen.fillRect(end - plate, top, plate, tall);
}

function wall(pen, left, ground, size, theme) {
  const tall = WALL_HEIGHT * size;
  pen.save();
  pen.beginPath();
  pen.rect(left, ground - tall, size, tall);
  pen.fillStyle = theme.line;
  pen.fill();
  pen.clip();
  pen.beginPath();
  for (let x = left - tall; x < left + size; x += Math.max(3, 0.16 * size)) {
    pen.moveTo(x, ground);
    pen.lineTo(x + tall, ground - tall);
  }
  pen.strokeStyle = theme.muted;
  pen.lineWidth = 1;
  pen.stroke();
  pen.lineWidth = 3;
  pen.strokeRect(left, ground - tall, size, tall);
  pen.restore();
}

function arrow(pen, x, y, length, colour) {
  if (Math.abs(length) < 2.5) return;
  const head = Math.sign(length) * Math.min(7, 0.6 * Math.abs(length)), back = x + length - head, half = 0.6 * Math.abs(head);
  pen.fillStyle = colour;
  pen.fillRect(Math.min(x, back), y - 1, Math.abs(back - x), 2);
  pen.beginPath();
  pen.moveTo(x + length, y);
  pen.lineTo(back, y - half);
  pen.lineTo(back, y + half);
  pen.fill();
}

function rounded(pen, x, y, wide, tall, radius) {
  pen.beginPath();
  pen.roundRect(x, y, wide, tall, radius);
  pen.fill();
}

// Draw one line of text. `align` is "left", "center" or "right". If the text is wider than `room`, its letters are drawn narrower.
function write(pen, text, x, y, size, colour, align = "left", bold = false, room = undefined) {
  pen.font = `${bold ? 600 : 400} ${size}px ${FONT}`;
  pen.textAlign = align;
  pen.fillStyle = colour;
  pen.fillText(text, x, y, room);
}
const FONT = 'Inter, system-ui, -apple-system, "Segoe UI", Roboto, "DejaVu Sans", sans-serif';
