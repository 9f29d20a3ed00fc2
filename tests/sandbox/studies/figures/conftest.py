"""Fixtures with the tables of all figures. Each table is computed when a test first needs it."""

from functools import cache

import numpy as np
import pytest
from softcradle.sandbox.studies.figures.catalogue import figures_named


@pytest.fixture(scope="session")
def tables():
    return cache(lambda name: figures_named([name])[0].table())


def columns(table, name, count):
    """Return the columns of beads 0 to `count` - 1 as an array of shape (T, count)."""
    return np.column_stack([table[f"{name}{i}"] for i in range(count)])


def forces(table, kind, count=4):
    """Return the forces of the first `count` contacts as an array of shape (T, count).

    The forces are computed by the approximate model or by the full equations, depending on `kind`.
    """
    return np.column_stack([table[f"f{i}{i + 1} {kind}"] for i in range(count)])
