"""The console that commands print to: tables that fit its width, and notes and progress that --quiet leaves out."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.console import Console
    from rich.progress import Progress
    from rich.table import Table

WIDTH_OF_A_PIPE = 120  # columns of text; rich assumes 80 for a file or a pager
_state = {"quiet": False}


def set_quiet(quiet: bool) -> None:
    """Leave out progress and notes from now on, or not; results and warnings stay."""
    _state["quiet"] = quiet


def is_quiet() -> bool:
    """Whether progress and notes are left out."""
    return _state["quiet"]


def note(text: str) -> None:
    """Print a line that is no result, such as the name of a file that was written."""
    if not is_quiet():
        print(text, flush=True)


def console(*, error: bool = False) -> Console:
    """A console that prints text without markup, because labels come from users and may hold brackets."""
    from rich.console import Console

    found = Console(markup=False, emoji=False, highlight=False, stderr=error)
    if not found.is_terminal:
        found.width = WIDTH_OF_A_PIPE
    return found


def progress_bar() -> Progress:
    """A bar on standard error that disappears at the end."""
    from rich.progress import Progress

    return Progress(console=console(error=True), transient=True, disable=is_quiet())


def table(*columns: str, numbers: bool = False) -> Table:
    """An empty table; with `numbers`, all columns after the first are aligned right."""
    from rich import box
    from rich.table import Table

    grid = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for i, name in enumerate(columns):
        grid.add_column(name, justify="right" if numbers and i > 0 else "left", overflow="fold")
    return grid


def print_table(output: Console, grid: Table) -> None:
    """Print a table: on a terminal that is too narrow for its numbers as a record a row; in a pipe as wide as it is."""
    from rich.measure import Measurement

    for column in grid.columns if grid.columns[-1].justify == "right" else ():  # labels and numbers are not broken
        column.min_width = max(len(line) for cell in column.cells for line in str(cell).splitlines() or [""])
    needed = Measurement.get(output, output.options.update(max_width=10_000), grid).minimum
    if needed <= output.width:
        output.print(grid)
    elif output.is_terminal:
        _print_records(output, grid)
    else:
        output.print(grid, width=needed, crop=False)


def _print_records(output: Console, grid: Table) -> None:
    """Each row as lines of title and value, below its first cell."""
    titles = [" ".join(str(column.header).split()) for column in grid.columns]
    for row in zip(*(column.cells for column in grid.columns), strict=True):
        output.print(f"{titles[0]} {row[0]}".strip(), style="bold")
        for title, cell in zip(titles[1:], row[1:], strict=True):
            output.print(f"  {title}: {cell}")
