"""Tests of the sentence that explains a collision. The sentence uses the overlaps and forces at the moment of the
largest force.
"""

import numpy as np
import pytest
from softcradle.physics import simulate
from softcradle.sandbox.story import why

from softcradle import scenes

SPACE = "\u00a0"


def explained(name: str, lane: int = 0, body: str = "bead") -> str:
    """Return the explanation of the collision in one row of beads of a scene."""
    scene = scenes.load(name)
    chain = scene.lanes[lane].chain()
    found = simulate(chain, velocity=list(scene.lanes[lane].velocity), duration=scene.duration, samples=2000)
    row = int(np.abs(found.force).max(axis=1).argmax())
    alone = not (chain.driven or chain.brakes or found.force[0].any())
    push = why.push_of(chain.mass, found.overlap[row].tolist(), found.force[row].tolist(), alone)
    return "" if push is None else why.why_words(push, body).replace(SPACE, " ")


SAID = [
    (
        "one-on-four",
        0,
        "Squeezed by 45 cm, 3 cm, 0.6 mm and 0.6 µm, the contacts still push with 1, 3/4, 1/2 and 1/4 of the force. "
        "So the push reaches the last bead at once, without a wave: an evanescent mode.",
    ),
    (
        "steel-and-soft",
        0,
        "Squeezed by 13 cm, 3 cm, 0.5 mm and 0.3 µm, the contacts push with 1, 1/9, 0 and 0 of the force. "
        "So the push has not reached the last bead yet: it runs along the row as a wave.",
    ),
    (
        "galilean",
        0,
        "Squeezed by 45 cm, 3 cm, 0.6 mm and 0.6 µm, the contacts still push with 1, 3/4, 1/2 and 1/4 of the force. "
        "So the push reaches the last bead at once, without a wave: an evanescent mode.",
    ),
    (
        "two-on-two",
        0,
        "Squeezed by 0.6 mm, 58 cm and 0.6 mm, the contacts still push with 1/2, 1 and 1/2 of the force. "
        "So the push reaches the last bead at once, without a wave: an evanescent mode.",
    ),
    (
        "draft-gear-one-on-three",
        0,
        "Squeezed by 3 mm, 0 and 0, the contacts still push with 1, 2/3 and 1/3 of the force. "
        "So the push reaches the last bead at once, without a wave.",
    ),
]


@pytest.mark.parametrize(("name", "lane", "said"), SAID, ids=[name for name, *_ in SAID])
def test_a_push_is_explained_by_its_own_numbers(name: str, lane: int, said: str) -> None:
    assert explained(name, lane) == said


def test_a_long_row_is_listed_from_its_strongest_contact_on() -> None:
    said = explained("one-on-ten")
    assert said.startswith(
        "Squeezed by 46 cm, 6 cm, 1.3 cm, 3 mm, … and 1·10⁻¹¹ m, the contacts still push with 1, 4/5"
    )
    assert said.endswith("evanescent mode.")
    push = why.push_of([1.0] * 8, [0.1, 0.2, 1.0, 0.2, 0.1, 0.0, 0.0], [1.0, 2.0, 3.0, 2.0, 1.0, 0.5, 0.1])
    assert push is not None
    assert push.contacts == (2, 3, 4, 5, 6)
    assert not push.gap


@pytest.mark.parametrize(
    ("name", "lane"), [("prestressed", 1), ("train-braking", 0)], ids=["pressed before", "brakes on every wagon"]
)
def test_nothing_is_concluded_if_other_forces_act(name: str, lane: int) -> None:
    said = explained(name, lane, "wagon")
    assert said.startswith("Squeezed by ")
    assert said.count(". ") == 0


def test_a_pull_has_no_explanation_by_overlaps() -> None:
    assert why.push_of([1.0] * 3, [-0.06, -0.05], [-1.0, -0.9]) is None
    assert why.push_of([1.0, 1.0], [0.0], [0.0]) is None


def test_a_single_contact_is_compared_with_nothing() -> None:
    push = why.push_of([1.0, 1.0], [0.002], [3.0])
    assert push is not None
    assert why.why_words(push, "wagon").replace(SPACE, " ") == "The contact is squeezed by 2 mm."


def test_a_row_between_soft_and_hard_is_partly_a_wave() -> None:
    push = why.push_of([1.0] * 4, [0.1, 0.05, 0.02], [1.0, 0.4, 0.12])
    assert push is not None
    assert "The rest runs along the row as a wave." in why.why_words(push, "bead")


@pytest.mark.parametrize(
    ("length", "text"),
    [
        (0.45, "45 cm"),
        (1.26, "1.3 m"),
        (0.033, "3 cm"),
        (0.0098, "10 mm"),
        (5.7e-4, "0.6 mm"),
        (9e-5, "90 µm"),
        (5.6e-7, "0.6 µm"),
        (1.1e-8, "11 nm"),
        (3e-14, "3·10⁻¹⁴ m"),
        (0.0, "0"),
        (-0.02, "0"),
    ],
)
def test_lengths_are_written_in_usual_units(length: float, text: str) -> None:
    assert why.length_text(length).replace(SPACE, " ") == text


def test_shares_are_fractions_or_all_in_percent() -> None:
    assert why.share_texts([1.0, 0.769, 0.513, 0.257]) == ["1", "3/4", "1/2", "1/4"]
    assert why.share_texts([1.0, 0.113, 2e-4]) == ["1", "1/9", "0"]
    assert [text.replace(SPACE, "") for text in why.share_texts([1.0, 0.287, 1e-5])] == ["100%", "29%", "0%"]
