"""Copies of arrays, number by number: a slice that takes an array might overlap it, so it would allocate, and kernels do not."""

from __future__ import annotations

from softcradle.physics.numerics.jit import jit


@jit
def copy_into(target, source):
    """``target[:] = source`` of arrays (k,)."""
    for i in range(source.size):
        target[i] = source[i]
