// Listeners for the pointer and keys on the beads, and for sliders and buttons. The module also starts the page.

// Movement of a finger in pixels after which the gesture is decided. A sideways movement drags. A vertical movement scrolls the page.
const SIDEWAYS = 8;

// Return true if the touch that began at `first` is a drag. Return false if it scrolls the page, and null if it is not decided yet.
function becomesDrag(first, event) {
  const x = Math.abs(event.clientX - first.clientX), y = Math.abs(event.clientY - first.clientY);
  return Math.max(x, y) < SIDEWAYS ? null : x > y;
}

/**
 * Report drags of an element. A drag with the mouse begins at once, and a drag with a finger or pen after a sideways movement. `begin` can
 * reject a drag. A `tap` is a touch without movement.
 * @param {HTMLElement} element
 * @param {{begin: (event: PointerEvent) => boolean, move: (event: PointerEvent) => void, end?: () => void, tap?: (event: PointerEvent) => void}} work
 */
function onDrag(element, { begin, move, end = () => {}, tap = () => {} }) {
  let first = null, dragged = false;
  const start = (event) => {
    dragged = begin(first);
    if (dragged) element.setPointerCapture(event.pointerId);
    first = null;
  };
  element.addEventListener("pointerdown", (event) => {
    if (event.button || !event.isPrimary) return;
    first = event;
    if (event.pointerType === "mouse") start(event);
  });
  element.addEventListener("pointermove", (event) => {
    const drag = first && becomesDrag(first, event);
    if (drag === false) first = null;
    else if (drag) start(event);
    if (dragged && element.hasPointerCapture(event.pointerId)) move(event);
  });
  element.addEventListener("pointerup", (event) => { if (first) tap(event); });
  for (const kind of ["pointerup", "pointercancel", "lostpointercapture"]) {
    element.addEventListener(kind, () => { first = null; dragged = false; end(); });
  }
}

/**
 * Report the values of a slider. A touch counts after a sideways movement or when it ends. If a touch scrolls the page, the slider returns
 * to its previous value.
 * @param {HTMLInputElement} input @param {() => void} work
 */
function onSlide(input, work) {
  let first = null, before = "";
  input.addEventListener("pointerdown", (event) => {
    first = event.pointerType === "mouse" ? null : event;
    before = input.value;
  });
  input.addEventListener("pointermove", (event) => {
    if (!first || !becomesDrag(first, event)) return;
    first = null;
    work();
  });
  input.addEventListener("pointerup", () => {
    if (first && input.value !== before) work();
    first = null;
  });
  input.addEventListener("pointercancel", () => {
    if (first) input.value = before;
    first = null;
  });
  input.addEventListener("input", () => { if (!first) work(); });
}

function canvasOf(page, lane, parent) {
  const canvas = document.createElement("canvas");
  canvas.className = "stage";
  canvas.tabIndex = 0;
  canvas.setAttribute("role", "application");
  parent.append(canvas);
  const across = (event) => event.clientX - canvas.getBoundingClientRect().left;
  const down = (event) => event.clientY - canvas.getBoundingClientRect().top;
  const there = () => page.stages[lane]?.canvas === canvas;
  let wound = null;
  onDrag(canvas, {
    begin: (event) => {
      const { source } = page, x = across(event);
      if (!source.live) wound = { x, time: source.time };
      else {
        const bead = page.stages[lane].beadAt(x, down(event));
        if (bead < 0) return false;
        page.grab(lane, bead, x);
      }
      return true;
    },
    move: (event) => {
      const { source } = page, x = across(event);
      if (!there()) return;
      if (source.hand?.lane === lane) { source.hand.across = x; page.follow(); }
      else if (wound && Math.abs(x - wound.x) > 4) page.go(wound.time + (source.last - source.begun) * (x - wound.x) / canvas.clientWidth);
    },
    end: () => { wound = null; if (page.source.hand?.across !== null) page.release(); },
  });
  canvas.addEventListener("pointermove", (event) => {
    if (page.source.live && !page.source.hand && there()) canvas.style.cursor = page.stages[lane].beadAt(across(event), down(event)) < 0 ? "" : "grab";
  });
  canvas.addEventListener("keydown", (event) => beadKey(page, lane, event));
  for (const kind of ["focus", "blur"]) {
    canvas.addEventListener(kind, () => {
      if (!there()) return; // The element is no longer part of the page.
      if (kind === "blur") page.release();
      if (!page.playing) page.show(false);
    });
  }
  return canvas;
}

// Handle a key that is pressed on the beads. Arrow keys choose a bead or pull the held bead. With Shift, they throw the bead. Enter takes
// and releases it.
function beadKey(page, lane, event) {
  const { source } = page, direction = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
  if (!source.live || event.ctrlKey || event.metaKey || event.altKey || !(direction || event.key === "Enter" || event.key === "Escape")) return;
  event.preventDefault();
  const { mass } = source.rows[lane]; // In this list, the mass of a wall is 0.
  const fresh = page.chosen?.lane !== lane || !mass[page.chosen.bead];
  if (fresh) page.chosen = { lane, bead: mass.findIndex(Boolean) };
  if (direction && source.hand) source.hand.place += direction * PULLED * page.data.length;
  else if (direction && event.shiftKey) page.throwChosen(direction);
  else if (direction && !fresh) {
    let bead = page.chosen.bead + direction;
    while (mass[bead] === 0) bead += direction;
    if (mass[bead]) page.chosen.bead = bead;
  }
  if (event.key === "Escape" || (event.key === "Enter" && source.hand)) page.release();
  else if (event.key === "Enter") page.grab(lane, page.chosen.bead, null);
  part("said").textContent = say("chosen", { bead: page.chosen.bead, speed: speedText(source.values(lane).velocity[page.chosen.bead]) });
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
  onDrag(canvas, { begin: (event) => { go(event); return true; }, move: go, tap: go });
  return canvas;
}

/** Write the current values of beads and contacts into the tables. @param {Page} page @param {Now[]} nows */
function fillTables(page, nows) {
  const rows = (titles, lines) => {
    const table = document.createElement("table"), add = (row, tag, text) => { const cell = document.createElement(tag); cell.textContent = text; row.append(cell); };
    const head = table.createTHead().insertRow(), body = table.createTBody();
    titles.forEach((title) => { add(head, "th", title); head.lastElementChild.setAttribute("scope", "col"); });
    lines.forEach((line) => { const row = body.insertRow(); line.forEach((text) => add(row, "td", text)); });
    return table;
  };
  part("tables").replaceChildren(...nows.flatMap((now, lane) => {
    const { mass, velocity } = page.specs[lane], caption = document.createElement("h2");
    caption.textContent = page.looks[lane].label;
    const digits = Math.max(2, 3 - Math.floor(Math.log10(Math.max(...page.source.scales.velocity.map(Math.abs)))));
    const before = (k) => (page.data.lanes[lane]?.late ? "-" : fixed(velocity[k], digits));
    const beads = mass.map((m, k) => [String(k), m === null ? say("wall") : plain(m, 4), before(k), fixed(now.velocity[k], digits)]);
    const contacts = Array.from(now.force, (force, k) => [`${k}-${k + 1}`, say(now.state[k]), plain(force, 4), now.overlap[k] > 0 ? scientific(now.overlap[k], 3) : "0"]);
    return [caption, rows([bodyWord("one"), say("mass"), say("before"), say("now")], beads),
      rows([say("contact"), say("state"), say("force now"), say("overlap now")], contacts)];
  }));
}

/** @param {Page} page */
function listen(page) {
  const { source, limits } = page, on = (id, kind, work) => part(id).addEventListener(kind, work);
  for (const kind of GUESSES) on(`guess-${kind}`, "click", () => page.answer(kind));
  on("explain", "click", () => page.reveal());
  on("toggle", "click", () => page.toggle());
  on("again", "click", () => page.again());
  on("back", "click", () => page.step(-1));
  on("ahead", "click", () => page.step(1));
  on("pace", "change", () => page.edit("pace", Number(part("pace").value)));
  onSlide(part("time"), () => page.go(source.begun + (source.last - source.begun) * Number(part("time").value) / SLIDER));
  on("language", "change", () => { page.speak(part("language").value); page.build(); page.controls(); page.label(); page.dress(); });
  on("numbers", "toggle", () => page.show(true));
  window.addEventListener("hashchange", () => page.open());
  for (const name of SHOWN) on(`show-${name}`, "change", () => page.edit("shown", SHOWN.filter((each) => part(`show-${each}`).checked)));
  if (source.live) {
    for (const name of Object.keys(SLIDERS)) onSlide(part(name), () => page.edit(name, SLIDERS[name].from(Number(part(name).value), limits[name])));
    for (const name of ["law", "beside"]) on(name, "change", () => page.edit(name, part(name).value));
    on("contrast", "click", () => {
      const { data, experiment, own } = page;
      page.edit("beside", experiment.beside === "none" ? contrastTo(compared(data, experiment, own)) : "none");
    });
  }
  listenShare(page);
  part("full").href = location.href; // An element without an address cannot get the focus.
  on("full", "click", () => { part("full").href = addressWith(page, "").replace(/[#&]embed=1/, ""); });
  const keys = { " ": () => page.toggle(), ",": () => page.step(-1), ".": () => page.step(1), r: () => page.again() };
  document.addEventListener("keydown", (event) => {
    const target = /** @type {HTMLElement} */ (event.target);
    if (event.ctrlKey || event.metaKey || event.altKey || target.closest("select, summary, button, input:not([type=range]), textarea, dialog, a")) return;
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

// Return the kernels of the page. The promise is rejected if the browser does not allow kernels.
async function kernels(text) {
  const packed = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const code = new Response(packed).body.pipeThrough(new DecompressionStream("gzip"));
  return WebAssembly.compile(await new Response(code).arrayBuffer());
}

// Wait until the browser has drawn the page. The first computation can take seconds.
const drawn = () => new Promise((done) => { setTimeout(done, 200); requestAnimationFrame(() => setTimeout(done, 0)); });

/** @returns {Promise<Page>} */
async function start() {
  const data = JSON.parse(part("data").textContent), code = part("kernels");
  let source = null, why = "recorded";
  useLanguage(languageIn([addressLanguage(location.hash), ...navigator.languages]) ?? "en");
  part("wait").textContent = say("wait");
  if (code) {
    try { source = new Live(data, await kernels(code.textContent)); why = ""; } catch { why = "refused"; }
  }
  document.body.classList.toggle("live", source !== null);
  document.body.classList.add("ready");
  await drawn();
  const page = new Page(data, source ?? new Recorded(data), why);
  part("wait").hidden = true;
  return page;
}

const started = start();
listenHost(started);
