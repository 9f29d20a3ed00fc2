"""Tests of the table of physical quantities. All headings and axes must use its names and units."""

import re

from softcradle.physics import one_on, power_law
from softcradle.physics.simulation import solve
from softcradle.sandbox.quantities import FORCE, KINETIC, MASS, MOMENTUM, OVERLAP, POSITION, QUANTITIES, TIME, VELOCITY
from softcradle.sandbox.session.editable_numbers import NUMBERS
from softcradle.sandbox.session.values_table import BEAD_COLUMNS, CONTACT_COLUMNS, values_csv
from softcradle.sandbox.story.page_words import WORDS as WORDS_OF_PAGES
from softcradle.sandbox.sweeps.measure_table import MEASURES
from softcradle.sandbox.trajectory_summary import bead_table, contact_table, summarise
from softcradle.sandbox.window.plots.kinds import signal_of

from tests.helpers.sessions import opened

TABLE = (*QUANTITIES.values(), MASS)
# Words by which the quantity of a heading is recognised. If a heading contains two of them, the last one counts. For
# example, "momentum of force" is a force.
WORDS = {"mass": MASS, "time": TIME, "position": POSITION, "velocity": VELOCITY, "velocities": VELOCITY, "overlap": OVERLAP,
         "force": FORCE, "forces": FORCE, "momentum": MOMENTUM, "energy": KINETIC}  # fmt: skip
HEADING = re.compile(r"([A-Za-z _]+)[\d-]* [\[(]([^\])]*)[\])]")


def test_headings_have_the_units_of_the_quantities(tmp_path):
    trajectory = solve(one_on(2, power_law(1.0, 0.1)), [1.0, 0.0, 0.0])
    trajectory.to_csv(tmp_path / "run.csv")
    columns = (tmp_path / "run.csv").read_text().splitlines()[0].split(",")
    assert {f"{one.name} 0 [{one.unit}]" for one in (POSITION, VELOCITY)} <= set(columns)
    summary = summarise("", trajectory)
    tables = [title for one in (bead_table(summary), contact_table(summary)) for title in one.titles if "[" in title]
    measures = [f"{one.name.replace('_', ' ')} [{one.unit}]" for one in MEASURES if one.unit]
    numbers = [f"{one.name} ({one.unit})" for one in NUMBERS if one.unit]
    words = [text for text in WORDS_OF_PAGES.values() if re.fullmatch(r"[^{}]*\([A-Za-z/ ]+\)", text)]
    assert len(words) > 4
    wrong = []
    for heading in [*columns, *tables, *measures, *numbers, *words, *(one.title for one in TABLE), "velocity (m)"]:
        name, unit = HEADING.search(heading).groups()
        exact = [one for one in TABLE if one.name == name]
        owners = exact or [WORDS[word] for word in re.findall("[a-z]+", name.lower()) if word in WORDS]
        # Units with a prefix, such as kN, are also correct.
        if owners and unit not in [prefix + owners[-1].unit for prefix in ("", "k", "M")]:
            wrong.append(heading)
    assert wrong == ["velocity (m)"]  # Only the deliberately wrong heading "velocity (m)" is reported.


def test_the_table_of_values_and_signals_are_the_table():
    assert set(BEAD_COLUMNS[1:]) | set(CONTACT_COLUMNS[1:]) <= {one.column for one in TABLE}
    assert all(f",{column}" in values_csv(opened()) for column in (*BEAD_COLUMNS, *CONTACT_COLUMNS))
    for letter, quantity in QUANTITIES.items():
        assert signal_of(letter if quantity.owner == "chain" else f"{letter}0", 3).quantity is quantity
