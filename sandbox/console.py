"""Tables on the terminal."""

from __future__ import annotations

from rich import box
from rich.console import Console
from rich.table import Table

WIDTH_OF_A_PIPE = 120  # a file or a pager has no width; the 80 that rich assumes would break the tables


def console() -> Console:
    """A console that prints text as it is: labels come from users and may hold brackets."""
    found = Console(markup=False, emoji=False, highlight=False)
    if not found.is_terminal:
        found.width = WIDTH_OF_A_PIPE
    return found


def table(*columns: str, numbers: bool = False) -> Table:
    """An empty table; with `numbers`, all columns after the first stand right and never break."""
    made = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for i, name in enumerate(columns):
        number = numbers and i > 0
        made.add_column(name, justify="right" if number else "left", no_wrap=number)
    return made
