"""softcradle: soft contacts, Newton's cradles and draft gears. This module exports the public names of
`softcradle.physics`.

>>> from softcradle import one_on, power_law, simulate
>>> simulate(one_on(4, power_law(1.0, 0.1)), [1, 0, 0, 0, 0]).final_velocity.round(2)
array([-0.57,  0.17,  0.45,  0.47,  0.47])
"""

from __future__ import annotations

import os
from importlib import import_module

TYPE_CHECKING = (
    # avoids importing typing and pathlib, which take most of the time; the command handles Ctrl+C after this file
    False
)
if TYPE_CHECKING:
    from softcradle.physics import METHODS as METHODS
    from softcradle.physics import Chain as Chain
    from softcradle.physics import ChainBatch as ChainBatch
    from softcradle.physics import Contact as Contact
    from softcradle.physics import Coupler as Coupler
    from softcradle.physics import EnsembleEnds as EnsembleEnds
    from softcradle.physics import OwnLaw as OwnLaw
    from softcradle.physics import SoftChain as SoftChain
    from softcradle.physics import SoftContact as SoftContact
    from softcradle.physics import State as State
    from softcradle.physics import TimedForce as TimedForce
    from softcradle.physics import Trajectory as Trajectory
    from softcradle.physics import advance as advance
    from softcradle.physics import cluster_on_cluster as cluster_on_cluster
    from softcradle.physics import draft_gear as draft_gear
    from softcradle.physics import ensemble as ensemble
    from softcradle.physics import ensemble_ends as ensemble_ends
    from softcradle.physics import hertz as hertz
    from softcradle.physics import hooke as hooke
    from softcradle.physics import one_on as one_on
    from softcradle.physics import power_law as power_law
    from softcradle.physics import simulate as simulate
    from softcradle.physics import stable_step as stable_step
    from softcradle.physics import step_force as step_force
    from softcradle.physics import warm as warm
    from softcradle.sandbox.film.encoder import open_film as open_film
    from softcradle.sandbox.notebook.views import play as play
    from softcradle.sandbox.studies.fitting.fit_scene import fit as fit
    from softcradle.sandbox.sweeps.run_sweep import sweep as sweep

    __version__: str

# public names that do not belong to physics
_OF_SANDBOX = {
    "fit": "studies.fitting.fit_scene",
    "open_film": "film.encoder",
    "play": "notebook.views",
    "sweep": "sweeps.run_sweep",
}
_HERE = os.path.dirname(__file__)
_CHECKOUT = os.path.dirname(_HERE)
if not os.path.isdir(f"{_HERE}/physics") and os.path.isfile(f"{_CHECKOUT}/physics/__init__.py"):
    __path__.append(_CHECKOUT)  # a wheel contains the three folders, a checkout has them next to this one


if not TYPE_CHECKING:  # a type checker that saw __getattr__ would accept any name

    def __getattr__(name: str) -> object:
        physics = import_module("softcradle.physics")
        if name == "__version__":
            from softcradle.physics.version import version

            return version()
        if name == "__all__":  # for `from softcradle import *`, which would otherwise export the imports of this file
            return [*physics.__all__, *_OF_SANDBOX]
        if name in _OF_SANDBOX:
            return getattr(import_module(f"softcradle.sandbox.{_OF_SANDBOX[name]}"), name)
        if name not in physics.__all__:
            raise AttributeError(f"module 'softcradle' has no attribute {name!r}")
        return getattr(physics, name)


def __dir__() -> list[str]:
    return sorted([*import_module("softcradle.physics").__all__, "__version__", *_OF_SANDBOX])
