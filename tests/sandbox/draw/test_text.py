"""Text: lines that fit their room, numbers as text; and colours that differ."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from softcradle.sandbox.draw import number_format
from softcradle.sandbox.draw.number_format import MINUS, factor, fixed, scientific, ticks
from softcradle.sandbox.draw.palette import BEAD_COLOURS, OKABE_ITO, bead_colours
from softcradle.sandbox.draw.text import shortened, width, wrapped


def test_text_fits_its_room():
    assert width(shortened("a rather long title", 20, 100), 20) <= 100
    assert shortened("short", 20, 1000) == "short"
    assert all(width(line, 15) <= 200 for line in wrapped("a b c " * 40, 15, 200))
    assert " ".join(wrapped("one two three", 15, 60)) == "one two three"


@given(st.floats(1e-9, 1e9), st.integers(1, 8))
def test_steps_are_round(span, most):
    step = number_format.round_step(span, most)
    assert span / step <= most * (1 + 1e-6)
    assert float(f"{step:.0e}"[:-4]) in {1.0, 2.0, 5.0}
    assert number_format.round_down(step) == pytest.approx(step)
    assert len(ticks(0.0, span, most)) <= most + 1


@pytest.mark.parametrize(
    ("found", "expected"),
    [
        (scientific(0.41), "0.41"),
        (scientific(7.8e-4), "7.8·10⁻⁴"),
        (scientific(-1.25e7), "\N{MINUS SIGN}1.2·10⁷"),
        (scientific(0.0), "0"),
        (factor(20000.0), "\N{MULTIPLICATION SIGN}20\N{NARROW NO-BREAK SPACE}000"),
        (factor(2e6), "\N{MULTIPLICATION SIGN}2·10⁶"),
        (fixed(-0.001, 2), "0.00"),
        ([number_format.number_text(v) for v in (None, 0.0, 1e-15, -0.25)], ["-", "0", "0", f"{MINUS}0.2500"]),
        ([number_format.number_text(v) for v in (2e-5, 1234.4, 123456.0)], ["2.00·10⁻⁵", "1234", "1.23·10⁵"]),
        (number_format.subscript(1, 2), "₁₂"),
        (number_format.subscript(9, 10), "₉₋₁₀"),
        (number_format.decades(-6, 0, 3), [(0.0, "10⁰"), (-2.0, "10⁻²"), (-4.0, "10⁻⁴"), (-6.0, "10⁻⁶")]),
        (ticks(-0.2, 1.0, 4), [(0.0, "0.0"), (0.5, "0.5"), (1.0, "1.0")]),
        ([text for _, text in ticks(0.0, 1.4e6, 3)], ["0", "500 k", "1 M"]),
        ([text for _, text in ticks(-2e4, 2e4, 4)], [f"{MINUS}20 k", f"{MINUS}10 k", "0", "10 k", "20 k"]),
    ],
)
def test_numbers(found, expected):
    assert found == expected


def apart(colours):
    """The least distance of two of the colours for the colour-blind.

    Deuteranopia and protanopia after Machado et al. (2009), severity 1, on linear light.
    """
    machado = {
        "deutan": [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]],
        "protan": [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
    }
    linear, least = (np.array(colours) / 255.0) ** 2.2, 1e3
    for matrix in machado.values():
        seen = np.clip(linear @ np.array(matrix).T, 0.0, 1.0) ** (1 / 2.2) * 255.0
        distance = np.linalg.norm(seen[:, None] - seen[None], axis=-1) + 1e3 * np.eye(len(seen))
        least = min(least, distance.min())
    return least


def test_colours_differ_for_the_colour_blind():
    assert apart(OKABE_ITO) > 20.0
    assert len(set(bead_colours(60))) == 60
    assert bead_colours(12) == BEAD_COLOURS
    assert apart(BEAD_COLOURS) > 40.0  # twice the least that is told apart
