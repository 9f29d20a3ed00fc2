// Messages between the page and the site that embeds it. docs/sharing.md describes the messages.

/**
 * Return the state of the page for the site that embeds it.
 * @param {Page} page
 */
function stateOf(page) {
  const { source, specs, experiment, after, guess, asked, data } = page, list = (values) => Array.from(values);
  const known = Object.entries(KEYS).filter(([name]) => experiment[name] !== undefined);
  const settings = Object.fromEntries(known.map(([name, key]) => [key, experiment[name]]));
  const rows = specs.map(({ mass }, lane) => {
    const { position, velocity, overlap, force } = source.values(lane);
    return { mass, position: list(position), velocity: list(velocity), overlap: list(overlap), force: list(force) };
  });
  const subject = specs[subjectOf(specs)];
  return { title: part("title").textContent, story: part("lead").textContent, settings, time: source.time, end: source.last, playing: page.playing,
    touched: source.touched, guess: guess || null, outcome: after && outcomeOf(subject, after[subjectOf(specs)]).kind, rows,
    unmet: asked ? unmetWishes(asked, data, experiment, source.open ? Infinity : source.last) : [] };
}

/**
 * Answer messages of the site that embeds the page. Messages of other windows are ignored. Settings have the same form as in the address of
 * the page.
 * @param {Promise<Page>} started
 */
function listenHost(started) {
  window.addEventListener("message", async ({ data: message, source: host }) => {
    const asked = message?.softcradle;
    if (host !== window.parent || host === window || (asked !== "get" && asked !== "set")) return;
    const page = await started;
    if (asked === "set") page.obey({ ...message.settings }, message.play);
    const answer = () => window.parent.postMessage({ softcradle: "answer", id: message.id, state: stateOf(page) }, "*");
    if (message.follow) page.report = answer;
    answer();
  });
}
