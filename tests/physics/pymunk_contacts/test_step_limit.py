"""Tests of SoftContacts with steps that are too long: warnings, energy gain, substeps, and the table of docs/games.md."""

import math
import warnings

import pymunk
import pytest
from softcradle.physics import Contact, SoftContact, draft_gear, hertz, hooke, power_law
from softcradle.physics.pymunk_contacts import compiled_force

from benchmarks import soft_contacts
from tests.helpers.paths import ROOT
from tests.helpers.spaces import FRAME, cradle, pair, run

GROWING = {"hertz": hertz(1e6), "hooke": hooke(1e4), "power law": power_law(50.0, 0.1), "gear": draft_gear(1e3, 0.05)}
# These tests examine the warnings that the project's settings ignore.
pytestmark = pytest.mark.filterwarnings("default::RuntimeWarning")


def warned(space, step, count):
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        run(space, step, count)
    return [str(one.message) for one in said]


@pytest.mark.parametrize("native", [None, False])
@pytest.mark.parametrize("law", GROWING)
def test_one_warning_at_the_first_step_past_the_limit(law, native):
    space, bodies, _ = cradle(GROWING[law], native)
    bodies[0].position = -0.51, 0.0
    assert warned(space, FRAME, 30) == [], "they have not met"
    (sentence,) = warned(space, FRAME, 1)
    assert "is past its limit of about" in sentence
    assert "at 1 m/s" in sentence
    assert str(GROWING[law]) in sentence
    assert warned(space, FRAME, 150) == [], "once for each law"


def test_the_warning_names_the_calling_line():
    with pytest.warns(RuntimeWarning, match="SoftContact") as said:
        cradle(hertz(1e6))[0].step(FRAME)
    assert said[0].filename == __file__
    with warnings.catch_warnings(action="error"), pytest.raises(RuntimeWarning, match="past its limit"):
        cradle(hertz(1e6))[0].step(FRAME)


@pytest.mark.parametrize("native", [None, False])
@pytest.mark.parametrize("law", GROWING)
def test_substeps_keep_the_energy_and_are_silent(law, native):
    space, bodies, contacts = cradle(GROWING[law], native)
    substeps = contacts[0].substeps(FRAME, 1.0)
    assert substeps == contacts[0].substeps(FRAME / 2, 1.0) * 2 or substeps > 20
    assert warned(space, FRAME / substeps, 30 * substeps) == []
    kinetic = sum(0.5 * body.mass * body.velocity.length**2 for body in bodies)
    assert kinetic + sum(contact.energy for contact in contacts) == pytest.approx(0.5, rel=soft_contacts.SAID)


def test_changed_speeds_and_steps_are_checked_again():
    space, bodies, contacts = cradle(Contact(0.0, 1e5, 3.0), beads=2)
    step = FRAME / contacts[0].substeps(FRAME, 1.0)
    assert warned(space, step, 2000) == []
    bodies[0].velocity, bodies[0].position = (30.0, 0.0), bodies[1].position - (1.1, 0.0)
    (sentence,) = warned(space, step, 200)
    assert "m/s" in sentence
    space, bodies, contacts = cradle(hertz(1e4), beads=2)
    assert warned(space, 1e-4, 2000) == []
    for law in (None, hertz(1e9)):  # If the law of a contact is replaced, the step is checked again.
        if law:
            contacts[0].contact = law
        bodies[0].velocity, bodies[0].position = (bodies[1].velocity.x + 1.0, 0.0), bodies[1].position - (1.1, 0.0)
        assert len(warned(space, FRAME, 30)) == 1


def test_slow_contacts_beside_a_fast_blow_are_judged_by_it():
    """Check the inner contacts of a chain, which close slowly next to a fast collision. The errors of the slow contacts
    are compared with the speed of this collision.
    """
    space, _, contacts = cradle(power_law(50.0, 0.1))
    substeps = contacts[0].substeps(FRAME, 1.0)
    assert warned(space, FRAME / substeps, 10) == []
    assert 0.0 < contacts[3].rate < 0.01
    assert contacts[3].substeps(FRAME, contacts[3].rate) > 10 * substeps


def test_bodies_that_turn_yield_more():
    pairs = [pymunk.Body(1.0, 0.01), pymunk.Body(1.0, 0.01)]
    pairs[1].position = 1.0, 0.2
    centred = SoftContact(*pairs, (0, 0), (0, 0), 1.0, hooke(1e4)).substeps(FRAME, 1.0)
    aside = SoftContact(*pairs, (0, 0.2), (0, 0), 1.0, hooke(1e4)).substeps(FRAME, 1.0)
    assert aside > 1.5 * centred


def test_a_law_that_has_no_energy_at_some_depth_is_left_to_itself():
    space, _, contact = pair(1.0)
    contact.contact = lambda overlap: 10.0 * overlap if overlap < 1e-3 else math.nan
    contact.a.velocity = 1.0, 0.0
    with pytest.raises(ValueError, match=r"finite force, not nan at an overlap of 0.0"):
        run(space, 1e-3, 10)


@pytest.mark.parametrize("native", [None, False])
def test_a_body_that_is_nowhere_is_named(native):
    space, (a, _), _ = pair(0.75, native=native)
    a.velocity = math.nan, 0.0
    for _ in range(2):
        with pytest.raises(ValueError, match="a body of a SoftContact has the velocity Vec2d"):
            space.step(FRAME)


@pytest.mark.skipif(bool(compiled_force.unavailable()), reason=compiled_force.unavailable())
def test_compiled_code_asks_python_once_a_blow(monkeypatch):
    asked = []
    monkeypatch.setattr(SoftContact, "_look_at_step", lambda contact, overlap: asked.append(overlap))
    space, bodies, _ = cradle(hooke(30.0), beads=2)
    for _ in range(3):
        bodies[0].velocity, bodies[1].velocity = (1.0, 0.0), (0.0, 0.0)
        bodies[0].position = bodies[1].position - (1.05, 0.0)
        run(space, 1e-3, 1000)
    assert len(asked) == 3


def test_the_scan_finds_no_growth_without_a_warning():
    warned, gains = soft_contacts.silent(range(72))
    assert warned > 20
    assert len(gains) > 20
    assert [(seed, gain) for seed, gain in gains if gain > soft_contacts.SAID] == []


def test_the_table_of_the_page_is_measured():
    page = (ROOT / "docs" / "games.md").read_text(encoding="utf-8")
    rows = [f"| {' | '.join(row)} |" for row in soft_contacts.table()]
    assert [row for row in rows if row not in page] == []
