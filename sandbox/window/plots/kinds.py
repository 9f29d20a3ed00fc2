"""The table of live plots and their contents. It also defines the signals that the user can choose for the x-y plot."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from operator import attrgetter

import numpy as np
import pygame
from softcradle.sandbox.draw.axes import VerticalAxis, decade_axis, linear_axis
from softcradle.sandbox.draw.palette import Colour, bead_colours, tones
from softcradle.sandbox.draw.shared_scales import Scales
from softcradle.sandbox.languages import N_, NP_, _
from softcradle.sandbox.motion import Array, Motion
from softcradle.sandbox.quantities import BEAD, CHAIN, CONTACT, FORCE, OVERLAP, QUANTITIES, VELOCITY, Quantity
from softcradle.sandbox.story.numbers import subscript
from softcradle.sandbox.window.plots.curves import Plot, PlotContent
from softcradle.sandbox.window.plots.shapes import DifferencePlot, KymographPlot, PhasePlot, StackedPlot, StripPlot

KEY = N_(
    "t: time; x, v, p, e with a bead number: position, velocity, momentum, energy; "
    "d, r, f with a contact number: overlap, rate, force; s: stored energy"
)


BEADS_NUMBERED = N_("{text!r}: the beads of this lane are numbered 0 to {last}")
CONTACTS_NUMBERED = N_("{text!r}: the contacts of this lane are numbered 0 to {last}")


@dataclass(frozen=True)
class Signal:
    """A quantity as a function of time. It is given by a letter in QUANTITIES and by the index of a bead or contact.

    The index counts from the left.
    """

    letter: str
    index: int = 0

    @property
    def quantity(self) -> Quantity:
        """The quantity of the signal."""
        return QUANTITIES[self.letter]

    @property
    def label(self) -> str:
        """Symbol and unit of the signal."""
        owner = self.quantity.owner
        index = {BEAD: subscript(self.index), CONTACT: subscript(self.index, self.index + 1), CHAIN: ""}[owner]
        return f"{self.quantity.symbol}{index} ({self.quantity.unit})"

    def values(self, motion: Motion, length: float) -> Array:
        """Return the (T,) values of the signal in a motion of beads that are `length` [m] long.

        The values are NaN if the motion has no such bead or contact.
        """
        columns = self.quantity.values(motion, length)
        if self.index >= columns.shape[1]:
            return np.full(len(motion.time), np.nan)
        column: Array = columns[:, self.index]
        return column

    def __str__(self) -> str:
        return self.letter if self.quantity.owner == CHAIN else f"{self.letter}{self.index}"


def signal_of(text: str, beads: int) -> Signal:
    """Return the signal that `text` names, such as v0, f1 or t, for a lane with `beads` beads.

    Raise ValueError with a sentence if the signal is unknown.
    """
    found = re.fullmatch(r"([a-z])_?(\d*)(?:-(\d+))?", text.strip().lower())
    if found is None or found[1] not in QUANTITIES or (found[3] and not _is_contact(*found.groups())):
        known = ", ".join(QUANTITIES)
        wrong = _("{text!r} is unknown. Use {known}, with a number: v0, f1", text=text.strip(), known=known)
        raise ValueError(wrong)
    letter, digits = found[1], found[2]
    owner = QUANTITIES[letter].owner
    if owner == CHAIN:
        return Signal(letter)
    count = beads if owner == BEAD else beads - 1
    if not digits or int(digits) >= count:
        numbered = BEADS_NUMBERED if owner == BEAD else CONTACTS_NUMBERED
        raise ValueError(_(numbered, text=text.strip(), last=count - 1))
    return Signal(letter, int(digits))


def _is_contact(letter: str, left: str, right: str) -> bool:
    """Return True if the signal belongs to a contact, and the two numbers are those of neighbouring beads."""
    return QUANTITIES[letter].owner == CONTACT and left != "" and int(right) == int(left) + 1


def pair_of(text: str, beads: int) -> tuple[Signal, Signal]:
    """Return the two signals of a text such as "f0 against d0". The vertical signal comes first.

    Raise ValueError with a sentence for the user if the text does not contain two signals.
    """
    between = _("{vertical} against {horizontal}", vertical="", horizontal="").strip()
    parts = re.split(rf"\s+(?:against|{re.escape(between)})\s+|\s*,\s*|\s+", text.strip())
    if len(parts) != 2:
        raise ValueError(_("{text!r}: write two signals, as f0 against d0", text=text))
    return signal_of(parts[0], beads), signal_of(parts[1], beads)


BEAD_HEIGHT = 0.8  # Height of the band of a bead in a kymograph, as a fraction of the length of the bead.
# Default signals of the x-y plot. The force over the overlap of the first contact shows its hysteresis loop.
PAIR = Signal("f"), Signal("d")
# Functions that return the (T, k) values of a Motion.
_velocity, _force, _overlap = map(attrgetter, ("velocity", "force", "overlap"))
MOST_ROW_LABELS = 5  # Largest number of labels of a space-time plot.


@dataclass(frozen=True)
class PlotSetting:
    """The values from which the content of a plot is made.

    Attributes:
        scales: scales of the page.
        lane: number of the lane.
        beads: number of beads in the lane.
        length: length of a bead [m].
        logarithmic: True if overlaps have a logarithmic axis.
        pair: the two signals that the user chose, the vertical one first.
    """

    scales: Scales
    lane: int
    beads: int
    length: float
    logarithmic: bool
    pair: tuple[Signal, Signal] = PAIR

    @property
    def colours(self) -> tuple[Colour, ...]:
        """Colours of the beads. A contact has the colour of the bead on its right."""
        return bead_colours(self.beads)

    def bead_names(self, symbol: str) -> list[str]:
        """Return `symbol` with the index of each bead."""
        return [symbol + subscript(i) for i in range(self.beads)]

    def contact_names(self, symbol: str) -> list[str]:
        """Return `symbol` with the indices of each contact."""
        return [symbol + subscript(i, i + 1) for i in range(self.beads - 1)]


@dataclass(frozen=True)
class PlotKind:
    """A kind of plot.

    Attributes:
        name: text on the button of the plot, translated in the context "button". It is also the name of the action that
            shows or hides the plot.
        key: pygame's code of the key for this action.
        help: text of this action in the help.
        content: function that returns title, axis and curves.
        plot: class that draws the plot.
        shown: True if a new page shows the plot.
        two_lanes: True if the plot compares two lanes, which must have equal numbers of beads.
    """

    name: str
    key: int
    help: str
    content: Callable[[PlotSetting], PlotContent]
    plot: type[Plot] = Plot
    shown: bool = False
    two_lanes: bool = False


def _velocities(setting: PlotSetting) -> PlotContent:
    axis = linear_axis("", *setting.scales.velocity)
    return PlotContent(_(VELOCITY.title), axis, setting.bead_names(VELOCITY.symbol), setting.colours, _velocity)


def _forces(setting: PlotSetting) -> PlotContent:
    axis = linear_axis("", setting.scales.pull, setting.scales.force)
    return PlotContent(_(FORCE.title), axis, setting.contact_names(FORCE.symbol), setting.colours[1:], _force)


def _overlaps(setting: PlotSetting) -> PlotContent:
    if setting.logarithmic:
        axis = decade_axis("", *setting.scales.decades)
    else:
        axis = linear_axis("", 0.0, 1.1 * (max(map(max, setting.scales.deepest)) or 1.0))
    return PlotContent(_(OVERLAP.title), axis, setting.contact_names(OVERLAP.symbol), setting.colours[1:], _overlap)


def _energies(setting: PlotSetting) -> PlotContent:
    axis = linear_axis("", 0.0, 1.05 * setting.scales.energy)
    names, colours = [*setting.bead_names("E"), _("stored")], (*setting.colours, tones.steel)
    return PlotContent(_("energy (J): beads, contacts grey"), axis, names, colours, _energy_layers)


def _contact_forces_by_row(setting: PlotSetting) -> PlotContent:
    axis, names = _row_axis(setting.contact_names("")), setting.contact_names(FORCE.symbol)
    title, darkest = _("contact forces (N), row by row"), setting.scales.force
    return PlotContent(title, axis, names, setting.colours[1:], _force, darkest=darkest)


def _bead_markers(setting: PlotSetting) -> PlotContent:
    axis, names = linear_axis("", *setting.scales.window), setting.bead_names("x")
    title, band = _("markers of the beads (m)"), BEAD_HEIGHT * setting.length
    return PlotContent(title, axis, names, setting.colours, lambda motion: motion.middles(setting.length), band=band)


def _difference(setting: PlotSetting) -> PlotContent:
    """Return the content of a difference plot. It shows velocities next to the first lane and forces next to the
    second.

    The axes are limited by the largest difference of two values that fit on the axes of the lanes.
    """
    if setting.lane == 0:
        half = setting.scales.velocity[1] - setting.scales.velocity[0]
        axis, names = linear_axis("", -half, half), setting.bead_names("Δv")
        return PlotContent(_("second minus first (m/s)"), axis, names, setting.colours, _velocity)
    half = setting.scales.force - setting.scales.pull
    axis, names = linear_axis("", -half, half), setting.contact_names("Δf")
    return PlotContent(_("second minus first (N)"), axis, names, setting.colours[1:], _force)


def _chosen(setting: PlotSetting) -> PlotContent:
    """Return the content of the x-y plot: one signal against another, both chosen by the user."""
    vertical, horizontal = setting.pair

    def both(motion: Motion) -> Array:
        return np.column_stack([signal.values(motion, setting.length) for signal in setting.pair])

    title = _("{vertical} against {horizontal}", vertical=vertical.label, horizontal=horizontal.label)
    names = vertical.label, horizontal.label
    # A curve has the colour of its bead. A contact has the colour of the bead on its right.
    place = vertical.index + (vertical.quantity.owner == CONTACT)
    colour = tones.accent if vertical.quantity.owner == CHAIN else setting.colours[min(place, len(setting.colours) - 1)]
    return PlotContent(title, linear_axis("", 0.0, 1.0), names, (colour, colour), both)


def _energy_layers(motion: Motion) -> Array:
    return np.column_stack((motion.kinetic, motion.stored))


def _row_axis(names: Sequence[str]) -> VerticalAxis:
    """Return an axis with a strip for each contact, the first contact on top. Only some strips have labels."""
    step = max(1, (len(names) + MOST_ROW_LABELS - 1) // MOST_ROW_LABELS)
    return VerticalAxis("", float(len(names)), 0.0, tuple((k + 0.5, names[k]) for k in range(0, len(names), step)))


# Names of plots that other modules use.
VELOCITIES, FORCES, KYMOGRAPH = NP_("button", "velocities"), NP_("button", "forces"), NP_("button", "kymograph")
OWN = "x-y"

PLOT_KINDS: dict[str, PlotKind] = {
    kind.name: kind
    for kind in (
        PlotKind(VELOCITIES, pygame.K_1, N_("velocities"), _velocities, shown=True),
        PlotKind(FORCES, pygame.K_2, N_("forces"), _forces, shown=True),
        PlotKind(NP_("button", "overlaps"), pygame.K_3, N_("overlaps"), _overlaps, shown=True),
        PlotKind(NP_("button", "energy"), pygame.K_4, N_("energy split"), _energies, StackedPlot),
        PlotKind(NP_("button", "space-time"), pygame.K_5, N_("space-time strip"), _contact_forces_by_row, StripPlot),
        PlotKind(KYMOGRAPH, pygame.K_7, N_("space-time picture"), _bead_markers, KymographPlot),
        PlotKind(OWN, pygame.K_8, N_("x-y plot"), _chosen, PhasePlot),
        PlotKind(
            NP_("button", "difference"),
            pygame.K_6,
            N_("difference of two lanes"),
            _difference,
            DifferencePlot,
            shown=True,
            two_lanes=True,
        ),
    )
}
