"""The files of figures: whole, readable at the size at which they are printed, and written by the command."""

from dataclasses import replace

import numpy as np
import pytest
from PIL import Image
from softcradle.sandbox.cli.commands.figures import KEPT
from softcradle.sandbox.cli.main import main
from softcradle.sandbox.studies.data_table import write_table
from softcradle.sandbox.studies.figures import catalogue, collision
from softcradle.sandbox.studies.figures.catalogue import FIGURES, compute_tables, figures_named, write_figure
from softcradle.sandbox.studies.plot_style import SUFFIXES, styled

from tests.helpers.figure_layout import keys_on_curves, unnamed_colours, unreadable

# A table of one curve, of two methods, of a mode, and of a coupler; the others in `make test-all`.
KINDS = ("2a", "1b", "exchange", "stop")
NAMES = [
    figure.name if figure.name in KINDS else pytest.param(figure.name, marks=pytest.mark.slow) for figure in FIGURES
]


@pytest.mark.parametrize("name", NAMES)
def test_files_are_whole(tables, name, tmp_path):
    (figure,) = figures_named([name])
    paths = write_figure(replace(figure, table=lambda: tables[name]), tmp_path)
    assert [path.suffix for path in paths] == list(SUFFIXES)
    with Image.open(paths[0]) as image:
        assert min(image.size) > 700
        dark = np.asarray(image.convert("L")) < 128
        assert 0.002 < dark.mean() < 0.3
        assert not dark[[0, -1]].any()  # nothing is cut off at the edges
        assert not dark[:, [0, -1]].any()
    assert paths[1].read_bytes().startswith(b"%PDF")


@pytest.mark.slow
@pytest.mark.parametrize("name", [figure.name for figure in FIGURES])
def test_a_printed_figure_can_be_read(tables, name):
    """Every curve is named; no text below 6 points or beyond the edge, none on another one or on a curve, no key on a curve."""
    (figure,) = figures_named([name])
    with styled():
        picture = figure.draw(tables[name])
        assert unreadable(picture) == []
        assert unnamed_colours(picture) == set()
        assert keys_on_curves(picture) == []
    assert not [axes for axes in picture.axes if axes.xaxis_inverted() or axes.yaxis_inverted()]
    width, height = picture.get_size_inches() * 25.4
    assert width <= 178.0 + 1e-9
    assert height <= 240.0  # of the page


def test_csv_reads_back_equal(tmp_path):
    table = collision.modes()
    write_table(table, tmp_path / "modes.csv")
    header, _, rows = (tmp_path / "modes.csv").read_text(encoding="utf-8").partition("\n")
    assert header.split(",") == list(table)
    np.testing.assert_array_equal(np.loadtxt(rows.splitlines(), delimiter=","), np.column_stack(list(table.values())))


def test_command_writes_the_wanted_figures_and_lists_all(tmp_path, softcradle):
    assert main(["figures", "2a", "exchange", "-o", str(tmp_path / "new" / "folder")]) == 0
    written = sorted(path.name for path in (tmp_path / "new" / "folder").iterdir())
    assert written == [f"figure-{name}{suffix}" for name in ("2a", "exchange") for suffix in sorted(SUFFIXES)]
    listed = " ".join(softcradle("figures", "--list").out.split())  # long captions go on in the next line
    assert all(figure.caption in listed for figure in FIGURES)


def same(found, expected):
    return [*found] == [*expected] and all(np.array_equal(found[n], expected[n], equal_nan=True) for n in expected)


def test_tables_of_a_sweep_are_those_of_the_figures(tables):
    """With all columns in their order, however long those of other figures are."""
    wanted = figures_named(["1d", "1b", "2a", "1d"])
    found = list(compute_tables(wanted, workers=1))
    assert all(same(table, tables[figure.name]) for table, figure in zip(found, wanted, strict=True))
    assert len({len(next(iter(table.values()))) for table in found}) > 1


def test_a_figure_that_is_computed_is_not_computed_again(tables, tmp_path, monkeypatch):
    def stop(_: str, done: int, __: int) -> None:
        if done >= 1:
            raise KeyboardInterrupt

    wanted = figures_named(["2a", "exchange"])
    with pytest.raises(KeyboardInterrupt):
        list(compute_tables(wanted, tmp_path / KEPT, stop, 1))
    again = [replace(wanted[0], table=lambda: pytest.fail("computed again")), wanted[1]]
    monkeypatch.setattr(catalogue, "FIGURES", again)
    found = list(compute_tables(again, tmp_path / KEPT, None, 1))
    assert all(same(table, tables[figure.name]) for table, figure in zip(found, wanted, strict=True))
    assert main(["figures", "2a", "exchange", "-o", str(tmp_path)]) == 0
    assert {path.suffix for path in tmp_path.iterdir()} == set(SUFFIXES)
