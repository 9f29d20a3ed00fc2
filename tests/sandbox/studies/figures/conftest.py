"""The tables of all figures, each computed when a test first asks for it."""

from functools import cache

import numpy as np
import pytest
from softcradle.sandbox.studies.figures.catalogue import figures_named


@pytest.fixture(scope="session")
def tables():
    return cache(lambda name: figures_named([name])[0].table())


def columns(table, name, count):
    """(T, count): the columns of beads 0 to count - 1."""
    return np.column_stack([table[f"{name}{i}"] for i in range(count)])


def forces(table, kind, count=4):
    """(T, count): the forces of all contacts, of the model or the full equations."""
    return np.column_stack([table[f"f{i}{i + 1} {kind}"] for i in range(count)])
