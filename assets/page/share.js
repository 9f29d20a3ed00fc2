// Sharing and handing in. The module creates the link with its QR code, the code for embedding the page, and the table and the picture of a
// motion.

const MOST_ROWS = 600, MOST_VALUES = 40000; // Largest number of times in a table, and largest number of values in a table.
const QR_MARGIN = 4, QR_MODULE = 4; // Width of the light margin of a QR code in modules, and width of a module in pixels.
const FRAME = { width: 720, height: 420 }; // Size in pixels of an embedded page.

const onWeb = () => /^https?:$/.test(location.protocol);

// Return the address of the page with an added entry in its fragment. For a file on this device, return the file name instead of the full
// path.
function addressWith(page, more) {
  const fragment = [page.write(), more].filter(Boolean).join("&");
  const place = onWeb() ? location.href.split("#")[0] : decodeURIComponent(location.pathname.split("/").at(-1));
  return place + (fragment && `#${fragment}`);
}

// Write the texts of the dialog and open it. The path of a file on this device is useless to other people. Only the fragment after its name
// is shown.
function openShare(page) {
  const fragment = page.write(), link = onWeb() ? addressWith(page, "") : fragment && `#${fragment}`;
  const quoted = (text) => text.replaceAll("&", "&amp;").replaceAll('"', "&quot;"), cell = location.protocol === "about:";
  part("share-link").value = link;
  part("share-note").textContent = onWeb() ? "" : link ? say("send file", { text: link }) : say("send alone");
  part("share-part").hidden = cell; // A cell of a notebook has no address.
  part("share-link-part").hidden = !link;
  const title = quoted(part("title").textContent), size = `width="${FRAME.width}" height="${FRAME.height}" style="border: 0"`;
  const allowed = "allow-scripts allow-popups allow-downloads";
  part("share-code").value = `<iframe src="${quoted(addressWith(page, "embed=1"))}" title="${title}" ${size} sandbox="${allowed}"></iframe>`;
  const modules = onWeb() ? qrCode(link) : null;
  part("qr").hidden = !modules;
  if (modules) drawModules(part("qr"), modules);
  part("csv-text").value = "";
  part("csv").open = false;
  if (page.playing) page.pause();
  part("share").showModal();
}

function drawModules(canvas, modules) {
  const pen = canvas.getContext("2d"), size = modules.length + 2 * QR_MARGIN;
  canvas.width = canvas.height = size * QR_MODULE;
  pen.fillStyle = "#ffffff"; // QR code readers expect dark modules on a light background, whatever the theme is.
  pen.fillRect(0, 0, canvas.width, canvas.height);
  pen.fillStyle = "#000000";
  modules.forEach((row, y) => row.forEach((dark, x) => {
    if (dark) pen.fillRect((x + QR_MARGIN) * QR_MODULE, (y + QR_MARGIN) * QR_MODULE, QR_MODULE, QR_MODULE);
  }));
}

// Copy the text of a field to the clipboard. If the clipboard is not available, select the text.
async function copyText(field, button) {
  try { await navigator.clipboard.writeText(field.value); } catch { field.select(); return; }
  button.textContent = say("copied");
  setTimeout(() => { button.textContent = say("copy"); }, 1500);
}

/**
 * Return the played motion as a table (CSV) with one line for each time. It contains the position, velocity and force of each bead, and the
 * force of each contact. The position of a bead is the position of its left edge. The force on a bead is the sum of the forces of its
 * contacts.
 * @param {Page} page
 */
function csvOf(page) {
  const { source, specs, data } = page, beads = Math.max(...specs.map(({ mass }) => mass.length));
  const each = (count, name) => Array.from({ length: count }, (_, k) => name(k));
  const head = ["row", "time (s)", ...each(beads, (k) => `position ${k} (m)`), ...each(beads, (k) => `velocity ${k} (m/s)`),
    ...each(beads, (k) => `force ${k} (N)`), ...each(beads - 1, (k) => `contact force ${k}-${k + 1} (N)`)];
  const most = Math.max(2, Math.min(MOST_ROWS, Math.floor(MOST_VALUES / head.length / specs.length))), lines = [head];
  const number = (value) => String(Number(value.toPrecision(10)));
  specs.forEach((_, lane) => source.each(lane, most, (time, { position, velocity, force }) => {
    const n = velocity.length, filled = (list) => each(list === force ? beads - 1 : beads, (k) => (k < list.length ? number(list[k]) : ""));
    const net = each(n, (k) => (force[k - 1] ?? 0) - (force[k] ?? 0)), place = Array.from(position, (x, k) => x + k * data.length);
    lines.push([String(lane + 1), number(time), ...filled(place), ...filled(velocity), ...filled(net), ...filled(force)]);
  }));
  return `${lines.map((line) => line.join(",")).join("\r\n")}\r\n`;
}

// Return a picture of the visible rows and graphs with the title and the text above the beads. It is returned as a data address.
function pictureOf(page) {
  const { theme, stages, charts, experiment } = page, { density } = theme, edge = 16;
  const canvases = [...stages, ...(experiment.shown.includes("charts") ? charts : [])].map(({ canvas }) => canvas);
  const wide = Math.max(...canvases.map(({ width }) => width)) / density + 2 * edge, pen = document.createElement("canvas").getContext("2d");
  pen.font = `400 15px ${FONT}`;
  const lines = part("lead").textContent.split("\n").flatMap((text) => wrapped(pen, text, wide - 2 * edge)), top = 44 + 21 * lines.length;
  const tall = canvases.reduce((sum, { height }) => sum + height / density + 8, top) + edge;
  Object.assign(pen.canvas, { width: Math.round(wide * density), height: Math.round(tall * density) });
  pen.scale(density, density);
  pen.fillStyle = theme.paper;
  pen.fillRect(0, 0, wide, tall);
  write(pen, part("title").textContent, edge, 30, 20, theme.ink, "left", true, wide - 2 * edge);
  lines.forEach((text, k) => write(pen, text, edge, 54 + 21 * k, 15, theme.ink));
  canvases.reduce((y, canvas) => {
    pen.drawImage(canvas, edge, y, canvas.width / density, canvas.height / density);
    return y + canvas.height / density + 8;
  }, top);
  return pen.canvas.toDataURL("image/png");
}

// Return the lines of a text. Each line is at most `room` wide.
function wrapped(pen, text, room) {
  return text.split(" ").reduce((lines, word) => {
    const longer = lines.length ? `${lines.at(-1)} ${word}` : word;
    return lines.length && pen.measureText(longer).width <= room ? [...lines.slice(0, -1), longer] : [...lines, word];
  }, []);
}

// Offer a file for download.
function save(ending, address) {
  const link = document.createElement("a");
  link.download = `${part("title").textContent.replace(/[^\p{L}\p{N}]+/gu, "-").replace(/^-|-$/g, "").slice(0, 60) || "softcradle"}.${ending}`;
  link.href = address;
  link.click();
}

/** @param {Page} page */
function listenShare(page) {
  const on = (id, kind, work) => part(id).addEventListener(kind, work);
  on("link", "click", () => openShare(page));
  on("copy-link", "click", () => copyText(part("share-link"), part("copy-link")));
  on("copy-code", "click", () => copyText(part("share-code"), part("copy-code")));
  on("save-csv", "click", () => save("csv", `data:text/csv;charset=utf-8,${encodeURIComponent(csvOf(page))}`));
  on("save-png", "click", () => save("png", pictureOf(page)));
  on("csv", "toggle", () => { part("csv-text").value = part("csv").open ? csvOf(page) : ""; });
  on("copy-csv", "click", () => copyText(part("csv-text"), part("copy-csv")));
  on("close", "click", () => part("share").close());
}
