"""Measured data from CSV files: what is read, and how what cannot be read is refused."""

from pathlib import Path

import numpy as np
import pytest
from softcradle.sandbox.session.measured_data import load_measured
from softcradle.sandbox.user_error import UserError


def written(folder: Path, text: str) -> Path:
    path = folder / "track.csv"
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.parametrize(
    "text",
    [
        "t,v0,v1\n0,1,0\n0.5,0.5,\n1,0,1\n",
        "t;v0;v1\n0;1;0\n0,5;0,5;\n1;0;1\n",
        "t\tv0\tv1\n\n0\t1\t0\n.5\t.5\t\n1\t0\t1\n",
    ],
)
def test_commas_semicolons_and_tabs_part_columns(tmp_path, text):
    data = load_measured(written(tmp_path, text))
    assert data.columns == ("v0", "v1")
    assert data.time.tolist() == [0.0, 0.5, 1.0]
    assert data.values[:, 0].tolist() == [1.0, 0.5, 0.0]
    assert np.isnan(data.values[1, 1])


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("", "needs a line of names"),
        ("t,v\n0,1\n", "at least two rows"),
        ("0,1\n1,2\n2,3\n", "first line must be names"),
        ("t,v\n0,1\n0,2\n", "times must ascend, but 0 s in row 3 follows 0 s"),
        ("t,v\n0,1\n1,fast\n", "'v' in row 3 is 'fast', not a finite number"),
        ("t,v\n0,1\n1,inf\n", "'v' in row 3 is 'inf'"),
        ("t,v\n0,1\n,2\n", "'t' in row 3 is ''"),
        ("t,v\n0,1\n1,2,3\n", "row 3 has 3 cells, and 2 names"),
    ],
)
def test_what_is_no_table_is_refused_in_a_sentence(tmp_path, text, sentence):
    with pytest.raises(UserError, match=sentence):
        load_measured(written(tmp_path, text))


def test_a_missing_file_and_bytes_are_refused(tmp_path):
    with pytest.raises(UserError, match="cannot read"):
        load_measured(tmp_path / "none.csv")
    (tmp_path / "bytes.csv").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(UserError, match="UTF-8"):
        load_measured(tmp_path / "bytes.csv")
