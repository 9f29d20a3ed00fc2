"""Other integrators for the collisions of the work-precision chart. An integrator whose package is missing is left out.

Each integrator gets the settings that an expert would choose. The variables are overlaps, and the right-hand side is
compiled. Absolute tolerances are smaller for overlaps than for rates. The first step is small, because the integrator
would otherwise skip the collision. No integrator can stop when a collision is over, so each runs to the known end. No
integrator supports touching contacts, so draft gears chatter.
"""

from __future__ import annotations

from importlib.util import find_spec
from typing import NamedTuple

from softcradle.sandbox.studies.precision.cases import ChartCase
from softcradle.sandbox.studies.precision.measurement import Solver


class Peer(NamedTuple):
    """Another integrator, with its name, the package that it needs, and its function in `integrators`."""

    name: str
    package: str
    function: str

    def solvers(self, case: ChartCase) -> list[Solver]:
        """Return the solvers of this integrator for the case. The list is empty if it cannot solve the case."""
        # The import is local because this module needs numba.
        from softcradle.sandbox.studies.precision.peers import integrators

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
    """Return the distribution names of the packages of all integrators."""
    return [peer.name for peer in PEERS if peer.package not in ("numba", "scipy")]


def peer_solvers(case: ChartCase) -> list[Solver]:
    """Return the solvers of every installed integrator that can solve the case.

    These integrators can solve power laws and a steady external force without dissipation.
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
