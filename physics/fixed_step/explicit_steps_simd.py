"""Explicit steps of long chains: the drifts and kicks of `explicit_steps`, block by block, in vector code.

A block is drifted, its forces are evaluated and the contacts before it are kicked while it lies in the nearest cache; a block
in which no contact pushes takes no power. The operations on each contact are those of `explicit_steps.split_steps`, in the same
order: only the power differs, in its last digits.
"""

from __future__ import annotations

from softcradle.physics.numerics.float_bits import COMPILED, VECTORS
from softcradle.physics.numerics.jit import jit
from softcradle.physics.numerics.simd_power import forces

BLOCK = 256  # contacts of a block: their nine rows (18 kB) fit the first-level cache of current processors
LONG = 64 if COMPILED and VECTORS else 2**62  # contacts from which vector code measures faster than scalar steps


@jit
def drift(part, overlap, rate):
    """``d += part w``."""
    for i in range(overlap.size):
        overlap[i] += part * rate[i]


@jit
def kick_inner(part, rate, before, own, after, inverse_left, inverse_right):
    """``w += part (a_left - a_right)`` of contacts with a neighbour on both sides; forces before, at and after each."""
    for i in range(rate.size):
        rate[i] += part * ((before[i] - own[i]) * inverse_left[i] - (own[i] - after[i]) * inverse_right[i])


@jit
def kick_by_push(part, push, inverse_mass, rate):
    """``w += part (push_left/m_left - push_right/m_right)``; one bead more than contacts."""
    for i in range(rate.size):
        rate[i] += part * (push[i] * inverse_mass[i] - push[i + 1] * inverse_mass[i + 1])


@jit
def kick(first, last, part, inverse_mass, push, rate, force):
    """Kick the contacts from `first` to before `last`; their forces and those of their neighbours are known."""
    n = rate.size
    if push.size:
        kick_by_push(part, push[first : last + 1], inverse_mass[first : last + 1], rate[first:last])
    low, high = max(first, 1), min(last, n - 1)
    if first == 0 and last > 0:
        after = force[1] if n > 1 else 0.0
        rate[0] += part * (-force[0] * inverse_mass[0] - (force[0] - after) * inverse_mass[1])
    if high > low:
        kick_inner(
            part, rate[low:high], force[low - 1 : high - 1], force[low:high], force[low + 1 : high + 1],
            inverse_mass[low:high], inverse_mass[low + 1 : high + 1],
        )  # fmt: skip
    if last == n and n > 1:
        rate[n - 1] += part * ((force[n - 2] - force[n - 1]) * inverse_mass[n - 1] - force[n - 1] * inverse_mass[n])


@jit
def any_differs(overlap, closed):
    """Whether a contact has left the state in `closed`, without a branch."""
    found = 0
    for i in range(overlap.size):
        found |= (1 if overlap[i] > 0.0 else 0) ^ closed[i]
    return found != 0


@jit
def simd_split_steps(most, h, drifts, kicks, chain, motion, closed):
    """As `split_steps` without dissipation: up to `most` steps in place, until a contact leaves the state in `closed`."""
    inverse_mass, outside, bead = chain.inverse_mass, chain.push, chain.anchor_bead
    overlap, rate, anchor, force = motion.overlap, motion.rate, motion.anchor, motion.force
    n = overlap.size
    stages = kicks.size
    end = h * drifts[stages]
    for step in range(most):
        switched = False
        for stage in range(stages):
            part, strength = h * drifts[stage], h * kicks[stage]
            last_stage = stage == stages - 1
            for low in range(0, n, BLOCK):
                high = min(n, low + BLOCK)
                drift(part, overlap[low:high], rate[low:high])
                forces(chain.law[low:high], overlap[low:high], force[low:high])
                first, last = max(low - 1, 0), n if high == n else high - 1  # those whose neighbours' forces are known
                kick(first, last, strength, inverse_mass, outside, rate, force)
                if last_stage:
                    if end != 0.0:
                        drift(end, overlap[first:last], rate[first:last])
                    switched |= any_differs(overlap[first:last], closed[first:last])
            anchor[0] += part * anchor[1]
            if outside.size:
                anchor[1] += strength * outside[bead] * inverse_mass[bead]
            before = force[bead - 1] if bead > 0 else 0.0
            after = force[bead] if bead < n else 0.0
            anchor[1] += strength * (before - after) * inverse_mass[bead]
        if end != 0.0:
            anchor[0] += end * anchor[1]
        if switched:
            return step + 1
    return most
