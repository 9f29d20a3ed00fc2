"""Console output of the commands. The output consists of tables that fit the width of the terminal, notes and progress.
The option --quiet suppresses notes and progress.
"""

from __future__ import annotations

import sys
import threading
from collections.abc import Iterable, Sequence
from contextlib import suppress
from time import monotonic
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.console import Console
    from rich.progress import Progress
    from rich.table import Table

# Width of the output in a file or a pipe [columns]. The default value of the package rich, 80, is too narrow for the
# tables.
WIDTH_OF_A_PIPE = 120
MINUTE = 60.0  # Duration of a minute [s].
LINE_AFTER = MINUTE  # Time between two lines of progress in a file [s].
_state = {"quiet": False}


def set_quiet(quiet: bool) -> None:
    """Suppress progress and notes from now on if `quiet` is True. Results and warnings are still printed."""
    _state["quiet"] = quiet


def is_quiet() -> bool:
    """Return True if progress and notes are suppressed."""
    return _state["quiet"]


def note(text: str) -> None:
    """Print a line that is not a result, for example the name of a written file."""
    if not is_quiet():
        print(text, flush=True)


def console(*, error: bool = False) -> Console:
    """Return a console that prints text without interpreting markup, because labels of users may contain brackets."""
    from rich.console import Console

    class Told(Console):
        """Console that raises an error if the pipe is closed, like `print` does. `main` converts this error into an
        exit code.
        """

        def on_broken_pipe(self) -> None:
            raise  # noqa: PLE0704 - it is called where the error is handled

    found = Told(markup=False, emoji=False, highlight=False, stderr=error)
    if not found.is_terminal:
        found.width = WIDTH_OF_A_PIPE
    return found


class ProgressShown:
    """Progress of a command on standard error. On a terminal, it is a bar that disappears at the end. In a file, it is
    one line per minute.

    Arguments:
        what: name of the counted items. A study that reports "points" counts these items.
        count: number of items; None if it is reported later.
        shown: True if the progress is printed.
    """

    def __init__(self, what: str, count: int | None = None, shown: bool = True) -> None:
        self._points, self._what, self._done, self._count = what, what, 0, count
        self._shown, self._ended = shown and not is_quiet(), threading.Event()
        self._bar: Progress | None = None
        self._lines: threading.Thread | None = None
        self._began, self._before = monotonic(), 0

    def __enter__(self) -> ProgressShown:
        output = console(error=True) if self._shown else None
        if output is not None and output.is_terminal:
            self._bar = _bar(output)
            self._task = self._bar.add_task(self._what, total=self._count)
            self._bar.start()
        elif output is not None:
            self._lines = threading.Thread(target=self._write_lines, name="progress", daemon=True)
            self._lines.start()
        return self

    def __exit__(self, *error: object) -> None:
        self._ended.set()
        if self._bar is not None:
            self._bar.stop()
        if self._lines is not None:
            # Wait for the thread that prints progress, because its last line must not follow the results of the
            # command.
            self._lines.join()

    def tell(self, what: str, done: int, count: int | None = None) -> None:
        """Report that `done` of `count` items are finished."""
        what = self._points if what == "points" else what
        if (what, count) != (self._what, self._count):
            self._began, self._before = monotonic(), done
        self._what, self._done, self._count = what, done, count
        if self._bar is not None:
            self._bar.update(self._task, description=what, completed=done, total=count)

    def advance(self, by: int = 1) -> None:
        """Report that `by` more items are finished."""
        self.tell(self._what, self._done + by, self._count)

    def _write_lines(self) -> None:
        while not self._ended.wait(LINE_AFTER):
            with suppress(OSError, ValueError):  # The disk may be full, or the stream may be closed.
                print(f"softcradle: {self.line(monotonic() - self._began)}", file=sys.stderr, flush=True)

    def line(self, seconds: float) -> str:
        """Return a line with the number of finished items, their rate and the remaining time. `seconds` is the elapsed
        time.
        """
        of = "" if self._count is None else f" of {self._count}"
        rate = (self._done - self._before) / max(seconds, 1e-9)
        told = f"{self._what}: {self._done}{of}, after {_duration(seconds)}"
        if self._count is None or rate == 0.0:
            return told
        return f"{told}, {rate:.3g} a second, about {_duration((self._count - self._done) / rate)} left"


def _bar(output: Console) -> Progress:
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    columns = TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn()
    return Progress(*columns, console=output, transient=True)


def _duration(seconds: float) -> str:
    if seconds < MINUTE:
        return f"{seconds:.0f} s"
    return f"{seconds / MINUTE:.0f} min" if seconds < MINUTE**2 else f"{seconds / MINUTE**2:.1f} h"


def table(*columns: str, numbers: bool = False) -> Table:
    """Return an empty table. If `numbers` is True, all columns after the first are aligned to the right."""
    from rich import box
    from rich.table import Table

    grid = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for i, name in enumerate(columns):
        grid.add_column(name, justify="right" if numbers and i > 0 else "left", overflow="fold")
    return grid


def print_rows(
    titles: Sequence[str], rows: Iterable[Sequence[str]], numbers: bool = False, output: Console | None = None
) -> None:
    """Print rows of text below the column titles. See `table` and `print_table`."""
    grid = table(*titles, numbers=numbers)
    for row in rows:
        grid.add_row(*row)
    print_table(output or console(), grid)


def print_json(content: object) -> None:
    """Print `content` as JSON. See `readable_json`."""
    from softcradle.sandbox.files import readable_json

    print(readable_json(content))


def print_table(output: Console, grid: Table) -> None:
    """Print a table without breaking its numbers.

    If the table is too wide for a terminal, print each row as a record of several lines. If the output goes to a pipe,
    print the table in its full width.
    """
    from rich.measure import Measurement

    numbers = grid.columns[-1].justify == "right"
    for column in grid.columns if numbers else ():  # Labels and numbers must not be broken into several lines.
        lines = [line for cell in column.cells for line in str(cell).splitlines()]
        column.min_width = max(map(len, lines), default=0)
    needed = Measurement.get(output, output.options.update(max_width=10_000), grid).minimum
    if needed <= output.width and (not numbers or _is_whole(output, grid)):
        output.print(grid)
    elif output.is_terminal:
        _print_records(output, grid)
    else:
        output.print(grid, width=needed, crop=False)


def _is_whole(output: Console, grid: Table) -> bool:
    """Return True if no word of the table is broken when it is printed. A column may need more width than rich has
    measured.
    """
    text = "\n".join("".join(segment.text for segment in line) for line in output.render_lines(grid))
    words = [word for column in grid.columns for cell in (column.header, *column.cells) for word in str(cell).split()]
    return all(word in text for word in words)


def _print_records(output: Console, grid: Table) -> None:
    """Print each row as a record. The first cell is followed by one line with title and value for each other cell."""
    titles = [" ".join(str(column.header).split()) for column in grid.columns]
    for row in zip(*(column.cells for column in grid.columns), strict=True):
        output.print(f"{titles[0]} {row[0]}".strip(), style="bold")
        for title, cell in zip(titles[1:], row[1:], strict=True):
            output.print(f"  {title}: {cell}")
