"""Hands on the beads: selecting, dragging, throwing, placing, and the edits that have keys."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING

import pygame
from softcradle.sandbox.session.contact_conversion import kind_of
from softcradle.sandbox.session.inputs import AddBead, Input, Lock, RemoveBead, SetKind
from softcradle.sandbox.window.scene.lane_view import Pick

if TYPE_CHECKING:
    from softcradle.sandbox.window.scene.scene_page import Play

STILL = 4.0  # design pixels that a click may tremble
WHEEL = 1.0 / 8.0  # decades of slow motion a notch


class Hands:
    """What mouse and keys do to the beads of a page."""

    def __init__(self, page: Play) -> None:
        self.page = page
        self.held: Pick | None = None
        self.pulling = False
        self._pressed, self._pointer, self._grip = (0, 0), (0, 0), 0.0
        self.actions: dict[str, Callable[[], None]] = {
            "select_left": lambda: self.neighbour(-1),
            "select_right": lambda: self.neighbour(1),
            "add_bead": self.add_bead,
            "remove_bead": self.remove_bead,
            "lock": self.lock,
            "law": self.turn,
            "law_all": self.turn_all,
        }

    # ---- mouse

    def handle(self, event: pygame.Event) -> bool:
        """Press, move, release, wheel."""
        if event.type == pygame.MOUSEBUTTONDOWN and event.button == 1:
            return self._press(event.pos)
        if event.type == pygame.MOUSEMOTION and self.held is not None:
            self._move(event.pos)
            return True
        if event.type == pygame.MOUSEBUTTONUP and event.button == 1 and self.held is not None:
            self.release()
            return True
        return event.type == pygame.MOUSEWHEEL and self._wheel(event)

    def at(self, point: tuple[int, int]) -> Pick | None:
        """What is under `point`."""
        return next((pick for view in self.page.scenery.views if (pick := view.pick(point)) is not None), None)

    def _press(self, point: tuple[int, int]) -> bool:
        pick = self.at(point)
        if pick is None:
            if any(view.stage.rect.collidepoint(point) for view in self.page.scenery.views):
                self.page.select(None)
                return True
            return False
        self.page.select(pick)
        if pick.kind == "bead":
            self.held, self.pulling = pick, False
            self._pressed = self._pointer = point
            self._grip = float(self.page.scenery.views[pick.lane].edges[pick.index]) - point[0]
        return True

    def _move(self, point: tuple[int, int]) -> None:
        self._pointer = point
        if math.dist(point, self._pressed) > STILL * self.page.host.unit:
            self.pulling = True

    def release(self) -> None:
        """Let go: a running bead keeps its velocity."""
        self.held, self.pulling = None, False
        self.page.session.drop()

    def hold(self) -> None:
        """Once a frame: hand the pointer's place to the model."""
        if self.held is None or not self.pulling or self.page.waiting:
            return
        pick, session = self.held, self.page.session
        view = self.page.scenery.views[pick.lane]
        if pick.index >= len(view.edges):
            self.release()
            return
        offset = self._pointer[0] + self._grip - float(view.edges[pick.index])
        wanted = float(session.lanes[pick.lane].position[pick.index]) + view.metres(offset)
        try:
            session.drag(pick.lane, pick.index, wanted)
        except ValueError as error:
            self.page.host.messages.say(str(error), trouble=True)
            self.release()

    def _wheel(self, event: pygame.Event) -> bool:
        point = pygame.mouse.get_pos()
        if pygame.key.get_mods() & pygame.KMOD_CTRL:
            self.page.actions["zoom_in" if event.y > 0 else "zoom_out"]()
            return True
        if self.page.places.side.collidepoint(point):
            return False
        slow = self.page.transport.slow * 10.0 ** (-event.y * WHEEL)
        self.page.transport.set_slow(float(f"{slow:.2g}"))
        return True

    def paint(self, surface: pygame.Surface) -> None:
        """The hand that holds a bead."""
        if self.held is not None and self.held.index < len(self.page.scenery.views[self.held.lane].edges):
            spring = self.pulling and self.page.session.playing
            self.page.scenery.views[self.held.lane].paint_hold(surface, self.held.index, self._pointer, spring)

    # ---- keys

    def _bead(self) -> Pick:
        """The selected bead; the last of the first lane where none is."""
        pick = self.page.pick
        if pick is None or pick.kind != "bead":
            lane = 0 if pick is None else pick.lane
            return Pick(lane, "bead", self.page.session.lanes[lane].chain.contacts if pick is None else pick.index)
        return pick

    def neighbour(self, by: int) -> None:
        """Select what stands beside: beads and contacts in turn."""
        pick = self.page.pick
        if pick is None:
            self.page.select(Pick(0, "bead", 0))
            return
        beads = self.page.session.lanes[pick.lane].chain.contacts + 1
        place = 2 * pick.index + (1 if pick.kind == "contact" else 0) + by
        place = min(max(place, 0), 2 * beads - 2)
        self.page.select(Pick(pick.lane, "contact" if place % 2 else "bead", place // 2))

    def add_bead(self) -> None:
        """A bead like the selected one, to its right."""
        pick = self._bead()
        lane = self.page.session.lanes[pick.lane]
        mass = lane.chain.mass[pick.index]
        usual = mass if math.isfinite(mass) else min(lane.chain.mass)
        if self.page.apply(AddBead(pick.lane, pick.index + 1, usual)):
            self.page.select(Pick(pick.lane, "bead", pick.index + 1))

    def remove_bead(self) -> None:
        """Take the selected bead out."""
        pick = self.page.pick
        if pick is None or pick.kind != "bead":
            self.page.host.messages.say("select the bead to remove")
            return
        self.page.apply(RemoveBead(pick.lane, pick.index))

    def _contact(self) -> Pick | None:
        pick = self.page.pick
        if pick is None or pick.kind != "contact":
            self.page.host.messages.say("select a contact: click between two beads, on its bar or its loupe")
            return None
        return pick

    def lock(self) -> None:
        """Lock or unlock the selected contact's piston; with a bead or nothing selected, all of them."""
        pick, session = self.page.pick, self.page.session
        if pick is not None and pick.kind == "contact":
            locked = session.lanes[pick.lane].setup.locked[pick.index] is not None
            self.page.apply(Lock(pick.lane, pick.index, not locked))
        else:
            locked = all(law is not None for lane in session.lanes for law in lane.setup.locked)
            if self._to_all_lanes(lambda lane: Lock(lane, None, not locked)):
                said = "all pistons unlocked" if locked else "all pistons locked: the usual cradle"
                self.page.host.messages.say(said)

    def _to_all_lanes(self, edit: Callable[[int], Input]) -> bool:
        """Give every lane its edit; whether all were taken."""
        taken = [self.page.apply(edit(lane)) for lane in range(len(self.page.session.lanes))]
        return all(taken)

    def turn(self) -> None:
        """Power law or draft gear in the selected contact."""
        pick = self._contact()
        if pick is not None:
            law = self.page.session.lanes[pick.lane].chain.contact[pick.index]
            self.page.apply(SetKind(pick.lane, pick.index, "power" if kind_of(law) == "gear" else "gear"))

    def turn_all(self) -> None:
        """Power law or draft gear in all contacts."""
        session = self.page.session
        gears = all(kind_of(law) == "gear" for lane in session.lanes for law in lane.chain.contact)
        kind = "power" if gears else "gear"
        if self._to_all_lanes(lambda lane: SetKind(lane, None, kind)):
            name = {"power": "power laws", "gear": "draft gears"}[kind]
            self.page.host.messages.say(f"all contacts are {name} now")
