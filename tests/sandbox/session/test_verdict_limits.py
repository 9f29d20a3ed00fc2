"""The health of a lane: good where the physics is right, bad with a sentence where it is not."""

import numpy as np
import pytest
from softcradle.physics import METHODS, simulate
from softcradle.physics.scales import speed_scale
from softcradle.sandbox.session import AddBead, SetContact, SetMethod, SetSlow, SetStep, SetVelocity
from softcradle.sandbox.session.lane_setup import ERROR, FRAME_COST, STEP_COST, choose_method, steps_in
from softcradle.sandbox.session.run_verdict import LEVELS, MOST_CHATTER

from softcradle import scenes
from tests.helpers.relations import simulate_quietly
from tests.helpers.scene_kinds import EVERY_SCENE
from tests.helpers.sessions import opened

LIVE = [method.name for method in METHODS if method.name != "scipy"]


def worst_of(session, frames=600):
    """The worst health in `frames` frames."""
    found = []
    for _ in range(frames // 20):
        session.step_frames(20)
        found += [session.health(lane) for lane in range(len(session.lanes))]
    return max(found, key=lambda health: LEVELS.index(health.level))


RATTLING = {"weak-contact"}  # the cluster that breaks rattles shortly: its contacts do bounce within a step or two


@pytest.mark.parametrize("name", EVERY_SCENE)
def test_the_chosen_method_is_good_on_every_scene(name):
    health = worst_of(opened(name), 900)
    assert health.level == "good" or (name in RATTLING and health.level == "fair")
    assert health.energy_error < 1e-10
    assert health.chatter < 0.5 or name in RATTLING


@pytest.mark.parametrize("name", EVERY_SCENE)
def test_the_chosen_step_holds_the_error_that_it_promises(name):
    """`mixed` alone rattles at its end, as the run that tells the truth warns."""
    scene = scenes.load(name)
    for lane in scene.lanes:
        chain, speed = lane.chain(), speed_scale(lane.chain(), lane.velocity)
        method, step = choose_method(chain, speed)
        found = simulate(chain, lane.velocity, scene.duration, method=method, step=step).final_velocity
        finer = {"method": method, "step": step / 16} if chain.dissipative else {}  # as accurate, and not a minute
        truth = simulate_quietly(chain, lane.velocity, scene.duration, **finer)
        assert not truth.warnings or name == "mixed"
        assert np.abs(found - truth.final_velocity).max() < ERROR * speed


@pytest.mark.parametrize("method", LIVE)
def test_every_method_can_be_switched_to_while_it_runs(method):
    session = opened("hertz-cradle")
    session.step_frames(510)
    session.apply(SetMethod(None, method))
    session.step_frames(500)
    lane = session.scene.lanes[0]
    truth = simulate(lane.chain(), lane.velocity, session.time, "conserving", step=1e-4).final_velocity
    assert session.lanes[0].velocity == pytest.approx(truth, abs=2e-3)
    assert session.health(0).level == "good"


@pytest.mark.parametrize("method", ["euler", "verlet", "yoshida4", "pymunk"])
def test_contacts_that_only_seem_to_stay_closed_are_chatter(method):
    session = opened("draft-gear-one-on-three")
    session.apply(SetMethod(0, method))
    health = worst_of(session)
    assert health.chatter > MOST_CHATTER
    assert health.level == "bad"
    assert method in health.sentence
    assert "conserving" in health.sentence


def test_too_large_a_step_of_an_explicit_method_is_bad():
    session = opened("hertz-cradle")
    session.apply(SetSlow(1.0))
    session.apply(SetMethod(0, "euler"))
    session.apply(SetStep(0, 0.05))
    session.apply(SetContact(0, None, session.lanes[0].chain.contact[0].__class__(0.0, 1e7, 1.5)))
    health = worst_of(session, 240)
    assert health.level == "bad"
    assert "smaller step" in health.sentence


def test_velocities_of_steps_longer_than_a_contact_are_called_arbitrary():
    session = opened("hertz-cradle")
    session.apply(SetSlow(1.0))
    session.apply(SetContact(0, None, session.lanes[0].chain.contact[0].__class__(0.0, 1e9, 1.5)))
    session.apply(SetStep(0, 1.0))
    health = session.health(0)
    assert health.steps_a_contact < 1.0
    assert (health.level, "arbitrary" in health.sentence) == ("bad", True)


def test_a_method_that_blows_up_is_stopped_and_reported():
    session = opened("hertz-cradle")
    session.apply(SetSlow(1.0))
    session.apply(SetMethod(0, "euler"))
    session.apply(SetStep(0, 1.0))
    session.apply(SetContact(0, None, session.lanes[0].chain.contact[0].__class__(0.0, 1e12, 10.0)))
    session.apply(SetVelocity(0, 0, 1e3))
    session.play()
    for _ in range(240):
        session.tick(1 / 60)
    assert not session.playing
    assert session.verdict() == ("bad", session.failure)
    assert "blown up" in session.failure
    assert np.isfinite(session.lanes[0].velocity).all()
    session.apply(SetMethod(0, "auto"))
    session.apply(SetVelocity(0, None, 0.0))
    session.play()
    session.tick(1 / 60)
    assert session.playing
    assert session.failure == ""


def test_a_frame_of_fifty_beads_leaves_time_for_drawing():
    session = opened()
    for _ in range(45):
        session.apply(AddBead(0, 5))
    session.apply(SetSlow(1.0))
    setup = session.setup.lanes[0]
    steps = steps_in(session.setup.frame_time, "conserving", 1e-9, 49, False)
    assert steps * 49 * STEP_COST["conserving"] <= FRAME_COST
    assert setup.step_for(session.setup.frame_time) <= setup.step * (1.0 + 1e-9)
