"""The part of a long chain that moves: a run that steps it alone is the run of the chain, digit for digit, and cheaper."""

from __future__ import annotations

import numpy as np
import pytest
from softcradle.physics import Chain, draft_gear, hertz, hooke, one_on, power_law
from softcradle.physics.adaptive import moving_part, runner
from softcradle.physics.adaptive.moving_part import SHORTEST, MovingPart, rests_exactly
from softcradle.physics.simulation import solve
from softcradle.physics.state import State

N = 600
LEFT, MIDDLE, RIGHT = np.eye(1, N + 1)[0], np.roll(np.eye(1, N + 1)[0], N // 2), -np.roll(np.eye(1, N + 1)[0], N)
UNEVEN = [1.0 + 0.3 * np.sin(i) for i in range(N + 1)]
GAPS = [0.01 * (i % 3) for i in range(N)]
STARTS = {
    "from the left": (one_on(N, hertz(1.0)), LEFT),
    "from the right": (one_on(N, hertz(1.0)), RIGHT),
    "from both sides": (one_on(N, hertz(1.0)), LEFT + RIGHT),
    "in the middle": (one_on(N, hertz(1.0)), MIDDLE),
    "in the middle, to a wall": (Chain([1.0] * N + [np.inf], hertz(1.0)), MIDDLE),
    "springs": (one_on(N, hooke(1.0)), LEFT),
    "uneven beads and gaps": (Chain(UNEVEN, hertz(1.0), GAPS), LEFT),
}


@pytest.fixture
def parts(monkeypatch):
    """The contacts [first, last) of all parts that are made."""
    made: list[tuple[int, int]] = []
    take = MovingPart._take

    def taking(part, first, last):
        made.append((first, last))
        take(part, first, last)

    monkeypatch.setattr(MovingPart, "_take", taking)
    return made


def whole(monkeypatch, *arguments, **options):
    """The same run without parts."""
    with monkeypatch.context() as patched:
        patched.setattr(runner, "_is_divisible", lambda _: False)
        return solve(*arguments, **options)


def assert_same(found, expected):
    for name in ("time", "position", "velocity", "overlap", "force", "final_velocity", "velocity_error"):
        np.testing.assert_array_equal(getattr(found, name), getattr(expected, name), err_msg=name)
    assert found.contact_intervals == expected.contact_intervals
    assert (found.steps, found.evaluations, found.status) == (expected.steps, expected.evaluations, expected.status)


@pytest.mark.parametrize("name", STARTS)
@pytest.mark.parametrize("duration", [60.0, 300.0])
def test_it_is_the_run_of_the_chain(name, duration, parts, monkeypatch):
    chain, velocity = STARTS[name]
    found = solve(chain, velocity, duration, samples=2, tolerance=1e-6)
    assert (parts[0] == (0, N)) is (name == "from both sides")  # one part has both
    assert_same(found, whole(monkeypatch, chain, velocity, duration, samples=2, tolerance=1e-6))


def test_a_collision_ends_when_that_of_the_chain_does(parts, monkeypatch):
    chain, velocity = STARTS["from the left"]
    found = solve(chain, velocity, samples=2, tolerance=1e-6)
    assert parts[-1] == (0, N)  # the last bead has left
    assert_same(found, whole(monkeypatch, chain, velocity, samples=2, tolerance=1e-6))


def test_beads_that_move_together_are_at_rest(parts, monkeypatch):
    """Where the anchor is beyond the part its way is one product, in place of a sum over all steps."""
    chain, velocity = STARTS["in the middle"]
    found = solve(chain, velocity + 0.25, 20.0, samples=2, tolerance=1e-6)
    assert all(first > chain.anchor for first, _ in parts)
    expected = whole(monkeypatch, chain, velocity + 0.25, 20.0, samples=2, tolerance=1e-6)
    np.testing.assert_array_equal(found.final_velocity, expected.final_velocity)
    np.testing.assert_allclose(found.position, expected.position, rtol=0.0, atol=1e-12)


def test_soft_contacts_of_dop853_alone(parts, monkeypatch):
    chain, velocity = one_on(300, power_law(1.0, 0.5)), np.eye(1, 301)[0]
    found = solve(chain, velocity, 3.0, "dop853", samples=2, tolerance=1e-6)
    assert parts[0][1] < 300
    assert_same(found, whole(monkeypatch, chain, velocity, 3.0, "dop853", samples=2, tolerance=1e-6))


def test_what_rests_is_not_stepped(monkeypatch):
    """A pulse that crosses a hundredth of the chain: no part is longer than a few times its way."""
    stepped: list[int] = []
    steps = MovingPart.steps

    def counted(part, most):
        found = steps(part, most)
        stepped.append(part.contacts)
        return found

    monkeypatch.setattr(MovingPart, "steps", counted)
    solve(one_on(20_000, hertz(1.0)), np.eye(1, 20_001)[0], 200 / 0.84, samples=2, tolerance=1e-6)
    assert max(stepped) < 2 * (200 + SHORTEST)
    assert len(stepped) < 100  # calls of the kernel


def test_no_step_reaches_the_edge_of_a_part(monkeypatch):
    """Ranges of active contacts end before it, with their margin: the bound on what a step adds holds."""
    chain, velocity = STARTS["from the left"]
    reached = []
    steps = MovingPart.steps

    def looked(part, most):
        if part.contacts < N:
            reached.append(part.last - part._moving(part.first, part.last)[1])
        return steps(part, most)

    monkeypatch.setattr(MovingPart, "steps", looked)
    solve(chain, velocity, 300.0, samples=2, tolerance=1e-6)
    assert min(reached) > moving_part.MARGIN


@pytest.mark.parametrize(
    ("chain", "explicit", "expected"),
    [
        (one_on(N, hertz(1.0)), False, True),
        (one_on(SHORTEST, hertz(1.0)), False, False),  # one part
        (one_on(N, power_law(1.0, 0.5)), False, False),  # radau couples all contacts
        (one_on(N, power_law(1.0, 0.5)), True, True),
        (one_on(N, draft_gear(1.0, 0.1)), True, False),  # what touches passes on at once what pushes it
        (Chain([1.0] * (N + 1), hertz(1.0), friction=0.1), False, False),
        (Chain([1.0] * (N + 1), hertz(1.0), drive=[1.0] + [0.0] * N), False, False),
    ],
)
def test_where_contacts_rest_exactly(chain, explicit, expected):
    state = State.at_start(chain, np.eye(1, chain.contacts + 1)[0])
    assert rests_exactly(chain, state, explicit) is expected
