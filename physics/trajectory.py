"""Trajectory: the result of a simulation. A Trajectory contains sampled arrays, the contact times, and the cost of the
computation.
"""

from __future__ import annotations

from dataclasses import dataclass, field, fields
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from softcradle.physics import trajectory_file
from softcradle.physics.chain import Chain
from softcradle.physics.notebook_views import Moving
from softcradle.physics.state import from_anchor, hanging_energy
from softcradle.physics.status import Status, Warnings

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

Array = NDArray[np.float64]
Interval = tuple[float, float]

# Largest difference of the velocities of two walls that count as equal, relative to the largest speed. Such velocities
# are sums over the chain, so they contain round-off.
ALIKE = 1e-9


def _nothing() -> Array:
    return np.zeros(0)


def work_of_walls(chain: Chain, velocity: Array, momentum: Array) -> Array:
    """Return the work (T,) [J] of the walls of `chain` on its beads since the first of T times. The result is NaN if
    the work is unknown.

    `momentum` (T,) [N s] is the momentum of the beads without the contributions of other causes, so its changes come
    from the walls. The work follows from it if all walls have the same speed and no bed absorbs momentum. Walls at rest
    do not do work.

    Parameters
    ----------
    velocity : ndarray, shape (T, n+1)
        Velocities [m/s] of all beads, including walls.
    """
    # Velocities of the walls, which must be equal.
    speeds = velocity[:, np.isinf(chain.mass)]
    if not speeds.any():
        return np.zeros(len(velocity))
    speed, fastest = speeds[0, 0], np.abs(velocity).max(initial=0.0, where=np.isfinite(velocity))
    if not np.abs(speeds - speed).max() <= ALIKE * fastest or (speed != 0.0 and chain.on_bed):
        return np.full(len(velocity), np.nan)
    return speed * (momentum - momentum[0])


@dataclass(frozen=True, eq=False, repr=False)
class Trajectory(Moving):
    """Result of a simulation: samples of the motion, the times at which each contact closed and opened, and the cost.

    `velocity_error` is the estimated error of `final_velocity`. `position_error` is the estimated error of the
    positions. Errors of velocities at samples and of contact times are not estimated. The errors of these values are
    larger while contacts push, or if contacts close slowly. Compare runs at two tolerances to measure these errors.

    Attributes
    ----------
    chain : Chain
    time : ndarray, shape (T,)
        Sample times [s].
    overlap : ndarray, shape (T, n)
        Overlaps [m], Eq. (1).
    rate : ndarray, shape (T, n)
        Overlap rates [m/s]. Deep inside a cluster, they are more accurate than differences of `velocity`.
    anchor : ndarray, shape (T, 2)
        Position [m] and velocity [m/s] of bead ``chain.anchor``.
    force : ndarray, shape (T, n)
        Contact forces [N].
    final_velocity : ndarray, shape (n+1,)
        Bead velocities [m/s] at the end of the run, independent of the samples.
    contact_intervals : tuple of tuples
        For each contact a tuple of (closed, opened) times [s]. The opening time is inf if the contact never opens.
        A contact that touches at rest closes as soon as a neighbour pushes it, long before a wave brings a
        significant force. With fixed steps, it closes up to two steps per contact later. Some times are not
        determined by the motion. Examples are the number of bounces of a soft contact while it separates, and the
        opening times between beads that a wave leaves nearly at rest. Another example is the force between beads
        that friction holds at rest. Adaptive methods then use the middle of the possible range of this force. With
        fixed steps, contacts next to such a bead may close by round-off. Bounces within an adaptive step are not
        reported, because their force is nearly zero.
    method : str
        Name of the method.
    step : float
        Step of a fixed-step method [s]; 0 for adaptive methods.
    tolerance : float
        Tolerance of an adaptive method; 0 for fixed steps.
    speed_scale : float
        Speed [m/s] to which `tolerance` is relative: the largest possible closing speed of the motion. The scale is
        0 for fixed steps.
    steps : int
        Number of steps taken.
    evaluations : int
        Number of evaluations of all contact forces.
    seconds : float
        Wall time of the solver [s].
    status : Status
        How the run ended. If it gave up, `final_velocity` belongs to the time at which it stopped.
    velocity_error : ndarray, shape (n+1,)
        Estimated error [m/s] of `final_velocity`; NaN if the method does not estimate errors (fixed steps).
    warnings : tuple of CodedWarning
        Possible problems, each with a code, a sentence and its numbers; empty without problems.
    choice : str
        Method that "auto" has chosen, and the reason. The text is "" for other methods.
    absorbed_by_contacts : ndarray, shape (T,)
        Energy [J] that contacts with loss have dissipated since t = 0.
    absorbed_by_bed : ndarray, shape (T,)
        Energy [J] that bed friction has dissipated since t = 0. The energy balance is: kinetic energy + contact
        energy + both dissipated energies = energy at the start + `driven` + `by_walls`.
    given : ndarray, shape (T, 2)
        Work [J] and impulse [N s] of the time-dependent forces since t = 0, without walls. In a motion that was
        recorded in the window, the work and impulse of the pointer and of edits since the first sample are
        included.
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
        # Defaults of arrays that the caller did not pass: errors are unknown, and energies are 0.
        if self.velocity_error.size != self.final_velocity.size:
            object.__setattr__(self, "velocity_error", np.full(self.final_velocity.size, np.nan))
        for name in ("absorbed_by_contacts", "absorbed_by_bed"):
            if getattr(self, name).size != self.time.size:
                object.__setattr__(self, name, np.zeros(self.time.size))
        if len(self.given) != self.time.size:
            object.__setattr__(self, "given", np.zeros((self.time.size, 2)))

    @cached_property
    def position(self) -> Array:
        """Positions [m] without the bead lengths, shape (T, n+1). Two beads that just touch have the same position."""
        return from_anchor(self.overlap, self.anchor[:, 0], self.chain.anchor)

    @property
    def position_error(self) -> Array:
        """Estimated error [m] of the positions, shape (T,). The estimate is the time since the start, multiplied by a
        velocity error.

        This velocity error is the largest `velocity_error`, but at least the tolerance times `speed_scale`. The lower
        limit is needed for beads that have come to rest: they have hardly any velocity error, but their positions
        contain earlier errors.
        """
        # This is only an estimate: the velocity error is assumed to act during the whole time.
        return np.maximum(self.velocity_error.max(), self.tolerance * self.speed_scale) * self.time

    @cached_property
    def velocity(self) -> Array:
        """Bead velocities [m/s], shape (T, n+1)."""
        return from_anchor(self.rate, self.anchor[:, 1], self.chain.anchor)

    @cached_property
    def kinetic_energy(self) -> Array:
        """Kinetic energy [J] of the beads, shape (T,), without walls."""
        with np.errstate(over="ignore"):  # The energy is inf for a motion that has diverged.
            return 0.5 * self.velocity[:, self._bead] ** 2 @ self.chain.finite_mass[self._bead]

    @cached_property
    def contact_energy(self) -> Array:
        """Energy [J] stored in the contacts, shape (T,). Contacts with loss return only a part of it."""
        return self.chain.stored_energy(self.overlap, force=self.force).sum(axis=1)

    @cached_property
    def string_energy(self) -> Array:
        """Energy [J] of the beads on strings, shape (T,), relative to their positions at rest. The energy is 0 without
        strings.
        """
        if not self.chain.swing:
            return np.zeros(self.time.size)
        found: Array = hanging_energy(self.chain, self.overlap, self.anchor[:, 0])
        return found

    @cached_property
    def momentum(self) -> Array:
        """Momentum [N s] of the beads, shape (T,), without walls."""
        return self.velocity[:, self._bead] @ self.chain.finite_mass[self._bead]

    @property
    def ledger(self) -> Array:
        """Total of the energy balance [J], shape (T,). The total must stay constant.

        The total is the energy of motion, contacts and strings, plus the energy dissipated by contacts and bed, minus
        `driven` and `by_walls`. The total is NaN if `by_walls` is unknown.
        """
        energy = self.kinetic_energy + self.contact_energy - self.driven - self.by_walls
        if self.chain.swing:
            energy = energy + self.string_energy
        return energy + self.absorbed_by_contacts + self.absorbed_by_bed

    @cached_property
    def driven(self) -> Array:
        """Work [J] of the drive and of time-dependent forces on the beads since t = 0, shape (T,), without walls."""
        if self.chain.drive_force is None:
            return self.given[:, 0]
        start = np.concatenate(([0.0], np.cumsum(self.chain.gap)))
        work: Array = (self.position - start)[:, self._bead] @ self.chain.drive_force[self._bead]
        return work + self.given[:, 0]

    @cached_property
    def impulse(self) -> Array:
        """Momentum [N s] that the drive and time-dependent forces have transferred to the beads since t = 0, shape
        (T,).

        Walls are not included.
        """
        if self.chain.drive_force is None:
            return self.given[:, 1]
        return self.time * self.chain.drive_force[self._bead].sum() + self.given[:, 1]

    @cached_property
    def by_walls(self) -> Array:
        """Work [J] of moving walls on the beads since the first sample, shape (T,); see ``work_of_walls``."""
        return work_of_walls(self.chain, self.velocity, self.momentum - self.impulse)

    @cached_property
    def _bead(self) -> NDArray[np.bool_]:
        return np.isfinite(self.chain.mass)

    def hits(self) -> NDArray[np.void]:
        """Return the table of all hits. A hit is a time interval in which a contact is closed.

        The columns are contact, begin, end, impulse, closing speed, largest force and energy lost. The motion is
        computed again, with samples at the contact times and at the largest overlaps. The values therefore do not
        depend on the samples of this Trajectory. See :func:`softcradle.physics.analysis.hits.hits`.

        Returns
        -------
        ndarray
            Structured array, sorted by `begin`. `pandas.DataFrame(table)` converts it to a data frame.

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

    @cached_property
    def largest_force(self) -> Array:
        """Largest force [N] of each contact, shape (n,), from :meth:`hits`.

        The value is exact, in contrast to the maximum of the sampled `force`. The value is negative for a coupler that
        pulled more than it pushed, and 0 for a contact that never closed. A ValueError is raised in the same cases as
        by `hits`.
        """
        found = np.zeros(self.chain.contacts)
        for row in self.hits():
            if abs(row["largest_force"]) > abs(found[row["contact"]]):
                found[row["contact"]] = row["largest_force"]
        return found

    def save(self, path: trajectory_file.Path) -> None:
        """Write all data, including the chain and the versions, to an .npz file, which :meth:`load` reads."""
        values = {item.name: getattr(self, item.name) for item in fields(self)}
        trajectory_file.save_motion(path, values, {"position": self.position, "velocity": self.velocity})

    @staticmethod
    def load(path: trajectory_file.Path) -> Trajectory:
        """Read a file that :meth:`save` wrote.

        Raises
        ------
        OSError
            If the file cannot be read.
        ValueError
            If the file is not a trajectory of softcradle, or was written by a later version.
        """
        return trajectory_file.load_motion(path, Trajectory)

    def to_csv(self, path: trajectory_file.Path) -> None:
        """Write one row per sample to a .csv file. The header contains quantities and units.

        The columns are time, positions, velocities, overlaps, forces, energies and momentum.
        """
        trajectory_file.write_csv(path, self._columns())

    def to_xarray(self) -> xr.Dataset:
        """Return the samples as an xarray Dataset over time, bead and contact, with units as attributes.

        This requires the extra [notebook].
        """
        return trajectory_file.dataset(self._columns(), self._attributes())

    def to_pandas(self) -> pd.DataFrame:
        """Return the samples as a pandas DataFrame with the columns of :meth:`to_csv` and time as index.

        This requires the extra [notebook].
        """
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
