// Script that benchmarks/page_play.py runs in a page: a separate clock, random play, and the cost of a picture.

// Callbacks of the next picture by their number, the clock [ms], the bead in hand, and the last exception.
const random = { due: new Map(), requests: 0, wall: 0, down: null, thrown: '' };

// The page's clock is the script's; pointers that no hand moves can be captured as well.
const prelude = () => {
  window.requestAnimationFrame = (work) => { random.due.set(++random.requests, work); return random.requests; };
  window.cancelAnimationFrame = (number) => { random.due.delete(number); };
  HTMLAnchorElement.prototype.click = () => {}; // no downloads
  HTMLCanvasElement.prototype.setPointerCapture = () => {};
  HTMLCanvasElement.prototype.hasPointerCapture = () => true;
  window.addEventListener('error', (event) => { random.thrown = String(event.error?.stack ?? event.message); });
  window.addEventListener('unhandledrejection', (event) => { random.thrown = String(event.reason?.stack ?? event.reason); });
};

// `count` pictures of random play; a number that is not finite ends it.
const play = (seed, count) => {
  const chance = () => (seed = Math.imul(seed, 1664525) + 1013904223 >>> 0) / 4294967296,
    pick = (list) => list[Math.floor(chance() * list.length)];
  const send = (target, kind, more = {}) => target.dispatchEvent(new PointerEvent(kind, {bubbles: true, pointerId: 7, pointerType: 'mouse', isPrimary: true, button: 0, ...more}));
  const input = (id, value, kind) => { const e = document.getElementById(id); e.value = value; e.dispatchEvent(new Event(kind)); };
  const pressed = () => (random.down?.stage.canvas.isConnected ? random.down : (random.down = null));
  const deeds = [
    [0.02, () => { const stage = pick(page.stages), box = stage.canvas.getBoundingClientRect();
      if (pressed()) return; const bead = Math.floor(chance() * stage.edges.length);
      random.down = {stage, x: stage.middle(bead), y: box.top + stage.view.ground - stage.view.size / 2};
      send(stage.canvas, 'pointerdown', {clientX: box.left + random.down.x, clientY: random.down.y}); }],
    [0.03, () => { if (pressed()) { send(random.down.stage.canvas, 'pointerup'); random.down = null; } }],
    [0.01, () => { const canvas = pick(page.stages).canvas; canvas.focus(); canvas.dispatchEvent(new KeyboardEvent('keydown',
      {key: pick(['ArrowLeft', 'ArrowRight', 'Enter', 'Escape']), shiftKey: chance() < 0.3, bubbles: true})); }],
    [0.004, () => document.body.dispatchEvent(new KeyboardEvent('keydown', {key: pick([' ', ',', '.', 'r']), bubbles: true}))],
    [0.012, () => input('alpha', Math.floor(30 * chance()), 'input')],
    [0.004, () => input(pick(['friction', 'loss']), chance() < 0.5 ? 0 : Math.floor(91 * chance()), 'input')],
    [0.002, () => input('speed', Math.floor(25 * chance()), 'input')],
    [0.001, () => { input('targets', 1 + Math.floor((chance() < 0.2 ? 49 : 10) * chance()), 'input'); }],
    [0.001, () => input('strikers', 1 + Math.floor(4 * chance()), 'input')],
    [0.001, () => input('law', pick(LAWS), 'change')],
    [0.001, () => input('beside', pick(BESIDE), 'change')],
    [0.002, () => input('pace', String(pick(PACES)), 'change')],
    [0.002, () => input('time', Math.floor(1000 * chance()), 'input')],
    [0.002, () => document.getElementById('show-' + pick(SHOWN)).click()],
    [0.002, () => document.getElementById(pick(['back', 'ahead', 'again', 'contrast', 'toggle', 'explain', 'guess-last'])).click()],
    [0.0005, () => { for (const id of ['link', 'save-csv', 'save-png', 'close']) document.getElementById(id).click(); }],
    [0.0003, () => input('language', pick(['en', 'de', 'fr']), 'change')],
    [0.0005, () => { location.hash = pick(['#n=3&a=0.05', '#law=gear&with=soft', '#mu=0.02&v=0.5', '#', '#loss=0.5&n=12&m=2']); }],
  ];
  let off = 0, bad = 0, moved = 0, fastest = 0;
  for (let k = 0; k < count && !bad; k++) {
    random.wall += 1000 / 60;
    for (const [share, deed] of deeds) if (chance() < share) deed();
    if (pressed()) { random.down.x += 60 * (chance() - 0.5); const box = random.down.stage.canvas.getBoundingClientRect();
      send(random.down.stage.canvas, 'pointermove', {clientX: box.left + random.down.x, clientY: random.down.y}); }
    if (!page.playing && chance() < 0.05) page.toggle();
    const before = page.source.time, due = [...random.due.values()];
    random.due.clear();
    for (const work of due) work(random.wall);
    if (page.source.time !== before) moved += 1;
    for (const row of page.source.rows) {
      off = Math.max(off, row.energyError());
      fastest = Math.max(fastest, ...row.kernel.rate.map((rate) => Math.abs(rate) / row.spec.speed));
      if (![off, ...row.kernel.overlap, ...row.kernel.rate].every(Number.isFinite)) bad = k + 1;
    }
  }
  return {off, bad, moved, fastest, thrown: random.thrown, seed};
};

// The physics of `count` pictures.
const marched = (count) => { for (let k = 0; k < 2 * count; k++) page.source.next(); };

// `count` pictures of a motion that begins again and again, and the median of milliseconds from one to the next.
const shown = (count) => new Promise((done) => {
  const times = [];
  page.picture = (now) => {
    times.push(now);
    if (times.length <= count) { Page.prototype.picture.call(page, now); if (!page.playing) page.again(); return; }
    delete page.picture;
    page.pause();
    done(times.slice(1).map((time, k) => time - times[k]).sort((a, b) => a - b)[count >> 1]);
  };
  page.again();
});
