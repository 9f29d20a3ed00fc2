"""Acceptance of inputs: what an input makes of the lanes, before anything is changed; a ValueError says why it is refused."""

from __future__ import annotations

from dataclasses import dataclass, replace

from softcradle.sandbox.languages import _
from softcradle.sandbox.session import inputs
from softcradle.sandbox.session.lane_setup import Setup
from softcradle.sandbox.session.live_lane import LiveLane
from softcradle.sandbox.session.snapshots import NOTHING_HELD, HeldBead

FASTEST = 1e-2  # slow motion: least wall seconds for one second of the model
SLOWEST = 1e6  # slow motion: most wall seconds for one second of the model


@dataclass(frozen=True)
class Present:
    """What inputs change: setup, lanes, and the bead that the pointer holds."""

    setup: Setup
    lanes: list[LiveLane]
    held: HeldBead


def accepted(item: inputs.Input, now: Present, at_start: bool) -> Present:
    """The present after `item`; one `at_start` of the session changes the start of the lanes too. ValueError: refused."""
    if isinstance(item, inputs.Drag):
        return replace(now, held=_grasped(item, now.lanes))
    if isinstance(item, inputs.Drop):
        return replace(now, held=NOTHING_HELD)
    if isinstance(item, inputs.Resume):
        copies = [LiveLane(lane.setup, lane.state.copy(), lane.ledger.copy()) for lane in now.lanes]
        return Present(now.setup, copies, NOTHING_HELD)
    if isinstance(item, inputs.SetSlow):
        if not FASTEST <= item.slow <= SLOWEST:
            raise ValueError(
                _(
                    "slow motion must be from {least:g} to {most:g}, not {given!r}",
                    least=FASTEST,
                    most=SLOWEST,
                    given=item.slow,
                )
            )
        return replace(now, setup=replace(now.setup, slow=float(item.slow)))
    return _edited(item, now, at_start)


def _edited(item: inputs.LaneInput, now: Present, at_start: bool) -> Present:
    chosen = range(len(now.lanes)) if item.lane is None else (item.lane,)
    changed = {index: _lane(now.lanes, index).changed(item, at_start) for index in chosen}
    lanes = [changed.get(index, lane) for index, lane in enumerate(now.lanes)]
    setup = replace(now.setup, lanes=tuple(lane.setup for lane in lanes))
    held = NOTHING_HELD if isinstance(item, inputs.AddBead | inputs.RemoveBead) else now.held
    return Present(setup, lanes, held)


def _grasped(item: inputs.Drag, lanes: list[LiveLane]) -> HeldBead:
    beads = _lane(lanes, item.lane).chain.contacts + 1
    if not (0 <= item.bead < beads and abs(item.position) < float("inf")):
        raise ValueError(_("there is no bead {bead} to hold at {place!r}", bead=item.bead, place=item.position))
    return HeldBead(float(item.lane), float(item.bead), float(item.position))


def _lane(lanes: list[LiveLane], index: int) -> LiveLane:
    if not 0 <= index < len(lanes):
        raise ValueError(_("there is no lane {lane}; they are numbered 0 to {last}", lane=index, last=len(lanes) - 1))
    return lanes[index]
