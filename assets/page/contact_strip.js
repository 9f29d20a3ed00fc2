// The strip above the slider of time: a line for each contact while it is closed, in the colour of its bars and curves.

const STRIP_HEIGHT = 30, THUMB = 22; // of the slider's thumb, half of which lies beside both ends of its track

function contactStrip(canvas, motions, theme, [begin, end]) {
  const density = window.devicePixelRatio || 1, width = Math.max(canvas.parentElement.clientWidth, LEAST_WIDTH), pen = canvas.getContext("2d");
  canvas.width = Math.round(width * density);
  canvas.height = Math.round(STRIP_HEIGHT * density);
  pen.scale(density, density);
  const rows = motions.reduce((sum, motion) => sum + motion.contacts, 0), pitch = (STRIP_HEIGHT - 2) / rows;
  const across = (time) => THUMB / 2 + (width - THUMB) * (Math.min(Math.max(time, begin), end) - begin) / (end - begin);
  let row = 0;
  for (const motion of motions) {
    motion.closed.forEach((spans, k) => {
      const y = 1 + pitch * row++;
      pen.fillStyle = theme.line;
      pen.fillRect(across(begin), y + pitch / 2 - 0.5, across(end) - across(begin), rows > 12 ? 0 : 1);
      pen.fillStyle = theme.bead(k + 1);
      for (const [closed, opened] of spans) {
        const x = across(closed), wide = Math.max(1.5, across(opened ?? end) - x);
        pen.fillRect(x, y + 0.12 * pitch, wide, Math.max(1, 0.76 * pitch));
      }
    });
  }
}
