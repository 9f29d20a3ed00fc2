"""Fuzz: a session under random inputs, seeded, faster than the clock. Any exception, NaN or unbounded memory is a bug.

python -m softcradle.sandbox.session.random_play --hours 1 --seed 1
"""

from __future__ import annotations

import argparse
import math
import random
import sys
from collections.abc import Callable
from dataclasses import replace
from time import perf_counter

import numpy as np
from softcradle.physics.contact import Contact, draft_gear, power_law
from softcradle.sandbox.session import inputs
from softcradle.sandbox.session.contact_conversion import KINDS
from softcradle.sandbox.session.session import Session

from softcradle import scenes

METHODS = ("auto", "conserving", "conserving", "verlet", "euler", "yoshida4")
FRAME = 1.0 / 60.0  # wall seconds from one picture to the next
MOST_BEADS = 30  # so that an hour is many sessions' worth of edits, not one long row


class Monkey:
    """Random hands on a session; the same seed does the same things."""

    def __init__(self, session: Session, seed: int) -> None:
        self.session, self.random = session, random.Random(seed)
        self.given = self.refused = self.frames = 0
        self.actions: tuple[Callable[[], None], ...] = (
            *(self.edit,) * 10,
            *(self.drag,) * 12,
            *(self.drop,) * 3,
            *(session.play,) * 10,
            *(session.pause,) * 2,
            *(self.scrub,) * 3,
            *(self.step_frames,) * 2,
            *(self.slow,) * 2,
            self.restart,
            self.calm,
        )

    def act(self) -> None:
        """Do one thing; a refusal is a sentence, not an error."""
        self.given += 1
        try:
            self.random.choice(self.actions)()
        except ValueError as refusal:
            self.refused += 1
            if not str(refusal):
                raise

    def edit(self) -> None:
        """Change something."""
        self.session.apply(self.random_input())

    def drag(self) -> None:
        """Pull a bead about."""
        lane, bead = self.place()
        self.session.drag(lane, bead, self.random.gauss(0.0, 3.0))

    def drop(self) -> None:
        """Let go."""
        self.session.drop()

    def scrub(self) -> None:
        """Go to some moment, now and then to an end."""
        first, last = self.session.span
        self.session.scrub(self.random.choice((first, last, self.random.uniform(first, last))))

    def step_frames(self) -> None:
        """Some frames to and fro."""
        self.session.step_frames(self.random.randint(-20, 20))

    def slow(self) -> None:
        """Another slow motion."""
        self.session.apply(inputs.SetSlow(10.0 ** self.random.uniform(0.0, 3.0)))

    def restart(self) -> None:
        """From the start, now and then."""
        if self.random.random() < 0.2:
            self.session.restart()

    def calm(self) -> None:
        """Bring everything to a sane speed."""
        for lane in range(len(self.session.lanes)):
            self.session.apply(inputs.SetVelocity(lane, None, 0.0))

    def place(self) -> tuple[int, int]:
        """A lane and a bead, seldom one that is not there."""
        lane = self.random.randrange(len(self.session.lanes))
        return lane, self.random.randrange(len(self.session.lanes[lane].chain.mass) + (self.random.random() < 0.02))

    def contact(self) -> Contact:
        """Any contact."""
        size = 10.0 ** self.random.uniform(-2.0, 3.0)
        exponent = self.random.choice((1.0 / 30.0, 1.0 / 14.0, 0.1, 0.5, 1.0, 1.5, self.random.uniform(0.02, 3.0)))
        gear = draft_gear(size, 10.0 ** self.random.uniform(-3.0, 0.0))
        return self.random.choice((power_law(size, exponent), gear))

    def random_input(self) -> inputs.Input:
        """Any edit."""
        lane, bead = self.place()
        chain, chance = self.session.lanes[lane].chain, self.random
        contact = min(bead, chain.contacts - 1)
        some = chance.choice((contact, contact, None))
        mass = chance.choice((10.0 ** chance.uniform(-2.0, 2.0), 1.0, 1.0, math.inf))
        law = replace(chain.contact[contact], stiffness=10.0 ** chance.uniform(-1.0, 2.0))
        crowded = len(chain.mass) >= MOST_BEADS
        return chance.choice(
            (
                inputs.SetMass(lane, chance.choice((bead, None)), mass),
                inputs.SetVelocity(lane, bead, chance.gauss(0.0, 1.0)),
                inputs.SetContact(lane, some, self.contact()),
                inputs.SetContact(lane, contact, law),
                inputs.SetKind(lane, some, chance.choice(KINDS)),
                inputs.Lock(lane, some, chance.random() < 0.5),
                inputs.SetGap(lane, contact, chance.choice((0.0, chance.uniform(0.0, 1.0)))),
                inputs.SetDrive(lane, bead, chance.choice((0.0, 0.0, chance.gauss(0.0, 1.0)))),
                inputs.SetFriction(lane, chance.choice((0.0, 0.0, chance.random()))),
                inputs.RemoveBead(lane, bead) if crowded else inputs.AddBead(lane, bead, mass, chance.random()),
                inputs.RemoveBead(lane, bead),
                inputs.SetMethod(chance.choice((lane, None)), chance.choice(METHODS)),
                inputs.SetStep(lane, chance.choice((None, 10.0 ** chance.uniform(-4.0, -1.0)))),
            )
        )


def check(session: Session) -> None:
    """What must hold whatever was done. AssertionError with the place where it does not."""
    for number, lane in enumerate(session.lanes):
        for name in ("overlap", "rate", "anchor", "force"):
            values = getattr(lane.state, name)
            assert np.isfinite(values).all(), f"lane {number}: {name} is {values}"
        assert np.isfinite(lane.books).all(), f"lane {number}: ledger is {lane.books}"
        assert len(lane.chain.mass) == len(lane.state.overlap) + 1
    assert session.history.memory <= session.history.bound + 2 * session.history.blocks[-1].memory
    assert session.history.first <= session.frame <= session.history.last


def look(session: Session) -> None:
    """Ask for everything that a window shows."""
    for lane in range(len(session.lanes)):
        series = session.series(lane, 240)
        assert np.isfinite(series.velocity).all()
        assert np.isfinite(series.kinetic).all()
        session.health(lane)
    assert session.verdict()[1]
    assert all(impact.speed > 0.0 for impact in session.impacts)
    assert (np.diff(session.marks().time) >= 0.0).all()


def fuzz(session: Session, wall_seconds: float, seed: int, checks: Callable[[Session], None] = check) -> Monkey:
    """Play with `session` for that long by its own clock: three things done a second, a tick a picture."""
    monkey = Monkey(session, seed)
    for picture in range(round(wall_seconds / FRAME)):
        if monkey.random.random() < 3.0 * FRAME:
            monkey.act()
        monkey.frames += session.tick(FRAME)
        checks(session)
        if picture % 30 == 0:
            look(session)
    return monkey


def main(arguments: list[str] | None = None) -> int:
    """Fuzz one session after the other, every scene of the catalogue in turn; print a line for each."""
    parser = argparse.ArgumentParser(prog="python -m softcradle.sandbox.session.random_play", description=__doc__)
    parser.add_argument("--hours", type=float, default=1.0, help="of play, by the session's clock")
    parser.add_argument("--seed", type=int, default=1)
    wish = parser.parse_args(arguments)
    names = scenes.names()
    each = 3600.0 * wish.hours / len(names)
    for number, name in enumerate(names):
        began = perf_counter()
        session = Session(scenes.load(name), budget=math.inf)  # no frame depends on the computer's speed
        monkey = fuzz(session, each, wish.seed + number)
        print(
            f"{name}: {each:.0f} s of play in {perf_counter() - began:.0f} s, {monkey.frames} frames"
            f", {monkey.given} inputs ({monkey.refused} refused), {session.history.memory / 2**20:.1f} MB of history"
            f", {_resident():.0f} MB in all",
            flush=True,
        )
    return 0


def _resident() -> float:
    """Megabytes this process holds; 0 where the system does not say."""
    try:
        with open("/proc/self/statm", encoding="ascii") as file:
            return int(file.read().split()[1]) * 4096 / 2**20
    except OSError:
        return 0.0


if __name__ == "__main__":
    sys.exit(main())
