"""Numbers as text, and round ticks."""

import pytest
from hypothesis import given
from hypothesis import strategies as st
from softcradle.sandbox.draw.number_format import (
    MINUS,
    decades,
    factor,
    fixed,
    power_of_ten,
    round_down,
    round_step,
    scientific,
    subscript,
    ticks,
)


@given(st.floats(1e-9, 1e9), st.integers(1, 8))
def test_steps_are_round(span, most):
    step = round_step(span, most)
    assert span / step <= most * (1 + 1e-6)
    assert float(f"{step:.0e}"[:-4]) in {1.0, 2.0, 5.0}
    assert round_down(step) == pytest.approx(step)
    assert len(ticks(0.0, span, most)) <= most + 1


@pytest.mark.parametrize(
    ("found", "expected"),
    [
        (scientific(0.41), "0.41"),
        (scientific(7.8e-4), "7.8·10⁻⁴"),
        (scientific(-1.25e7), "\N{MINUS SIGN}1.2·10⁷"),
        (scientific(0.0), "0"),
        (scientific(123.0), "123"),
        (factor(0.5), "\N{MULTIPLICATION SIGN}0.5"),
        (factor(20000.0), "\N{MULTIPLICATION SIGN}20\N{NARROW NO-BREAK SPACE}000"),
        (factor(2e6), "\N{MULTIPLICATION SIGN}2·10⁶"),
        (factor(1e29), "\N{MULTIPLICATION SIGN}10²⁹"),
        (fixed(-0.001, 2), "0.00"),
        (fixed(-1.5, 1), "\N{MINUS SIGN}1.5"),
        (subscript(1, 2), "₁₂"),
        (subscript(9, 10), "₉₋₁₀"),
        (power_of_ten(-12), "10⁻¹²"),
        (decades(-6, 0, 3), [(0.0, "10⁰"), (-2.0, "10⁻²"), (-4.0, "10⁻⁴"), (-6.0, "10⁻⁶")]),
        (ticks(-0.2, 1.0, 4), [(0.0, "0.0"), (0.5, "0.5"), (1.0, "1.0")]),
    ],
)
def test_numbers(found, expected):
    assert found == expected


def test_large_ticks_have_the_prefix_of_a_unit():
    assert [text for _, text in ticks(0.0, 1.4e6, 3)] == ["0", "500 k", "1 M"]
    assert [text for _, text in ticks(-2e4, 2e4, 4)] == [f"{MINUS}20 k", f"{MINUS}10 k", "0", "10 k", "20 k"]
