"""State of a chain. A State contains overlaps and their rates instead of positions.

Differences of positions could not resolve the tiny overlaps deep inside a cluster.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from softcradle.physics.chain import Chain, per_chain
from softcradle.physics.checked_input import LARGEST, number_array, require_kind, shown
from softcradle.physics.contact import is_closed
from softcradle.physics.messages import InputError
from softcradle.physics.status import Status, Warnings

Array = NDArray[np.float64]


class Switches(NamedTuple):
    """Changes of contacts between open and closed: S contacts (S,) and times (S,) [s].

    The changes of each contact are in order of time.
    """

    contact: NDArray[np.int64]
    time: Array

    @classmethod
    def of(cls, pairs: Sequence[tuple[int, float]]) -> Switches:
        """Return the switches given as (contact, time) pairs."""
        return cls(np.array([contact for contact, _ in pairs], dtype=np.int64), np.array([time for _, time in pairs]))


NO_SWITCHES = Switches.of(())
# Names of the arrays of a State that have one row for each sample
MOVING = "overlap", "rate", "anchor", "force", "taken"


@dataclass
class State:
    """State of a chain: time, overlaps, overlap rates, and the motion of one anchor bead. The positions and velocities
    of all other beads are sums of these values.

    Attributes
    ----------
    time : float
        Time [s].
    overlap : ndarray, shape (n,)
        Overlaps d_i = u_i - u_(i+1) [m], Eq. (1); negative if the beads are apart.
    rate : ndarray, shape (n,)
        Overlap rates w_i = v_i - v_(i+1) [m/s].
    anchor : ndarray, shape (2,)
        Position [m] and velocity [m/s] of bead ``chain.anchor``.
    force : ndarray, shape (n,)
        Contact forces [N] of the last step. The forces are stored because the overlap of a touching contact does
        not determine its force.
    push : ndarray or None, shape (n+1,)
        External force on each bead [N] for the next `advance` (such as a spring to the pointer), or None. This
        force is added to the drive of the chain.
    switches : int
        Number of closings and openings of contacts in all `advance` so far.
    switched : Switches
        Closings and openings in the last `advance`, limited to the first FRAME_LOG of them.
    coupled : ndarray, shape (n,) or (0,)
        True for each contact that has coupled. A coupler that has not coupled yet only pushes. The array is empty
        if no contact has several segments.
    taken : ndarray, shape (4,)
        Array that contains the values of `absorbed` and `given`.
    velocity_error : float
        Estimated error [m/s] of the bead velocities, for the methods accurate, radau and dop853. The estimate
        accumulates over all calls of `advance` since the start. The estimate grows by local errors, by round-off,
        and by bounces of contacts, which amplify errors. The estimate is not confirmed by a second run. After an
        `advance` by another method it is NaN, because other methods do not estimate errors. A copy of the state
        continues from the error at its time. Set it to 0 to start a new estimate.
    status : Status
        How the last `advance` ended. If its method gave up, the method `conserving` continued to the end.
    warnings : tuple of CodedWarning
        Problems of the last `advance`; empty without problems.
    work : dict
        Scratch memory of the methods, for internal use.
    """

    time: float
    overlap: Array
    rate: Array
    anchor: Array
    force: Array
    push: Array | None = None
    switches: int = 0
    switched: Switches = NO_SWITCHES
    coupled: NDArray[np.int8] = field(default_factory=lambda: np.zeros(0, dtype=np.int8))
    taken: Array = field(default_factory=lambda: np.zeros(4))
    velocity_error: float = 0.0
    status: Status = Status.DONE
    warnings: Warnings = ()
    work: dict[str, Any] = field(default_factory=dict, repr=False, compare=False)

    @classmethod
    def at_start(cls, chain: Chain, velocity: ArrayLike) -> State:
        """Return the state of a chain at the start, with bead velocities `velocity` (n+1,) [m/s].

        Bead 0 has the position 0. The distances between neighbours are the gaps of the chain.
        """
        require_kind("chain", chain, Chain)
        speeds = checked_velocity(chain, velocity)
        if chain.swing and speeds[np.isinf(chain.mass)].any():
            raise InputError("wall_on_strings", "a wall among beads on strings stays at rest: its velocity must be 0")
        overlap, place, force, coupled = start_of(chain)
        anchor = np.array([place, speeds[chain.anchor]])
        return cls(0.0, overlap.copy(), speeds[:-1] - speeds[1:], anchor, force.copy(), coupled=coupled.copy())

    @property
    def absorbed(self) -> Array:
        """Energy [J] that contacts with loss and the bed have dissipated so far, shape (2,)."""
        return self.taken[:2]

    @property
    def given(self) -> Array:
        """Work [J] and impulse [N s] of the time-dependent forces so far, shape (2,)."""
        return self.taken[2:]

    @property
    def closed(self) -> NDArray[np.bool_]:
        """True for each closed contact, shape (n,). A contact is closed if it overlaps, or if it touches and carries a
        force.
        """
        return is_closed(self.overlap, self.force)

    def position(self, chain: Chain) -> Array:
        """Return the (n+1,) positions [m] without the bead lengths. Two beads that just touch have the same position."""
        return from_anchor(self.overlap, self.anchor[0], chain.anchor)

    def velocity(self, chain: Chain) -> Array:
        """Return the (n+1,) bead velocities [m/s]."""
        return from_anchor(self.rate, self.anchor[1], chain.anchor)

    def energy(self, chain: Chain, velocity: Array | None = None) -> float:
        """Return the kinetic energy plus the energy of contacts and strings [J], without walls.

        Pass the bead velocities `velocity` (n+1,) [m/s] if they have been computed already.
        """
        moves = self.velocity(chain) if velocity is None else velocity
        kinetic = 0.5 * (chain.finite_mass * moves**2).sum()
        if chain.swing:
            kinetic += hanging_energy(chain, self.overlap, self.anchor[0])
        # All contacts are open at the start and the end of most motions.
        if not chain.piecewise and all(overlap <= 0.0 for overlap in self.overlap.tolist()):
            return float(kinetic)
        return float(kinetic + chain.stored_energy(self.overlap, force=self.force).sum())

    def external(self, chain: Chain) -> Array | None:
        """Return the (n+1,) steady external force on each bead [N]: the drive of the chain plus `push`.

        Return None without both. The array is always writable. numba treats a read-only array as another type, and
        would compile every kernel again.
        """
        if chain.drive_force is None:
            return self.push
        # The sum is a new array, because the drive of the chain is read-only.
        return chain.drive_force + (0.0 if self.push is None else self.push)

    def copy(self) -> State:
        """Return an independent copy, without the scratch memory."""
        return State(
            self.time, self.overlap.copy(), self.rate.copy(), self.anchor.copy(), self.force.copy(),
            None if self.push is None else self.push.copy(), self.switches, self.switched, self.coupled.copy(),
            self.taken.copy(), self.velocity_error, self.status, self.warnings,
        )  # fmt: skip

    def put_force(self, chain: Chain, contact: int) -> None:
        """Set the force of a contact to the force of its law. Call it after the overlap or the law has changed."""
        overlap, law = float(self.overlap[contact]), chain.contact[contact]
        # A coupler that has not coupled yet does not pull.
        free = overlap < 0.0 and chain.has_segments and not coupled_of(chain, self)[contact]
        self.force[contact] = 0.0 if free else law.force(overlap)

    def note_switches(self, contact: ArrayLike, time: ArrayLike, count: int | None = None) -> None:
        """Append switches to `switched`.

        `count` is the actual number of switches if the log did not have room for all of them.
        """
        contact, time = np.array(contact, dtype=np.int64), np.array(time, dtype=np.float64)
        self.switches += contact.size if count is None else count
        if contact.size:
            before = self.switched
            self.switched = Switches(np.append(before.contact, contact), np.append(before.time, time))


@per_chain
def start_of(chain: Chain) -> tuple[Array, float, Array, NDArray[np.int8]]:
    """Return the values of a State at the start of the chain.

    The values are overlaps (n,) [m], the position [m] of the anchor bead, contact forces (n,) [N], and flags of coupled
    contacts.
    """
    force = np.zeros(chain.contacts)
    if not any(chain.gap) and not chain.piecewise:
        return np.zeros(chain.contacts), 0.0, force, np.zeros(0, dtype=np.int8)
    gap = np.array(chain.gap)
    coupled = coupled_at(chain, -gap, force)
    # Contacts that overlap or pull at the start carry the force of their law.
    pulled = (
        [i for i, contact in chain.piecewise if -gap[i] < contact.pulls_below and coupled[i]] if coupled.size else []
    )
    for i in [*np.flatnonzero(gap < 0.0).tolist(), *pulled]:
        force[i] = float(chain.contact[i].force(-gap[i]))
    position = np.concatenate(([0.0], np.cumsum(gap)))
    return 0.0 - gap, float(position[chain.anchor]), force, coupled


@per_chain
def rest_of(chain: Chain) -> tuple[Array, float]:
    """Return the overlaps (n,) [m] of beads on strings at rest, and the position [m] of the anchor bead.

    The rest position is the start of the chain.
    """
    overlap, place, _, _ = start_of(chain)
    return overlap, place


def displacement(chain: Chain, overlap: Array, anchor: Any) -> Array:
    """Return the displacements (..., n+1) [m] of beads on strings from their positions at rest.

    The displacements follow from overlaps (..., n) and positions of the anchor bead (...).
    """
    rest, place = rest_of(chain)
    return from_anchor(overlap - rest, np.asarray(anchor) - place, chain.anchor)


def hanging_energy(chain: Chain, overlap: Array, anchor: Any) -> Any:
    """Return the energy (...) [J] of beads on strings, which is 0 for a chain without strings.

    The energy follows from overlaps (..., n) [m] and positions of the anchor bead (...) [m].
    """
    return 0.5 * chain.swing * (chain.finite_mass * displacement(chain, overlap, anchor) ** 2).sum(axis=-1)


def coupled_at(chain: Chain, overlap: Array, force: Array) -> NDArray[np.int8]:
    """Return flags of the contacts that are coupled at the given overlaps (n,) and forces (n,).

    Earlier times are not taken into account.
    """
    found = np.ones(chain.contacts if chain.has_segments else 0, dtype=np.int8)
    for i, contact in chain.piecewise if found.size else ():
        found[i] = force[i] < 0.0 or contact.starts_coupled(float(overlap[i]))
    return found


def coupled_of(chain: Chain, state: State) -> NDArray[np.int8]:
    """Return ``state.coupled``. If the State was created without it, derive it from the overlaps."""
    if state.coupled.size != (chain.contacts if chain.has_segments else 0):
        state.coupled = coupled_at(chain, state.overlap, state.force)
    return state.coupled


@np.errstate(invalid="ignore")  # A motion that has diverged contains NaN.
def from_anchor(difference: Array, value: Any, anchor: int) -> Array:
    """Compute bead values (..., n+1) from the differences (..., n) between neighbours.

    The `value` (...) of the anchor bead determines the constant.
    """
    # Sum the differences from the first bead on. Then shift all values, so that the anchor bead gets its value.
    down = np.zeros((*difference.shape[:-1], difference.shape[-1] + 1))
    down[..., 1:] = difference
    np.subtract.accumulate(down, axis=-1, out=down)
    if anchor:
        down -= down[..., anchor, None].copy() if down.ndim > 1 else down[anchor]
    down += np.asarray(value)[..., None] if down.ndim > 1 else value
    return down


def checked_velocity(chain: Chain, velocity: ArrayLike) -> Array:
    """Return `velocity` as an array (n+1,) of finite floats. Raise ValueError if this is not possible."""
    speeds = number_array("velocity", velocity)
    if speeds.shape != (chain.contacts + 1,):
        raise InputError(
            "velocity_count",
            "{beads} beads need {beads} velocities, not {given}",
            beads=chain.contacts + 1,
            given=shown(velocity),
        )
    values = speeds.tolist()
    fastest = max(map(abs, values))
    if not all(map(math.isfinite, values)):
        raise InputError("velocity", "every velocity must be finite")
    if fastest > LARGEST:
        raise InputError(
            "fast",
            "every velocity must be at most {most:g} m/s, not {given:g}: choose other units",
            most=LARGEST,
            given=fastest,
        )
    return speeds
