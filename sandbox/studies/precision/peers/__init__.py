"""Other integrators on the collisions of the work-precision chart, each left out where its package is not installed.

Each has what an expert would give it: overlaps as variables, a compiled right-hand side, absolute tolerances finer for
overlaps than for rates, a small first step (without it the collision would be stepped over). None can stop when a
collision is over, so each runs to its known end. None has contacts that touch, so draft gears chatter.
"""

from __future__ import annotations

from importlib.util import find_spec
from typing import NamedTuple

from softcradle.sandbox.studies.precision.cases import ChartCase
from softcradle.sandbox.studies.precision.measurement import Solver


class Peer(NamedTuple):
    """A peer: its name, the package without which it is left out, and its function in `integrators`."""

    name: str
    package: str
    function: str

    def solvers(self, case: ChartCase) -> list[Solver]:
        """Solvers of the case, none where the peer cannot take it."""
        from softcradle.sandbox.studies.precision.peers import integrators  # needs numba

        found: list[Solver] = getattr(integrators, self.function)(case)
        return found


PEERS: tuple[Peer, ...] = (
    Peer("Verlet by hand", "numba", "verlet_by_hand"),
    Peer("CyRK", "CyRK", "cyrk"),
    Peer("numbalsoda", "numbalsoda", "numbalsoda"),
    Peer("heyoka", "heyoka", "heyoka"),
    Peer("SciPy", "scipy", "scipy"),
    Peer("scikit-sundae", "sksundae", "sundae"),
    Peer("diffrax", "diffrax", "diffrax"),
)


def missing_peers() -> list[Peer]:
    """Peers that are not installed."""
    return [peer for peer in PEERS if find_spec(peer.package) is None]


def peer_distributions() -> list[str]:
    """Packages of the peers, by the names under which versions are known."""
    return [peer.name for peer in PEERS if peer.package not in ("numba", "scipy")]


def peer_solvers(case: ChartCase) -> list[Solver]:
    """Solvers of every installed peer that can take the case: power laws and a steady drive, nothing that takes energy."""
    chain = case.chain
    if chain.dissipative or chain.timed or chain.couplers or chain.own_laws or not _numba_compiles():
        return []
    missing = missing_peers()
    return [solver for peer in PEERS if peer not in missing for solver in peer.solvers(case)]


def _numba_compiles() -> bool:
    if find_spec("numba") is None:
        return False
    from numba import config

    return not config.DISABLE_JIT
