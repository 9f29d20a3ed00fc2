// Plays pages in node, without a document: node story_of_pages.cjs SCRIPT PAGES KERNELS prints what each page reports at its end.
const { readFileSync } = require("node:fs");
const vm = require("node:vm");

const [, , script, pages, kernels] = process.argv;
const play = `
(page, module) => {
  const { data, computed } = page, source = computed ? new Live(data, module) : new Recorded(data);
  const specs = data.lanes.map((lane) => lane.spec), ends = specs.map(() => null);
  if (source.live) {
    source.begin(specs, 1);
    while (!source.over) {
      source.next();
      source.rows.forEach((row, k) => { ends[k] = row.apart ? ends[k] ?? source.time : null; });
    }
  } else source.go(source.last);
  const lanes = specs.map((spec, k) => {
    const velocity = source.parted?.velocity[k] ?? source.values(k).velocity, said = {};
    for (const code of Object.keys(WORDS)) {
      words = WORDS[code];
      numberForm.mark = code === "en" ? "." : ",";
      said[code] = whatHappened(velocity, spec);
    }
    return { groups: groupsOf(spec.mass, spec.velocity, velocity), said, end: ends[k], velocity: Array.from(velocity) };
  });
  return { lanes, apart: source.apart, frame: source.live ? source.frameTime : null };
}`;
const context = vm.createContext({ performance, atob, WebAssembly, console });
vm.runInContext(readFileSync(script, "utf8"), context);
const played = vm.runInContext(play, context);
const module_ = new WebAssembly.Module(readFileSync(kernels));
console.log(JSON.stringify(JSON.parse(readFileSync(pages, "utf8")).map((page) => played(page, module_))));
