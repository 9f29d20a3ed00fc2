"""Contacts in a line of text: read, written back, refused in a sentence."""

from __future__ import annotations

import pytest
from softcradle.scenes import SceneError
from softcradle.scenes.contact_kinds import KINDS
from softcradle.scenes.contact_text import contact_from, contact_text

from softcradle import physics

WRITTEN = {
    "power_law(1, 0.1)": physics.power_law(1.0, 0.1),
    "draft_gear(770, 0.0177)": physics.draft_gear(770.0, 0.0177),
    "hertz(30)": physics.hertz(30.0),
    "hooke(0.001)": physics.hooke(0.001),
    "step_force(2)": physics.step_force(2.0),
    "preloaded(1, 2, 0.5)": physics.Contact(1.0, 2.0, 0.5),
    "draft_gear(5, 0.2, loss=0.8)": physics.draft_gear(5.0, 0.2, loss=0.8),
}


@pytest.mark.parametrize("text", WRITTEN)
def test_there_and_back(text):
    law = contact_from(text)
    assert law.contact() == WRITTEN[text]
    assert contact_text(law) == text
    assert contact_text(WRITTEN[text]) == text


def test_every_kind_is_among_the_written_ones():
    assert {contact_from(text).law for text in WRITTEN} == {kind.law for kind in KINDS}


@pytest.mark.parametrize(
    "text", ["power(2, 1/14)", " power_law( f0 = 2 , alpha = 1/14 ) ", "power(2, alpha=1/14)", "power_law(2.0,1 / 14)"]
)
def test_names_numbers_and_fractions(text):
    assert contact_from(text).contact() == physics.power_law(2.0, 1 / 14)


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("power_law", "must be a law with its numbers, such as power_law(1, 1/10)"),
        ("pwer_law(1, 2)", "unknown law 'pwer_law' (did you mean 'power_law'?)"),
        ("power_law(1)", "contact 'power_law(1)': key 'alpha' is missing"),
        ("power_law(1, -2)", "alpha must be greater than 0, not -2.0"),
        ("power_law(1, soft)", "alpha must be a number, not 'soft'"),
        ("power_law(1, inf)", "alpha must be a finite number, not inf"),
        ("power_law(1, 1/0)", "must not divide by zero"),
        ("power_law(1, f0=2)", "f0 is given twice"),
        ("power_law(1, beta=2)", "unknown key 'beta'"),
        ("hertz(1, 2)", "hertz has 1 numbers, stiffness, and loss=..."),
        ("hertz(1, loss=1)", "loss must be less than 1"),
        ("draft_gear(true, 1)", "stiffness must be a number, not True"),
    ],
)
def test_refusals(text, sentence):
    with pytest.raises(SceneError) as error:
        contact_from(text)
    assert sentence in str(error.value)
    assert "\n" not in str(error.value)
