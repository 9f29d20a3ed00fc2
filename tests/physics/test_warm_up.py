"""Compiling is told of, and can be done ahead: in processes of their own, with an empty cache."""

import subprocess

import pytest
from softcradle.physics.kernel_tiers import FIRST, KernelTiers

from softcradle import warm
from tests.helpers.own_process import python

pytest.importorskip("numba")
CRADLE = "import softcradle as s\ns.simulate(s.one_on(1, s.power_law(1, 1)), [1, 0], method='verlet')"


def run(folder, *arguments: str, **more: str) -> subprocess.CompletedProcess[str]:
    cache = {"NUMBA_CACHE_DIR": str(folder / "kernels"), "SOFTCRADLE_CACHE": str(folder), **more}
    return python(*arguments, **cache)


@pytest.mark.slow
def test_first_use_that_compiles_says_so_and_the_second_has_nothing_to_say(tmp_path):
    first = run(tmp_path, "-c", CRADLE, SOFTCRADLE_COMPILE="first")
    assert first.stderr.count(FIRST) == 1
    assert run(tmp_path, "-c", CRADLE).stderr == ""


@pytest.mark.slow
def test_the_command_says_it_too_unless_quiet(tmp_path):
    scene = ("-m", "softcradle", "run", "hertz-cradle", "--method", "verlet", "--step", "1e-3", "--duration", "0.1")
    first = run(tmp_path, *scene, SOFTCRADLE_COMPILE="first")
    assert first.stderr.splitlines()[0] == f"softcradle: {FIRST}"
    assert FIRST not in run(tmp_path / "other", *scene, "-q", SOFTCRADLE_COMPILE="first").stderr


def test_warm_takes_names():
    warm("verlet")
    warm(["euler", "SoftChain"])
    with pytest.raises(ValueError, match="did you mean 'verlet'"):
        warm("verlt")


def test_warm_loads_the_kernels_of_batches(monkeypatch):
    loaded = []
    monkeypatch.setattr(KernelTiers, "load", lambda kernels: loaded.append(kernels.name))
    warm("ensemble_ends")
    assert set(loaded) == {"batch-march", "batch-adaptive"}
    warm()
    assert {"batch-adaptive", "adaptive", "fixed-step"} <= set(loaded)
