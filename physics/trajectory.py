"""The trajectory: what a simulation returns. Arrays with shapes and units, the switches of every contact, and the cost."""

from __future__ import annotations

from dataclasses import dataclass, field, fields
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from softcradle.physics import trajectory_file
from softcradle.physics.chain import Chain
from softcradle.physics.notebook_views import Moving
from softcradle.physics.state import from_anchor
from softcradle.physics.status import Status, Warnings

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

Array = NDArray[np.float64]
Interval = tuple[float, float]

# of the greatest speed: walls whose velocities, sums over the chain, differ by no more move as one
ALIKE = 1e-9


def _nothing() -> Array:
    return np.zeros(0)


def work_of_walls(chain: Chain, velocity: Array, momentum: Array) -> Array:
    """(T,) work [J] of the walls of `chain` on its beads since the first of T times; nan where it is not known.

    Walls give the `momentum` (T,) [N s] of the beads that nothing else has given. Their work follows from it where all move at
    one speed and no bed takes momentum too; walls at rest do none.

    Parameters
    ----------
    velocity : ndarray, shape (T, n+1)
        [m/s], of walls too.
    """
    speeds = velocity[:, np.isinf(chain.mass)]
    if not speeds.any():
        return np.zeros(len(velocity))
    speed, fastest = speeds[0, 0], np.abs(velocity).max(initial=0.0, where=np.isfinite(velocity))
    if not np.abs(speeds - speed).max() <= ALIKE * fastest or (speed != 0.0 and chain.on_bed):
        return np.full(len(velocity), np.nan)
    return speed * (momentum - momentum[0])


@dataclass(frozen=True, eq=False, repr=False)
class Trajectory(Moving):
    """Samples of a motion, when each contact closed and opened, and what it cost.

    `velocity_error` is the estimated error of `final_velocity`, and `position_error` that of the positions. Velocities at samples
    and contact times have no estimate. Their error is that of the steps, and larger while contacts push or if they close slowly;
    compare runs at two tolerances.

    Attributes
    ----------
    chain : Chain
    time : ndarray, shape (T,)
        Sample times [s].
    overlap : ndarray, shape (T, n)
        Overlaps [m], Eq. (1).
    rate : ndarray, shape (T, n)
        Overlap rates [m/s]; finer than differences of `velocity` deep inside a cluster.
    anchor : ndarray, shape (T, 2)
        Position [m] and velocity [m/s] of bead ``chain.anchor``.
    force : ndarray, shape (T, n)
        Contact forces [N].
    final_velocity : ndarray, shape (n+1,)
        Bead velocities [m/s] at the end of the run, wherever the samples lie.
    contact_intervals : tuple of tuples
        Per contact a tuple of (closed, opened) times [s]; opened is inf where it never opens. What touches at rest closes as
        soon as a neighbour pushes it, long before a wave brings a force that counts; by fixed steps up to two steps a contact
        later. Not determined are how often a soft contact opens and closes while it lets go, when contacts open between beads
        that a wave leaves all but at rest, and whether beads that friction holds at rest push each other: adaptive methods take
        a force in the middle of what it may be. By fixed steps beads beside such a bead may close by round-off, and an adaptive
        step tells of no bounce within it, which has next to no force.
    method : str
        Name of the method.
    step : float
        Step of a fixed-step method [s]; 0 for adaptive ones.
    tolerance : float
        Tolerance of an adaptive method; 0 for fixed steps.
    speed_scale : float
        Speed [m/s] that `tolerance` is relative to: the largest closing speed that the motion can have. 0 for fixed steps.
    steps : int
        Number of steps taken.
    evaluations : int
        How often all contact forces were evaluated.
    seconds : float
        Wall time of the solver [s].
    status : Status
        How the run ended; where it gave up, `final_velocity` is that of the time it reached.
    velocity_error : ndarray, shape (n+1,)
        Estimated error [m/s] of `final_velocity`; nan where the method estimates none (fixed steps).
    warnings : tuple of CodedWarning
        What may be wrong with it, each with a code, a sentence and its numbers; empty when nothing is.
    choice : str
        What method "auto" chose and why; "" where the method was given.
    absorbed_by_contacts : ndarray, shape (T,)
        Energy [J] that contacts with loss have taken since t = 0.
    absorbed_by_bed : ndarray, shape (T,)
        Energy [J] that bed friction has taken since t = 0. Kinetic + contact energy + both = that at the start +
        `driven` + `by_walls`.
    given : ndarray, shape (T, 2)
        Work [J] and impulse [N s] of the chain's forces over time since t = 0, walls left out; in a motion that was played in
        the window also those of the pointer and of edits, since its first sample.
    """

    chain: Chain
    time: Array
    overlap: Array
    rate: Array
    anchor: Array
    force: Array
    final_velocity: Array
    contact_intervals: tuple[tuple[Interval, ...], ...]
    method: str
    step: float = 0.0
    tolerance: float = 0.0
    speed_scale: float = 0.0
    steps: int = 0
    evaluations: int = 0
    seconds: float = 0.0
    status: Status = Status.DONE
    warnings: Warnings = ()
    choice: str = ""
    velocity_error: Array = field(default_factory=_nothing)
    absorbed_by_contacts: Array = field(default_factory=_nothing)
    absorbed_by_bed: Array = field(default_factory=_nothing)
    given: Array = field(default_factory=lambda: np.zeros((0, 2)))

    def __post_init__(self) -> None:
        if self.velocity_error.size != self.final_velocity.size:
            object.__setattr__(self, "velocity_error", np.full(self.final_velocity.size, np.nan))
        for name in ("absorbed_by_contacts", "absorbed_by_bed"):
            if getattr(self, name).size != self.time.size:
                object.__setattr__(self, name, np.zeros(self.time.size))
        if len(self.given) != self.time.size:
            object.__setattr__(self, "given", np.zeros((self.time.size, 2)))

    @cached_property
    def position(self) -> Array:
        """(T, n+1) positions [m], bead lengths taken out; two beads that just touch have the same position."""
        return from_anchor(self.overlap, self.anchor[:, 0], self.chain.anchor)

    @property
    def position_error(self) -> Array:
        """Estimated error [m] of the positions, shape (T,): the time since the start times a velocity error.

        That error is the largest `velocity_error`, but at least the tolerance times `speed_scale`. Beads that have come to rest
        have hardly any error of velocity left, and still the positions that earlier errors gave them.
        """
        return np.maximum(self.velocity_error.max(), self.tolerance * self.speed_scale) * self.time

    @cached_property
    def velocity(self) -> Array:
        """(T, n+1) bead velocities [m/s]."""
        return from_anchor(self.rate, self.anchor[:, 1], self.chain.anchor)

    @cached_property
    def kinetic_energy(self) -> Array:
        """(T,) kinetic energy [J] of the beads, walls left out."""
        with np.errstate(over="ignore"):  # of a motion that has blown up it is inf
            return 0.5 * self.velocity[:, self._bead] ** 2 @ self.chain.finite_mass[self._bead]

    @cached_property
    def contact_energy(self) -> Array:
        """(T,) energy [J] taken up by the contacts; those with loss give only a part of it back."""
        return self.chain.stored_energy(self.overlap, force=self.force).sum(axis=1)

    @cached_property
    def momentum(self) -> Array:
        """(T,) momentum [N s] of the beads, walls left out."""
        return self.velocity[:, self._bead] @ self.chain.finite_mass[self._bead]

    @property
    def ledger(self) -> Array:
        """(T,) energy [J] that must not change, kinetic + of contacts + absorbed by them and by the bed - `driven` - `by_walls`.

        Not known, nan, where `by_walls` is not.
        """
        energy = self.kinetic_energy + self.contact_energy - self.driven - self.by_walls
        return energy + self.absorbed_by_contacts + self.absorbed_by_bed

    @cached_property
    def driven(self) -> Array:
        """(T,) work [J] of the drive and forces over time on the beads since t = 0, walls left out."""
        if self.chain.drive_force is None:
            return self.given[:, 0]
        start = np.concatenate(([0.0], np.cumsum(self.chain.gap)))
        work: Array = (self.position - start)[:, self._bead] @ self.chain.drive_force[self._bead]
        return work + self.given[:, 0]

    @cached_property
    def impulse(self) -> Array:
        """(T,) momentum [N s] that the drive and forces over time have given to the beads since t = 0, walls left out."""
        if self.chain.drive_force is None:
            return self.given[:, 1]
        return self.time * self.chain.drive_force[self._bead].sum() + self.given[:, 1]

    @cached_property
    def by_walls(self) -> Array:
        """(T,) work [J] of moving walls on the beads since the first sample, see ``work_of_walls``."""
        return work_of_walls(self.chain, self.velocity, self.momentum - self.impulse)

    @cached_property
    def _bead(self) -> NDArray[np.bool_]:
        return np.isfinite(self.chain.mass)

    def hits(self) -> NDArray[np.void]:
        """Return the table of all hits: contact, begin, end, impulse, closing speed, largest force, energy lost.

        The motion is computed again with samples at the contact times and at the largest overlaps, so the values do not depend on
        the samples of this Trajectory. See :func:`softcradle.physics.analysis.hits.hits`.

        Returns
        -------
        ndarray
            Structured array, sorted by `begin`; `pandas.DataFrame(table)` makes a data frame of it.

        Raises
        ------
        ValueError
            If the samples do not begin at t = 0, or if the motion cannot be computed again (it was played by hand).

        Examples
        --------
        >>> from softcradle import hooke, one_on, simulate
        >>> table = simulate(one_on(1, hooke(4.0)), [1, 0]).hits()
        >>> table["impulse"].round(6), table["largest_force"].round(6)
        (array([1.]), array([1.414214]))
        """
        from softcradle.physics.analysis.hits import hits

        return hits(self)

    def save(self, path: trajectory_file.Path) -> None:
        """Write everything, the chain and the versions included, to an .npz file that :meth:`load` reads back."""
        values = {item.name: getattr(self, item.name) for item in fields(self)}
        trajectory_file.save_motion(path, values, {"position": self.position, "velocity": self.velocity})

    @staticmethod
    def load(path: trajectory_file.Path) -> Trajectory:
        """Read what :meth:`save` wrote.

        Raises
        ------
        OSError
            The file cannot be read.
        ValueError
            It is no trajectory of softcradle, or one of a later version.
        """
        return trajectory_file.load_motion(path, Trajectory)

    def to_csv(self, path: trajectory_file.Path) -> None:
        """Write one row a sample: time, positions, velocities, overlaps, forces, energies, momentum; header with units."""
        trajectory_file.write_csv(path, self._columns())

    def to_xarray(self) -> xr.Dataset:
        """The samples as an xarray Dataset, over time, bead and contact; units are attributes. Extra [notebook]."""
        return trajectory_file.dataset(self._columns(), self._attributes())

    def to_pandas(self) -> pd.DataFrame:
        """The samples as a pandas DataFrame with the columns of :meth:`to_csv`, time as the index. Extra [notebook]."""
        return trajectory_file.data_frame(self._columns(), self._attributes())

    def __repr__(self) -> str:
        end = "gave up" if self.status.gave_up else self.status.name.lower()
        how = f"step {self.step:.3g} s" if self.step else f"tolerance {self.tolerance:.3g}"
        times = (
            f"{self.time[0]:.6g} to {self.time[-1]:.6g} s in {self.time.size} samples"
            if self.time.size
            else "no samples"
        )
        return f"Trajectory of {self.chain.contacts + 1} beads, {times}, by {self.method} ({how}), {end}"

    def _attributes(self) -> dict[str, str | float]:
        return {
            "method": self.method,
            "step": self.step,
            "tolerance": self.tolerance,
            "status": self.status.name.lower(),
        }

    def _columns(self) -> list[trajectory_file.Columns]:
        beads = [f" {i}" for i in range(self.chain.contacts + 1)]
        contacts = [f" {i}-{i + 1}" for i in range(self.chain.contacts)]
        return [
            trajectory_file.Columns("time", "s", [""], self.time),
            trajectory_file.Columns("position", "m", beads, self.position, "bead"),
            trajectory_file.Columns("velocity", "m/s", beads, self.velocity, "bead"),
            trajectory_file.Columns("overlap", "m", contacts, self.overlap, "contact"),
            trajectory_file.Columns("force", "N", contacts, self.force, "contact"),
            trajectory_file.Columns("kinetic energy", "J", [""], self.kinetic_energy),
            trajectory_file.Columns("contact energy", "J", [""], self.contact_energy),
            trajectory_file.Columns("momentum", "N s", [""], self.momentum),
            trajectory_file.Columns("absorbed by contacts", "J", [""], self.absorbed_by_contacts),
            trajectory_file.Columns("absorbed by bed", "J", [""], self.absorbed_by_bed),
        ]
