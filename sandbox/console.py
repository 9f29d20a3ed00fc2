"""The console that commands print to, and its tables."""

from __future__ import annotations

from rich import box
from rich.console import Console
from rich.table import Table

WIDTH_OF_A_PIPE = 120  # columns; rich assumes 80 for a file or a pager, which would break the tables


def console() -> Console:
    """A console that prints text without markup, because labels come from users and may hold brackets."""
    found = Console(markup=False, emoji=False, highlight=False)
    if not found.is_terminal:
        found.width = WIDTH_OF_A_PIPE
    return found


def table(*columns: str, numbers: bool = False) -> Table:
    """An empty table; with `numbers`, all columns after the first are aligned right and not broken."""
    grid = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for i, name in enumerate(columns):
        numeric = numbers and i > 0
        grid.add_column(name, justify="right" if numeric else "left", no_wrap=numeric)
    return grid
