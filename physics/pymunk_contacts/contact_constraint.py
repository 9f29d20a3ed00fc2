"""Soft contacts for pymunk: constraints that only push, ``force = F + K * overlap**a``, in anyone's Space."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import pymunk
from softcradle.physics.checked_input import magnitude, require_kind, shown
from softcradle.physics.contact import Contact
from softcradle.physics.coupler import Coupler
from softcradle.physics.own_law import Law
from softcradle.physics.pymunk_contacts import compiled_force as compiled
from softcradle.physics.pymunk_contacts.post_step import raise_after_step

Pair = tuple[float, float]


class SoftContact(pymunk.DampedSpring):
    """Two bodies that push each other apart while their anchors are nearer than they can be without pressing.

    Works like a ``pymunk.DampedSpring`` whose force is that of a :class:`~softcradle.physics.contact.Contact`, and only
    while ``overlap = touching_distance - distance > 0``. The force is evaluated once a step, after the bodies have moved, as
    in symplectic Euler: use many substeps, for contacts are short. It acts along the line between the anchors, so the
    overlap must stay smaller than `touching_distance`.

    It replaces the collision between the two bodies' shapes: `collide_bodies` is False unless set to True.

    A Contact with loss pushes with a part of its force while the bodies move apart. Its force depends on their velocities,
    so it is always a Python callback.

    Copy and pickle include it, but not a `force_func` of your own.

    Parameters
    ----------
    a, b : pymunk.Body
    anchor_a, anchor_b : (float, float)
        Anchor points, relative to the bodies [m].
    touching_distance : float
        Distance > 0 of the anchors at which the contact just touches [m]; for two balls with anchors in their
        centres the sum of their radii.
    contact : Contact or law
        A Contact, or any object whose ``force(overlap)`` returns a force [N] for an overlap > 0 [m].
    native : bool, optional
        True: the force is compiled code, several times faster; False: a Python callback, same digits; None:
        compiled where it can be had.

    Raises
    ------
    ValueError
        The distance is not a finite number > 0, or `contact` has no force.
    RuntimeError
        `native` is True and compiled code cannot be had; the message says why.

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

    def __init__(
        self,
        a: pymunk.Body,
        b: pymunk.Body,
        anchor_a: Pair,
        anchor_b: Pair,
        touching_distance: float,
        contact: Law,
        native: bool | None = None,
    ) -> None:
        require_kind("a", a, pymunk.Body)
        require_kind("b", b, pymunk.Body)
        if a is b:
            raise ValueError("a SoftContact needs two different bodies: a and b are the same")
        distance = _checked_distance(touching_distance)
        super().__init__(a, b, anchor_a, anchor_b, distance, 0.0, 0.0)
        self.collide_bodies = False
        self._native = native
        self._touching_distance = distance
        self._known_overlap = math.nan
        self._compiled_law: Any = None
        self.force_func = SoftContact.contact_force  # type: ignore[assignment]  # its first argument is narrower
        self.contact = contact

    @staticmethod
    def contact_force(spring: SoftContact, dist: float) -> float:
        """Default force function: the contact's force at this distance of the anchors, 0 when they are apart.

        An exception in it is raised by :py:meth:`pymunk.Space.step` at the end of the step; pymunk by itself prints it
        and goes on with a wrong force.
        """
        overlap = spring._known_overlap
        if math.isnan(overlap):
            overlap = spring._touching_distance - dist
        if overlap <= 0.0:
            return 0.0
        try:
            force = spring._law(overlap)
            if not math.isfinite(force):
                raise ValueError(f"a law must give a finite force, not {force!r} at an overlap of {overlap:.6g} m")
            _require_in_space(spring)
            return force if spring._loss == 0.0 or spring.rate >= 0.0 else (1.0 - spring._loss) * force
        except BaseException as error:  # KeyboardInterrupt too, which pymunk would only print
            raise_after_step(spring, error)
            return 0.0

    @property
    def contact(self) -> Law:
        """The law of the contact; set it, and the new one counts from the next step on."""
        return self._contact

    @contact.setter
    def contact(self, contact: Law) -> None:
        law, native = _scalar_law(contact), self._wants_native(contact)
        self._law, self._contact = law, contact
        self._loss = contact.loss if isinstance(contact, Contact) else 0.0
        self._use(native)
        self.activate_bodies()

    @property
    def touching_distance(self) -> float:
        """Distance of the anchors at which the contact just touches [m], > 0."""
        return self._touching_distance

    @touching_distance.setter
    def touching_distance(self, distance: float) -> None:
        self._touching_distance = _checked_distance(distance)
        pymunk.DampedSpring.rest_length.fset(self, self._touching_distance)  # type: ignore[attr-defined]
        self._write_law()

    rest_length = touching_distance

    @property
    def overlap(self) -> float:
        """Overlap of the bodies now [m]; negative: their distance."""
        ends = self.a.local_to_world(self.anchor_a), self.b.local_to_world(self.anchor_b)
        return self._touching_distance - (ends[1] - ends[0]).length

    @property
    def rate(self) -> float:
        """Rate of the overlap now [m/s]; negative while the bodies move apart."""
        ends = self.a.local_to_world(self.anchor_a), self.b.local_to_world(self.anchor_b)
        line = ends[1] - ends[0]
        closing = self.a.velocity_at_world_point(ends[0]) - self.b.velocity_at_world_point(ends[1])
        return line.dot(closing) / line.length if line.length > 0.0 else 0.0

    @property
    def native(self) -> bool:
        """True where the force is compiled code, False where it is a Python callback."""
        return self._compiled_law is not None and self.force_func is SoftContact.contact_force

    @property
    def stiffness(self) -> float:
        """Always 0: the force is the contact's."""
        return 0.0

    @stiffness.setter
    def stiffness(self, stiffness: float) -> None:
        raise AttributeError("a SoftContact has no stiffness of its own: set its contact")

    @property
    def damping(self) -> float:
        """Always 0: a damper would pull bodies that are apart."""
        return 0.0

    @damping.setter
    def damping(self, damping: float) -> None:
        raise AttributeError("a SoftContact has no damping: a damper would pull bodies that are apart")

    def _take_overlap(self, overlap: float) -> None:
        """Use this overlap [m] from now on: the caller knows it to more digits than the positions have."""
        self._known_overlap = overlap
        if self._compiled_law is not None:
            self._compiled_law[4] = overlap

    def _wants_native(self, contact: Law) -> bool:
        """Whether `contact` is to be compiled code; RuntimeError where it must be and cannot."""
        if self._native is False:
            return False
        reason = compiled.unavailable() if isinstance(contact, Contact) else f"{contact!r} is not a Contact"
        if isinstance(contact, Contact) and contact.loss:
            reason = "the force of a contact with loss depends on velocities"
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
            law[3], law[4] = self._touching_distance, self._known_overlap


def _require_in_space(spring: SoftContact) -> None:
    """RuntimeError where a body that moves has been removed from the Space and its contact has not."""
    for body in (spring.a, spring.b):
        if body.space is None and body.body_type == pymunk.Body.DYNAMIC:
            raise RuntimeError("a body of a SoftContact is not in the Space: remove its contacts with it")


def _checked_distance(distance: float) -> float:
    return magnitude("touching_distance", distance)


def _scalar_law(contact: Law) -> Callable[[float], float]:
    """Force as a plain function of an overlap > 0, digit for digit that of softcradle.physics.numerics.law_kernels."""
    if not callable(getattr(contact, "force", None)):
        raise ValueError(f"contact must be a Contact or have a method force(overlap), not {shown(contact)}")
    if isinstance(contact, Coupler):
        raise ValueError(
            "a SoftContact only pushes, a coupler pulls and goes solid: take simulate(..., method='conserving')"
        )
    if not isinstance(contact, Contact):
        return lambda overlap: float(contact.force(overlap))
    preload, stiffness, exponent = contact.preload, contact.stiffness, contact.exponent
    if stiffness == 0.0:
        return lambda overlap: preload
    if exponent == 1.0:
        return lambda overlap: preload + stiffness * overlap
    if exponent == 1.5:
        return lambda overlap: preload + stiffness * (overlap * math.sqrt(overlap))
    return lambda overlap: preload + stiffness * overlap**exponent
