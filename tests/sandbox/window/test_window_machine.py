"""Tests of the window with short random sequences of inputs.

The command `python -m tests.helpers.window_machine` runs longer sequences and also shortens a failing sequence.
"""

import pytest
from hypothesis import Phase, settings
from hypothesis.stateful import run_state_machine_as_test

from tests.helpers.window_machine import WindowMachine


@pytest.mark.parametrize(("examples", "steps"), [(6, 25), pytest.param(20, 40, marks=pytest.mark.slow)])
def test_no_order_of_inputs_breaks_the_window(examples: int, steps: int) -> None:
    """Check that random inputs do not break the window.

    A failing sequence is not shortened in this test, because that takes minutes.
    """
    phases = (Phase.explicit, Phase.generate)
    wanted = settings(max_examples=examples, stateful_step_count=steps, database=None, phases=phases)
    run_state_machine_as_test(WindowMachine, settings=wanted)
