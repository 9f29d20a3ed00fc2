"""The tables of all figures, each computed when a test first asks for it."""

import numpy as np
import pytest
from softcradle.sandbox.studies.figures.catalogue import figures_named


class Tables(dict):
    def __missing__(self, name):
        (figure,) = figures_named([name])
        self[name] = figure.table()
        return self[name]


@pytest.fixture(scope="session")
def tables():
    return Tables()


def columns(table, name, count, kind=""):
    """(T, count): the columns of beads 0 to count - 1."""
    return np.column_stack([table[f"{name}{i}{kind}"] for i in range(count)])


def forces(table, kind, count=4):
    """(T, count): the forces of all contacts, of the model or the full equations."""
    return np.column_stack([table[f"f{i}{i + 1} {kind}"] for i in range(count)])
