"""Random play: a fuzz of sessions by seeded random inputs, faster than the clock.

Any exception, any number that is not finite and unbounded memory is a bug.

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
from softcradle.physics.contact import Contact, draft_gear, hertz, power_law
from softcradle.sandbox.session import inputs
from softcradle.sandbox.session.contact_conversion import KINDS
from softcradle.sandbox.session.session import Session

from softcradle import scenes

METHODS = ("auto", "conserving", "conserving", "verlet", "euler", "yoshida4")
PICTURE = 1.0 / 60.0  # wall seconds from one picture to the next
MOST_BEADS = 30  # with more, beads are only removed: an hour is to be many edits, not one long chain


class RandomPlayer:
    """Random inputs to a session; the same seed gives the same inputs."""

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
            self.stop_beads,
        )

    def act(self) -> None:
        """Do one thing; a refusal with a sentence is no error."""
        self.given += 1
        try:
            self.random.choice(self.actions)()
        except ValueError as refusal:
            self.refused += 1
            if not str(refusal):
                raise

    def edit(self) -> None:
        """Apply a random input."""
        self.session.apply(self.random_input())

    def drag(self) -> None:
        """Drag a bead."""
        lane, bead = self.random_bead()
        self.session.drag(lane, bead, self.random.gauss(0.0, 3.0))

    def drop(self) -> None:
        """Release the bead that is held."""
        self.session.drop()

    def scrub(self) -> None:
        """Show a frame of the history, now and then the first or the last."""
        first, last = self.session.span
        self.session.scrub(self.random.choice((first, last, self.random.uniform(first, last))))

    def step_frames(self) -> None:
        """Step some frames forward or back."""
        self.session.step_frames(self.random.randint(-20, 20))

    def slow(self) -> None:
        """Change the slow motion."""
        self.session.apply(inputs.SetSlow(10.0 ** self.random.uniform(0.0, 3.0)))

    def restart(self) -> None:
        """Restart, one time in five."""
        if self.random.random() < 0.2:
            self.session.restart()

    def stop_beads(self) -> None:
        """Stop all beads, so that speeds do not grow for ever."""
        for lane in range(len(self.session.lanes)):
            self.session.apply(inputs.SetVelocity(lane, None, 0.0))

    def random_bead(self) -> tuple[int, int]:
        """A lane and a bead, seldom one that does not exist."""
        lane = self.random.randrange(len(self.session.lanes))
        return lane, self.random.randrange(len(self.session.lanes[lane].chain.mass) + (self.random.random() < 0.02))

    def random_contact(self) -> Contact:
        """A power law or a draft gear."""
        size = 10.0 ** self.random.uniform(-2.0, 3.0)
        exponent = self.random.choice((1.0 / 30.0, 1.0 / 14.0, 0.1, 0.5, 1.0, 1.5, self.random.uniform(0.02, 3.0)))
        gear = draft_gear(size, 10.0 ** self.random.uniform(-3.0, 0.0))
        return self.random.choice((power_law(size, exponent), gear))

    def random_input(self) -> inputs.Input:
        """An edit of any kind."""
        lane, bead = self.random_bead()
        chain, rng = self.session.lanes[lane].chain, self.random
        contact = min(bead, chain.contacts - 1)
        one_or_all = rng.choice((contact, contact, None))
        mass = rng.choice((10.0 ** rng.uniform(-2.0, 2.0), 1.0, 1.0, math.inf))
        law = chain.contact[contact]
        law = replace(law if isinstance(law, Contact) else hertz(1.0), stiffness=10.0 ** rng.uniform(-1.0, 2.0))
        crowded = len(chain.mass) >= MOST_BEADS
        return rng.choice(
            (
                inputs.SetMass(lane, rng.choice((bead, None)), mass),
                inputs.SetVelocity(lane, bead, rng.gauss(0.0, 1.0)),
                inputs.SetContact(lane, one_or_all, self.random_contact()),
                inputs.SetContact(lane, contact, law),
                inputs.SetKind(lane, one_or_all, rng.choice(KINDS)),
                inputs.Lock(lane, one_or_all, rng.random() < 0.5),
                inputs.SetGap(lane, contact, rng.choice((0.0, rng.uniform(0.0, 1.0)))),
                inputs.SetDrive(lane, bead, rng.choice((0.0, 0.0, rng.gauss(0.0, 1.0)))),
                inputs.SetFriction(lane, rng.choice((0.0, 0.0, rng.random()))),
                inputs.RemoveBead(lane, bead) if crowded else inputs.AddBead(lane, bead, mass, rng.random()),
                inputs.RemoveBead(lane, bead),
                inputs.SetMethod(rng.choice((lane, None)), rng.choice(METHODS)),
                inputs.SetStep(lane, rng.choice((None, 10.0 ** rng.uniform(-4.0, -1.0)))),
            )
        )


def check_invariants(session: Session) -> None:
    """What holds whatever was done: finite numbers, bounded memory, a frame of the history. AssertionError where not."""
    for number, lane in enumerate(session.lanes):
        for name in ("overlap", "rate", "anchor", "force"):
            values = getattr(lane.state, name)
            assert np.isfinite(values).all(), f"lane {number}: {name} is {values}"
        assert np.isfinite(lane.ledger).all(), f"lane {number}: ledger is {lane.ledger}"
        assert len(lane.chain.mass) == len(lane.state.overlap) + 1
    assert session.history.memory <= session.history.bound + 2 * session.history.blocks[-1].memory
    assert session.history.first <= session.frame <= session.history.last


def read_all(session: Session) -> None:
    """Read everything that a window shows. AssertionError where it is not finite or not in order."""
    for lane in range(len(session.lanes)):
        for part in session.history_slices(lane, 240):
            assert np.isfinite(part.velocity).all()
            assert np.isfinite(part.kinetic).all()
        session.health(lane)
    assert session.verdict()[1]
    assert all(impact.speed > 0.0 for impact in session.impacts)
    assert (np.diff(session.contact_events().time) >= 0.0).all()


def play_at_random(
    session: Session, wall_seconds: float, seed: int, check: Callable[[Session], None] = check_invariants
) -> RandomPlayer:
    """Play with `session` for `wall_seconds` of its own clock: about three inputs a second, a tick a picture."""
    player = RandomPlayer(session, seed)
    for picture in range(round(wall_seconds / PICTURE)):
        if player.random.random() < 3.0 * PICTURE:
            player.act()
        player.frames += session.tick(PICTURE)
        check(session)
        if picture % 30 == 0:
            read_all(session)
    return player


def main(arguments: list[str] | None = None) -> int:
    """Play with every scene of the catalogue in turn; print a line for each."""
    parser = argparse.ArgumentParser(prog="python -m softcradle.sandbox.session.random_play", description=__doc__)
    parser.add_argument("--hours", type=float, default=1.0, help="of play, by the session's clock")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args(arguments)
    names = scenes.names()
    seconds = 3600.0 * options.hours / len(names)
    for number, name in enumerate(names):
        began = perf_counter()
        session = Session(scenes.load(name), budget=math.inf)  # no frame depends on the computer's speed
        player = play_at_random(session, seconds, options.seed + number)
        print(
            f"{name}: {seconds:.0f} s of play in {perf_counter() - began:.0f} s, {player.frames} frames"
            f", {player.given} inputs ({player.refused} refused), {session.history.memory / 2**20:.1f} MB of history"
            f", {_resident():.0f} MB in all",
            flush=True,
        )
    return 0


def _resident() -> float:
    """Megabytes of memory of this process; 0 where the system does not tell."""
    try:
        with open("/proc/self/statm", encoding="ascii") as file:
            return int(file.read().split()[1]) * 4096 / 2**20
    except OSError:
        return 0.0


if __name__ == "__main__":
    sys.exit(main())
