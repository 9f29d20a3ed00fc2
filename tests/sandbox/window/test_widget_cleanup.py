"""What pages leave behind goes at once, on any system."""

from __future__ import annotations

import ctypes
import weakref

import pytest
from softcradle.sandbox.window.widget_cleanup import sweep


class Widget:
    """Holds itself, as widgets hold their containers."""

    def __init__(self) -> None:
        self.container = self


def test_circles_are_let_go_of() -> None:
    widget = weakref.ref(Widget())
    assert widget() is not None
    sweep()
    assert widget() is None


@pytest.mark.parametrize("refusal", [OSError, AttributeError, TypeError])
def test_a_system_that_cannot_take_holes_back_is_no_error(
    refusal: type[Exception], monkeypatch: pytest.MonkeyPatch
) -> None:
    def library(name: None) -> None:
        raise refusal

    monkeypatch.setattr(ctypes, "CDLL", library)
    widget = weakref.ref(Widget())
    sweep()
    assert widget() is None
