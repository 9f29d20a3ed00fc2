// What benchmarks/page_play.py runs in a page: a clock of its own, random play, and what a picture costs.

// The page's clock is the script's; pointers that no hand moves can be captured as well.
const prelude = () => {
  window.pictures = [];
  window.requestAnimationFrame = (work) => pictures.push(work);
  HTMLCanvasElement.prototype.setPointerCapture = () => {};
  HTMLCanvasElement.prototype.hasPointerCapture = () => true;
  window.addEventListener('error', (event) => { window.thrown = String(event.error?.stack ?? event.message); });
  window.addEventListener('unhandledrejection', (event) => { window.thrown = String(event.reason?.stack ?? event.reason); });
};

// `count` pictures of random play; a number that is not finite ends it.
const play = (seed, count) => {
  const random = () => (seed = Math.imul(seed, 1664525) + 1013904223 >>> 0) / 4294967296, 
    pick = (list) => list[Math.floor(random() * list.length)];
  const send = (target, kind, more = {}) => target.dispatchEvent(new PointerEvent(kind, {bubbles: true, pointerId: 7, button: 0, ...more}));
  const input = (id, value, kind) => { const e = document.getElementById(id); e.value = value; e.dispatchEvent(new Event(kind)); };
  const pressed = () => (window.down?.stage.canvas.isConnected ? window.down : (window.down = null));
  const deeds = [
    [0.02, () => { const stage = pick(page.stages), box = stage.canvas.getBoundingClientRect();
      if (pressed()) return; const bead = Math.floor(random() * stage.edges.length);
      window.down = {stage, x: stage.middle(bead), y: box.top + stage.view.ground - stage.view.size / 2};
      send(stage.canvas, 'pointerdown', {clientX: box.left + down.x, clientY: down.y}); }],
    [0.03, () => { if (pressed()) { send(down.stage.canvas, 'pointerup'); window.down = null; } }],
    [0.01, () => { const canvas = pick(page.stages).canvas; canvas.focus(); canvas.dispatchEvent(new KeyboardEvent('keydown',
      {key: pick(['ArrowLeft', 'ArrowRight', 'Enter', 'Escape']), shiftKey: random() < 0.3, bubbles: true})); }],
    [0.004, () => document.body.dispatchEvent(new KeyboardEvent('keydown', {key: pick([' ', ',', '.', 'r']), bubbles: true}))],
    [0.012, () => input('alpha', Math.floor(1000 * random()), 'input')],
    [0.004, () => input(pick(['friction', 'loss']), random() < 0.5 ? 0 : Math.floor(1000 * random()), 'input')],
    [0.002, () => input('speed', Math.floor(1000 * random()), 'input')],
    [0.001, () => { input('targets', Math.floor((random() < 0.2 ? 1000 : 200) * random()), 'input'); }],
    [0.001, () => input('strikers', Math.floor(300 * random()), 'input')],
    [0.001, () => input('law', pick(LAWS), 'change')],
    [0.001, () => input('beside', pick(BESIDE), 'change')],
    [0.002, () => input('pace', String(pick(PACES)), 'change')],
    [0.002, () => input('time', Math.floor(1000 * random()), 'input')],
    [0.002, () => document.getElementById('show-' + pick(SHOWN)).click()],
    [0.002, () => document.getElementById(pick(['back', 'ahead', 'again', 'steel', 'toggle'])).click()],
    [0.0003, () => input('language', pick(['en', 'de', 'fr']), 'change')],
    [0.0005, () => { location.hash = pick(['#n=3&a=0.05', '#law=gear&with=soft', '#mu=0.02&v=0.5', '#', '#loss=0.5&n=12&m=2']); }],
  ];
  let off = 0, bad = 0, played = 0;
  for (let k = 0; k < count && !bad; k++) {
    window.wall = (window.wall || 0) + 1000 / 60;
    for (const [chance, deed] of deeds) if (random() < chance) deed();
    if (pressed()) { down.x += 60 * (random() - 0.5); const box = down.stage.canvas.getBoundingClientRect();
      send(down.stage.canvas, 'pointermove', {clientX: box.left + down.x, clientY: down.y}); }
    if (!page.playing && random() < 0.05) page.toggle();
    if (page.playing) played += 1;
    const due = pictures.splice(0);
    for (const work of due) work(wall);
    for (const row of page.source.rows) {
      off = Math.max(off, row.energyError());
      if (![...row.kernel.overlap, ...row.kernel.rate].every(Number.isFinite)) bad = k + 1;
    }
  }
  return {off, bad, played, thrown: window.thrown || '', seed};
};

// Milliseconds of physics and of drawing in a picture, the least of several runs: other processes may have the processors.
const cost = (repeats) => {
  const { source } = page, found = { physics: Infinity, drawing: Infinity };
  const timed = (name, work) => {
    page.pause();
    page.restart();
    let count = 0;
    const began = performance.now();
    for (; count < 240 && !source.over; count++) work(count);
    found[name] = Math.min(found[name], (performance.now() - began) / count);
  };
  for (let k = 0; k < repeats; k++) {
    timed('physics', () => { source.next(); source.next(); });
    timed('drawing', (count) => { source.next(); source.next(); page.show(count % 8 === 0); });
  }
  found.drawing -= found.physics;
  return found;
};

// Milliseconds from one picture to the next.
const pace = () => new Promise((done) => { const times = []; page.again(); const tick = (now) => { times.push(now);
  if (times.length < 150) frame(tick); else { const gaps = times.slice(1).map((t, k) => t - times[k]).sort((a, b) => a - b);
    done({median: gaps[75], most: gaps[140]}); } }; const frame = window.requestAnimationFrame; frame(tick); });
