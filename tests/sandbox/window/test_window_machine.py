"""Short runs of the window as a state machine. `python -m tests.helpers.window_machine` also shrinks failures."""

import pytest
from hypothesis import Phase, settings
from hypothesis.stateful import run_state_machine_as_test

from tests.helpers.window_machine import WindowMachine


@pytest.mark.parametrize(("examples", "steps"), [(6, 25), pytest.param(20, 40, marks=pytest.mark.slow)])
def test_no_order_of_inputs_breaks_the_window(examples: int, steps: int) -> None:
    """Run without shrinking, which takes minutes. The command does that."""
    phases = (Phase.explicit, Phase.generate)
    wanted = settings(max_examples=examples, stateful_step_count=steps, database=None, phases=phases)
    run_state_machine_as_test(WindowMachine, settings=wanted)
