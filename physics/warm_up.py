"""`warm`: compile or load all kernels of a method before its first use."""

from __future__ import annotations

from collections.abc import Iterable

from softcradle.physics.kernel_tiers import KernelTiers
from softcradle.physics.methods import METHODS, Family, Method, find_method

# Other functions and classes that use kernels, by their names in Python
SOFT_CHAIN, ENSEMBLE_ENDS = OTHERS = "SoftChain", "ensemble_ends"


def warm(methods: Iterable[str] | str | None = None) -> None:
    """Compile the kernels of some methods, or load them if they are compiled already.

    `simulate` and `advance` can then use the methods without delay. On a new machine, compiling takes about a minute
    per method. Later, loading takes a fraction of a second. The logger ``softcradle`` reports the progress.

    Parameters
    ----------
    methods : str or iterable of str, optional
        Name of one method, or several names. "SoftChain" and "ensemble_ends" are also valid. None means all.

    Raises
    ------
    ValueError
        If a name is not valid.

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
    """Return the kernels of a method, or None for a method without kernels."""
    if method.family is Family.FIXED_STEP:
        from softcradle.physics.fixed_step.runner import TIERS

        return TIERS["fixed-step"]
    if method.family is Family.ADAPTIVE:
        from softcradle.physics.adaptive.runner import TIERS

        return TIERS["adaptive"]
    return None
