"""Tests of loading the compiled kernels in the background while the window is open."""

import sys

import pytest
from softcradle.physics.fixed_step.runner import TIERS
from softcradle.sandbox.session.inputs import SetFriction
from softcradle.sandbox.window.kernel_warmup import INTERVAL, KernelWarmup

from tests.helpers.own_process import python
from tests.helpers.paths import ROOT

PLAYED = """
from tests.helpers.windows import Driver
driver = Driver("one-on-four", wait=False)
assert not driver.app.warmup.complete.is_set()
assert not driver.page.editor.preparing
driver.run(60)
print(driver.session.time, driver.session.lanes[0].velocity.tolist())
driver.close()
"""


def test_warmup_loads_all_kernels_and_restores_the_switch_interval():
    """Check that all kernels are loaded and that the switch interval of Python's threads is restored.

    With the default interval of 5 ms, imports in the background delayed the frames of the window.
    """
    usual, warmup, other, done = sys.getswitchinterval(), KernelWarmup(), KernelWarmup(), []
    warmup.start()
    warmup.submit(done.append, lambda: 7)
    assert warmup.complete.wait(3600.0)
    other.start()
    warmup.stop()
    assert sys.getswitchinterval() == pytest.approx(INTERVAL)
    other.stop()
    assert sys.getswitchinterval() == pytest.approx(usual)
    while not warmup.deliver():
        pass
    assert done == [7]
    assert all(map(warmup.is_warm, ("conserving", "accurate", "pymunk")))


def test_without_machine_code_only_few_contacts_can_move(driver, monkeypatch) -> None:
    for kernels in TIERS.values():
        monkeypatch.setattr(kernels, "_loaded", False)
    warmup, lanes, time = driver.app.warmup, driver.session.lanes, driver.session.setup.frame_time
    assert warmup.can_move(lanes, time)
    assert not warmup.can_move(lanes, time, "accurate") or warmup.is_warm("accurate")
    monkeypatch.setattr("softcradle.sandbox.window.kernel_warmup.PLAIN_FRAME", 0)
    assert warmup.can_move(lanes, time, "pymunk"), "it has nothing to load"
    driver.session.apply(SetFriction(0, 0.1))
    driver.session.play()
    driver.frames(3)
    assert driver.page.editor.preparing
    frame = driver.session.frame
    driver.frames(3)
    assert driver.session.frame == frame
    monkeypatch.undo()
    driver.frames(3)
    assert not driver.page.editor.preparing
    assert driver.session.frame > frame


@pytest.mark.slow
def test_plain_python_plays_a_scene_with_the_same_digits(driver, tmp_path):
    drivers = {"SDL_VIDEODRIVER": "dummy", "SDL_AUDIODRIVER": "dummy"}
    plain = python("-c", PLAYED, cwd=ROOT, NUMBA_CACHE_DIR=str(tmp_path), **drivers)
    driver.run(60)
    assert plain.stdout.splitlines()[-1] == f"{driver.session.time} {driver.session.lanes[0].velocity.tolist()}"
