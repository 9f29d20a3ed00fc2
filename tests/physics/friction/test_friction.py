"""Bed friction and contacts with loss: closed forms, sticking, the energy ledger, refusals, and where they are kept."""

from __future__ import annotations

import math
import warnings
from dataclasses import replace

import numpy as np
import pymunk
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from softcradle.physics import (
    Chain,
    Contact,
    SoftChain,
    SoftContact,
    State,
    Trajectory,
    advance,
    draft_gear,
    hertz,
    one_on,
    power_law,
    simulate,
    step_force,
)
from softcradle.physics.chain import GRAVITY
from softcradle.physics.methods import METHODS
from softcradle.physics.scales import contact_scales, default_step
from softcradle.sandbox.session import Session
from softcradle.sandbox.session.inputs import SetContact, SetMethod
from softcradle.sandbox.trajectory_summary import summarise
from softcradle.scenes import SceneError, parse

DISSIPATIVE = [method.name for method in METHODS if method.dissipative]
SMALL = {"conserving": 1e-6, "scipy": 1e-7, "euler": 2e-2, "verlet": 4e-3, "pymunk": 2e-2}
LAWS = {
    "draft gear": draft_gear(770.0, 0.0177, 0.8),
    "Hertz": hertz(1.0, 0.8),
    "power law": power_law(1.0, 0.1, 0.8),
    "step": step_force(1.0, 0.8),
}


def small(method):
    return SMALL.get(method, 1e-7)


def step_of(method, chain, velocity, parts=1000):
    """A step for methods that need one; a thousandth of a contact by default."""
    adaptive = next(known.adaptive for known in METHODS if known.name == method)
    return None if adaptive else default_step(chain, velocity) * 1000 / parts


def ledger_error(found):
    scale = found.kinetic_energy[0] + found.contact_energy[0] + np.abs(found.driven).max()
    return float(np.ptp(found.ledger)) / scale


def random_dissipative(seed, most=6):
    """A chain that rubs: mixed masses and laws, losses, gaps, sometimes a wall or a drive; and its velocities."""
    draw = np.random.default_rng(seed)
    n = int(draw.integers(1, most + 1))
    mass = 10 ** draw.uniform(-1, 1, n + 1)
    if draw.random() < 0.2:
        mass[-1] = math.inf
    kinds = [
        lambda: power_law(10 ** draw.uniform(-1, 1), float(draw.choice([0.05, 0.1, 0.3]))),
        lambda: draft_gear(10 ** draw.uniform(0, 3), 10 ** draw.uniform(-3, 0)),
        lambda: hertz(10 ** draw.uniform(0, 4)),
        lambda: Contact(draw.uniform(0, 2), draw.uniform(0.1, 10), float(draw.choice([0.1, 0.5, 1, 1.5]))),
    ]
    laws = [replace(kinds[int(draw.integers(4))](), loss=float(draw.choice([0, 0.3, 0.8, 0.95]))) for _ in range(n)]
    gap = np.where(draw.random(n) < 0.7, 0.0, draw.uniform(0, 0.1, n))
    drive = np.where(np.isfinite(mass), draw.normal(size=n + 1), 0.0) if draw.random() < 0.2 else None
    velocity = np.where(np.isfinite(mass), draw.normal(size=n + 1), 0.0)
    return Chain(mass, laws, gap, drive, float(draw.choice([0.001, 0.01, 0.1, 0.5]))), velocity


# ---- closed forms


@pytest.mark.parametrize("method", DISSIPATIVE)
@pytest.mark.parametrize("friction", [0.05, 0.6])
def test_a_bead_slides_to_rest(method, friction):
    """It stops after v/(mu g), v²/(2 mu g) on, and the bed has all its energy."""
    chain = Chain([2.0, 1.0], power_law(1.0, 0.1), gap=50.0, friction=friction)
    time = 1.5 / (friction * GRAVITY)
    step = None if step_of(method, chain, [1.5, 0]) is None else time / 333.3
    found = simulate(chain, [1.5, 0], 1.5 * time, method, step, samples=16)
    assert found.position[-1, 0] == pytest.approx(1.5**2 / (2 * friction * GRAVITY), rel=1e-2 if step else 1e-9)
    if method == "conserving":
        assert found.position[-1, 0] == pytest.approx(1.5**2 / (2 * friction * GRAVITY), rel=1e-13)
    assert (found.velocity[11:, 0] == 0.0).all()
    assert (found.position[11:, 0] == found.position[-1, 0]).all()
    assert found.absorbed_by_bed[-1] == pytest.approx(0.5 * 2.0 * 1.5**2, rel=1e-12)
    assert (found.velocity[:, 1] == 0.0).all()


@pytest.mark.parametrize("method", DISSIPATIVE)
@pytest.mark.parametrize("law", LAWS)
def test_restitution_of_one_on_one(method, law):
    """What comes back is (1 - loss) of the energy: restitution sqrt(1 - loss), whatever the law."""
    if method == "scipy" and law == "power law":
        pytest.skip("a minute of the reference; draft gear, Hertz and step stand for it")
    chain = one_on(1, LAWS[law], [1.0, 3.0])
    found = simulate(chain, [1.0, 0.0], method=method, step=step_of(method, chain, [1.0, 0.0]))
    parting = found.final_velocity[1] - found.final_velocity[0]
    assert parting == pytest.approx(math.sqrt(0.2), rel=small(method) if law != "Hertz" else max(small(method), 1e-5))
    assert found.final_velocity @ [1.0, 3.0] == pytest.approx(1.0, rel=1e-12)
    assert found.absorbed_by_contacts[-1] == pytest.approx(
        0.8 * 0.375, rel=small(method) if method != "pymunk" else 0.02
    )
    assert found.absorbed_by_bed[-1] == 0.0


@pytest.mark.parametrize("method", DISSIPATIVE)
def test_a_push_below_the_threshold_moves_nothing(method):
    """Four beads on a bed, pushed with 0.99 mu g of all of them, stay bit for bit; with 1.01 they go, all alike."""
    weight = 0.3 * GRAVITY * 4
    for share in (0.99, 1.01):
        drive = [share * weight, 0.0, 0.0, 0.0]
        chain = Chain([1.0] * 4, draft_gear(100.0, 0.5), drive=drive, friction=0.3)
        step = None if step_of(method, chain, [0.0] * 4) is None else 1e-3
        if method in ("euler", "verlet", "pymunk"):  # f = 0 at overlap 0: a touching contact chatters there
            continue
        found = simulate(chain, [0.0] * 4, 0.5, method, step, samples=11)
        if share < 1.0:
            assert (found.position == 0.0).all()
            assert (found.velocity == 0.0).all()
        else:
            assert found.velocity[-1] == pytest.approx([0.5 * 0.01 * 0.3 * GRAVITY] * 4, rel=1e-9)
            assert np.diff(found.force[-1]) == pytest.approx([-weight * 1.01 / 4] * 2, rel=1e-6)


def test_struck_beads_beyond_the_reach_of_the_blow_stay():
    """A weak blow on a long row: what it cannot move does not move by one bit relative to the last, which is anchor."""
    chain = Chain([1.0] * 11 + [1.5], hertz(1e6), gap=0.001, friction=0.5)
    found = simulate(chain, [0.3] + [0.0] * 11, method="conserving")
    moved = found.position[-1] != found.position[0]
    assert moved[:2].all()
    assert not moved[-3:].any()
    assert (found.velocity[:, -7:] == 0.0).all()
    assert (found.rate[:, -6:] == 0.0).all()
    assert (found.overlap[:, -6:] == -0.001).all()
    assert found.warnings == ()


def test_a_gear_may_stay_pressed_on_its_bed():
    """Where friction can carry what a gear gives back, it stays pressed: everything rests and the run ends."""
    chain = Chain([1.0, 1.0], Contact(0.0, 50.0, 1.0, 0.95), friction=0.8)
    found = simulate(chain, [1.0, 0.0], method="conserving")
    assert found.contact_intervals[0][0][1] == math.inf
    assert found.velocity[-1].tolist() == [0.0, 0.0]
    assert found.overlap[-1, 0] > 0.0
    assert ledger_error(found) < 1e-12


# ---- ledger and convergence


@given(st.integers(0, 2**32 - 1), st.sampled_from([5, 60, 1000]))
def test_the_ledger_of_conserving_closes(seed, parts):
    chain, velocity = random_dissipative(seed)
    longest = float(contact_scales(chain, velocity)[1].max())
    longest = min(longest, np.ptp(velocity) / (chain.friction * GRAVITY))  # or the time in which the bed stops a bead
    found = simulate(chain, velocity, longest * min(20, 2000 / parts), "conserving", longest / parts, samples=41)
    assume(found.warnings == ())  # one in some hundred chains has a step that does not converge, and says so
    assert ledger_error(found) < 1e-10


@given(st.integers(0, 2**32 - 1))
@settings(max_examples=12)
def test_the_ledger_of_radau_closes(seed):
    chain, velocity = random_dissipative(seed, 4)
    longest = float(contact_scales(chain, velocity)[1].max())
    longest = min(longest, np.ptp(velocity) / (chain.friction * GRAVITY))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)
        found = simulate(chain, velocity, 2.0 * longest, "radau", samples=21, tolerance=1e-11)
    assume(found.warnings == ())
    assert ledger_error(found) < 2.0 * 10.0 * 1e-11  # ten tolerances of the velocities are twenty of the energy


@pytest.mark.parametrize("method", ["radau", "accurate", "scipy"])
def test_adaptive_methods_and_conserving_agree(method):
    """Stops, reversals, a gear that is held, a bead that sticks and is carried off: two ways that share no step."""
    chain = Chain([1.0, 2.0, 1.5, 1.0], draft_gear(300.0, 0.01, 0.6), gap=[0.005, 0.0, 0.002], friction=0.25)
    velocity = [1.0, 0.0, 0.0, -0.5]
    found = simulate(chain, velocity, 0.2, method, tolerance=1e-11)
    other = simulate(chain, velocity, 0.2, "conserving", 1e-6)
    assert np.abs(found.position - other.position).max() < 2e-7
    assert np.abs(found.velocity - other.velocity).max() < 1e-5
    assert np.abs(found.absorbed_by_bed - other.absorbed_by_bed).max() < 1e-6
    assert np.abs(found.absorbed_by_contacts - other.absorbed_by_contacts).max() < 1e-6
    assert ledger_error(found) < 1e-10
    assert found.warnings == ()


@pytest.mark.parametrize("method", ["euler", "verlet", "pymunk"])
def test_the_ledger_of_explicit_methods_closes_as_the_step_shrinks(method):
    chain = Chain([1.0, 2.0, 1.5], hertz(1000.0, 0.5), gap=0.01, friction=0.1)
    errors = [
        ledger_error(simulate(chain, [1, 0, 0], 0.4, method, step_of(method, chain, [1, 0, 0], parts)))
        for parts in (100, 400)
    ]
    assert errors[1] < 0.5 * errors[0] < 0.05


def test_conserving_is_of_second_order_through_stops_and_reversals():
    chain = Chain([1.0, 2.0, 1.5, 1.0], draft_gear(300.0, 0.01, 0.6), gap=[0.005, 0.0, 0.002], friction=0.25)
    velocity = [1.0, 0.0, 0.0, -0.5]
    fine = simulate(chain, velocity, 0.2, "conserving", 1e-6, samples=2)
    errors = [
        np.abs(simulate(chain, velocity, 0.2, "conserving", step, samples=2).position[-1] - fine.position[-1]).max()
        for step in (1.6e-3, 4e-4, 1e-4)
    ]
    assert errors[0] < 1e-4
    assert errors[2] < errors[0] / 40


def test_absorbed_energy_never_falls():
    chain = Chain([1.0] * 5, draft_gear(300.0, 0.01, 0.8), friction=0.1)
    found = simulate(chain, [1.0, 0, 0, 0, 0], method="conserving")
    assert np.diff(found.absorbed_by_contacts).min() > -1e-14
    assert np.diff(found.absorbed_by_bed).min() >= 0.0


# ---- the end, refusals, live use


def test_the_end_comes_when_nothing_can_meet_again():
    """A bead that stops short of the next does not keep the run going; one that will arrive does."""
    for speed, hits in ((1.0, False), (1.2, True)):
        chain = Chain([1.0, 1.0], hertz(1e5), gap=1.2**2 / (2 * 0.5 * GRAVITY) - 0.001, friction=0.5)
        found = simulate(chain, [speed, 0.0], method="conserving", step=1e-4)
        assert bool(found.contact_intervals[0]) == hits
        assert found.time[-1] < 0.3


def test_yoshida_refuses_in_one_sentence():
    for chain in (one_on(1, hertz(1.0, 0.1)), Chain([1, 1], hertz(1.0), friction=0.1)):
        with pytest.raises(ValueError, match=r"'yoshida4' steps back in time.*take 'conserving'"):
            simulate(chain, [1.0, 0.0], method="yoshida4")
        with pytest.raises(ValueError, match="yoshida4"):
            advance(chain, State.at_start(chain, [1.0, 0.0]), 0.1, "yoshida4")


@pytest.mark.parametrize("loss", [-0.1, 1.0, 2.0, math.nan])
def test_a_loss_out_of_range(loss):
    with pytest.raises(ValueError, match="loss"):
        Contact(1.0, 1.0, 1.0, loss)


@pytest.mark.parametrize("friction", [-0.1, math.inf, math.nan])
def test_a_friction_out_of_range(friction):
    with pytest.raises(ValueError, match="friction must be"):
        Chain([1, 1], hertz(1.0), friction=friction)


@pytest.mark.parametrize("method", ["conserving", "verlet", "pymunk"])
def test_advance_is_simulate(method):
    chain = Chain([1.0, 2.0, 1.0], draft_gear(300.0, 0.01, 0.7), gap=0.01, friction=0.2)
    state = State.at_start(chain, [1.0, 0.0, 0.0])
    for _ in range(20):
        advance(chain, state, 0.01, method, 1e-4)
    found = simulate(chain, [1.0, 0.0, 0.0], 0.2, method, 1e-4, samples=21)
    assert state.position(chain) == pytest.approx(found.position[-1], abs=1e-9 if method != "verlet" else 1e-6)
    both = found.absorbed_by_contacts[-1], found.absorbed_by_bed[-1]
    assert state.absorbed == pytest.approx(both, rel=1e-6)
    assert state.copy().absorbed.tolist() == state.absorbed.tolist()


def test_a_push_of_the_hand_is_felt_beyond_the_threshold():
    chain = Chain([1.0, 1.0], hertz(1e4), gap=1.0, friction=0.5)
    state = State.at_start(chain, [0.0, 0.0])
    for push, moves in ((0.9, False), (1.1, True)):
        state.push = np.array([push * 0.5 * GRAVITY, 0.0])
        advance(chain, state, 0.1, "conserving", 1e-3)
        assert (state.position(chain)[0] > 0.0) == moves


# ---- pymunk


def space_of(make, speed=1.0):
    space = pymunk.Space()
    balls = [pymunk.Body(1, math.inf) for _ in range(2)]
    for i, ball in enumerate(balls):
        ball.position = i, 0
    balls[0].velocity = speed, 0
    made = make(balls)
    space.add(*balls, *made)
    return space, balls, made


def test_a_soft_contact_with_loss():
    space, balls, made = space_of(lambda b: [SoftContact(*b, (0, 0), (0, 0), 1.0, hertz(100.0, 0.8))])
    assert not made[0].native
    for _ in range(20_000):
        space.step(1e-4)
    assert balls[1].velocity.x - balls[0].velocity.x == pytest.approx(math.sqrt(0.2), rel=1e-3)
    with pytest.raises(RuntimeError, match="has to look at velocities"):
        SoftContact(*balls, (0, 0), (0, 0), 1.0, hertz(100.0, 0.8), native=True)


@pytest.mark.parametrize("law", LAWS)
def test_a_soft_chain_with_loss(law):
    space, balls, (link,) = space_of(lambda b: list(SoftChain(b, LAWS[law], 1.0)), 0.5)
    for _ in range(10_000):
        space.step(1e-3)
    chain = link.chain
    assert balls[1].velocity.x - balls[0].velocity.x == pytest.approx(0.5 * math.sqrt(0.2), rel=1e-2)
    kinetic = sum(0.5 * ball.mass * ball.velocity.length**2 for ball in balls)
    assert kinetic + chain.energy + chain.absorbed == pytest.approx(0.125, rel=1e-9)


# ---- files, scenes, the window's books

SCENE = """
title = "Wagons"
[[lanes]]
beads = [1, 2]
mass = 80e3
contact = {law = "draft_gear", stiffness = 2e7, precompression = 0.01, loss = 0.8}
velocity = 1.5
approach = 0.1
friction = 0.002
"""


def test_scene_and_files_keep_friction_and_loss(tmp_path):
    scene = parse(SCENE)
    assert parse(scene.to_toml()) == scene
    lane = scene.lanes[0]
    chain = lane.chain()
    assert chain.friction == 0.002
    assert {contact.loss for contact in chain.contact} == {0.8}
    found = simulate(chain, lane.velocity, method="conserving")
    found.save(tmp_path / "wagons.npz")
    read = Trajectory.load(tmp_path / "wagons.npz")
    assert read.chain == chain
    assert (read.ledger == found.ledger).all()
    assert read.absorbed_by_contacts[-1] > 0.0
    found.to_csv(tmp_path / "wagons.csv")
    header, *rows = (tmp_path / "wagons.csv").read_text().splitlines()
    assert header.endswith("absorbed by contacts [J],absorbed by bed [J]")
    assert float(rows[-1].split(",")[-1]) == pytest.approx(found.absorbed_by_bed[-1])
    told = summarise("", found)
    assert told.energy_error < 1e-12
    assert told.absorbed_by_contacts == found.absorbed_by_contacts[-1]
    assert told.momentum_error is None


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("loss = 0.8", "loss = 1.0", "lanes[0].contact.loss must be less than 1"),
        ("loss = 0.8", "loss = -1", "loss"),
        ("friction = 0.002", "friction = -1", "lanes[0].friction must be greater than or equal to 0"),
        ('title = "Wagons"', 'title = "Wagons"\nmethod = "yoshida4"', "yoshida4"),
    ],
)
def test_a_scene_says_what_is_wrong(old, new, said):
    with pytest.raises(SceneError) as error:
        parse(SCENE.replace(old, new))
    assert said in str(error.value)


def test_the_window_books_what_is_absorbed():
    """A lossy scene is no energy error; edits keep friction and loss, and a method that takes neither is refused."""
    session = Session(parse(SCENE.replace("velocity = 1.5", "velocity = 3")))
    session.step_frames(100)
    health = session.health(0)
    assert health.energy_error < 1e-10
    assert health.momentum_error is None
    assert session.lanes[0].books[-2:].sum() > 0.0
    with pytest.raises(ValueError, match="yoshida4"):
        session.apply(SetMethod(0, "yoshida4"))
    session.apply(SetContact(0, 0, draft_gear(1e7, 0.01, 0.5)))
    session.step_frames(10)
    assert session.health(0).energy_error < 1e-10
    lane = parse(session.to_scene().to_toml()).lanes[0]
    assert lane.friction == 0.002
    assert [contact.loss for contact in lane.chain().contact] == [0.5, 0.8]
