"""The warm-up of kernels behind the window."""

from __future__ import annotations

from softcradle.sandbox.session import Session
from softcradle.sandbox.window.kernel_warmup import KernelWarmup

from softcradle import scenes


def test_a_dissipative_scene_needs_kernels_of_its_own():
    warmup = KernelWarmup()
    conservative, dissipative = Session(scenes.load("one-on-four")).lanes, Session(scenes.load("train-cut")).lanes
    assert dissipative[0].chain.dissipative
    assert not warmup.can_move(conservative)
    warmup.start()
    assert warmup.complete.wait(300.0)
    warmup.stop()
    assert warmup.can_move(conservative)
    assert warmup.can_move(dissipative)
    warmup._warm.discard((dissipative[0].setup.method, True))
    assert warmup.can_move(conservative)
    assert not warmup.can_move(dissipative)
    assert warmup.can_move(dissipative, "yoshida4"), "a method that refuses the chain has nothing to load"
