// Installs the wheel given as an argument in Pyodide and runs one collision. The core needs no compiler: loops run as plain Python.
import { readFileSync } from "node:fs";
import { basename } from "node:path";
import { loadPyodide } from "pyodide";

const wheel = process.argv[2];
const pyodide = await loadPyodide();
await pyodide.loadPackage("micropip");
pyodide.FS.writeFile(`/tmp/${basename(wheel)}`, readFileSync(wheel));
const seconds = await pyodide.runPythonAsync(`
import micropip, time
await micropip.install("emfs:/tmp/${basename(wheel)}")
from softcradle import one_on, power_law, simulate
begin = time.perf_counter()
result = simulate(one_on(4, power_law(1.0, 0.1)), [1, 0, 0, 0, 0])
assert abs(result.final_velocity[0] + 0.5676) < 1e-4, result.final_velocity
time.perf_counter() - begin
`);
console.log(`one bead on four in Pyodide: ${seconds.toFixed(2)} s`);
