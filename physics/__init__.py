"""softcradle's physics: contacts, chains, and the methods that move them. Public names load on first use."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from physics.chain import Chain as Chain
    from physics.chain import cluster_on_cluster as cluster_on_cluster
    from physics.chain import one_on as one_on
    from physics.constraints import SoftContact as SoftContact
    from physics.contact import Contact as Contact
    from physics.contact import draft_gear as draft_gear
    from physics.contact import hertz as hertz
    from physics.contact import hooke as hooke
    from physics.contact import power_law as power_law
    from physics.contact import step_force as step_force
    from physics.many import ensemble as ensemble
    from physics.methods import METHODS as METHODS
    from physics.simulation import advance as advance
    from physics.simulation import simulate as simulate
    from physics.soft_chain import SoftChain as SoftChain
    from physics.state import State as State
    from physics.trajectory import Trajectory as Trajectory
    from physics.trust import stable_step as stable_step

_HOME = {
    "Contact": "contact",
    "power_law": "contact",
    "draft_gear": "contact",
    "hertz": "contact",
    "hooke": "contact",
    "step_force": "contact",
    "Chain": "chain",
    "one_on": "chain",
    "cluster_on_cluster": "chain",
    "State": "state",
    "simulate": "simulation",
    "ensemble": "many",
    "advance": "simulation",
    "Trajectory": "trajectory",
    "METHODS": "methods",
    "stable_step": "trust",
    "SoftContact": "constraints",
    "SoftChain": "soft_chain",
}

__all__ = list(_HOME)


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module 'physics' has no attribute {name!r}")
    value = getattr(import_module(f"physics.{_HOME[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted(__all__)
