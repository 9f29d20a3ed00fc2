"""The scene editor. It holds the selected bead or contact, passes inputs to the session, and offers the edits that have
keys.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

from softcradle.sandbox.languages import N_, _, scene_words
from softcradle.sandbox.session.contact_conversion import kind_of
from softcradle.sandbox.session.inputs import AddBead, Input, LaneInput, Lock, RemoveBead, SetKind, SetMethod
from softcradle.sandbox.session.session import Session
from softcradle.sandbox.story.bodies import BODIES, body_word, capital
from softcradle.sandbox.story.numbers import subscript
from softcradle.sandbox.window.page import Host


@dataclass(frozen=True)
class Pick:
    """A selected bead or contact: the number of its lane, its kind ("bead" or "contact"), and its index."""

    lane: int
    kind: str
    index: int


def pick_title(session: Session, pick: Pick) -> str:
    """Return the title of a bead or contact with its number. If there are two lanes, the title includes the label of
    the lane.
    """
    if pick.kind == "bead":
        wall = math.isinf(session.lanes[pick.lane].chain.mass[pick.index])
        body = capital(BODIES[body_word(session.lanes[pick.lane].chain)].words()["one"])
        title = _("Wall {number}", number=pick.index) if wall else f"{body} {pick.index}"
    else:
        title = _("Contact {number}", number=subscript(pick.index, pick.index + 1))
    label = scene_words(session.label(pick.lane))
    return f"{title} · {label}" if len(session.lanes) > 1 and label else title


AUTO = "auto"  # Entry of the method menu that lets the program choose the method.
PREPARING = N_("preparing the physics: takes a few seconds, only once")
ALL_NOW = {"power": N_("all contacts are power laws now"), "gear": N_("all contacts are draft gears now")}


class SceneEditor:
    """Edits of one session.

    Attributes:
        selection: the selected bead or contact, or None.
        refused: number of rejected choices of a method. When it changes, the method menu is rebuilt, because it still
            shows
            the rejected method.
        preparing: True while kernels are being loaded. The session can then neither move nor be edited.
        actions: edits that have keys.
    """

    def __init__(self, host: Host, session: Session) -> None:
        self.host, self.session = host, session
        self._selection: Pick | None = None
        self.refused, self.preparing = 0, False
        self.check_kernels()
        self.actions: dict[str, Callable[[], None]] = {
            "select_left": partial(self.select_neighbour, -1),
            "select_right": partial(self.select_neighbour, 1),
            "add_bead": self.add_bead,
            "remove_bead": self.remove_bead,
            "undo": partial(self._go, self.session.undo, N_("undid: {edit}"), N_("nothing to undo")),
            "redo": partial(self._go, self.session.redo, N_("did again: {edit}"), N_("nothing to redo")),
            "lock": self.lock,
            "lock_all": self.lock_all,
            "law": self.convert,
            "law_all": self.convert_all,
        }

    @property
    def selection(self) -> Pick | None:
        """The selected bead or contact. If it was removed, the last bead or contact of the lane is selected instead."""
        pick = self._selection
        if pick is None:
            return None
        last = self.session.lanes[pick.lane].chain.contacts - (0 if pick.kind == "bead" else 1)
        return pick if pick.index <= last else Pick(pick.lane, pick.kind, last)

    @selection.setter
    def selection(self, pick: Pick | None) -> None:
        self._selection = pick

    def check_kernels(self) -> None:
        """Update `preparing`. It is False if the methods of the session can compute all lanes in real time."""
        session = self.session
        self.preparing = not self.host.warmup.can_move(session.lanes, session.setup.frame_time)

    def apply(self, item: Input, gesture: bool = False) -> bool:
        """Apply an input to the session. Return True if it was accepted; otherwise show the reason as a message.

        Inputs of one `gesture` form one undo step.
        """
        return self.apply_all([item], gesture)

    def apply_all(self, items: Sequence[Input], gesture: bool = False, anew: bool = False, trial: bool = False) -> bool:
        """Apply all inputs as one undo step, or none of them. Return True if they were accepted.

        If `anew`, restart before the inputs. For `trial` see :meth:`Session.apply_all`.
        """
        if self.preparing:
            self.host.messages.hint(_(PREPARING))
            return False
        for item in items:
            if isinstance(item, SetMethod) and not self._method_is_loaded(item.method):
                text = _("method {method} is still being prepared: try again in a few seconds", method=item.method)
                self.host.messages.hint(text)
                return False
        try:
            self.session.apply_all(items, gesture, anew, trial)
        except ValueError as error:
            self.host.messages.show(str(error), warning=True)
            return False
        return True

    def _method_is_loaded(self, name: str) -> bool:
        frame_time = self.session.setup.frame_time
        return name == AUTO or self.host.warmup.can_move(self.session.lanes, frame_time, name)

    def _apply_to_lanes(self, edit: Callable[[int], LaneInput]) -> bool:
        """Apply an edit to every lane. Return True if it was accepted."""
        return self.apply_all([edit(lane) for lane in range(len(self.session.lanes))])

    def _go(self, step: Callable[[], str], done: str, nothing: str) -> None:
        """Undo or redo, and show a message about it."""
        name = step()
        if name:
            self.host.messages.show(_(done, edit=_(name)))
        else:
            self.host.messages.hint(_(nothing))

    # ---- edits that have keys

    def select_neighbour(self, by: int) -> None:
        """Select the next (1) or previous (-1) bead or contact. Beads and contacts alternate in this order."""
        pick = self.selection
        if pick is None:
            self.selection = Pick(0, "bead", 0)
            return
        beads = self.session.lanes[pick.lane].chain.contacts + 1
        place = 2 * pick.index + (1 if pick.kind == "contact" else 0) + by
        place = min(max(place, 0), 2 * beads - 2)
        self.selection = Pick(pick.lane, "contact" if place % 2 else "bead", place // 2)

    def add_bead(self) -> None:
        """Add a copy of the selected bead on its right. For a selected contact, copy the bead on the left of the
        contact.
        """
        pick = self.selection
        if pick is None:
            self.host.messages.hint(_("select a bead first: the new bead is added to its right"))
            return
        masses = self.session.lanes[pick.lane].chain.mass
        mass = masses[pick.index]
        if self.apply(AddBead(pick.lane, pick.index + 1, mass if math.isfinite(mass) else min(masses))):
            self.selection = Pick(pick.lane, "bead", pick.index + 1)

    def remove_bead(self) -> None:
        """Remove the selected bead."""
        pick = self.selection
        if pick is None or pick.kind != "bead":
            self.host.messages.hint(_("select the bead to remove"))
            return
        self.apply(RemoveBead(pick.lane, pick.index))

    def lock(self) -> None:
        """Lock or unlock the piston of the selected contact."""
        pick = self._contact()
        if pick is not None:
            locked = self.session.lanes[pick.lane].setup.locked[pick.index] is not None
            self.apply(Lock(pick.lane, pick.index, not locked))

    def lock_all(self) -> None:
        """Lock the pistons of all contacts, or unlock them if all of them are locked."""
        lanes = self.session.lanes
        locked = all(law is not None for lane in lanes for law in lane.setup.locked)
        if self._apply_to_lanes(lambda lane: Lock(lane, None, not locked)):
            self.host.messages.show(
                _("all pistons unlocked") if locked else _("all pistons locked: now an ordinary Newton's cradle")
            )

    def convert(self) -> None:
        """Convert the selected contact into a power law or a draft gear."""
        pick = self._contact()
        if pick is None:
            return
        law = self.session.lanes[pick.lane].chain.contact[pick.index]
        self.apply(SetKind(pick.lane, pick.index, "power" if kind_of(law) == "gear" else "gear"))

    def _contact(self) -> Pick | None:
        """Return the selected contact. If no contact is selected, show a message and return None."""
        pick = self.selection
        if pick is not None and pick.kind == "contact":
            return pick
        text = _("select a contact: click between two beads, on its force bar or on its magnified inset")
        self.host.messages.hint(text)
        return None

    def convert_all(self) -> None:
        """Convert all contacts into power laws or draft gears."""
        gears = all(kind_of(law) == "gear" for lane in self.session.lanes for law in lane.chain.contact)
        kind = "power" if gears else "gear"
        if self._apply_to_lanes(lambda lane: SetKind(lane, None, kind)):
            self.host.messages.show(_(ALL_NOW[kind]))
