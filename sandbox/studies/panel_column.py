"""Panels of a wide figure below each other, in the width of one column."""

from __future__ import annotations

from itertools import product
from typing import TYPE_CHECKING, Any
from weakref import WeakKeyDictionary

import numpy as np

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

MOST_IN_A_COLUMN = 3  # panels; more stand two abreast
Place = tuple[int, int]  # row and column of a panel in the wide figure

# panels, and whether all share their abscissa
_grids: WeakKeyDictionary[Figure, tuple[Any, bool]] = WeakKeyDictionary()


def panels_below_each_other(
    figure: Figure, rows: int, columns: int, sharex: bool | str = False, sharey: bool | str = False, **_: Any
) -> Any:
    """The panels of a figure of `rows` by `columns`, in an array of that shape, wherever they stand.

    The figure has the height of one row of panels; it becomes as many times as high as there are rows now.

    Arguments:
        sharex, sharey: as for `Figure.subplots`: False, True, "row" or "col" of the wide figure.
    """
    places = _places(rows, columns)
    abreast = 1 if len(places) <= MOST_IN_A_COLUMN else 2
    down = -(-len(places) // abreast)
    figure.set_figheight(down * figure.get_figheight())
    found = figure.subplots(down, abreast, squeeze=False).ravel()
    grid = np.empty((rows, columns), dtype=object)
    for place, axes in zip(places, found, strict=False):
        grid[place] = axes
    for axes in found[len(places) :]:
        axes.remove()
    _share(grid, sharex, sharey)
    _grids[figure] = (grid, sharex is True)
    return grid[0] if rows == 1 else grid


def _places(rows: int, columns: int) -> list[Place]:
    """The panels in reading order; pairs that stand one above the other stay together."""
    if rows == 2:
        return [(row, column) for column, row in product(range(columns), range(rows))]
    return list(product(range(rows), range(columns)))


def _share(grid: Any, sharex: bool | str, sharey: bool | str) -> None:
    for (row, column), axes in np.ndenumerate(grid):
        for share, method in ((sharex, "sharex"), (sharey, "sharey")):
            first = {True: (0, 0), "col": (0, column), "row": (row, 0)}.get(share)
            if first is not None and first != (row, column):
                getattr(axes, method)(grid[first])


def label_panels(figure: Figure) -> None:
    """Give each panel the axis labels that it had in common with its row and column in the wide figure."""
    if figure not in _grids:
        return
    grid, one_abscissa = _grids[figure]
    lowest = _lowest(grid)
    for (row, column), axes in np.ndenumerate(grid):
        axes.set_ylabel(axes.get_ylabel() or grid[row, 0].get_ylabel())
        label = axes.get_xlabel() or grid[-1, column].get_xlabel()
        axes.set_xlabel("" if one_abscissa and axes not in lowest else label)


def _lowest(grid: Any) -> list[Axes]:
    """The panels with none below them."""
    places = {axes: axes.get_subplotspec() for axes in grid.ravel()}
    columns = {place.colspan.start for place in places.values()}
    return [
        max((axes for axes in places if places[axes].colspan.start == column), key=lambda a: places[a].rowspan.start)
        for column in columns
    ]
