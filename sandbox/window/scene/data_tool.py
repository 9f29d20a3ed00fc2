"""The tool for data of one's own: measured numbers and pictures over the plots, and signals chosen for a plot."""

from __future__ import annotations

import os
from functools import partial
from pathlib import Path

import numpy as np
import pygame
from softcradle.sandbox.draw.number_format import scientific
from softcradle.sandbox.languages import _, localized, ngettext
from softcradle.sandbox.session.measured_data import load_measured
from softcradle.sandbox.session.session import Session
from softcradle.sandbox.user_error import UserError
from softcradle.sandbox.window.page import Host
from softcradle.sandbox.window.plots.curves import Plot
from softcradle.sandbox.window.plots.data_overlay import (
    PICTURES,
    TABLES,
    NumbersOverlay,
    PictureOverlay,
    edges_of,
    load_picture,
)
from softcradle.sandbox.window.plots.kinds import KEY, KYMOGRAPH, OWN, VELOCITIES, pair_of
from softcradle.sandbox.window.scene.save_dialogs import shown_path
from softcradle.sandbox.window.scene.view import SceneView


class DataTool:
    """Files that are laid over the plots of a page, and its plot of chosen signals."""

    def __init__(self, host: Host, session: Session, view: SceneView) -> None:
        self.host, self.session, self.view, self.board = host, session, view, view.board
        self.actions = {"data": self.ask, "signals": self.ask_signals}

    def ask(self) -> None:
        """Ask for the path of a file to lay over the plots; nothing typed removes what lies there."""
        if any(self.board.overlays.values()):
            self.board.overlays.clear()
            self.host.messages.show(_("measured data removed"))
            return
        note = _(
            "a table ({endings}: time in s, then a column a curve) or a picture of a kymograph",
            endings=", ".join(TABLES),
        )
        self.host.ask(_("Measured data over a plot"), note, "", self._take_typed)

    def _take_typed(self, text: str) -> None:
        if not self.take_file(text, (-1, -1)):
            endings = ", ".join((*TABLES, *PICTURES))
            wrong = _("{path}: needs the ending {endings}", path=text, endings=endings)
            self.host.messages.show(wrong, warning=True)

    def take_file(self, text: str, point: tuple[int, int]) -> bool:
        """Lay a file over the plot at `point`, or over the usual one; whether it is a table or a picture."""
        path = Path(os.path.expanduser(text))
        ending = path.suffix.lower()
        if ending not in (*TABLES, *PICTURES):
            return False
        try:
            if ending in TABLES:
                self._lay_numbers(path, point)
            else:
                self._ask_edges(path)
        except (UserError, ValueError) as error:  # no file can have a name with a NUL
            self.host.messages.show(str(error), warning=True)
        return True

    def _plot(self, kind: str, point: tuple[int, int] = (-1, -1)) -> tuple[tuple[str, int], Plot]:
        """The kind and lane of the plot at `point`, else of that kind, which is shown for it."""
        under = self.board.plot_at(point)
        if under is not None and under.timed:
            return self.board.keys[self.board.plots.index(under)], under
        self.view.show_plot(kind)
        where = next(k for k, key in enumerate(self.board.keys) if key[0] == kind)
        return self.board.keys[where], self.board.plots[where]

    def _lay_numbers(self, path: Path, point: tuple[int, int]) -> None:
        data = load_measured(path)
        key, plot = self._plot(VELOCITIES, point)
        curves = len(plot.content.colours)
        if len(data.columns) > curves:
            raise UserError(_too_many(path, len(data.columns), curves))
        laid = NumbersOverlay(data)
        self.board.overlays[key] = [laid]
        text = ngettext(
            "{n} time from {path} over {plot}",
            "{n} times from {path} over {plot}",
            len(data.time),
            path=shown_path(path),
            plot=plot.content.title,
        )
        differences = laid.differences(plot)
        if differences.size:
            difference = scientific(float(np.sqrt(np.mean(differences**2))), 1)
            text += _("; they differ by {difference} (root mean square)", difference=difference)
        self.host.messages.show(text)

    def _ask_edges(self, path: Path) -> None:
        picture = load_picture(path)
        key, plot = self._plot(KYMOGRAPH)
        begin, end = max(0.0, plot.span.time(0)), plot.span.time(plot.area.width)
        proposed = localized(f"{begin:.4g} {end:.4g} {plot.axis.high:.4g} {plot.axis.low:.4g}")
        note = _("where its edges lie: time at the left and right [s], place at the top and bottom [m]")
        self.host.ask(_("A picture over the kymograph"), note, proposed, partial(self._lay_picture, picture, key))

    def _lay_picture(self, picture: pygame.Surface, key: tuple[str, int], text: str) -> None:
        try:
            self.board.overlays[key] = [PictureOverlay(picture, edges_of(text))]
        except ValueError as error:
            self.host.messages.show(str(error), warning=True)

    def ask_signals(self) -> None:
        """Ask which signal is plotted against which."""
        vertical, horizontal = self.board.pair
        text = _("{vertical} against {horizontal}", vertical=vertical, horizontal=horizontal)
        self.host.ask(_("A signal against another"), _(KEY), text, self._take_signals)

    def _take_signals(self, text: str) -> None:
        try:
            self.board.pair = pair_of(text, self.session.lanes[0].chain.contacts + 1)
        except ValueError as error:
            self.host.messages.show(str(error), warning=True)
            return
        self.view.show_plot(OWN)


def _too_many(path: Path, columns: int, curves: int) -> str:
    """That a table has more columns than a plot has curves."""
    return ngettext(
        "{path}: has {columns} columns after the time, and the plot has {n} curve",
        "{path}: has {columns} columns after the time, and the plot has {n} curves",
        curves,
        path=path,
        columns=columns,
    )
