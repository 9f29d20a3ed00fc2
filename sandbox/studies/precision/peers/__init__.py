"""Other integrators on the collisions of the work-precision chart. An integrator is left out if its package is not
installed.

Each gets the settings that an expert would choose: overlaps as variables, a compiled right-hand side, smaller absolute
tolerances for overlaps than for rates, and a small first step (otherwise the collision would be skipped). None can stop
when a collision is over, so each runs to the known end. None supports touching contacts, so draft gears chatter.
"""

from __future__ import annotations

from importlib.util import find_spec
from typing import NamedTuple

from softcradle.sandbox.studies.precision.cases import ChartCase
from softcradle.sandbox.studies.precision.measurement import Solver


class Peer(NamedTuple):
    """Another integrator: its name, the package that it needs, and its function in `integrators`."""

    name: str
    package: str
    function: str

    def solvers(self, case: ChartCase) -> list[Solver]:
        """Return its solvers of the case; empty if it cannot solve it."""
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
    """Return the integrators that are not installed."""
    return [peer for peer in PEERS if find_spec(peer.package) is None]


def peer_distributions() -> list[str]:
    """Return the distribution names of the integrators' packages."""
    return [peer.name for peer in PEERS if peer.package not in ("numba", "scipy")]


def peer_solvers(case: ChartCase) -> list[Solver]:
    """Return the solvers of every installed integrator that can solve the case: power laws and a steady drive, without
    dissipation.
    """
    chain = case.chain
    if chain.dissipative or chain.timed or chain.piecewise or chain.own_laws or not _numba_compiles():
        return []
    missing = missing_peers()
    return [solver for peer in PEERS if peer not in missing for solver in peer.solvers(case)]


def _numba_compiles() -> bool:
    if find_spec("numba") is None:
        return False
    from numba import config

    return not config.DISABLE_JIT
