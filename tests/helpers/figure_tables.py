"""Columns of a figure's table that belong together."""

import numpy as np


def columns(table, name, count, kind=""):
    """(T, count): the columns of beads 0 to count - 1."""
    return np.column_stack([table[f"{name}{i}{kind}"] for i in range(count)])


def forces(table, kind, count=4):
    """(T, count): the forces of all contacts, of the model or the full equations."""
    return np.column_stack([table[f"f{i}{i + 1} {kind}"] for i in range(count)])
