"""`warm`: compile or load all kernels of a method ahead of its first use."""

from __future__ import annotations

from collections.abc import Iterable

from softcradle.physics.chain import Chain
from softcradle.physics.contact import power_law
from softcradle.physics.methods import METHODS, find_method
from softcradle.physics.simulation import move, solve
from softcradle.physics.state import State

WITHOUT_KERNELS = ("pymunk", "scipy")


def warm(methods: Iterable[str] | str | None = None) -> None:
    """Compile what `simulate` and `advance` need for these methods, or load it where it has been compiled before.

    On a new machine this takes about half a minute a method, later a fraction of a second; the logger ``softcradle`` tells of it.

    Arguments:
        methods: one name or several; None: all methods, and SoftChain.

    Raises:
        ValueError: there is no such method.

    >>> from softcradle import warm
    >>> warm("verlet")
    """
    names = [methods] if isinstance(methods, str) else methods
    for method in METHODS if names is None else [find_method(name) for name in names]:
        if method.name in WITHOUT_KERNELS:
            continue
        for dissipative in (False, True) if method.dissipative else (False,):
            call_kernels(method.name, dissipative)
    if methods is None:
        _step_soft_chain()


def call_kernels(method: str, dissipative: bool) -> None:
    """Call every compiled kernel of a method once, with the types that the window calls it with."""
    chain, velocity = Chain([1.0, 1.0, 1.0], power_law(1.0, 0.1), friction=0.1 if dissipative else 0.0), [1.0, 0.0, 0.0]
    move(chain, State.at_start(chain, velocity), 1e-3, method, None, 1e-8, 1000)
    solve(chain, velocity, duration=1e-3, method=method, samples=2)


def _step_soft_chain() -> None:
    """A step of a SoftChain, with and without loss."""
    import pymunk
    from softcradle.physics.pymunk_contacts.soft_chain import SoftChain

    for loss in (0.0, 0.1):
        space, bodies = pymunk.Space(), [pymunk.Body(1, 1), pymunk.Body(1, 1)]
        bodies[1].position = 1, 0
        bodies[0].velocity = 1, 0
        space.add(*bodies, *SoftChain(bodies, power_law(1.0, 1.0, loss), 1))
        space.step(1e-3)
