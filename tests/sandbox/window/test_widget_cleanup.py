"""The clean-up of widgets frees cycles at once, on any system."""

from __future__ import annotations

import ctypes
import weakref

import pytest
from softcradle.sandbox.window.theme import collect_garbage


class Widget:
    """Refers to itself, as widgets and containers refer to each other."""

    def __init__(self) -> None:
        self.container = self


def test_cycles_are_freed() -> None:
    widget = weakref.ref(Widget())
    assert widget() is not None
    collect_garbage()
    assert widget() is None


@pytest.mark.parametrize("refusal", [OSError, AttributeError, TypeError])
def test_a_system_that_cannot_trim_the_heap_is_no_error(
    refusal: type[Exception], monkeypatch: pytest.MonkeyPatch
) -> None:
    def library(name: None) -> None:
        raise refusal

    monkeypatch.setattr(ctypes, "CDLL", library)
    widget = weakref.ref(Widget())
    collect_garbage()
    assert widget() is None
