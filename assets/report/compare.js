// A line in every chart shows the moment that the film shows; a click in a chart goes to its moment.
const film = document.querySelector("video");
const clock = Number(film.dataset.clock), slow = Number(film.dataset.slow), unit = Number(film.dataset.unit);
const cursors = [...document.querySelectorAll(".cursor")].map((line) => {
  const { low, high, left, right } = line.dataset;
  return { line, low: Number(low), high: Number(high), left: Number(left), right: Number(right) };
});
function show() {
  const time = (clock + film.currentTime / slow) / unit;
  for (const { line, low, high, left, right } of cursors) {
    const inside = time >= low && time <= high;
    line.setAttribute("visibility", inside ? "visible" : "hidden");
    if (inside) line.setAttribute("transform", `translate(${left + (right - left) * (time - low) / (high - low)})`);
  }
}
for (const cursor of cursors) {
  const svg = cursor.line.ownerSVGElement;
  svg.addEventListener("click", (event) => {
    const across = (event.clientX - svg.getBoundingClientRect().left) * svg.viewBox.baseVal.width / svg.clientWidth;
    const time = cursor.low + (cursor.high - cursor.low) * (across - cursor.left) / (cursor.right - cursor.left);
    film.currentTime = Math.min(Math.max(0, (time * unit - clock) * slow), film.duration || 0);
  });
}
const follow = () => { show(); if (!film.paused) requestAnimationFrame(follow); };
film.addEventListener("play", follow);
film.addEventListener("seeked", show);
film.addEventListener("timeupdate", show);
