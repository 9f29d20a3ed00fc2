"""The state: what moves. Overlaps and their rates, because deep overlaps drown when taken as differences of positions."""

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
from softcradle.physics.status import Status, Warnings

Array = NDArray[np.float64]


class Switches(NamedTuple):
    """Changes of contacts between open and closed, in order of time for each contact: (S,) which, (S,) when [s]."""

    contact: NDArray[np.int64]
    time: Array

    @classmethod
    def of(cls, pairs: Sequence[tuple[int, float]]) -> Switches:
        """Those of (contact, time) for each."""
        return cls(np.array([contact for contact, _ in pairs], dtype=np.int64), np.array([time for _, time in pairs]))


NO_SWITCHES = Switches.of(())
MOVING = "overlap", "rate", "anchor", "force", "taken"  # arrays of a State of which samples have rows


@dataclass
class State:
    """Time, overlaps, rates and one anchor bead; everything else is rebuilt from them by summation.

    Attributes
    ----------
    time : float
        Time [s].
    overlap : ndarray, shape (n,)
        Overlaps d_i = u_i - u_(i+1) [m], Eq. (1); negative where the beads are apart.
    rate : ndarray, shape (n,)
        Overlap rates w_i = v_i - v_(i+1) [m/s].
    anchor : ndarray, shape (2,)
        Position [m] and velocity [m/s] of bead ``chain.anchor``.
    force : ndarray, shape (n,)
        Contact forces [N] of the last step: what a touching contact carries is not in its overlap.
    push : ndarray or None, shape (n+1,)
        External force on each bead [N] for the next `advance` (a spring to the pointer), or None; it adds to the
        chain's drive.
    switches : int
        How often contacts have closed or opened in all `advance` so far.
    switched : Switches
        Which of them did in the last `advance`, and when; of more than FRAME_LOG changes the first.
    coupled : ndarray, shape (n,) or (0,)
        Whether each contact has coupled: a coupler that has not yet only pushes. Without rows if no contact has several segments.
    taken : ndarray, shape (4,)
        What `absorbed` and `given` are parts of.
    velocity_error : float
        Estimated error [m/s] of the bead velocities, accumulated over all `advance` since the start by the methods accurate,
        radau and dop853. It grows by local errors, by round-off and by what the bounces of contacts amplify; no finer run
        confirms it. NaN after an `advance` by another method, which estimates none. A copy goes on from the error that it has
        at its time; set it to 0 to begin anew.
    status : Status
        How the last `advance` ended; where its method gave up, `conserving` went on to the end.
    warnings : tuple of CodedWarning
        What the last `advance` could not do; empty where it did as it should.
    work : dict
        Scratch memory of the methods, theirs alone.
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
        """The start of a scene: bead 0 at position 0, the chain's gaps between neighbours, `velocity` (n+1,) [m/s]."""
        require_kind("chain", chain, Chain)
        speeds = checked_velocity(chain, velocity)
        overlap, place, force, coupled = start_of(chain)
        anchor = np.array([place, speeds[chain.anchor]])
        return cls(0.0, overlap.copy(), speeds[:-1] - speeds[1:], anchor, force.copy(), coupled=coupled.copy())

    @property
    def absorbed(self) -> Array:
        """(2,) energy [J] that contacts with loss and the bed have absorbed so far."""
        return self.taken[:2]

    @property
    def given(self) -> Array:
        """(2,) work [J] and impulse [N s] of the chain's forces over time so far."""
        return self.taken[2:]

    @property
    def closed(self) -> NDArray[np.bool_]:
        """(n,) whether each contact pushes: it overlaps, or it touches and carries a force."""
        return is_closed(self.overlap, self.force)

    def position(self, chain: Chain) -> Array:
        """(n+1,) positions [m], bead lengths taken out: two beads that just touch have the same position."""
        return from_anchor(self.overlap, self.anchor[0], chain.anchor)

    def velocity(self, chain: Chain) -> Array:
        """(n+1,) bead velocities [m/s]."""
        return from_anchor(self.rate, self.anchor[1], chain.anchor)

    def energy(self, chain: Chain) -> float:
        """Kinetic and contact energy [J], walls left out."""
        kinetic = 0.5 * (chain.finite_mass * self.velocity(chain) ** 2).sum()
        return float(kinetic + chain.stored_energy(self.overlap, force=self.force).sum())

    def external(self, chain: Chain) -> Array | None:
        """(n+1,) steady external force on each bead [N], the chain's drive and the push; None where there is neither.

        An array that can be written to: to a kernel one that cannot is of another type, for which all of it would be
        compiled anew.
        """
        if chain.drive_force is None:
            return self.push
        return chain.drive_force + (0.0 if self.push is None else self.push)

    def copy(self) -> State:
        """An independent copy, without the scratch memory."""
        return State(
            self.time, self.overlap.copy(), self.rate.copy(), self.anchor.copy(), self.force.copy(),
            None if self.push is None else self.push.copy(), self.switches, self.switched, self.coupled.copy(),
            self.taken.copy(), self.velocity_error, self.status, self.warnings,
        )  # fmt: skip

    def put_force(self, chain: Chain, contact: int) -> None:
        """Set the force of a contact whose overlap or law has been changed to that at its overlap."""
        overlap, law = float(self.overlap[contact]), chain.contact[contact]
        free = overlap < 0.0 and chain.has_segments and not coupled_of(chain, self)[contact]
        self.force[contact] = 0.0 if free else law.force(overlap)

    def note_switches(self, contact: ArrayLike, time: ArrayLike, count: int | None = None) -> None:
        """Append switches to those of this `advance`; they were `count` in truth where the log had no room for all."""
        contact, time = np.array(contact, dtype=np.int64), np.array(time, dtype=np.float64)
        self.switches += contact.size if count is None else count
        if contact.size:
            before = self.switched
            self.switched = Switches(np.append(before.contact, contact), np.append(before.time, time))


@per_chain
def start_of(chain: Chain) -> tuple[Array, float, Array, NDArray[np.int8]]:
    """Overlaps (n,) [m] at the start, the position [m] of the anchor bead, contact forces (n,) [N], and which have coupled."""
    force = np.zeros(chain.contacts)
    if not any(chain.gap) and not chain.piecewise:
        return np.zeros(chain.contacts), 0.0, force, np.zeros(0, dtype=np.int8)
    gap = np.array(chain.gap)
    coupled = coupled_at(chain, -gap, force)
    pulled = (
        [i for i, contact in chain.piecewise if -gap[i] < contact.pulls_below and coupled[i]] if coupled.size else []
    )
    for i in [*np.flatnonzero(gap < 0.0).tolist(), *pulled]:
        force[i] = float(chain.contact[i].force(-gap[i]))
    position = np.concatenate(([0.0], np.cumsum(gap)))
    return 0.0 - gap, float(position[chain.anchor]), force, coupled


def coupled_at(chain: Chain, overlap: Array, force: Array) -> NDArray[np.int8]:
    """Return which contacts are coupled at overlaps and forces (n,) if nothing is known of the time before."""
    found = np.ones(chain.contacts if chain.has_segments else 0, dtype=np.int8)
    for i, contact in chain.piecewise if found.size else ():
        found[i] = force[i] < 0.0 or contact.starts_coupled(float(overlap[i]))
    return found


def coupled_of(chain: Chain, state: State) -> NDArray[np.int8]:
    """Return ``state.coupled``; a State that was made without it gets what its overlaps tell."""
    if state.coupled.size != (chain.contacts if chain.has_segments else 0):
        state.coupled = coupled_at(chain, state.overlap, state.force)
    return state.coupled


@np.errstate(invalid="ignore")  # of a motion that has blown up some are nan
def from_anchor(difference: Array, value: Any, anchor: int) -> Array:
    """Rebuild (..., n+1) bead values from (..., n) neighbour differences and the anchor bead's `value` (...)."""
    down = np.zeros((*difference.shape[:-1], difference.shape[-1] + 1))
    down[..., 1:] = difference
    np.subtract.accumulate(down, axis=-1, out=down)
    if anchor:
        down -= down[..., anchor, None].copy() if down.ndim > 1 else down[anchor]
    down += np.asarray(value)[..., None] if down.ndim > 1 else value
    return down


def checked_velocity(chain: Chain, velocity: ArrayLike) -> Array:
    """`velocity` as (n+1,) finite floats, or a ValueError that says what is wrong."""
    speeds = number_array("velocity", velocity)
    if speeds.shape != (chain.contacts + 1,):
        raise ValueError(f"{chain.contacts + 1} beads need {chain.contacts + 1} velocities, not {shown(velocity)}")
    values = speeds.tolist()
    fastest = max(map(abs, values))
    if not all(map(math.isfinite, values)):
        raise ValueError("every velocity must be finite")
    if fastest > LARGEST:
        raise ValueError(f"every velocity must be at most {LARGEST:g} m/s, not {fastest:g}: choose other units")
    return speeds
