"""Sharing: values as CSV and the scene as text on the clipboard, and the scene beside a copy of itself."""

from __future__ import annotations

from collections.abc import Callable

import pygame
from softcradle.sandbox.languages import N_, _
from softcradle.sandbox.session.contact_conversion import has_soft_contacts, steel_ball
from softcradle.sandbox.session.inputs import SetContact, SetKind
from softcradle.sandbox.session.session import Session
from softcradle.sandbox.session.shared_text import shared_text
from softcradle.sandbox.session.summary_text import summary_text
from softcradle.sandbox.session.values_table import values_csv
from softcradle.sandbox.window.window_page import Host
from softcradle.scenes import Scene

STEEL = N_("steel balls")
OTHER, COMPARED = ", the other", ", compared"  # as in sandbox/languages/translation.py


class Sharing:
    """What goes from a session to the clipboard."""

    def __init__(self, host: Host, session: Session) -> None:
        self.host, self.session = host, session

    def copy_values(self) -> None:
        """Put all values at the frame shown on the clipboard as CSV."""
        self._copy(lambda: values_csv(self.session), _("the values are on the clipboard, as CSV"))

    def tell(self) -> None:
        """Show what has happened in words; it can be copied, to be read aloud."""
        text = summary_text(self.session)
        self.host.choose(
            _("What happened"),
            text,
            {_("Close"): lambda: None, _("Copy"): lambda: self._copy(lambda: text, _("copied"))},
        )

    def copy_scene(self) -> None:
        """Put the scene with all edits on the clipboard as text."""
        done = _("the scene is on the clipboard, as text: paste it into a message, or into a window with Ctrl+V")
        self._copy(lambda: shared_text(self.session.to_scene()), done)

    def _copy(self, text: Callable[[], str], done: str) -> None:
        try:
            pygame.scrap.put_text(text())
        except (ValueError, pygame.error) as error:
            self.host.messages.show(_("nothing was copied: {error}", error=error), warning=True)
        else:
            self.host.messages.show(done)


def beside_other_balls(session: Session) -> Scene:
    """The first lane of a session beside the same blow among steel balls, or among soft beads where they are of steel.

    ValueError where contacts are couplers or laws of one's own, or no scene file can say it.
    """
    scene = beside_itself(session.to_scene())
    chain, speed = session.lanes[0].chain, session.lanes[0].setup.speed
    steel, other = has_soft_contacts(chain), Session(scene)
    if steel:
        for i in range(chain.contacts):
            law = steel_ball(chain, i, speed, scene.view.length)
            other.apply(SetContact(1, i, law))
    else:
        other.apply(SetKind(1, None, "power"))
    found = other.to_scene()
    first, second = found.lanes
    second = second.model_copy(update={"label": STEEL if steel else second.label})
    text = f"The same blow twice: above {first.label or 'the row as it was'}, below {second.label}."
    return found.model_copy(update={"lanes": (first, second), "text": text})


def beside_itself(scene: Scene) -> Scene:
    """The first lane of a scene beside a copy of it, to be edited and compared."""
    lane = scene.lanes[0].model_dump()
    lanes = [lane, {**lane, "label": f"{lane['label']}{OTHER}".removeprefix(", ")}]
    title = scene.title.removesuffix(COMPARED) + COMPARED  # once, though it is compared again
    return Scene.model_validate({**scene.model_dump(), "title": title, "lanes": lanes})
