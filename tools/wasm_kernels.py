"""Kernels of the web pages as WebAssembly, compiled from the numba sources of the engine.

    python -m tools.wasm_kernels [FILE]         writes assets/page/kernels.wasm; needs numba and a linker: pip install
        '.[wasm]'

The kernels are `march` with the method conserving. The exports are `march` (no friction, no loss) and `march_lossy`.
Their arguments are addresses in the memory of the module, and numbers of 32 bits or floats, so a caller does not need
BigInt. KERNELS lists the exports, and `tools/wasm_runner.py` calls them. The exports use WebAssembly of 2017, which
every browser supports, and import no functions. The results of the exports are bitwise the same as those of the native
kernels, because all operations are IEEE 754 operations.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

FILE = Path(__file__).parents[1] / "assets" / "page" / "kernels.wasm"
TRIPLE, PROCESSOR = "wasm32-unknown-unknown", "mvp"
# Sizes of the stack and of the memory in bytes. A page enlarges the memory for long chains.
STACK, MEMORY = 2**16, 3 * 2**16
LINKER = (sys.executable, "-m", "ziglang", "wasm-ld")
# Environment in which numba creates code that does not depend on this machine. A separate process and folder are used,
# because such kernels must not be used elsewhere.
FOR_ANY_MACHINE = {
    "NUMBA_OPT": "0",
    "NUMBA_CPU_NAME": "generic",
    "NUMBA_CPU_FEATURES": "",
    "NUMBA_LOOP_VECTORIZE": "0",
    "NUMBA_SLP_VECTORIZE": "0",
    "PYTHONWARNINGS": "ignore",  # Suppress the warning of numba that these kernels cannot be cached.
}

# Names of the arguments: first numbers, then addresses, then the parts for dissipation. Arguments that a page never
# needs are left out or empty.
NUMBERS = "n, anchor_bead, pushed, rows, most_steps, h, start, end, swing"
ARRAYS = (
    "law, inverse_mass, push, overlap, rate, anchor, force, absorbed, log_contact, log_time, closed, counter, plan, beads, "
    "work, reached, rest"
)
LOSSY = "loss, bed, beds"
KERNEL = """
def march({names}):
    no_flags, none, none_2 = view(closed, (0,)), view(law, (0,)), view(law, (0, 1))
    m = n + 1 if pushed else 0
    knots = Knots(none, view(law, (0, 0)), view(law, (0, 0)), none, none, none, none, none)
    rows_2, whole = view(law, (0, 0)), view(counter, (0,))
    graph = Graphs(no_flags, no_flags, whole, rows_2, view(counter, (0, 4)), rows_2, rows_2, rows_2, rows_2)
    strings = Strings(view(rest, (n + 1 if swing > 0.0 else 0,)), swing)
    outside = view(push, (m,)), view(push, (m,))
    chain = view(law, (n, 3)), view(inverse_mass, (n + 1,)), *outside, int64(anchor_bead), graph, knots, {dissipation}, strings
    motion = (
        view(overlap, (n,)), view(rate, (n,)), view(anchor, (2,)), view(force, (n,)), view(absorbed, (2,)), no_flags, no_flags
    )
    samples = none, none_2, none_2, none_2, none_2, none_2
    log = view(log_contact, (rows,)), view(log_time, (rows,)), view(closed, (n,)), view(counter, (COUNTERS,))
    pause = view(plan, (3,))[1:], none  # that step of `plan` that never comes, and 0: not begun
    status, time = step_loop.march(
        (none, none, h), (start, end, False, int64(most_steps)), chain, motion, samples, log, (samples, view(plan, (3,))),
        pause, (view(beads, (BEAD_ROWS, n + 1)), view(work, (WORK_ROWS, n))),
    )
    reached[0] = time
    return status
"""
KERNELS = {
    "march": (f"{NUMBERS}, {ARRAYS}", "Dissipation(none, none)"),
    "march_lossy": (f"{NUMBERS}, {ARRAYS}, {LOSSY}", "Dissipation(view(loss, (n,)), view(bed, (beds,)))"),
}

# LLVM replaces loops that fill memory with zeros by a call of this C function.
MEMSET = """
define ptr @memset(ptr %to, i32 %byte, i32 %size) "no-builtins" {
  %narrow = trunc i32 %byte to i8
  br label %check
check:
  %k = phi i32 [ 0, %0 ], [ %next, %loop ]
  %more = icmp ult i32 %k, %size
  br i1 %more, label %loop, label %end
loop:
  %at = getelementptr i8, ptr %to, i32 %k
  store i8 %narrow, ptr %at
  %next = add i32 %k, 1
  br label %check
end:
  ret ptr %to
}
"""


def view_intrinsic() -> Any:
    """Return the function ``view(pointer, shape)``, which returns the numbers at an address as a C-ordered array.

    The array does not own its memory. numba.carray is not used because it counts references.
    """
    from numba import types
    from numba.core import cgutils
    from numba.extending import intrinsic
    from numba.np import arrayobj

    @intrinsic
    def view(typing_context: Any, pointer: Any, shape: Any) -> Any:
        array = types.Array(pointer.dtype, len(shape), "C")

        def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
            given = zip(cgutils.unpack_tuple(builder, arguments[1]), signature.args[1], strict=True)
            sizes = [context.cast(builder, size, kind, types.intp) for size, kind in given]
            width = context.get_constant(types.intp, context.get_abi_sizeof(context.get_data_type(array.dtype)))
            strides = [width]
            for size in reversed(sizes[1:]):
                strides.insert(0, builder.mul(strides[0], size))
            made = arrayobj.make_array(array)(context, builder)
            arrayobj.populate_array(
                made, data=builder.bitcast(arguments[0], made.data.type), shape=cgutils.pack_array(builder, sizes),
                strides=cgutils.pack_array(builder, strides), itemsize=width, meminfo=None,
            )  # fmt: skip
            return made._getvalue()

        return array(pointer, shape), generate

    return view


def kernel(name: str) -> tuple[Any, Any]:
    """Return the function that the module exports as `name`, and its signature."""
    from numba import types
    from numpy import int64
    from softcradle.physics.fixed_step import step_loop
    from softcradle.physics.fixed_step.discrete_gradient import WORK_ROWS
    from softcradle.physics.numerics.contact_solve import BEAD_ROWS
    from softcradle.physics.numerics.records import COUNTERS, Dissipation, Graphs, Knots, Strings

    floats, flags, counts = (types.CPointer(kind) for kind in (types.float64, types.int8, types.int64))
    whole, number = types.int32, types.float64
    kinds = {"h": number, "start": number, "end": number, "swing": number, "closed": flags} | dict.fromkeys(
        NUMBERS.split(", ")[:5], whole
    )
    kinds |= {"log_contact": counts, "counter": counts, "plan": counts, "beds": whole}
    names, dissipation = KERNELS[name]
    found: dict[str, Any] = {
        "view": view_intrinsic(), "int64": int64, "step_loop": step_loop, "WORK_ROWS": WORK_ROWS, "COUNTERS": COUNTERS,
        "Dissipation": Dissipation, "Graphs": Graphs, "Knots": Knots, "Strings": Strings, "BEAD_ROWS": BEAD_ROWS,
    }  # fmt: skip
    exec(KERNEL.format(names=names, dissipation=dissipation), found)
    return found["march"], types.int32(*(kinds.get(each, floats) for each in names.split(", ")))


def leave_out() -> None:
    """Exclude code that a page does not use.

    Excluded are tables of segments, forces over time, explicit steps, pauses and checkpoints. The excluded parts would
    be three tenths of the file.
    """
    from softcradle.physics.fixed_step import explicit_steps, step_loop
    from softcradle.physics.numerics import graph_kernels, knots, table_kernels
    from softcradle.physics.numerics.jit import inlined

    @inlined
    def nothing(*_: Any) -> bool:
        return False

    left_out = graph_kernels.has_segments, graph_kernels.settle_graph_forces, table_kernels.has_table, knots.put_mean
    left_out += knots.add_half_work, knots.steady_until, explicit_steps.split_steps, step_loop.keep_pause
    left_out += (step_loop.keep_checkpoint,)
    for module in [module for name, module in sys.modules.items() if name.startswith("softcradle.physics")]:
        for name, value in list(vars(module).items()):
            if any(value is each for each in left_out):
                setattr(module, name, nothing)


def portable_code(name: str) -> tuple[str, str]:
    """Return the LLVM code of a kernel and the name of its symbol.

    The code is not optimised, and includes all functions that the kernel calls.
    """
    import numba
    from numba.core.codegen import CPUCodeLibrary

    # Optimisation is switched off here. Otherwise numba would inline every function, and the file would be three times
    # as large.
    CPUCodeLibrary._optimize_functions = CPUCodeLibrary._optimize_final_module = lambda *_: None
    function, signature = kernel(name)
    leave_out()
    options = {"_nrt": False, "error_model": "numpy", "no_cpython_wrapper": True, "no_cfunc_wrapper": True}
    (made,) = numba.njit([signature], **options)(function).overloads.values()
    return made.library.get_llvm_str(), made.fndesc.llvm_func_name


def wasm_module(code: str, symbols: dict[str, str], machine: Any) -> Any:
    """Return the code as an LLVM module for WebAssembly, with its `symbols` renamed."""
    import llvmlite.binding as llvm

    for symbol, name in symbols.items():
        code = code.replace(symbol, name).replace(f'@"{name}"', f"@{name}")
    code = re.sub(r"= common (local_unnamed_addr )?global", "= internal global", code)
    code = re.sub(r'^target (triple|datalayout) = ".*"$', "", code, flags=re.MULTILINE)
    code = re.sub(r'"target-(cpu|features)"="[^"]*"', "", code).replace("alwaysinline", "optsize")
    module = llvm.parse_assembly(code)
    module.triple, module.data_layout = TRIPLE, str(machine.target_data)
    return module


def compiled(module: Any, exports: set[str], machine: Any) -> bytes:
    """Return the module as an object file that exposes only `exports`."""
    import llvmlite.binding as llvm

    for function in module.functions:
        if not function.is_declaration:
            function.linkage = "external" if function.name in exports else "internal"
            function.add_function_attribute("optsize")
    module.verify()
    options = llvm.create_pipeline_tuning_options(speed_level=2)
    options.loop_vectorization = options.slp_vectorization = False
    builder = llvm.create_pass_builder(machine, options)
    builder.getModulePassManager().run(module, builder)
    return machine.emit_object(module)


def build(out: Path) -> None:
    """Write the WebAssembly module with all kernels to `out`."""
    import llvmlite.binding as llvm

    llvm.initialize_all_targets()
    llvm.initialize_all_asmprinters()
    machine = llvm.Target.from_triple(TRIPLE).create_target_machine(cpu=PROCESSOR, opt=2, features="", reloc="static")
    module = llvm.parse_assembly("")
    for name in KERNELS:  # Code that several kernels share is included only once.
        code, symbol = portable_code(name)
        module.link_in(wasm_module(code, {symbol: name}, machine))
    with tempfile.TemporaryDirectory() as folder:
        objects = Path(folder, "kernels.o"), Path(folder, "memset.o")
        objects[0].write_bytes(compiled(module, set(KERNELS), machine))
        objects[1].write_bytes(compiled(wasm_module(MEMSET, {}, machine), {"memset"}, machine))
        exports = [f"--export={name}" for name in (*KERNELS, "__heap_base")]
        sizes = ["-z", f"stack-size={STACK}", f"--initial-memory={MEMORY}"]
        linked = [*map(str, objects), "-o", str(out)]
        subprocess.run([*LINKER, "--no-entry", *exports, "--gc-sections", "--strip-all", *sizes, *linked], check=True)
    out.chmod(0o644)


def main() -> None:
    """Build the module in a process whose kernels are not specific to this machine."""
    out = Path(sys.argv[1]) if len(sys.argv) > 1 else FILE
    if not FOR_ANY_MACHINE.items() <= os.environ.items():
        with tempfile.TemporaryDirectory() as folder:
            environment = os.environ | FOR_ANY_MACHINE | {"NUMBA_CACHE_DIR": folder}
            done = subprocess.run([sys.executable, "-m", "tools.wasm_kernels", str(out)], env=environment, check=False)
        sys.exit(done.returncode)
    build(out)
    print(f"{out}: {out.stat().st_size} bytes")


if __name__ == "__main__":
    main()
