"""`warm`: compile or load all kernels of a method before its first use."""

from __future__ import annotations

from collections.abc import Iterable

from softcradle.physics.kernel_tiers import KernelTiers
from softcradle.physics.methods import METHODS, Family, Method, find_method

# Other users of kernels, by their names in Python
SOFT_CHAIN, ENSEMBLE_ENDS = OTHERS = "SoftChain", "ensemble_ends"


def warm(methods: Iterable[str] | str | None = None) -> None:
    """Compile the kernels that `simulate` and `advance` need for these methods, or load them if they are compiled
    already.

    On a new machine this takes about a minute per method, later a fraction of a second. The logger ``softcradle``
    reports it.

    Parameters
    ----------
    methods : str or iterable of str, optional
        One or several names, which may include "SoftChain" and "ensemble_ends"; None: all.

    Raises
    ------
    ValueError
        If a method does not exist.

    Examples
    --------
    >>> from softcradle import warm
    >>> warm("verlet")
    """
    names = [methods] if isinstance(methods, str) else methods
    if names is None:
        names = [*(method.name for method in METHODS), *OTHERS]
    for name in names:
        for kernels in _kernels_called(name):
            kernels.load()


def _kernels_called(name: str) -> list[KernelTiers]:
    if name == SOFT_CHAIN:
        from softcradle.physics.pymunk_contacts.soft_chain import KERNELS

        return [KERNELS]
    if name == ENSEMBLE_ENDS:
        from softcradle.physics.batch.ends import TIERS

        return list(TIERS.values())
    found = kernels_of(find_method(name, OTHERS))
    return [] if found is None else [found]


def kernels_of(method: Method) -> KernelTiers | None:
    """Return the kernels of a method; None if it has none."""
    if method.family is Family.FIXED_STEP:
        from softcradle.physics.fixed_step.runner import TIERS

        return TIERS["fixed-step"]
    if method.family is Family.ADAPTIVE:
        from softcradle.physics.adaptive.runner import TIERS

        return TIERS["adaptive"]
    return None
