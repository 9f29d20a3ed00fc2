// What listens: pointers and keys on the beads, sliders, buttons, and the start of the page.

function canvasOf(page, lane, parent) {
  const canvas = document.createElement("canvas");
  canvas.className = "stage";
  canvas.tabIndex = 0;
  canvas.setAttribute("role", "application");
  parent.append(canvas);
  const across = (event) => event.clientX - canvas.getBoundingClientRect().left;
  const down = (event) => event.clientY - canvas.getBoundingClientRect().top;
  let wound = null;
  canvas.addEventListener("pointerdown", (event) => {
    if (event.button) return;
    const { source } = page, x = across(event), bead = source.live ? page.stages[lane].beadAt(x, down(event)) : -1;
    if (source.live && bead < 0) return;
    canvas.setPointerCapture(event.pointerId);
    if (source.live) page.grab(lane, bead, x); else wound = { x, time: source.time };
  });
  canvas.addEventListener("pointermove", (event) => {
    if (page.stages[lane]?.canvas !== canvas) return;
    const { source } = page, x = across(event);
    if (source.hand && source.hand.lane === lane && canvas.hasPointerCapture(event.pointerId)) { source.hand.across = x; page.follow(); }
    else if (wound && Math.abs(x - wound.x) > 4) page.go(wound.time + (source.last - source.begun) * (x - wound.x) / canvas.clientWidth);
    else if (source.live) canvas.style.cursor = page.stages[lane].beadAt(x, down(event)) < 0 ? "" : "grab";
  });
  for (const kind of ["pointerup", "pointercancel", "lostpointercapture"]) {
    canvas.addEventListener(kind, () => { wound = null; if (page.source.hand?.across !== null) page.release(); });
  }
  canvas.addEventListener("keydown", (event) => beadKey(page, lane, event));
  for (const kind of ["focus", "blur"]) {
    canvas.addEventListener(kind, () => {
      if (page.stages[lane]?.canvas !== canvas) return; // it is taken out
      if (kind === "blur") page.release();
      if (!page.playing) page.show(false);
    });
  }
  return canvas;
}

// Arrow keys choose a bead, or pull the one in hand, or throw it with Shift; Enter takes it and lets it go.
function beadKey(page, lane, event) {
  const { source } = page, direction = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
  if (!source.live || event.ctrlKey || event.metaKey || event.altKey || !(direction || event.key === "Enter" || event.key === "Escape")) return;
  event.preventDefault();
  const { mass } = source.rows[lane]; // that of a wall is 0
  if (page.chosen?.lane !== lane || !mass[page.chosen.bead]) page.chosen = { lane, bead: mass.findIndex(Boolean) };
  else if (direction && source.hand) source.hand.place += direction * PULLED * page.data.length;
  else if (direction && event.shiftKey) page.throwChosen(direction);
  else if (direction) {
    let bead = page.chosen.bead + direction;
    while (mass[bead] === 0) bead += direction;
    if (mass[bead]) page.chosen.bead = bead;
  }
  if (event.key === "Escape" || (event.key === "Enter" && source.hand)) page.release();
  else if (event.key === "Enter") page.grab(lane, page.chosen.bead, null);
  part("said").textContent = say("chosen", { bead: page.chosen.bead, speed: speedText(source.values(lane).velocity[page.chosen.bead], page.specs[lane].speed) });
  if (!page.playing) page.show(false);
}

function chartCanvas(page, parent) {
  const figure = document.createElement("figure"), canvas = document.createElement("canvas");
  canvas.setAttribute("role", "img");
  figure.append(canvas);
  parent.append(figure);
  const go = (event) => {
    const chart = page.charts.find((found) => found.canvas === canvas);
    page.go(chart.timeAt(event.clientX - canvas.getBoundingClientRect().left));
  };
  canvas.addEventListener("pointerdown", (event) => { canvas.setPointerCapture(event.pointerId); go(event); });
  canvas.addEventListener("pointermove", (event) => { if (canvas.hasPointerCapture(event.pointerId)) go(event); });
  return canvas;
}

/** Tables of what beads and contacts do now. @param {Page} page @param {Now[]} nows */
function fillTables(page, nows) {
  const rows = (titles, lines) => {
    const table = document.createElement("table"), add = (row, tag, text) => { const cell = document.createElement(tag); cell.textContent = text; row.append(cell); };
    const head = table.createTHead().insertRow(), body = table.createTBody();
    titles.forEach((title) => add(head, "th", title));
    lines.forEach((line) => { const row = body.insertRow(); line.forEach((text) => add(row, "td", text)); });
    return table;
  };
  part("tables").replaceChildren(...nows.flatMap((now, lane) => {
    const { mass, velocity } = page.specs[lane], caption = document.createElement("h3");
    caption.textContent = page.looks[lane].label;
    const digits = Math.max(2, 3 - Math.floor(Math.log10(Math.max(...page.source.scales.velocity.map(Math.abs)))));
    const before = (k) => (page.data.lanes[lane]?.late ? "-" : fixed(velocity[k], digits));
    const beads = mass.map((m, k) => [String(k), m === null ? say("wall") : plain(m, 4), before(k), fixed(now.velocity[k], digits)]);
    const contacts = Array.from(now.force, (force, k) => [`${k}-${k + 1}`, say(now.state[k]), plain(force, 4), now.overlap[k] > 0 ? scientific(now.overlap[k], 3) : "0"]);
    return [caption, rows([say("bead"), say("mass"), say("before"), say("now")], beads),
      rows([say("contact"), say("state"), say("force now"), say("overlap now")], contacts)];
  }));
}

/** @param {Page} page */
function listen(page) {
  const { source, limits } = page, on = (id, kind, work) => part(id).addEventListener(kind, work);
  on("toggle", "click", () => page.toggle());
  on("again", "click", () => page.again());
  on("back", "click", () => page.step(-1));
  on("ahead", "click", () => page.step(1));
  on("pace", "change", () => page.edit("pace", Number(part("pace").value)));
  on("time", "input", () => page.go(source.begun + (source.last - source.begun) * Number(part("time").value) / SLIDER));
  on("language", "change", () => { page.speak(part("language").value); page.build(); page.controls(); page.label(); page.dress(); });
  on("numbers", "toggle", () => page.show(true));
  window.addEventListener("hashchange", () => page.open());
  for (const name of SHOWN) on(`show-${name}`, "change", () => page.edit("shown", SHOWN.filter((each) => part(`show-${each}`).checked)));
  if (source.live) {
    for (const name of Object.keys(SLIDERS)) on(name, "input", () => page.edit(name, SLIDERS[name].from(Number(part(name).value) / SLIDER, limits[name])));
    for (const name of ["law", "beside"]) on(name, "change", () => page.edit(name, part(name).value));
    on("steel", "click", () => page.edit("beside", page.experiment.beside === "none" ? "steel" : "none"));
    on("link", "click", () => copyLink(page));
  }
  const keys = { " ": () => page.toggle(), ",": () => page.step(-1), ".": () => page.step(1), r: () => page.again() };
  document.addEventListener("keydown", (event) => {
    const target = /** @type {HTMLElement} */ (event.target);
    if (event.ctrlKey || event.metaKey || event.altKey || target.closest("select, summary, button, input:not([type=range])")) return;
    if (!keys[event.key]) return;
    keys[event.key]();
    event.preventDefault();
  });
  for (const query of ["(prefers-color-scheme: dark)", "print"]) matchMedia(query).addEventListener("change", () => page.dress());
  let size = "";
  new ResizeObserver(() => {
    const now = `${part("lanes").clientWidth} ${window.innerHeight}`;
    if (now !== size) { size = now; page.dress(); }
  }).observe(part("lanes"));
}

// Copy the address, or show it where there is no clipboard.
async function copyLink(page) {
  page.write();
  try { await navigator.clipboard.writeText(location.href); } catch {
    part("notice").textContent = location.href;
    part("notice").hidden = false;
    return;
  }
  part("link").textContent = say("copied");
  setTimeout(() => { part("link").textContent = say("link"); }, 1500);
}

// The kernels of the page, or why it cannot have them.
async function kernels(text) {
  const packed = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const code = new Response(packed).body.pipeThrough(new DecompressionStream("gzip"));
  return WebAssembly.compile(await new Response(code).arrayBuffer());
}

/** @returns {Promise<Page>} */
async function start() {
  const data = JSON.parse(part("data").textContent), code = part("kernels");
  let source = null, why = "recorded";
  useLanguage(knownLanguage(addressLanguage(location.hash) ?? navigator.language));
  if (code) {
    try { source = new Live(data, await kernels(code.textContent)); } catch { why = "refused"; }
  }
  if (!source) part("notice").textContent = say(part("notice").dataset.say = why);
  part("notice").hidden = source !== null;
  document.body.classList.toggle("live", source !== null);
  source ??= new Recorded(data);
  return new Page(data, source);
}

const started = start();
