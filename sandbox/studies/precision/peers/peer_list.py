"""The list of peers: other integrators, each with the package that it needs."""

from __future__ import annotations

from collections.abc import Callable
from importlib.util import find_spec
from typing import NamedTuple

from softcradle.sandbox.studies.precision.cases import Case
from softcradle.sandbox.studies.precision.solvers import Solver


class Peer(NamedTuple):
    """A peer.

    Attributes:
        name: of the peer.
        package: without which it is left out.
        solvers: imports its module and gives its solvers for a case.
    """

    name: str
    package: str
    solvers: Callable[[Case], list[Solver]]


def _verlet_by_hand(case: Case) -> list[Solver]:
    from softcradle.sandbox.studies.precision.peers import verlet_by_hand

    return verlet_by_hand.solvers(case)


def _cyrk(case: Case) -> list[Solver]:
    from softcradle.sandbox.studies.precision.peers import cyrk_peer

    return cyrk_peer.solvers(case)


def _numbalsoda(case: Case) -> list[Solver]:
    from softcradle.sandbox.studies.precision.peers import numbalsoda_peer

    return numbalsoda_peer.solvers(case)


def _heyoka(case: Case) -> list[Solver]:
    from softcradle.sandbox.studies.precision.peers import heyoka_peer

    return heyoka_peer.solvers(case)


def _scipy(case: Case) -> list[Solver]:
    from softcradle.sandbox.studies.precision.peers import scipy_peer

    return scipy_peer.solvers(case)


def _sundae(case: Case) -> list[Solver]:
    from softcradle.sandbox.studies.precision.peers import sundae_peer

    return sundae_peer.solvers(case)


def _diffrax(case: Case) -> list[Solver]:
    from softcradle.sandbox.studies.precision.peers import diffrax_peer

    return diffrax_peer.solvers(case)


PEERS: tuple[Peer, ...] = (
    Peer("Verlet by hand", "numba", _verlet_by_hand),
    Peer("CyRK", "CyRK", _cyrk),
    Peer("numbalsoda", "numbalsoda", _numbalsoda),
    Peer("heyoka", "heyoka", _heyoka),
    Peer("SciPy", "scipy", _scipy),
    Peer("scikit-sundae", "sksundae", _sundae),
    Peer("diffrax", "diffrax", _diffrax),
)


def missing_peers() -> list[Peer]:
    """The peers that are not installed."""
    return [peer for peer in PEERS if find_spec(peer.package) is None]


def peer_distributions() -> list[str]:
    """What is installed for the peers, by the names under which versions are known."""
    return [peer.name for peer in PEERS if peer.package not in ("numba", "scipy")]


def peer_solvers(case: Case) -> list[Solver]:
    """The solvers of every installed peer that can take the case: none where friction or losses take energy."""
    if case.chain.dissipative or not _numba_compiles():
        return []
    missing = missing_peers()
    return [solver for peer in PEERS if peer not in missing for solver in peer.solvers(case)]


def _numba_compiles() -> bool:
    """Whether the right-hand side of the peers can be compiled."""
    if find_spec("numba") is None:
        return False
    from numba import config

    return not config.DISABLE_JIT
