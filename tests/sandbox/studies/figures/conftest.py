"""The tables of all figures, each computed when a test first asks for it."""

import pytest
from softcradle.sandbox.studies.data_table import Table
from softcradle.sandbox.studies.figures.figure_list import figures_named


class Tables(dict[str, Table]):
    """Tables by the name of their figure."""

    def __missing__(self, name: str) -> Table:
        (figure,) = figures_named([name])
        self[name] = figure.table()
        return self[name]


@pytest.fixture(scope="session")
def tables():
    return Tables()
