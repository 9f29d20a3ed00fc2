// Loupes (magnified insets). Each contact has a separate magnification, because the overlaps of neighbouring contacts differ by orders of
// magnitude.

// Smallest distance of two loupes with text at the side, and with text below. The text is below only if the loupes do not fit otherwise.
const LOUPE_PITCH = 196, NARROW_PITCH = 86;
const GREATEST_DEPTH = 1.05; // Largest drawn overlap in radii of the loupe.

// Return the layout of the loupes of a lane. `contacts` are the contacts to show. Without `contacts`, and if there is not enough space, the
// loupes begin with the contact of the largest overlap. A `brief` text below a loupe omits the name of its contact. `small` loupes fit into
// a low window.
function loupeRow(motion, width, contacts = null, brief = false, small = false) {
  const wanted = contacts?.length ?? motion.contacts, narrow = brief || width < LOUPE_PITCH * Math.max(wanted, 3);
  const pitch = narrow ? NARROW_PITCH : LOUPE_PITCH, room = Math.max(1, Math.floor(width / pitch)), deepest = motion.deepest;
  const count = Math.min(room, wanted), first = Math.max(0, Math.min(deepest.indexOf(Math.max(...deepest)), wanted - room));
  const shown = contacts ? contacts.slice(0, count) : Array.from({ length: count }, (_, k) => first + k);
  const radius = small ? 18 : narrow ? 27 : 38, height = brief ? 2 * radius + 44 : narrow ? 122 : 96;
  return { narrow, brief, contacts: shown, radius, height, pitch: Math.min(width / count, 1.5 * pitch) };
}

function loupes(pen, row, view, now, top) {
  const { motion, theme } = view, largest = Math.max(...motion.deepest);
  row.contacts.forEach((k, slot) => {
    const aside = row.narrow ? 0 : -52, x = view.width / 2 + (slot - (row.contacts.length - 1) / 2) * row.pitch + aside, y = top + row.radius + 8;
    const magnify = roundDown(GREATEST_DEPTH * row.radius / (view.scale * (motion.deepest[k] || largest || 1)));
    leader(pen, view, now.contacts[k], x, y - row.radius);
    loupe(pen, view, k, now.overlap[k] * view.scale * magnify, x, y, row.radius);
    const depth = now.overlap[k], text = depth > 0 ? lengthText(depth, 2) : say(now.state[k]);
    const lines = [[say("overlap of", { contact: contactName(k) }), theme.muted, false], [text, depth > 0 ? theme.ink : theme.muted, depth > 0],
      [say("seen at", { factor: factorText(magnify) }), theme.muted, false]];
    if (row.narrow) { lines[0][0] = `δ${contactName(k)}`; lines[2][0] = factorText(magnify); }
    if (row.brief) lines.shift();
    lines.forEach(([line, colour, bold], n) => {
      if (row.narrow) write(pen, line, x, y + row.radius + 16 + 15 * n, 12, colour, "center", bold);
      else write(pen, line, x + row.radius + 11, y - 15 + 20 * n, bold ? 15 : 13, colour, "left", bold);
    });
  });
}

function leader(pen, view, contact, x, y) {
  pen.beginPath();
  pen.moveTo(Math.min(Math.max(contact, 0), view.width), view.ground + 2);
  pen.lineTo(x, y);
  pen.strokeStyle = view.theme.strong;
  pen.lineWidth = 1;
  pen.stroke();
}

function loupe(pen, view, k, depth, x, y, radius) {
  const { theme, colours } = view, shown = Math.max(depth, -1.1 * radius);
  pen.save();
  pen.beginPath();
  pen.arc(x, y, radius, 0, 2 * Math.PI);
  pen.fillStyle = theme.paper;
  pen.fill();
  pen.clip();
  if (view.motion.gears[k]) gearLoupe(pen, theme, colours[k], colours[k + 1], shown, x, y, radius);
  else {
    const cap = 1.5 * radius;
    disc(pen, x + shown / 2 - cap, y, cap, colours[k], 1.5, theme);
    disc(pen, x - shown / 2 + cap, y, cap, colours[k + 1], 1.5, theme);
  }
  pen.restore();
  pen.beginPath();
  pen.arc(x, y, radius, 0, 2 * Math.PI);
  pen.lineWidth = 1.5;
  pen.strokeStyle = theme.strong;
  pen.stroke();
}

// Draw the cylinder head, the piston and the opposite face of a draft gear. A dashed line marks the face of the piston at overlap 0.
function gearLoupe(pen, theme, left, right, depth, x, y, r) {
  const box = (colour, from, to, half) => { pen.fillStyle = colour; pen.fillRect(from, y - half, to - from, 2 * half); };
  const head = x - 0.75 * r, face = x + 0.45 * r, pushed = face - Math.max(depth, 0), other = face - depth;
  box(theme.steel, head, pushed, 0.22 * r);
  box(theme.muted, pushed - 0.16 * r, pushed, 0.5 * r);
  box(left, x - r, head, 0.8 * r);
  box(outlineOf(left, theme), head - 0.2 * r, head, 0.8 * r);
  box(outlineOf(right, theme), other, other + 2, 0.8 * r);
  box(right, other + 2, Math.max(x + r, other + 2), 0.8 * r);
  pen.fillStyle = theme.ink;
  for (let k = -4; k < 5; k += 2) pen.fillRect(face - 0.5, y + (k - 0.5) * 0.1 * r, 1, 0.1 * r);
}
