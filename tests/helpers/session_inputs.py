"""Inputs of a session as values that Hypothesis draws and shrinks."""

import math
from dataclasses import fields, replace
from typing import Any

from hypothesis import strategies as st
from softcradle.physics.contact import draft_gear, hertz, power_law
from softcradle.sandbox.session import inputs
from softcradle.sandbox.session.contact_conversion import KINDS
from softcradle.sandbox.session.session import Session

METHODS = ("auto", "conserving", "verlet", "euler", "yoshida4", "accurate", "radau", "dop853", "pymunk")
MOST_BEADS = 30  # of a lane; with more, beads are only removed

_NUMBERS = st.integers(0, 60)  # of lanes, beads and contacts, modulo how many there are
_OR_ALL = st.one_of(_NUMBERS, st.none())
_LAWS = st.one_of(
    st.builds(power_law, st.sampled_from((0.1, 1.0, 100.0)), st.sampled_from((1 / 30, 1 / 14, 0.1, 0.5, 1.0, 1.5))),
    st.builds(draft_gear, st.sampled_from((0.1, 5.0, 800.0)), st.sampled_from((1e-3, 0.02, 0.5))),
    st.builds(hertz, st.sampled_from((1.0, 1e3))),
)
_MASSES = st.sampled_from((1.0, 0.01, 0.3, 100.0, math.inf, 0.0))
_NUMBER = st.sampled_from((0.0, 1.0, -1.0, 0.3, -2.5, 1e3, math.nan, math.inf))
_POSITIONS = st.sampled_from((0.0, 1.0, -1.0, 0.3, -2.5, 50.0))

INPUTS: st.SearchStrategy[inputs.Input] = st.one_of(
    st.builds(inputs.Place, _NUMBERS, _NUMBERS, _POSITIONS),
    st.builds(inputs.Drag, _NUMBERS, _NUMBERS, _POSITIONS),
    st.builds(inputs.Drop),
    st.builds(inputs.SetVelocity, _NUMBERS, _OR_ALL, _NUMBER),
    st.builds(inputs.SetMass, _NUMBERS, _OR_ALL, _MASSES),
    st.builds(inputs.SetContact, _NUMBERS, _OR_ALL, _LAWS),
    st.builds(inputs.SetKind, _NUMBERS, _OR_ALL, st.sampled_from(KINDS)),
    st.builds(inputs.Lock, _NUMBERS, _OR_ALL, st.booleans()),
    st.builds(inputs.SetGap, _NUMBERS, _NUMBERS, st.sampled_from((0.0, 0.5, -1.0))),
    st.builds(inputs.SetDrive, _NUMBERS, _OR_ALL, _NUMBER),
    st.builds(inputs.SetFriction, _NUMBERS, st.sampled_from((0.0, 0.2, 1.0, -0.1))),
    st.builds(inputs.AddBead, _NUMBERS, _NUMBERS, _MASSES, st.sampled_from((0.0, 0.4))),
    st.builds(inputs.RemoveBead, _NUMBERS, _NUMBERS),
    st.builds(inputs.SetMethod, _OR_ALL, st.sampled_from(METHODS)),
    st.builds(inputs.SetStep, _NUMBERS, st.sampled_from((None, 1e-3, 0.02, 0.0))),
    st.builds(inputs.SetSlow, st.sampled_from((1.0, 10.0, 400.0, 0.0))),
)


def fitted(item: inputs.Input, session: Session) -> inputs.Input:
    """`item` with numbers of a lane, a bead and a contact that `session` has."""
    names = {field.name for field in fields(item)}
    changed: dict[str, Any] = {}
    lane = getattr(item, "lane", None)
    if lane is not None:
        changed["lane"] = lane % len(session.lanes)
    contacts = session.lanes[changed.get("lane", 0)].chain.contacts
    most = {"bead": contacts + (2 if isinstance(item, inputs.AddBead) else 1), "contact": contacts}
    changed |= {
        key: getattr(item, key) % n for key, n in most.items() if key in names and getattr(item, key) is not None
    }
    item = replace(item, **changed)
    if isinstance(item, inputs.AddBead) and contacts >= MOST_BEADS:
        return inputs.RemoveBead(item.lane, item.bead % (contacts + 1))
    return item
