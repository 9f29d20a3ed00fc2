"""Other people's integrators on the same collisions: each a small module, each left out where it is not installed.

All have what an expert would give them: overlaps as variables, compiled right-hand sides, absolute tolerances finer for
overlaps than for rates, a small first step (they would jump over the collision). None can stop when a collision is over,
so they run to its known end; none knows a contact that touches, so draft gears chatter for them.
"""

from __future__ import annotations

from importlib import import_module
from importlib.util import find_spec
from typing import NamedTuple

from softcradle.sandbox.studies.precision.chart_cases import Case
from softcradle.sandbox.studies.precision.solvers import Solver


class Peer(NamedTuple):
    """A peer: what it is called, the package it needs, and the module here with its `solvers(case)`."""

    name: str
    package: str
    module: str


PEERS: tuple[Peer, ...] = (
    Peer("Verlet by hand", "numba", "verlet_by_hand"),
    Peer("CyRK", "CyRK", "cyrk_peer"),
    Peer("numbalsoda", "numbalsoda_peer", "numbalsoda"),
    Peer("heyoka", "heyoka", "heyoka_peer"),
    Peer("SciPy", "scipy", "scipy_peer"),
    Peer("scikit-sundae", "sksundae", "sundae_peer"),
    Peer("diffrax", "diffrax_peer", "diffrax"),
)


def missing() -> list[str]:
    """Names of the peers that are not installed."""
    return [peer.name for peer in PEERS if find_spec(peer.package) is None]


def peers(case: Case) -> list[Solver]:
    """Every peer that is installed and can take the case: none where contacts lose energy or the bed rubs."""
    if case.chain.dissipative:
        return []
    absent = missing()
    modules = [import_module(f"{__name__}.{peer.module}") for peer in PEERS if peer.name not in absent]
    return [solver for module in modules for solver in module.solvers(case)]
