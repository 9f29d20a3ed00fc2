"""SoftChain: contacts between neighbours in a row of pymunk bodies. All contacts are solved together, so any step size
is stable.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
import pymunk
from numpy.typing import ArrayLike, NDArray
from softcradle.physics.chain import Chain
from softcradle.physics.checked_input import magnitude, number_array, require_kind, shown
from softcradle.physics.contact import Contact, power_law, stored_energy
from softcradle.physics.coupler import Coupler
from softcradle.physics.hit_table import HitLog
from softcradle.physics.kernel_tiers import KernelTiers
from softcradle.physics.numerics.contact_solve import BEAD_ROWS
from softcradle.physics.numerics.records import NO_GRAPHS, NOTHING
from softcradle.physics.own_law import is_law
from softcradle.physics.pymunk_contacts.blow_watch import (
    FASTER,
    kinetic_energy,
    passing_sentence,
    warn_after_step,
    watch_of,
)
from softcradle.physics.pymunk_contacts.post_step import (
    call_after_step,
    raise_after_step,
    require_finite,
    settled,
    space_of,
)
from softcradle.physics.pymunk_contacts.soft_chain_step import (
    CHAIN_ROWS,
    begin_chain_step,
    end_chain_step,
    solve_chain_step,
    start_chain_step,
)
from softcradle.physics.pymunk_contacts.space_forces import SpaceForces, centres
from softcradle.physics.scales import scales_at

Array = NDArray[np.float64]

CHAIN_METHODS = ("conserving",)  # Valid values of the argument `method`
# Default of the allowed velocity error after a collision, relative to the collision speed. Larger errors are visible in
# a game.
VISIBLE_ERROR = 0.05
# Velocity error after a collision, relative to its speed, with a step as long as the shortest contact. The error falls
# with the square of the step. `python -m benchmarks soft-chains` measures it with random chains.
ERROR_AT_CONTACT_TIME = 3.0
# Names of the arrays that describe the motion of a chain
ROWS = ("_overlap", "_rate", "_lag", "_outside", "_acted", "_force", "_place", "_speed", "_absorbed")


@dataclass(frozen=True)
class SoftChainState:
    """State of motion of a SoftChain between two steps.

    Attributes
    ----------
    bodies : ndarray, shape (n+1, 6)
        Positions [m], velocities [m/s], angles and angular velocities of the bodies.
    rows : tuple of ndarray
        Stored quantities of the contacts.
    step : float
        The last step [s]; 0 before the first step.
    """

    bodies: Array
    rows: tuple[Array, ...]
    step: float


class SoftChain:
    """Contacts between neighbours in a row of bodies. Other joints, shapes and gravity act as usual.

    Iteration over a SoftChain yields its constraints, one between every two neighbours; ``chain[i]`` is one of them.
    Add them all with ``space.add(*bodies, *chain)``. Only constraints that are in the Space push. If one is removed,
    the row splits into two rows that move separately. `remove_from` removes all constraints, or those of some bodies.
    Shapes of neighbours do not collide. In every step of the Space, the first constraint that is evaluated solves all
    contacts by the method `conserving`. A collision conserves energy and momentum to round-off, with any step. The
    velocities of single bodies have a second-order error in the step: use `substeps` to reduce it. If a step is too
    long for a collision, or if bodies pass through each other, a RuntimeWarning is issued once.

    The positions X of pymunk's bodies are half a step behind their velocities V. `positions` returns the positions ``X
    + (step/2) V`` at the time of the velocities. The sum of kinetic energy and `energy` is constant. The kinetic energy
    is ``m v**2 / 2`` here; pymunk's own value lacks the factor 1/2.

    Bodies push each other along the line between their centres of gravity. The row need not be straight. The solver of
    the contacts includes gravity, forces, and strings to kinematic and static bodies. Strings are pin joints and taut
    slide joints without a limit of their force. Other joints are assumed to act as in the last two steps. A joint that
    stops a body within one step therefore dissipates energy. You may change positions and velocities of bodies between
    steps: the chain continues from the new values. Copies and pickles of the Space include the chain, and `of` finds it
    in the copy. `state` and `restore` roll back only the chain. A body can belong to one SoftChain only.

    The joints of pymunk also have errors. Example: a pendulum on a PinJoint, released at 0.5 rad, runs for 60 s with
    steps of 1/240 s. In plain pymunk it loses 5.5 % of its energy. A cradle of five such pendulums with a SoftChain
    loses 4.1 %.

    Parameters
    ----------
    bodies : sequence of pymunk.Body
        Bodies in the order of the row, n+1 >= 2 of them. At least one of two neighbours must be dynamic.
    contact : Contact or sequence of Contact
        One contact law for all contacts, or n laws.
    touching_distance : float or array_like, shape (n,)
        Distance > 0 [m] between the centres of two bodies that just touch. One number for all contacts, or n
        numbers.
    method : str, optional
        Method of the solver. "conserving" is the only one so far.
    touching_distances : float or array_like, optional
        Former name of `touching_distance`.

    Raises
    ------
    ValueError
        Wrong lengths or values.

    Examples
    --------
    A cradle in ten lines of pymunk that keeps its energy in steps of a sixtieth of a second, whatever the contacts:

    >>> import pymunk
    >>> from softcradle import SoftChain, hertz
    >>> space = pymunk.Space()
    >>> balls = [pymunk.Body(mass=1, moment=1) for _ in range(5)]
    >>> for i, ball in enumerate(balls):
    ...     ball.position = i, 0
    >>> balls[0].velocity = 1, 0
    >>> chain = SoftChain(balls, hertz(100), touching_distance=1)
    >>> space.add(*balls, *chain)
    >>> for _ in range(90):
    ...     space.step(1 / 60)
    >>> [round(ball.velocity.x, 2) for ball in balls]
    [-0.07, -0.03, -0.01, 0.13, 0.99]
    >>> round(sum(ball.velocity.length**2 / 2 for ball in balls) + chain.energy, 12)
    0.5
    """

    _contacts: tuple[Contact, ...]
    _checked: tuple[float, float]  # Step [s] and speed [m/s] of the last check in which the step was short enough
    _touching: Array

    def __init__(
        self,
        bodies: Sequence[pymunk.Body],
        contact: Contact | Sequence[Contact],
        touching_distance: ArrayLike | None = None,
        method: str = "conserving",
        *,
        touching_distances: ArrayLike | None = None,
    ) -> None:
        if (touching_distance is None) == (touching_distances is None):
            raise ValueError("a SoftChain needs its touching_distance: one for all contacts or one for each")
        if method not in CHAIN_METHODS:
            raise ValueError(f"method of a SoftChain must be one of {', '.join(CHAIN_METHODS)}, not {shown(method)}")
        # Check the bodies. All bodies must be different, and each pair must contain a dynamic body.
        require_kind("bodies", bodies, Sequence)
        for body in bodies:
            require_kind("every body", body, pymunk.Body)
        if len(bodies) < 2 or len(set(bodies)) < len(bodies):
            raise ValueError(f"a SoftChain needs at least 2 different bodies, not {len(set(bodies))}")
        for i, pair in enumerate(pairwise(bodies)):
            if all(body.body_type != pymunk.Body.DYNAMIC for body in pair):
                raise ValueError(f"of two neighbours one at least must be dynamic: bodies {i} and {i + 1} are not")
        self.method = method
        self.bodies = tuple(bodies)
        n = len(bodies) - 1
        # Motion of the contacts and bodies, see ROWS
        self._overlap, self._rate, self._lag, self._force = np.zeros((4, n))
        self._outside = np.zeros(n)  # Expected changes of the overlap rates by other forces in a step
        self._acted = np.zeros(n)  # Actual changes of the overlap rates by other forces in the last step
        self._place, self._speed, self._direction = np.zeros((n + 1, 2)), np.zeros((n + 1, 2)), np.zeros((n, 2))
        # scratch memory of the solver
        self._work = np.zeros((CHAIN_ROWS, n))
        self._beads = np.zeros((BEAD_ROWS, n + 1))
        self._absorbed = np.zeros(1)
        self._step = 0.0  # Length of the last step [s]; 0 before the first step
        self._gone: list[int] = []  # contacts that were not in the Space during the last step
        self._pushed = np.zeros(n, dtype=bool)  # contacts that pushed during the last step
        self._fastest = 0.0  # speed of the fastest collision so far [m/s]
        self._log: HitLog | None = None  # The first call of `hits` creates the log.
        self._unread: list[float | None] = [None] * n  # forces of the current step that pymunk has not read yet
        # These assignments call setters, which check the values.
        self.contact = contact
        self.touching_distance = touching_distance if touching_distances is None else touching_distances  # type: ignore[assignment]
        self._links = tuple(_Link.between(self, i) for i in range(n))

    @classmethod
    def of(cls, space: pymunk.Space) -> list[SoftChain]:
        """Return the chains in a Space, in the order in which they were added. The function also finds the chains of a
        copied Space.
        """
        require_kind("space", space, pymunk.Space)
        return list({link.chain: None for link in space.constraints if isinstance(link, _Link)})

    def remove_from(self, space: pymunk.Space, *bodies: pymunk.Body) -> None:
        """Remove contacts from the Space: all of them, or the contacts of `bodies`.

        These bodies may then join other chains. A removed contact acts again if you add it again: ``space.add(body,
        *(body.constraints - space.constraints))``.
        """
        require_kind("space", space, pymunk.Space)
        for body in bodies:
            require_kind("every body", body, pymunk.Body)
        if strangers := set(bodies) - set(self.bodies):
            raise ValueError(f"a SoftChain has no contacts of a body that is not in it: {shown(strangers.pop())}")
        there = [link for link in self._links if link in space.constraints]
        space.remove(*(link for link in there if not bodies or not {link.a, link.b}.isdisjoint(bodies)))

    @property
    def state(self) -> SoftChainState:
        """Current motion of bodies and contacts, for `restore`. Laws and touching distances are not included."""
        bodies = [(*body.position, *body.velocity, body.angle, body.angular_velocity) for body in self.bodies]
        return SoftChainState(np.array(bodies), tuple(getattr(self, row).copy() for row in ROWS), self._step)

    def restore(self, state: SoftChainState) -> None:
        """Restore a `state` of this chain or of its copy. The following steps are bitwise reproducible.

        pymunk stores impulses of joints and collisions as a start for its next step. Impulses of this kind are not
        restored.
        """
        require_kind("state", state, SoftChainState)
        if len(state.bodies) != len(self.bodies):
            raise ValueError(
                f"a state of {len(state.bodies)} bodies is none of a SoftChain of {len(self.bodies)}: take one of this chain"
            )
        # Set the angle first: it moves a body whose centre of gravity is not at its origin.
        for body, (x, y, u, v, angle, spin) in zip(self.bodies, state.bodies.tolist(), strict=True):
            body.angle, body.angular_velocity = angle, spin
            body.position, body.velocity = (x, y), (u, v)
        for row, values in zip(ROWS, state.rows, strict=True):
            getattr(self, row)[:] = values
        self._step = state.step
        if self._log is not None:
            self._log.forget()

    def hits(self, threshold: float = 0.0) -> NDArray[np.void]:
        """Return the table of all hits that have ended since the last call, sorted by their begin.

        The first call starts the log and returns an empty table, so call it before the first step. Without a call, no
        log is kept, which saves time. A hit lasts from the closing of a contact to its opening. Times are counted from
        the first call, and are interpolated within a step. Impulses and dissipated energies are sums over the steps.
        These sums agree with the motion to round-off. The largest force is the largest value of the forces at the ends
        of steps and of the mean forces of steps. After `restore`, the log is empty. At most 10 000 hits are kept
        between two calls.

        Parameters
        ----------
        threshold : float, optional
            Smallest impulse [N s] of a returned hit. Hits with a smaller impulse are dropped.

        Returns
        -------
        ndarray
            Structured array with the columns of :meth:`softcradle.Trajectory.hits`: contact, begin [s], end [s],
                impulse [N s],
            closing_speed [m/s], largest_force [N] and energy_lost [J].
        """
        least = magnitude("threshold", threshold, zero=True)
        if self._log is None:
            self._log = HitLog(len(self.bodies) - 1)
        return self._log.take(least)

    def __iter__(self) -> Iterator[pymunk.Constraint]:
        return iter(self._links)

    def __len__(self) -> int:
        return len(self._links)

    def __getitem__(self, index: int) -> pymunk.Constraint:
        return self._links[index]

    def substeps(self, dt: float, speed: float, error: float = VISIBLE_ERROR) -> int:
        """Return the number of equal steps into which `dt` should be divided to resolve a collision.

        Energy and momentum are exact without substeps, but the velocities of single bodies are not. With this number of
        steps, their error after a collision is at most `error` if each contact closes only once. Errors of successive
        collisions multiply.

        Parameters
        ----------
        dt : float
            Time [s], for example between two frames.
        speed : float
            Closing speed [m/s] of the fastest collision.
        error : float, optional
            Allowed error of velocities, relative to `speed`. The number of substeps grows with its inverse square root.

        Returns
        -------
        int
            Number of substeps, at least 1.
        """
        length, closing = magnitude("dt", dt), magnitude("speed", speed)
        return max(1, math.ceil(length / self._longest_step(closing, magnitude("error", error))))

    def _longest_step(self, speed: float, error: float = VISIBLE_ERROR) -> float:
        """Return the longest step [s] for a collision at `speed` [m/s] whose velocity error is at most `error`."""
        for i, body in enumerate(self.bodies):
            if body.body_type == pymunk.Body.DYNAMIC and not body.mass:
                raise ValueError(f"body {i} of a SoftChain has no mass yet: give it one, or shapes with density")
        mass = [body.mass if body.body_type == pymunk.Body.DYNAMIC else math.inf for body in self.bodies]
        times = scales_at(Chain(mass, list(self._contacts)), speed)[1]
        times[self._gone] = math.inf
        return float(times.min()) * math.sqrt(error / ERROR_AT_CONTACT_TIME)

    @property
    def contact(self) -> tuple[Contact, ...]:
        """Laws of the n contacts. Assign one law for all contacts, or n laws. New laws take effect in the next step."""
        return self._contacts

    @contact.setter
    def contact(self, contact: Contact | Sequence[Contact]) -> None:
        n = len(self.bodies) - 1
        found = tuple(contact) if isinstance(contact, Sequence) else (contact,) * n
        for law in found:
            if isinstance(law, Coupler):
                raise ValueError(
                    "a SoftChain takes no Coupler, its contacts only push: take simulate(..., method='conserving'), or a "
                    "Contact, and pymunk's joints for the pull"
                )
            if is_law(law) and not isinstance(law, Contact):
                raise ValueError(
                    f"a SoftChain takes Contacts, no other laws such as {shown(law)}: take a SoftContact, with contact.substeps"
                )
        if len(found) != n or not all(isinstance(law, Contact) for law in found):
            raise ValueError(
                f"a SoftChain of {n + 1} bodies needs one Contact for all or {n} of them, not {shown(contact)}"
            )
        # a new law needs a new check of the step
        self._contacts, self._checked = found, (0.0, 0.0)
        self._law = np.array([(contact.preload, contact.stiffness, contact.exponent) for contact in found])
        self._loss = np.array([contact.loss for contact in found])

    @property
    def touching_distance(self) -> Array:
        """(n,) distances [m] between the centres of two bodies that just touch.

        Assign one number for all contacts, or n numbers. New distances take effect at once.
        """
        return self._touching.copy()

    @touching_distance.setter
    def touching_distance(self, distances: ArrayLike) -> None:
        n = len(self.bodies) - 1
        found = number_array("touching_distance", distances).copy()
        if found.shape not in ((), (n,)) or not (np.isfinite(found) & (found > 0.0)).all():
            raise ValueError(f"touching_distance must be one or {n} finite numbers > 0, not {shown(distances)}")
        # Adapt the stored overlaps to the new distance.
        if self._step:
            self._overlap += found - self._touching
        self._touching = np.broadcast_to(found, (n,)).copy()

    @property
    def overlaps(self) -> Array:
        """(n,) overlaps [m] at the end of the last step; negative if bodies are apart. Before the first step, the
        current overlaps.

        A contact that was not in the Space during the step, or is no longer in it, has the overlap -inf.
        """
        if self._step:
            found = self._overlap.copy()
            found[[*self._gone, *self._taken_out()]] = -math.inf
            return found
        between = np.diff(centres(self.bodies)[0], axis=0)
        apart: Array = np.hypot(between[:, 0], between[:, 1])
        return self._touching - apart

    @property
    def forces(self) -> Array:
        """(n,) mean contact forces [N] of the last step. A contact that has been removed since then has the force 0."""
        found = self._force.copy()
        found[self._taken_out()] = 0.0
        return found

    @property
    def energy(self) -> float:
        """Energy [J] stored in the contacts. Contacts with loss return only a part of it."""
        return self._stored(self.overlaps)

    @property
    def absorbed(self) -> float:
        """Energy [J] that contacts with loss have dissipated.

        The sum of this energy, the kinetic energy and `energy` is constant.
        """
        return float(self._absorbed[0])

    @property
    def positions(self) -> list[pymunk.Vec2d]:
        """Centres of gravity [m] at the time of the velocities of the bodies, half a step later than ``position``."""
        position, velocity = centres(self.bodies)
        return [pymunk.Vec2d(*place) for place in (position + 0.5 * self._step * velocity).tolist()]

    def _stored(self, overlaps: Array) -> float:
        """Return the energy [J] that the contacts store at these overlaps [m]."""
        pairs = zip(self._contacts, overlaps.tolist(), strict=True)
        return math.fsum(float(contact.energy(overlap)) for contact, overlap in pairs)

    def _taken_out(self) -> list[int]:
        """Return the contacts that are not in a Space now.

        The data of the last step cannot show this if all contacts were removed.
        """
        there = [space.constraints for space in {body.space for body in self.bodies} if space]
        return [i for i, link in enumerate(self._links) if not any(link in links for links in there)]

    def _take_force(self, link: _Link) -> float:
        """Return the force of `link` in the current step. The first call in each step solves all contacts."""
        try:
            if self._unread[link.index] is None:
                self._begin_step(link)
            return self._unread[link.index] or 0.0
        finally:
            self._unread[link.index] = None

    def _begin_step(self, link: _Link) -> None:
        n = len(self._links)
        # If the solver raises an error, the other links push with force 0. Otherwise each link would raise the error
        # again.
        self._unread = [0.0] * n
        space = space_of(link)
        there = space.constraints
        # Contacts that were removed from the Space do not push.
        self._gone = [i for i, other in enumerate(self._links) if other not in there]
        self._require_own_bodies(space)
        step = space.current_time_step
        if step < 0.0:
            raise ValueError(
                f"a SoftChain cannot step back in time: dt must be > 0, not {step:g}; chain.restore goes back to a chain.state"
            )
        # Collect all other forces of the Space, and check that the motion is finite.
        outside = SpaceForces.of(space, self.bodies, step)
        for i in np.flatnonzero(~np.isfinite(outside.position + outside.expected).all(axis=1)).tolist():
            require_finite(self.bodies[i], f"body {i} of a SoftChain")
        bodies = self._touching, outside.position, outside.velocity, self._place, self._speed
        own = self._overlap, self._rate, self._lag, self._outside
        # Adapt the overlaps to changes of the bodies since the last step, for example by the user.
        if not self._step:
            _tier(start_chain_step)(step, *bodies, *own, self._force)
        before = self._step or step
        _tier(begin_chain_step)(step, before, *bodies, self._direction, *own)
        self._look_for_passing(link, step, outside)
        self._acted *= step / before
        self._step = step
        call_after_step(link, lambda: self._end_step(link))
        # The two bodies have the same position, so the direction of a force is undefined.
        at_one_place = np.flatnonzero(~self._direction.any(axis=1)).tolist()
        if apart := [*self._gone, *at_one_place]:  # Keep these contacts open during the step, wherever the bodies are.
            fastest = np.abs(outside.velocity).max() + np.abs(outside.expected).max()
            self._overlap[apart] = -self._touching[apart] - 4.0 * step * fastest
            self._lag[apart] = self._outside[apart] = self._acted[apart] = 0.0
        # solve all contacts
        moving = outside.mobility, outside.expected, outside.velocity, self._direction
        contacts = self._lag, self._outside, self._overlap, self._rate, self._force
        loss, memory = self._loss if self._loss.any() else NOTHING, (self._beads, self._work)
        overlap, rate = self._overlap.copy(), self._rate.copy()
        solved = _tier(solve_chain_step)(step, self._law, NO_GRAPHS, loss, self._absorbed, moving, *contacts, memory)
        self._unread = self._force.tolist()
        if self._log is not None:
            self._log_hits(self._log, step, overlap, rate)
        self._check_step(link, overlap, rate)
        if not solved:
            warnings.warn(
                "the contacts of a SoftChain did not converge: take a smaller step", RuntimeWarning, stacklevel=2
            )

    def _log_hits(self, log: HitLog, step: float, overlap: Array, rate: Array) -> None:
        """Add the step to the `log` of hits. `overlap` and `rate` are the values before the step."""
        law, end = self._law.T, self._overlap
        deepest = np.maximum(np.maximum(overlap, end), 0.0)
        pushing = self._force > 0.0
        whole = law[0] + law[1] * deepest ** law[2]  # Force of the loading branch.
        largest = np.where(pushing, np.maximum(self._force, np.where(rate > 0.0, whole, 0.0)), 0.0)
        # Dissipated energy: work of the mean force minus the increase of the stored energy. This energy is zero for an
        # elastic contact.
        rise = stored_energy(law[0], law[1], law[2], end) - stored_energy(law[0], law[1], law[2], overlap)
        lost = np.where(self._loss > 0.0, self._force * (end - overlap) - rise, 0.0)
        log.add_step(step, (overlap, rate), (end, self._rate), self._force, largest, lost)

    def _require_own_bodies(self, space: pymunk.Space) -> None:
        """Raise RuntimeError if a body is not in the Space, if contacts cannot move any body, or if two SoftChains
        share a body.
        """
        # bodies with at least one contact in the Space
        pushed = {
            i: body for i, body in enumerate(self.bodies) if not {i - 1, i} <= {-1, len(self._links), *self._gone}
        }
        moving = [body for body in pushed.values() if body.body_type == pymunk.Body.DYNAMIC]
        if len(moving) > 1 and all(body.space is not space for body in moving):
            raise RuntimeError(
                "the contacts of a SoftChain are in the Space, its bodies are not: space.add(*chain.bodies), without the walls"
            )
        for i, body in pushed.items():
            if body.space is not space and body.body_type == pymunk.Body.DYNAMIC:
                raise RuntimeError(
                    f"body {i} of a SoftChain is not in the Space, a contact of it is: add it, or chain.remove_from(space, body)"
                )
        # A contact between two bodies that cannot move cannot be solved.
        for i in range(len(self._links)):
            if i not in self._gone and all(body.body_type != pymunk.Body.DYNAMIC for body in self.bodies[i : i + 2]):
                raise RuntimeError(
                    f"of two neighbours in a SoftChain one at least must be dynamic: bodies {i} and {i + 1} are not any more; "
                    "remove the contact between them"
                )
        # the checks below are only needed before the first step
        if self._step:
            return
        for i, body in pushed.items():
            centre = self._links[i].anchor_a if i < len(self._links) else self._links[i - 1].anchor_b
            # Contact forces would rotate the body.
            if (body.center_of_gravity - centre).length > 1e-9 * self._touching.max():
                raise RuntimeError(
                    f"the centre of gravity of body {i} has moved since its SoftChain was made: give it its shapes before"
                )
        # Links of other chains that are attached to the same bodies
        links = {link for body in pushed.values() for link in body.constraints if isinstance(link, _Link)}
        others = links - {*self._links}
        if others and not others.isdisjoint(space.constraints):
            raise RuntimeError(
                "a body belongs to two SoftChains: each would solve its contacts without the other's; make one chain of the "
                "row, or join them by a SoftContact"
            )

    def _check_step(self, link: _Link, overlap: Array, rate: Array) -> None:
        """Warn if the step is too long for a collision that begins in it.

        `overlap` and `rate` are the values before the step.
        """
        pushes = self._force > 0.0
        begins, self._pushed = pushes & ~self._pushed, pushes
        if not begins.any():
            return
        # Speed of each new collision, including the energy that is stored at its start.
        for i in np.flatnonzero(begins).tolist():
            # This energy is positive if the bodies were placed into each other.
            stored = self._contacts[i].energy(float(overlap[i]))
            yielding = sum(1.0 / body.mass for body in self.bodies[i : i + 2] if body.body_type == pymunk.Body.DYNAMIC)
            self._fastest = max(self._fastest, math.sqrt(float(rate[i]) ** 2 + 2.0 * yielding * stored))
        # Repeat the check only if the step or the speed has grown noticeably. Check each law once.
        now = self._step, self._fastest
        if all(number <= FASTER * then for number, then in zip(now, self._checked, strict=True)):
            return
        watch = watch_of(space_of(link))
        laws = {str(self._contacts[i]) for i in np.flatnonzero(begins).tolist()}
        if laws <= watch.too_long or not self._fastest:
            return
        self._checked = now
        limit = self._longest_step(self._fastest)
        if self._step > limit:
            watch.too_long |= laws
            warn_after_step(
                link,
                f"SoftChain with step {self._step:.3g} s is past its limit of about {limit:.2g} s at {self._fastest:.3g} m/s: "
                f"energy holds, velocities of single bodies may be wrong; take {math.ceil(self._step / limit)} steps in its "
                f"place, chain.substeps(dt, speed), or a softer contact. The contact: {', '.join(sorted(laws))}",
            )

    def _look_for_passing(self, link: _Link, step: float, bodies: SpaceForces) -> None:
        """Warn if bodies have passed through each other when this step moved them."""
        now, moving = np.diff(bodies.position, axis=0), np.diff(bodies.velocity, axis=0)
        before = now - step * moving
        passed = np.einsum("ij,ij->i", before, now) < 0.0
        if passed.any():
            # The bodies must have met. Bodies that pass at a distance do not count.
            aside = np.abs(before[:, 0] * now[:, 1] - before[:, 1] * now[:, 0])
            self._warn_of_passing(link, passed & (aside < self._touching * step * np.hypot(*moving.T)))

    def _warn_of_passing(self, link: _Link, passed: NDArray[np.bool_]) -> None:
        """Warn that neighbours have passed through each other, once for each law in a Space.

        `passed` (n,) marks the contacts of these neighbours.
        """
        passed[self._gone] = False
        for i in np.flatnonzero(passed).tolist():
            law, watch = self._contacts[i], watch_of(space_of(link))
            if str(law) in watch.passed:
                continue
            watch.passed.add(str(law))
            # Among the contacts with this law, the smallest touching distance requires the largest stiffness.
            touching = min(
                float(self._touching[j])
                for j, contact in enumerate(self._contacts)
                if contact == law and j not in self._gone
            )
            sentence = passing_sentence(
                f"bodies {i} and {i + 1} of a SoftChain",
                law,
                kinetic_energy(self.bodies) + self._stored(self._overlap),
                touching,
            )
            warn_after_step(link, sentence)

    def _end_step(self, link: _Link) -> None:
        self._unread = [None] * len(self._links)
        # If the overlap exceeds the touching distance, the centres have passed each other.
        if (self._overlap > self._touching).any():
            self._warn_of_passing(link, self._overlap > self._touching)
        _tier(end_chain_step)(
            self._step, self._touching, *centres(self.bodies), self._place, self._speed, self._direction, self._overlap,
            self._rate, self._lag, self._outside,
        )  # fmt: skip
        acted, before = self._outside.copy(), self._acted
        # If a force acted in two consecutive steps, it is expected to continue. A collision acts in one step only, and
        # is not expected to recur.
        self._outside = np.maximum(np.minimum(acted, before), 0.0) + np.minimum(np.maximum(acted, before), 0.0)
        self._acted = acted


def _of_the_chain(name: str) -> property:
    """Return a read-only property of a link, for an attribute of pymunk's springs that the chain controls."""
    why = f"a link of a SoftChain takes no {name}: its force is the chain's; set chain.contact"
    return settled(getattr(pymunk.DampedSpring, name).fget, why)


class _Link(pymunk.DampedSpring):
    """Constraint of one contact of a SoftChain: a spring whose force the chain computes."""

    _pickle_attrs_init = pymunk.Constraint._pickle_attrs_init + ["anchor_a", "anchor_b"]  # noqa: RUF005 - as its base
    _pickle_attrs_general = ["error_bias", "max_bias", "collide_bodies"]  # noqa: RUF012 - not max_force

    anchor_a, anchor_b, rest_length = _of_the_chain("anchor_a"), _of_the_chain("anchor_b"), _of_the_chain("rest_length")
    stiffness, damping, max_force = _of_the_chain("stiffness"), _of_the_chain("damping"), _of_the_chain("max_force")
    force_func = _of_the_chain("force_func")

    chain: SoftChain
    index: int

    def __init__(
        self, a: pymunk.Body, b: pymunk.Body, anchor_a: tuple[float, float], anchor_b: tuple[float, float]
    ) -> None:
        super().__init__(a, b, anchor_a, anchor_b, 0.0, 0.0, 0.0)
        self.collide_bodies = False
        pymunk.DampedSpring.force_func.fset(self, _Link.chain_force)  # type: ignore[attr-defined]

    @classmethod
    def between(cls, chain: SoftChain, index: int) -> _Link:
        """Return the link between bodies `index` and `index` + 1."""
        a, b = chain.bodies[index : index + 2]
        link = cls(a, b, a.center_of_gravity, b.center_of_gravity)
        link.chain, link.index = chain, index
        return link

    @staticmethod
    def chain_force(link: _Link, dist: float) -> float:
        """Return the force that the chain has computed. An error is raised as in :meth:`SoftContact.contact_force`."""
        try:
            return link.chain._take_force(link)
        except BaseException as error:
            raise_after_step(link, error)
            return 0.0


def _step_once() -> None:
    """Take one step of a small chain. This calls every kernel."""
    space, bodies = pymunk.Space(), [pymunk.Body(1, 1), pymunk.Body(1, 1)]
    bodies[1].position = 1, 0
    bodies[0].velocity = 1, 0
    space.add(*bodies, *SoftChain(bodies, power_law(1.0, 1.0), 1))
    space.step(1e-3)


KERNELS = KernelTiers("soft-chain", __name__, _step_once)
TIERS = {KERNELS.name: KERNELS}


def _tier(kernel: Any) -> Any:
    """Return the version of a kernel that is available: compiled or plain Python.

    The return type is Any because the arguments are unpacked from tuples, which type checkers cannot count.
    """
    return KERNELS.of_frame(kernel)
