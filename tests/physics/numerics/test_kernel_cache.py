"""Tests of the disk cache of compiled kernels. The sources of a kernel are its key in the cache. A cached kernel must
never be outdated, and it must give bitwise the same results as plain Python.
"""

import os
import shutil
from pathlib import Path

import pytest
from softcradle.physics.numerics.float_bits import COMPILED
from softcradle.physics.numerics.jit import jit
from softcradle.physics.numerics.kernel_cache import cache_folder
from softcradle.physics.source_digest import digest_of, kernel_sources

from tests.helpers.own_process import python
from tests.helpers.paths import ROOT

PHYSICS = ROOT / "physics"

# This program prints the bytes of the results of a short run with every fixed-step method.
DIGITS = """
from softcradle import Chain, draft_gear, hertz, hooke, power_law, simulate
chain = Chain([1, 2, 0.5, 1, 3], [power_law(1, 0.1), hertz(2.0), draft_gear(3, 0.1), hooke(4.0)], [0, 0.01, 0, 0])
for method in ("euler", "verlet", "yoshida4", "conserving"):
    found = simulate(chain, [1, 0, 0, 0.25, -0.5], 0.5, method, step=0.01, samples=7)
    print(found.final_velocity.tobytes().hex(), found.overlap[3].tobytes().hex(), found.steps)
"""

ONE_FORCE = "from softcradle.physics.numerics.law_kernels import force; print(force(0.0, 1.0, 0.7, 0.5))"


def run(code: str, folder: Path = ROOT, **environment: str) -> str:
    kept = {key: value for key, value in os.environ.items() if not key.startswith("NUMBA_")}
    return python("-c", code, cwd=folder, env=kept, **environment).stdout


def test_the_cache_key_depends_on_all_kernel_sources(monkeypatch, tmp_path):
    names = {path.relative_to(PHYSICS).as_posix() for path in kernel_sources()}
    assert {"numerics/law_kernels.py", "adaptive/dop853.py", "pymunk_contacts/compiled_law.py"} <= names
    assert not names & {"chain.py", "simulation.py", "adaptive/runner.py", "reference/runner.py"}
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    assert cache_folder() == tmp_path / "kernels" / digest_of(kernel_sources())
    copy = tmp_path / "physics"
    shutil.copytree(PHYSICS, copy, ignore=shutil.ignore_patterns("__pycache__"))
    sources = kernel_sources(copy)
    assert {path.relative_to(copy).as_posix() for path in sources} == names
    keys = {digest_of(sources), digest_of(kernel_sources())}
    assert len(keys) == 1
    for path in sources:
        path.write_text(path.read_text() + "# edited\n")
        keys.add(digest_of(kernel_sources(copy)))
    (copy / "added.py").write_text("from softcradle.physics.numerics.jit import jit\n")
    keys.add(digest_of(kernel_sources(copy)))
    assert len(keys) == len(sources) + 2


def test_without_numba_the_same_functions_run(tmp_path):
    (tmp_path / "numba.py").write_text("raise ImportError('no wheel for this machine')")
    assert run(DIGITS, PYTHONPATH=str(tmp_path)) == run(DIGITS)


def test_an_edited_law_is_never_served_from_a_stale_cache(tmp_path):
    """Check that an edited contact law is compiled again. The test doubles a power in a copy of the package that shares
    the cache with the compiled originals. The mean force must double.
    """
    pytest.importorskip("numba")
    home = tmp_path / "house"
    for name in ("physics", "softcradle"):
        shutil.copytree(ROOT / name, home / name, ignore=shutil.ignore_patterns("__pycache__"))
    cache = {"NUMBA_CACHE_DIR": str(tmp_path / "cache")}
    before = float(run(ONE_FORCE, home, **cache))
    (written,) = (tmp_path / "cache" / "kernels").iterdir()
    assert list(written.rglob("*.nbi"))  # The kernel has been written to the cache.

    law = home / "physics" / "numerics" / "law_kernels.py"
    times = law.stat()
    text = law.read_text()
    line = "return preload + stiffness * power(overlap, exponent)\n"
    assert text.count(line) == 1
    law.write_text(text.replace(line, line.replace("stiffness", "2.0 * stiffness")))
    # The modification time of the file stays the same, so the cache cannot use it to detect the edit.
    os.utime(law, (times.st_atime, times.st_mtime))
    shutil.rmtree(law.parent / "__pycache__", ignore_errors=True)
    assert float(run(ONE_FORCE, home, **cache)) == 2.0 * before
    assert len(list((tmp_path / "cache" / "kernels").iterdir())) == 2


def test_compiling_leaves_other_users_of_numba_alone():
    numba = pytest.importorskip("numba")
    before = numba.config.CACHE_DIR
    jit(lambda x: x)
    assert before == numba.config.CACHE_DIR


@pytest.mark.skipif(not COMPILED, reason="machine code of numba")
def test_functions_of_a_whole_kernel_are_private():
    """Check that functions called by a kernel are private. LLVM inlines a private function that is called only once,
    whatever its size. Private functions save a quarter of the computing time of steps.
    """
    from numba import njit
    from softcradle.physics.numerics.jit import _Optimized, _Whole

    names: dict = {}
    exec("def long(x):\n" + 200 * "    x = x * x + 0.1\n" + "    return x\n", names)
    long = njit(pipeline_class=_Optimized)(names["long"])

    def twice(x):
        return long(long(x))

    whole = njit(pipeline_class=_Whole)(twice)
    assert whole(0.25) == names["long"](names["long"](0.25))
    (compiled,) = whole.overloads.values()
    code = compiled.library.get_llvm_str()
    assert "define private" in code
    assert "define linkonce_odr" not in code


@pytest.mark.parametrize("order", ["adaptive fixed_step", pytest.param("fixed_step adaptive", marks=pytest.mark.slow)])
def test_kernels_of_all_rooms_live_side_by_side(order):
    """Load the kernels of two folders in both orders. In an earlier version, kernels that were loaded later called
    functions of the other folder with different arguments.
    """
    code = "from importlib import import_module\n"
    for room in order.split():
        code += f"for tiers in import_module('softcradle.physics.{room}.runner').TIERS.values(): tiers.load_made()\n"
    code += "from softcradle import hertz, one_on, simulate\n"
    code += "for method in ('accurate', 'conserving'): print(simulate(one_on(2, hertz(1.0)), [1, 0, 0], method=method).steps)"
    assert all(int(steps) > 0 for steps in run(code).split())
