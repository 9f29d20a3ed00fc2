"""Letting go of what was left: pages and widgets hold their surfaces, and each other, in circles."""

from __future__ import annotations

import contextlib
import ctypes
import gc


def sweep() -> None:
    """Take away what nothing holds any more; what stays is not searched again in the middle of play.

    Python's own search would come minutes and some 100 MB later, and what is frozen it never searches.
    """
    gc.unfreeze()
    gc.collect()
    gc.freeze()
    _give_back()


def _give_back() -> None:
    """Surfaces of all sizes leave holes in the heap, some 50 MB after an hour; glibc can give them back, others need not."""
    with contextlib.suppress(AttributeError, OSError, TypeError):
        ctypes.CDLL(None).malloc_trim(0)
