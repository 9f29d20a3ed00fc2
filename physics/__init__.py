"""Physics of softcradle: contacts, chains, and the methods that move them. Public names are imported on first use."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from softcradle.physics.advice.stability_limits import stable_step as stable_step
    from softcradle.physics.batch.chain_batch import ChainBatch as ChainBatch
    from softcradle.physics.batch.ends import EnsembleEnds as EnsembleEnds
    from softcradle.physics.batch.ends import ensemble_ends as ensemble_ends
    from softcradle.physics.chain import Chain as Chain
    from softcradle.physics.chain import cluster_on_cluster as cluster_on_cluster
    from softcradle.physics.chain import one_on as one_on
    from softcradle.physics.contact import Contact as Contact
    from softcradle.physics.contact import draft_gear as draft_gear
    from softcradle.physics.contact import hertz as hertz
    from softcradle.physics.contact import hooke as hooke
    from softcradle.physics.contact import power_law as power_law
    from softcradle.physics.contact import step_force as step_force
    from softcradle.physics.coupler import Coupler as Coupler
    from softcradle.physics.ensemble_runs import ensemble as ensemble
    from softcradle.physics.methods import METHODS as METHODS
    from softcradle.physics.own_law import OwnLaw as OwnLaw
    from softcradle.physics.pymunk_contacts.contact_constraint import SoftContact as SoftContact
    from softcradle.physics.pymunk_contacts.soft_chain import SoftChain as SoftChain
    from softcradle.physics.simulation import advance as advance
    from softcradle.physics.simulation import simulate as simulate
    from softcradle.physics.state import State as State
    from softcradle.physics.timed_force import TimedForce as TimedForce
    from softcradle.physics.trajectory import Trajectory as Trajectory
    from softcradle.physics.warm_up import warm as warm

_NAMES = {
    "contact": "Contact power_law draft_gear hertz hooke step_force",
    "coupler": "Coupler",
    "own_law": "OwnLaw",
    "chain": "Chain one_on cluster_on_cluster",
    "timed_force": "TimedForce",
    "state": "State",
    "simulation": "simulate advance",
    "ensemble_runs": "ensemble",
    "batch.chain_batch": "ChainBatch",
    "batch.ends": "ensemble_ends EnsembleEnds",
    "trajectory": "Trajectory",
    "methods": "METHODS",
    "advice.stability_limits": "stable_step",
    "warm_up": "warm",
    "pymunk_contacts.contact_constraint": "SoftContact",
    "pymunk_contacts.soft_chain": "SoftChain",
}
_HOME = {name: module for module, names in _NAMES.items() for name in names.split()}

__all__ = list(_HOME)


if not TYPE_CHECKING:  # A type checker that sees this function would accept every name.

    def __getattr__(name: str) -> object:
        if name not in _HOME:
            raise AttributeError(f"module 'softcradle.physics' has no attribute {name!r}")
        value = getattr(import_module(f"softcradle.physics.{_HOME[name]}"), name)
        globals()[name] = value
        return value


def __dir__() -> list[str]:
    return sorted(__all__)
