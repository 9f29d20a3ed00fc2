"""The window as a state machine, short runs; one that shrinks what it finds is `python -m tests.helpers.window_machine`."""

import pygame
import pytest
from hypothesis import Phase, settings
from hypothesis.stateful import run_state_machine_as_test
from softcradle.sandbox.session.inputs import AddBead, RemoveBead

from tests.helpers.window_machine import WindowMachine
from tests.helpers.windows import FRAME, pressed


@pytest.mark.parametrize(("examples", "steps"), [(6, 25), pytest.param(20, 40, marks=pytest.mark.slow)])
def test_no_order_of_inputs_breaks_the_window(examples: int, steps: int) -> None:
    """Without shrinking, which takes minutes: the command does that."""
    phases = (Phase.explicit, Phase.generate)
    wanted = settings(max_examples=examples, stateful_step_count=steps, database=None, phases=phases)
    run_state_machine_as_test(WindowMachine, settings=wanted)


EDITS = {"remove": (pygame.K_DELETE, 0), "undo": (pygame.K_z, pygame.KMOD_CTRL), "redo": (pygame.K_y, pygame.KMOD_CTRL)}


def test_an_edit_that_is_undone_in_the_frame_in_which_the_page_was_built_anew(driver) -> None:
    """The page was then built of beads that there are no more."""
    driver.click(driver.bead(2))
    driver.session.step_frames(200)
    driver.frames(2)
    driver.app.frame(FRAME, [*pressed(pygame.K_DELETE), *pressed(pygame.K_i), *pressed(*EDITS["undo"])])
    driver.frames()
    assert driver.session.lanes[0].chain.contacts == 4
    assert [len(depths) for depths in driver.page.view.scales.scales.deepest] == [4]
    assert driver.page.view.lanes[0].drawing.chain == driver.session.lanes[0].chain


@pytest.mark.parametrize("edit", EDITS)
def test_a_click_meets_the_chain_that_an_edit_of_the_same_frame_has_left(driver, edit: str) -> None:
    driver.session.apply(AddBead(0, 5, 1.0))
    if edit == "redo":
        driver.session.apply(RemoveBead(0, 5))
        driver.session.undo()
    driver.select("bead", 5)
    turns, place = (pygame.MOUSEBUTTONDOWN, pygame.MOUSEBUTTONUP), driver.bead(5)
    clicked = [pygame.Event(kind, pos=place, button=1) for kind in turns]
    driver.app.frame(FRAME, [*pressed(*EDITS[edit]), *clicked])
    assert driver.session.lanes[0].chain.contacts == 4
    assert driver.page.editor.selection is None
