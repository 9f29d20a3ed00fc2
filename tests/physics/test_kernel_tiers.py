"""Tests of compiled kernels and plain Python. Both must give bitwise equal results. A run must not wait for compiling
if plain Python is sufficient. Messages about compiling are checked as well.
"""

import os
from dataclasses import replace
from functools import partial
from unittest.mock import Mock

import pytest
from softcradle.physics import State, advance, hertz, kernel_tiers, one_on, power_law, simulate, warm
from softcradle.physics.adaptive import runner as adaptive
from softcradle.physics.fixed_step.runner import TIERS
from softcradle.physics.kernel_tiers import FIRST, KernelTiers
from softcradle.physics.numerics import kernel_cache
from softcradle.physics.numerics.float_bits import COMPILED
from softcradle.physics.numerics.plain_kernels import plain
from softcradle.physics.pymunk_contacts import soft_chain

from tests.helpers.motions import CASES, LONG_ROW, digits_of, runs
from tests.helpers.own_process import python
from tests.helpers.relations import LIVE, digits
from tests.helpers.spaces import chain_row
from tests.helpers.spaces import run as run_space

pytest.importorskip("numba")
pytestmark = pytest.mark.skipif(not COMPILED, reason="nothing compiles here")
ALL = (*adaptive.TIERS.values(), *TIERS.values(), soft_chain.KERNELS)


@pytest.fixture
def cold(monkeypatch):
    """Simulate a machine without any compiled kernels. Attempts to start a compilation are ignored."""
    for kernels in ALL:
        for name, value in (("_loaded", False), ("_first", False), ("spent", 0.0)):
            monkeypatch.setattr(kernels, name, value)
    monkeypatch.setattr(KernelTiers, "on_disk", False)
    monkeypatch.setattr(KernelTiers, "compile_behind", lambda self, niceness=0: False)
    return monkeypatch


@pytest.mark.parametrize("method", ["accurate", "radau", "dop853", "conserving", "verlet"])
@pytest.mark.parametrize("friction", [0.0, 0.01])
def test_every_kernel_of_a_run_is_loaded_first(monkeypatch, method, friction):
    """Check that every kernel is called when compiled kernels are loaded. Otherwise a kernel would be compiled during
    the first run, and the run would wait.
    """
    called: dict[str, set[str]] = {}

    def of(self, kernel, work=0.0):
        called.setdefault(self.name, set()).add(kernel.__name__)
        return kernel

    monkeypatch.setattr(KernelTiers, "of", of)
    monkeypatch.setattr(KernelTiers, "of_frame", of)
    monkeypatch.setattr(KernelTiers, "in_memory", False)
    monkeypatch.setattr(KernelTiers, "load_made", lambda self: None)
    chain, velocity = replace(one_on(2, power_law(1.0, 0.5)), friction=friction), [1, 0, 0]
    for options in ({"samples": 2}, {"samples": 9}, {"duration": 1.0}, {"duration": 1.0, "samples": [0.5, 0.7]}):
        simulate(chain, velocity, method=method, **options)
    advance(chain, State.at_start(chain, velocity), 0.1, method)
    needed, called = called, {}
    for kernels in ALL:
        kernels.call_all()
    assert needed
    for name, kernels in needed.items():
        assert kernels <= called[name]


def soft_chain_steps(loss):
    space, balls, chain = chain_row(power_law(100.0, 1.5, loss), beads=4)
    for k, ball in enumerate(balls):
        ball.position = k, 0.1 * k * k
    chain.touching_distance = [1.01, 1.04, 1.1]
    run_space(space, 1e-2, 200)
    return [tuple(ball.velocity) for ball in balls]


MOVED = [partial(digits_of, LONG_ROW, one.name) for one in LIVE]
MOVED += [partial(soft_chain_steps, loss) for loss in (0.0, 0.3)]
DRAWN = [name for name in CASES if name.startswith("random")]
MOVED += [partial(digits_of, CASES[name], method) for name, method in runs(DRAWN, ("accurate", "radau", "conserving"))]
MOVED.append(partial(digits_of, CASES["gears on straws"], "verlet"))


@pytest.mark.parametrize("moved", MOVED)
def test_plain_python_gives_the_digits_of_machine_code(cold, moved):
    plainly = moved()
    cold.undo()
    assert moved() == plainly


def test_machine_code_takes_over_between_steps(cold):
    chain, velocity = one_on(4, power_law(1.0, 0.1)), [1, 0, 0, 0, 0]
    called = []

    def of(self, kernel, work=0.0):
        called.append(plain(kernel) if len(called) < 2 else kernel)
        return called[-1]

    cold.setattr(KernelTiers, "of", of)
    mixed = simulate(chain, velocity, samples=2)
    assert called[:2] != called[-2:]
    assert mixed.steps > 2 * adaptive.PLAIN_PAUSE
    cold.undo()
    assert digits(simulate(chain, velocity, samples=2)) == digits(mixed)


@pytest.fixture
def waited(cold):
    """Return the list of kernels for which runs wait."""
    names = []
    cold.setattr(KernelTiers, "wait", lambda self: names.append(self.name))
    return names


def test_long_runs_wait_for_machine_code(waited):
    simulate(one_on(2, hertz(1.0)), [1, 0, 0], 1.0, method="verlet", step=1e-3)
    assert waited == []
    assert TIERS["fixed-step"].spent == 2000.0
    simulate(one_on(2, hertz(1.0)), [1, 0, 0], 1.0, method="verlet", step=1e-6)
    assert waited == ["fixed-step"]


def test_a_run_of_unknown_length_is_tried_and_begun_anew(cold, waited):
    chain, options = one_on(2, hertz(1.0)), {"method": "verlet", "step": 1e-4, "samples": 3}
    found = simulate(chain, [1, 0, 0], **options)
    assert waited == ["fixed-step"]
    cold.undo()
    assert digits(simulate(chain, [1, 0, 0], **options)) == digits(found)


@pytest.fixture
def locked(tmp_path, monkeypatch):
    """Return a function that creates kernels with a separate cache and a lock. According to the lock, the process
    `number` compiles these kernels.
    """
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))

    def made(number=None, niceness=0, load=lambda: None):
        kernels = KernelTiers("nothing", "no.such.module", load)
        kernels._lock.parent.mkdir(parents=True)
        kernels._lock.write_text(f"{number or os.getpid()} {niceness}")
        return kernels

    return made


def test_a_process_that_died_does_not_count_as_compiling(locked):
    kernels = locked(999999999)
    assert kernels.compile_behind()  # The new process does not find the module.
    kernels.wait()
    assert not kernels.compile_behind()
    assert not kernels.on_disk


def test_a_process_that_compiles_gives_signs_of_life(locked, monkeypatch):
    """Check that no other process starts to compile the same kernels, however long the compilation takes. Another
    process can later have the same process number.
    """
    monkeypatch.setattr(kernel_tiers, "HEARTBEAT", 0.0)
    long_ago = kernel_tiers.time() - 2.0 * kernel_tiers.LONGEST_SILENCE

    def compile_long():
        os.utime(kernels._lock, (long_ago, long_ago))
        while not kernel_tiers._is_alive(kernels._lock):
            pass

    kernels = locked(load=compile_long)
    kernels._loaded, kernels._first = False, True
    os.utime(kernels._lock, (long_ago, long_ago))
    assert not kernel_tiers._is_alive(kernels._lock)
    kernels.compile_and_unlock()
    assert not kernels._lock.exists()


def test_who_waits_long_says_for_what(locked, monkeypatch, caplog):
    monkeypatch.setattr(kernel_tiers, "TOLD_AFTER", 0.0)
    kernels = locked()
    monkeypatch.setattr(kernel_tiers, "sleep", lambda seconds: caplog.messages and kernels._made.touch())
    kernels.wait()
    assert f"waiting for kernels (nothing) that process {os.getpid()} compiles" in caplog.text


def test_requested_kernels_are_compiled_in_a_child_process(cold):
    """Check that a child process compiles while this process waits. If the wait is interrupted, the compilation must
    stop.
    """
    ended: list[str] = []
    cold.setattr(KernelTiers, "wait", Mock(side_effect=KeyboardInterrupt))
    cold.setattr(KernelTiers, "_stop", lambda self: ended.append(self.name))
    with pytest.raises(KeyboardInterrupt):
        TIERS["fixed-step"].load()
    assert ended == ["fixed-step"]


@pytest.mark.skipif(os.name != "posix", reason="processes are not nice here")
@pytest.mark.parametrize(("niceness", "begun"), [(0, False), (10, True)])
def test_awaited_kernels_are_compiled_with_normal_priority(locked, monkeypatch, niceness, begun):
    """Check a process that waits for kernels. If another process compiles the kernels with low priority, the waiting
    process must start its own compilation.
    """
    kernels = locked(niceness=niceness)
    # The other process finishes the compilation.
    monkeypatch.setattr(kernel_tiers, "sleep", lambda seconds: kernels._made.touch())
    assert kernels.compile_behind()
    assert kernels._process is None
    kernels.wait()
    assert (kernels._process is not None) == begun


def test_a_cache_that_cannot_be_written_is_no_error(tmp_path, monkeypatch):
    (tmp_path / "kernels").write_text("a file where the folder should be")
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    kernels = KernelTiers("nothing", "no.such.module", lambda: None)
    assert not kernels.compile_behind()
    kernels.wait()
    kernels.load()
    assert kernels.in_memory


def test_kernels_of_other_versions_are_dropped_when_they_are_not_used(tmp_path, monkeypatch):
    used, old, other = (tmp_path / name for name in ("0" * 16, "a" * 16, "something"))
    for folder in (used, old, other):
        folder.mkdir()
        (folder / "kernel.nbc").write_text("")
    kernel_cache.drop_unused(used)
    assert old.exists()
    monkeypatch.setattr(kernel_cache, "time", lambda: old.stat().st_mtime + kernel_cache.UNUSED + 1.0)
    kernel_cache.drop_unused(used)
    assert [folder.exists() for folder in (used, old, other)] == [True, False, True]


@pytest.mark.slow
def test_an_empty_cache_is_filled_behind(tmp_path):
    script = """
import os
from softcradle.physics.adaptive.runner import TIERS
from softcradle.physics.kernel_tiers import YIELDING
kernels = TIERS["adaptive"]
kernels.compile_behind(YIELDING)
while os.name == "posix" and os.getpriority(os.PRIO_PROCESS, kernels._process.pid) < YIELDING:
    pass  # a process that never yields to frames is gone in the end, an error
kernels.wait()
kernels.load_made()
print(kernels.in_memory)
"""
    done = python("-c", script, NUMBA_CACHE_DIR=str(tmp_path))
    assert done.stdout == "True\n"
    waits = "waiting for kernels"  # This message appears on a busy machine.
    assert [line for line in done.stderr.splitlines() if not line.startswith(waits)] == []


CRADLE = "import softcradle as s\ns.simulate(s.one_on(1, s.power_law(1, 1)), [1, 0], method='verlet')"


def in_a_new_cache(folder, *arguments, **more):
    return python(*arguments, NUMBA_CACHE_DIR=str(folder / "kernels"), SOFTCRADLE_CACHE=str(folder), **more)


@pytest.mark.slow
def test_the_first_use_reports_compiling(tmp_path):
    first = in_a_new_cache(tmp_path, "-c", CRADLE, SOFTCRADLE_COMPILE="first")
    assert first.stderr.count(FIRST) == 1
    assert in_a_new_cache(tmp_path, "-c", CRADLE).stderr == ""
    scene = ("-m", "softcradle", "run", "hertz-cradle", "--method", "verlet", "--step", "1e-3", "--duration", "0.1")
    told = in_a_new_cache(tmp_path / "command", *scene, SOFTCRADLE_COMPILE="first")
    assert told.stderr.splitlines()[0] == f"softcradle: {FIRST}"
    assert FIRST not in in_a_new_cache(tmp_path / "quiet", *scene, "-q", SOFTCRADLE_COMPILE="first").stderr


def test_warm_loads_kernels_by_name(monkeypatch):
    warm(["euler", "SoftChain"])
    for wrong, near in (("verlt", "verlet"), ("softchain", "SoftChain")):
        with pytest.raises(ValueError, match=f"did you mean '{near}'"):
            warm(wrong)
    with pytest.raises(ValueError, match=r"unknown method 'auto'; there are SoftChain, ensemble_ends, euler"):
        warm("auto")
    loaded = []
    monkeypatch.setattr(KernelTiers, "load", lambda kernels: loaded.append(kernels.name))
    warm("ensemble_ends")
    assert set(loaded) == {"batch-march", "batch-adaptive"}
    warm()
    assert {"batch-adaptive", "adaptive", "fixed-step"} <= set(loaded)
