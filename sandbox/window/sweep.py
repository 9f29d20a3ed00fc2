"""Letting go of what was left: pages and widgets hold their surfaces, and each other, in circles."""

from __future__ import annotations

import gc


def sweep() -> None:
    """Take away what nothing holds any more; what stays is not searched again in the middle of play.

    Python's own search would come minutes and some 100 MB later, and what is frozen it never searches.
    """
    gc.unfreeze()
    gc.collect()
    gc.freeze()
