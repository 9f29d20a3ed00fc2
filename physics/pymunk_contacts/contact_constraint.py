"""Soft contacts for any pymunk Space. A soft contact is a constraint that only pushes, with ``force = F + K *
overlap**a``.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from typing import Any, SupportsFloat

import numpy as np
import pymunk
from softcradle.physics.advice.stability_limits import TRUSTED_ERROR, stable_step
from softcradle.physics.chain import Chain
from softcradle.physics.checked_input import magnitude, number_array, require_kind, shown
from softcradle.physics.contact import Contact
from softcradle.physics.hit_table import Hit, LiveHit
from softcradle.physics.numerics import law_kernels
from softcradle.physics.numerics.plain_kernels import plain
from softcradle.physics.own_law import Law, OwnLaw, is_law
from softcradle.physics.pymunk_contacts import compiled_force as compiled
from softcradle.physics.pymunk_contacts.blow_watch import (
    FASTER,
    kinetic_energy,
    passing_sentence,
    warn_after_step,
    watch_of,
)
from softcradle.physics.pymunk_contacts.compiled_law import DEEP
from softcradle.physics.pymunk_contacts.post_step import (
    call_after_step,
    raise_after_step,
    require_finite,
    settled,
    space_of,
)
from softcradle.physics.segments import PiecewiseContact

Pair = tuple[float, float]
LawLike = Law | Callable[[float], SupportsFloat]
OnHit = Callable[["SoftContact", Hit], None]


class SoftContact(pymunk.DampedSpring):
    """A contact of two bodies. The contact pushes the bodies apart while their anchors are nearer than
    `touching_distance`.

    A SoftContact works like a ``pymunk.DampedSpring`` with the force of a :class:`~softcradle.physics.contact.Contact`.
    The force acts only while ``overlap = touching_distance - distance > 0``. The force is evaluated once per step,
    after the bodies have moved, as in the symplectic Euler method. Contacts are short, so use `substeps` to choose the
    step. If the step is too long for a contact that closes, a RuntimeWarning is issued, once for each law in a Space.
    The force acts along the line between the anchors, so the overlap must stay smaller than `touching_distance`. If the
    bodies pass through each other, a RuntimeWarning recommends a stiffness that would have stopped them.

    The contact replaces the collision between the shapes of the two bodies: `collide_bodies` is False unless set to
    True.

    A Contact with loss pushes with a fraction of its force while the bodies separate. While they are at rest, its force
    lies between this fraction and the whole force. Exactly this force keeps the bodies at rest. To find it, the contact
    assumes that the other forces on the bodies are the same as in the last step. The force of a Contact with loss
    depends on velocities, so it is always a Python callback.

    Copies and pickles include the contact, but not a `force_func` that you have set.

    Parameters
    ----------
    a, b : pymunk.Body
    anchor_a, anchor_b : (float, float)
        Anchor points, relative to the bodies [m].
    touching_distance : float
        Distance > 0 of the anchors [m] at which the contact just touches. For two balls with anchors in their
        centres, it is the sum of their radii.
    contact : Contact or law
        A Contact. Also a function that takes an overlap > 0 [m] and returns a force [N], or an object with such a
        method ``force``.
    native : bool, optional
        True means that the force is compiled code, which is several times faster. False means a Python callback
        with bitwise the same results. None means compiled code if possible.
    on_hit : callable, optional
        Called as ``on_hit(contact, hit)`` at the end of the step in which the contact has opened. The hit has the
        attributes begin, end [s], impulse [N s], closing_speed [m/s], largest_force [N] and energy_lost [J]. The
        times of a hit are counted from the first step of the contact. The force is then a Python callback. Copies
        and pickles do not include `on_hit`.

    Raises
    ------
    ValueError
        The distance is not a finite number > 0, an anchor is not two finite numbers, or `contact` does not define a
        force.
    RuntimeError
        `native` is True, but compiled code is not available. The message contains the reason.

    Examples
    --------
    A cradle in ten lines of pymunk, three balls at rest hit by a fourth:

    >>> import pymunk
    >>> from softcradle import SoftContact, hertz
    >>> space = pymunk.Space()
    >>> balls = [pymunk.Body(mass=1, moment=1) for _ in range(4)]
    >>> for i, ball in enumerate(balls):
    ...     ball.position = i, 0
    ...     space.add(ball)
    >>> for a, b in zip(balls, balls[1:]):
    ...     space.add(SoftContact(a, b, (0, 0), (0, 0), 1, hertz(1e4)))
    >>> balls[0].velocity = 1, 0
    >>> for _ in range(1000):
    ...     space.step(1e-4)
    >>> [round(ball.velocity.x, 2) for ball in balls]
    [-0.07, -0.03, 0.38, 0.72]
    """

    _pickle_attrs_init = pymunk.Constraint._pickle_attrs_init + [  # noqa: RUF005 - as its base class writes it
        "anchor_a",
        "anchor_b",
        "touching_distance",
        "contact",
        "_native",
    ]
    _pickle_attrs_general = pymunk.Constraint._pickle_attrs_general + ["_was_closed", "_others"]  # noqa: RUF005 - as above

    def __init__(
        self,
        a: pymunk.Body,
        b: pymunk.Body,
        anchor_a: Pair,
        anchor_b: Pair,
        touching_distance: float,
        contact: LawLike,
        native: bool | None = None,
        on_hit: OnHit | None = None,
    ) -> None:
        require_kind("a", a, pymunk.Body)
        require_kind("b", b, pymunk.Body)
        if a is b:
            raise ValueError("a SoftContact needs two different bodies: a and b are the same")
        distance = magnitude("touching_distance", touching_distance)
        anchors = _checked_anchor("anchor_a", anchor_a), _checked_anchor("anchor_b", anchor_b)
        super().__init__(a, b, *anchors, distance, 0.0, 0.0)
        self.collide_bodies = False
        self._native = native
        self._on_hit, self._live = on_hit, LiveHit()
        self._touching_distance = distance
        self._known_overlap = self._known_rate = math.nan
        self._compiled_law: Any = None
        self._was_closed = False
        self._others = 0.0  # Rate of change of the closing speed by all other forces in the last step [m/s²].
        # Step [s], speed [m/s] and inverse mass [1/kg] for which the step was last checked.
        self._looked_at: tuple[float, ...]
        self.force_func = SoftContact.contact_force  # type: ignore[assignment]  # its first argument is narrower
        self.contact = contact

    @staticmethod
    def contact_force(spring: SoftContact, dist: float) -> float:
        """Return the force of the contact at the distance `dist` of the anchors. It is the default force function.

        The force is 0 if the bodies are apart. If the law raises an exception, :py:meth:`pymunk.Space.step` raises it
        at the end of the step. Otherwise pymunk would only print the exception and continue with a wrong force.
        """
        # The method `pymunk` supplies the overlap. Otherwise it is computed from the distance.
        overlap = spring._known_overlap
        if math.isnan(overlap):
            overlap = spring._touching_distance - dist
        was_closed, spring._was_closed = spring._was_closed, overlap > 0.0
        if overlap <= 0.0:
            if spring._on_hit is not None:
                spring._log_hit(overlap, 0.0)
            return 0.0
        try:
            _require_in_space(spring, overlap)
            step = space_of(spring).current_time_step
            if step < 0.0:  # With a negative step, springs of pymunk would produce velocities that are NaN.
                raise ValueError(f"a SoftContact cannot step back in time: dt must be > 0, not {step:g}")
            force = spring._law(overlap)
            if not math.isfinite(force):
                raise ValueError(f"a law must give a finite force, not {force!r} at an overlap of {overlap:.6g} m")
            # Check the step when a contact closes. Check for passed bodies when the overlap is large.
            if not was_closed or spring._compiled_law is not None:
                spring._look_at_step(overlap)
            if overlap > DEEP * spring._touching_distance:
                spring._look_for_passing()
            push = spring._push_with_loss(force, was_closed) if spring._loss else force
            if spring._on_hit is not None:
                spring._log_hit(overlap, push)
            return push
        except BaseException as error:  # This includes KeyboardInterrupt, which pymunk would only print.
            raise_after_step(spring, error)
            return 0.0

    @property
    def on_hit(self) -> OnHit | None:
        """Function that is called after each hit, or None."""
        return self._on_hit

    @on_hit.setter
    def on_hit(self, on_hit: OnHit | None) -> None:
        before, self._on_hit, self._live = self._on_hit, on_hit, LiveHit()
        try:
            self._use(self._wants_native(self._contact))
        except RuntimeError:
            self._on_hit = before
            raise

    def _log_hit(self, overlap: float, push: float) -> None:
        """Add the current step to the current hit. If the hit has ended, call `on_hit` at the end of the step."""
        try:
            stored = self._stores.energy(overlap) if overlap > 0.0 else 0.0
            step = space_of(self).current_time_step
            ended = self._live.step(step, overlap, self.rate, push, stored, self._loss)
            if ended is not None and self._on_hit is not None:
                call_after_step(self, partial(self._on_hit, self, ended))
        except BaseException as error:  # This includes KeyboardInterrupt, which pymunk would only print.
            raise_after_step(self, error)

    @property
    def contact(self) -> LawLike:
        """Law of the contact. A new law takes effect in the next step."""
        return self._contact

    @contact.setter
    def contact(self, contact: LawLike) -> None:
        law, native = _scalar_law(contact), self._wants_native(contact)
        self._law, self._contact = law, contact
        self._stores = contact if isinstance(contact, (Contact, OwnLaw)) else OwnLaw(contact)
        self._loss = contact.loss if isinstance(contact, Contact) else 0.0
        self._looked_at = 0.0, 0.0, 0.0
        self._use(native)
        self.activate_bodies()

    @property
    def touching_distance(self) -> float:
        """Distance of the anchors at which the contact just touches [m], > 0."""
        return self._touching_distance

    @touching_distance.setter
    def touching_distance(self, distance: float) -> None:
        self._touching_distance = magnitude("touching_distance", distance)
        pymunk.DampedSpring.rest_length.fset(self, self._touching_distance)  # type: ignore[attr-defined]
        self._write_law()

    rest_length = touching_distance

    @property
    def overlap(self) -> float:
        """Current overlap of the bodies [m]; negative if they are apart."""
        ends = self.a.local_to_world(self.anchor_a), self.b.local_to_world(self.anchor_b)
        return self._touching_distance - (ends[1] - ends[0]).length

    @property
    def rate(self) -> float:
        """Current rate of change of the overlap [m/s]; negative while the bodies separate."""
        ends = self.a.local_to_world(self.anchor_a), self.b.local_to_world(self.anchor_b)
        line = ends[1] - ends[0]
        closing = self.a.velocity_at_world_point(ends[0]) - self.b.velocity_at_world_point(ends[1])
        return line.dot(closing) / line.length if line.length > 0.0 else 0.0

    @property
    def energy(self) -> float:
        """Energy [J] that is stored in the contact now. A contact with loss returns only a part of it."""
        return self._stores.energy(max(self.overlap, 0.0))

    def substeps(self, dt: float, speed: float, error: float = TRUSTED_ERROR) -> int:
        """Return the number of equal steps into which to divide `dt` [s] so that a collision at `speed` [m/s] is accurate.

        The error of the velocities is then at most `error`, relative to the speed; see :func:`~softcradle.stable_step`.
        The masses of the bodies and the law are those at the time of the call. With an error of 0.01 a collision
        changes the energy by at most 3 %. The errors of several collisions add up.
        """
        length = magnitude("dt", dt)
        return max(1, math.ceil(length / self._longest_step(magnitude("speed", speed), self._yielding(), error)))

    def _longest_step(self, speed: float, yielding: float, error: float = TRUSTED_ERROR) -> float:
        """Return the longest step [s] for an accurate collision at `speed` [m/s].

        `yielding` is the inverse reduced mass [1/kg].
        """
        return stable_step(Chain([math.inf, 1.0 / yielding], self._stores), [0.0, -speed], error)

    def _yielding(self) -> float:
        """Return the change of the closing speed per impulse [1/kg]. The result depends on both masses and on the
        rotation of the bodies.
        """
        ends = self.a.local_to_world(self.anchor_a), self.b.local_to_world(self.anchor_b)
        line = (ends[1] - ends[0]).normalized()
        found = 0.0
        for body, end in zip((self.a, self.b), ends, strict=True):
            if body.body_type == pymunk.Body.DYNAMIC:
                if not (body.mass and body.moment):
                    raise ValueError(
                        "a body of a SoftContact has no mass or moment yet: give it both, or shapes with density"
                    )
                # An impulse also rotates a body if its line of action does not pass through the centre of gravity.
                arm = (end - body.local_to_world(body.center_of_gravity)).cross(line)
                found += 1.0 / body.mass + arm * arm / body.moment
        if not found:
            raise ValueError("of the bodies of a SoftContact one at least must be dynamic: none is any more")
        return found

    def _look_at_step(self, overlap: float) -> None:
        """Check if the step is too long for the fastest collision of soft contacts in this Space so far.

        If it is, warn at the end of the step.
        """
        if not math.isnan(self._known_overlap):
            return
        space = space_of(self)
        watch = watch_of(space)
        step, rate, yielding = space.current_time_step, self.rate, self._yielding()
        # The speed of the collision follows from the current rate and from the stored energy of bodies that were placed
        # into each other.
        before = overlap - step * rate
        released = 2.0 * yielding * self._stores.energy(before) if before > 1e-9 * overlap else 0.0
        watch.fastest = speed = max(watch.fastest, math.sqrt(rate * rate + released))
        # Repeat the check only if the step, the speed or the inverse mass has grown noticeably.
        pairs = zip((step, speed, yielding), self._looked_at, strict=True)
        if all(now <= FASTER * then for now, then in pairs) or repr(self._contact) in watch.too_long:
            return
        self._looked_at = step, speed, yielding
        try:
            limit = self._longest_step(speed, yielding)
        # The force of a user-defined law may be undefined at some depth. The law raises an error when the contact gets
        # to this depth.
        except (ValueError, ArithmeticError):
            return
        if step > limit:
            watch.too_long.add(repr(self._contact))
            law = getattr(self._stores, "name", self._stores)
            sentence = (
                f"SoftContact with step {step:.3g} s is past its limit of about {limit:.2g} s at {speed:.3g} m/s: energy may "
                f"grow; take {math.ceil(step / limit)} steps in its place, contact.substeps(dt, speed), or a SoftChain. The "
                f"contact: {law}"
            )
            warn_after_step(self, sentence)

    @property
    def native(self) -> bool:
        """True if the force is compiled code, False if it is a Python callback."""
        return self._compiled_law is not None and self.force_func is SoftContact.contact_force

    # The C field for the stiffness contains the address of the law.
    stiffness = settled(lambda _: 0.0, "a SoftContact has no stiffness of its own: set its contact")
    damping = settled(lambda _: 0.0, "a SoftContact has no damping: a damper would pull bodies that are apart")

    def _push_with_loss(self, force: float, was_closed: bool) -> float:
        """Return the force of a contact with loss.

        During loading it is `force`, and during unloading a fraction of `force`. At rest it is the force that keeps the
        bodies at rest.
        """
        # The smallest possible force is that of the unloading branch.
        least = (1.0 - self._loss) * force
        if not math.isnan(self._known_rate):
            return least if self._known_rate < 0.0 else force
        step, rate, yielding = space_of(self).current_time_step, self.rate, self._yielding()
        # Forces from before the contact was open do not predict the next step.
        if not was_closed:
            self._others = 0.0
        # With this force, the bodies are at rest at the end of the step.
        held = (rate / step + self._others) / yielding
        push = min(max(held, least), force)
        alone = rate - step * yielding * push  # Overlap rate after the step if no other forces act.
        call_after_step(self, lambda: setattr(self, "_others", (self.rate - alone) / step))
        return push

    def _look_for_passing(self) -> None:
        """Warn at the end of the step if the bodies have passed through each other, once for each law in a Space."""
        if not math.isnan(self._known_overlap):
            return
        space = space_of(self)
        ends = self.a.local_to_world(self.anchor_a), self.b.local_to_world(self.anchor_b)
        now = ends[1] - ends[0]
        moving = self.b.velocity_at_world_point(ends[1]) - self.a.velocity_at_world_point(ends[0])
        # The direction of the line between the anchors has reversed since the last step.
        before = now - space.current_time_step * moving
        watch, law = watch_of(space), repr(self._contact)
        if now.dot(before) >= 0.0 or law in watch.passed:
            return
        watch.passed.add(law)
        pressed = max(self._touching_distance - before.length, 0.0)
        energy = self._energy_around(space) + self._stores.energy(pressed)
        warn_after_step(
            self, passing_sentence("two bodies of a SoftContact", self._stores, energy, self._touching_distance)
        )

    def _energy_around(self, space: pymunk.Space) -> float:
        """Return the energy [J] of all bodies that are connected by soft contacts with the two bodies of this contact.

        The stored energy of this contact is not included.
        """
        # Follow the soft contacts from body to body. The search does not continue beyond fixed bodies.
        there = set(space.constraints)
        bodies: dict[pymunk.Body, None] = {}
        contacts: dict[SoftContact, None] = {}
        waiting = [self.a, self.b]
        while waiting:
            body = waiting.pop()
            if body in bodies:
                continue
            bodies[body] = None
            if body.body_type == pymunk.Body.DYNAMIC:
                own = [found for found in body.constraints if isinstance(found, SoftContact) and found in there]
                contacts.update(dict.fromkeys(own))
                waiting += [end for found in own for end in (found.a, found.b)]
        return kinetic_energy(bodies) + math.fsum(contact.energy for contact in contacts if contact is not self)

    def _take_overlap(self, overlap: float, rate: float) -> None:
        """Use the given overlap [m] and rate [m/s] from now on, instead of computing them from the bodies.

        The caller manages the steps. The caller has the overlap with more digits than the positions, and the rate
        before any contact of the step has pushed.
        """
        self._known_overlap, self._known_rate = overlap, rate
        if self._compiled_law is not None:
            self._compiled_law[4], self._compiled_law[6] = overlap, 0.0

    def _wants_native(self, contact: LawLike) -> bool:
        """Return True if the force of `contact` must be compiled code.

        Raise RuntimeError if `native` is True but compiled code is not possible.
        """
        if self._native is False:
            return False
        reason = compiled.unavailable() if isinstance(contact, Contact) else f"{contact!r} is not a Contact"
        if isinstance(contact, Contact) and contact.loss:
            reason = "the force of a contact with loss depends on velocities"
        if self._on_hit is not None:
            reason = "on_hit is called from a Python callback"
        if self._native and reason:
            raise RuntimeError(f"no compiled callback for this contact: {reason}; native=None takes a Python one")
        return not reason

    def _use(self, native: bool) -> None:
        if not native and self._compiled_law is not None:
            self.force_func = SoftContact.contact_force  # type: ignore[assignment]
            self._compiled_law = None
        if native and self._compiled_law is None:
            self._compiled_law = compiled.attach(self)
        self._write_law()

    def _write_law(self) -> None:
        law = self._compiled_law
        if law is not None:
            contact = self._contact
            assert isinstance(contact, Contact)
            law[0], law[1], law[2] = contact.preload, contact.stiffness, contact.exponent
            law[3], law[4], law[5] = self._touching_distance, self._known_overlap, 0.0
        self._was_closed = False


def _require_in_space(spring: SoftContact, overlap: float) -> None:
    """Raise an error if a dynamic body of the contact is not in the Space, or if its motion is not finite."""
    for body in (spring.a, spring.b):
        if body.space is None and body.body_type == pymunk.Body.DYNAMIC:
            raise RuntimeError("a body of a SoftContact is not in the Space: add it, or remove its contacts with it")
        if math.isnan(overlap):
            require_finite(body, "a body of a SoftContact")


def _checked_anchor(name: str, anchor: Pair) -> Pair:
    found = number_array(name, anchor)
    if found.shape != (2,) or not np.isfinite(found).all():
        raise ValueError(f"{name} must be two finite numbers, not {shown(anchor)}")
    x, y = found.tolist()
    return x, y


def _scalar_law(contact: LawLike) -> Callable[[float], float]:
    """Return the force as a plain Python function of an overlap > 0.

    Its results are bitwise equal to the results of softcradle.physics.numerics.law_kernels.
    """
    if not is_law(contact):
        raise ValueError(
            f"contact must be a Contact, a function of the overlap or have a method force(overlap), not {shown(contact)}"
        )
    if isinstance(contact, PiecewiseContact):
        raise ValueError(
            "a SoftContact only pushes, a coupler pulls and goes solid: take simulate(..., method='conserving')"
        )
    # A user-defined law is called directly. A Contact uses the plain Python version of the compiled kernel.
    if not isinstance(contact, Contact):
        return (lambda d: float(contact.force(d))) if isinstance(contact, Law) else (lambda d: float(contact(d)))
    return partial(plain(law_kernels.force), contact.preload, contact.stiffness, contact.exponent)
