"""Tests of the hits that SoftChain and SoftContact report. The tests check momentum and energy and compare the hits
with the table of Trajectory.hits.
"""

import copy

import numpy as np
import pytest
from softcradle.physics.analysis.hits import hits
from softcradle.physics.contact import draft_gear, hertz, hooke, power_law
from softcradle.physics.hit_table import COLUMNS, MOST_KEPT, HitLog

from softcradle import Chain, SoftChain, simulate
from tests.helpers.spaces import chain_row, pair, run

LOSSY = [hertz(200.0, loss=0.36), draft_gear(40.0, 0.02, loss=0.5), power_law(2.0, 0.3, loss=0.2)]


@pytest.mark.parametrize("law", [hertz(200.0), hooke(80.0), *LOSSY], ids=str)
def test_hits_of_a_chain_are_those_of_the_trajectory(law):
    space, bodies, chain = chain_row(law, gap=[0.1, 0.2, 0.15], beads=4)
    masses = [body.mass for body in bodies]
    assert chain.hits().size == 0  # The first call starts the log of hits.
    run(space, step=1e-3, count=3000)
    table = chain.hits()
    exact = hits(simulate(Chain(masses, law, gap=[0.1, 0.2, 0.15]), [1.0, 0.0, 0.0, 0.0], 3.0, samples=2))
    exact = exact[exact["end"] < 2.99]
    assert table.dtype.names == tuple(COLUMNS)
    assert table["contact"].tolist() == exact["contact"].tolist()
    for name, error in {
        "begin": 3e-3,
        "end": 5e-3,
        "impulse": 2e-3,
        "closing_speed": 5e-3,
        "largest_force": 0.05,
    }.items():
        assert table[name] == pytest.approx(exact[name], rel=error, abs=error)
    assert table["energy_lost"].sum() == pytest.approx(chain.absorbed, rel=1e-9, abs=1e-12)
    gained = np.array([body.mass * body.velocity.x for body in bodies]) - [masses[0], 0.0, 0.0, 0.0]
    passed = np.bincount(table["contact"], table["impulse"], minlength=3)
    assert np.append(0.0, passed) - np.append(passed, 0.0) == pytest.approx(gained, abs=1e-12)
    assert len(chain.hits()) == 0


def test_only_large_hits_since_the_last_call():
    space, _, chain = chain_row(hertz(500.0), gap=[0.1, 0.3], beads=3, masses=[1.0, 1.0, 0.1])
    chain.hits()
    run(space, count=150)
    assert len(chain.hits()) == 0  # The first hit has not ended yet.
    run(space, count=200)
    assert chain.hits()["contact"].tolist() == [0]
    run(space, count=300)
    impulse = 2.0 * 1.0 * 0.1 / 1.1
    (copied,) = SoftChain.of(other := space.copy())
    kept = chain.state
    run(space, count=200)
    run(other, count=200)
    assert copied.hits(threshold=0.9 * impulse)["impulse"] == pytest.approx([impulse], rel=1e-6)
    assert chain.hits(threshold=1.1 * impulse).size == 0
    chain.restore(kept)
    assert chain.hits().size == 0
    with pytest.raises(ValueError, match="threshold"):
        chain.hits(-1.0)


def test_a_log_that_nobody_reads_stays_small():
    log, zero, one = HitLog(1), np.zeros(1), np.ones(1)
    for _ in range(MOST_KEPT + 5):
        log.add_step(1.0, (-one, one), (-one, -one), one, one, zero)
    table = log.take()
    assert len(table) == MOST_KEPT
    assert table["begin"][0] == 5.0 + 1.0
    assert log.take().size == 0


@pytest.mark.parametrize("law", [hertz(200.0), *LOSSY], ids=str)
def test_a_soft_contact_calls_back_after_the_hit(law):
    found = []
    space, bodies, contact = pair(1.3, law, on_hit=lambda who, hit: found.append((who, hit)))
    bodies[0].velocity = 1.0, 0.0
    run(space, step=1e-4, count=30000)
    ((who, hit),) = found
    (exact,) = hits(simulate(Chain([1.0, 3.0], law, gap=0.3), [1.0, 0.0], samples=2))
    assert who is contact
    assert not contact.native
    assert hit.impulse == pytest.approx(1.0 - bodies[0].velocity.x, abs=1e-12)
    for name in COLUMNS:
        if name != "contact":
            assert getattr(hit, name) == pytest.approx(exact[name], rel=5e-3, abs=1e-4)


def test_on_hit_can_be_changed_and_its_errors_are_raised():
    def fail(contact, hit):
        raise ZeroDivisionError(f"{hit.impulse:.1f}")

    space, bodies, contact = pair(1.1)
    native = contact.native
    contact.on_hit = fail
    assert not contact.native
    bodies[0].velocity = 1.0, 0.0
    with pytest.raises(ZeroDivisionError, match=r"1\.5"):
        run(space, count=3000)
    assert copy.copy(contact).on_hit is None
    contact.on_hit = None
    assert contact.native == native
    if native:
        _, _, compiled = pair(native=True)
        with pytest.raises(RuntimeError, match="on_hit is called from a Python callback"):
            compiled.on_hit = fail
        assert compiled.on_hit is None
