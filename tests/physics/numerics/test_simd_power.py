"""Powers in vector code: digits against decimal arithmetic, edges, and the same without the compiler."""

from __future__ import annotations

import decimal
import math
import os
import subprocess
import sys

import numpy as np
import pytest
from softcradle.physics.numerics.simd_power import forces, powers

ULPS = 2.0  # what the module promises
RANGES = {
    "all": (-300.0, 3.0, 0.005, 3.0),
    "overlaps of the paper": (-30.0, 0.0, 0.02, 0.2),
    "deep, small exponents": (-300.0, 3.0, 0.005, 0.1),
    "near one": (-1e-3, 1e-3, 0.005, 3.0),
    "subnormal numbers": (-323.0, -308.0, 0.005, 0.9),
}


def taken(base, exponent):
    result = np.empty_like(base)
    powers(base, exponent, result)
    return result


def ulps(base, exponent, result):
    """Largest distance from base**exponent in 34 digits, in units of the last place of a double."""
    worst = 0.0
    with decimal.localcontext(prec=34, Emin=-999999, Emax=999999):
        for d, a, found in zip(base.tolist(), exponent.tolist(), result.tolist(), strict=True):
            truth = (+decimal.Decimal(d)) ** (+decimal.Decimal(a))  # + rounds to the 34 digits: some have 750
            worst = max(worst, abs(float((decimal.Decimal(found) - truth) / decimal.Decimal(math.ulp(float(truth))))))
    return worst


@pytest.mark.parametrize("name", RANGES)
def test_within_two_units_of_the_last_place(name):
    low, high, least, most = RANGES[name]
    draw = np.random.default_rng(7)
    base = 10.0 ** draw.uniform(low, high, 1000)
    base, exponent = base[base > 0.0], draw.uniform(least, most, 1000)[base > 0.0]
    assert ulps(base, exponent, taken(base, exponent)) < ULPS


def test_a_power_with_a_wrong_last_bit_is_seen():
    base, exponent = np.array([0.3]), np.array([0.7])
    right = taken(base, exponent)
    assert ulps(base, exponent, right * (1.0 + 3 * np.finfo(float).eps)) > ULPS


def test_edges():
    base = np.array([0.0, -1.0, -np.inf, np.nan, np.inf, 1.0, 2.0, 1e300, 1e-300])
    found = taken(base, np.array([0.1, 0.1, 0.1, 0.1, 0.1, 2.7, 0.0, 2.0, 2.0]))
    assert np.array_equal(found, [0, 0, 0, np.nan, np.inf, 1, 1, np.inf, 0], equal_nan=True)


@pytest.mark.parametrize("exponent", [1.0, 1.5, 0.1, None])
def test_forces_follow_the_law(exponent):
    draw = np.random.default_rng(3)
    n = 301
    overlap = draw.normal(size=n)
    overlap[5], overlap[6] = 0.0, np.nan
    law = draw.uniform(0.1, 2.0, (n, 3))
    if exponent is not None:
        law[:, 2] = exponent
    found = np.empty(n)
    forces(law, overlap, found)
    truth = np.where(overlap <= 0.0, 0.0, law[:, 0] + law[:, 1] * np.abs(overlap) ** law[:, 2])
    np.testing.assert_allclose(found, truth, rtol=1e-15)


def test_nothing_pushes_nothing_is_left():
    found = np.full(70, 3.0)
    forces(np.full((70, 3), 0.1), np.linspace(-1.0, 0.0, 70), found)
    assert not found.any()


def test_same_without_compiler():
    program = """
import numpy as np
from softcradle.physics.numerics.simd_power import powers
draw = np.random.default_rng(5)
base, result = 10.0 ** draw.uniform(-300, 3, 500), np.empty(500)
powers(base, draw.uniform(0.005, 3.0, 500), result)
print(result.tobytes().hex())
"""
    found = [
        np.frombuffer(bytes.fromhex(_run(program, environment)), dtype=float)
        for environment in ({}, {"NUMBA_DISABLE_JIT": "1"})
    ]
    np.testing.assert_allclose(found[0], found[1], rtol=2 * np.finfo(float).eps)


def _run(program, environment):
    command = [sys.executable, "-c", program]
    return subprocess.run(
        command, env={**os.environ, **environment}, capture_output=True, text=True, check=True
    ).stdout.strip()
