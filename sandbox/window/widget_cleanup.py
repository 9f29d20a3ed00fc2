"""The clean-up of widgets: pages and widgets refer to each other in cycles, and hold their surfaces."""

from __future__ import annotations

import contextlib
import ctypes
import gc


def collect_garbage() -> None:
    """Free what nothing refers to; the rest is not searched again in the middle of play.

    Python's own collection would come minutes and some 100 MB later, and it never searches frozen objects.
    """
    gc.unfreeze()
    gc.collect()
    gc.freeze()
    _trim_heap()


def _trim_heap() -> None:
    """Return holes in the heap to the system: surfaces of many sizes leave some 50 MB of them in an hour.

    Only glibc has a function for it; other systems do without.
    """
    with contextlib.suppress(AttributeError, OSError, TypeError):
        ctypes.CDLL(None).malloc_trim(0)
