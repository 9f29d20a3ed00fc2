"""Tests of trajectories on disk. A trajectory must be equal after reading, and readable without softcradle. A file must
be written completely or not at all.
"""

import json
import math
import os
from dataclasses import fields, replace
from unittest.mock import Mock

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from softcradle.physics import Trajectory, hertz, one_on, power_law, simulate
from softcradle.physics.atomic_files import output_file, output_folder
from softcradle.physics.status import CodedWarning, Status, WarningCode

from tests.helpers.motions import CASES, solved


@pytest.fixture(scope="module")
def collision() -> Trajectory:
    return simulate(one_on(3, [hertz(1.0), power_law(1.0, 0.1), power_law(2.0, 0.2)]), [1, 0, 0, 0], samples=31)


def assert_equal(one: Trajectory, other: Trajectory) -> None:
    for field in fields(Trajectory):
        ours, theirs = getattr(one, field.name), getattr(other, field.name)
        if isinstance(ours, np.ndarray):
            assert ours.dtype == theirs.dtype
            np.testing.assert_array_equal(ours, theirs, err_msg=field.name)
        else:
            assert type(ours) is type(theirs)
            assert ours == theirs, field.name


@given(data=st.data())
@settings(max_examples=40, deadline=None)
def test_any_numbers_and_texts_are_read_back_equal(data, tmp_path_factory):
    collision = simulate(one_on(2, hertz(1.0)), [1, 0, 0], samples=3)
    number = st.floats(allow_nan=False)
    intervals = st.lists(st.tuples(number, number | st.just(math.inf)), max_size=3)
    warning = st.builds(CodedWarning, st.sampled_from(WarningCode), st.text())
    rows = {
        name: data.draw(arrays(float, getattr(collision, name).shape, elements=number))
        for name in ("time", "overlap", "rate", "anchor", "force", "final_velocity")
    }
    made = replace(
        collision, **rows, method=data.draw(st.text()), step=data.draw(number), choice=data.draw(st.text()),
        contact_intervals=tuple(tuple(data.draw(intervals)) for _ in range(2)),
        steps=data.draw(st.integers(0, 10**12)), status=data.draw(st.sampled_from(Status)),
        warnings=tuple(data.draw(st.lists(warning, max_size=2))),
    )  # fmt: skip
    path = tmp_path_factory.mktemp("any") / "one.npz"
    with np.errstate(all="ignore"):  # The positions in this test are sums of arbitrary numbers, so they can overflow.
        made.save(path)
    assert_equal(Trajectory.load(path), made)


def test_file_needs_no_pickle_and_says_what_made_it(collision, tmp_path):
    collision.save(tmp_path / "one.npz")
    with np.load(tmp_path / "one.npz", allow_pickle=False) as file:
        metadata = json.loads(str(file["metadata"]))
        np.testing.assert_array_equal(file["velocity"], collision.velocity)
        np.testing.assert_array_equal(file["position"], collision.position)
        assert file["contact_intervals"].shape[1] == 3
    assert metadata["method"] == collision.method
    assert metadata["step"] == collision.step
    assert metadata["chain"]["contact"][0] == {"preload": 0.0, "stiffness": 1.0, "exponent": 1.5, "loss": 0.0}
    assert set(metadata["versions"]) == {"softcradle", "numpy", "python"}


@pytest.mark.parametrize("name", [name for name in CASES if not CASES[name].chain.own_laws])
def test_whatever_a_chain_has_is_read_back(name, tmp_path):
    made = solved(CASES[name], "conserving")
    made.save(tmp_path / "one.npz")
    assert_equal(Trajectory.load(tmp_path / "one.npz"), made)


def test_csv_has_a_row_a_sample_and_units(tmp_path):
    made = solved(CASES["gears on straws"], "conserving")
    made.to_csv(tmp_path / "one.csv")
    header = (tmp_path / "one.csv").read_text(encoding="utf-8").splitlines()[0].split(",")
    column = dict(zip(header, np.loadtxt(tmp_path / "one.csv", delimiter=",", skiprows=1).T, strict=True))
    assert header[0] == "time [s]"
    np.testing.assert_array_equal(column["time [s]"], made.time)
    np.testing.assert_array_equal(column["velocity 2 [m/s]"], made.velocity[:, 2])
    np.testing.assert_array_equal(column["force 0-1 [N]"], made.force[:, 0])
    np.testing.assert_array_equal(column["momentum [N s]"], made.momentum)
    energy = column["kinetic energy [J]"] + column["contact energy [J]"]
    np.testing.assert_array_equal(energy, made.kinetic_energy + made.contact_energy)
    assert made.absorbed_by_contacts[-1] > 0.0
    np.testing.assert_array_equal(column["absorbed by contacts [J]"], made.absorbed_by_contacts)
    np.testing.assert_array_equal(column["absorbed by bed [J]"], made.absorbed_by_bed)


@pytest.mark.parametrize(
    ("content", "sentence"),
    [
        *((content, r"other\.npz: not a trajectory") for content in (b"", b"not a zip file", b"PK\x03\x04 torn")),
        ({"a": np.zeros(3)}, "not a trajectory"),
        ({"metadata": np.array(json.dumps({"format": 99}))}, "format 99"),
    ],
)
def test_other_files_and_later_formats_are_rejected(content, sentence, tmp_path):
    path = tmp_path / "other.npz"
    if isinstance(content, dict):
        np.savez(path, **content)
    else:
        path.write_bytes(content)
    with pytest.raises(ValueError, match=sentence):
        Trajectory.load(path)


def test_incomplete_files_and_unknown_codes_are_handled(collision, tmp_path):
    path = tmp_path / "torn.npz"
    replace(collision, warnings=(CodedWarning(WarningCode.SENSITIVE, "so so", {}),)).save(path)
    with np.load(path) as file:
        content = dict(file)
    metadata = json.loads(str(content.pop("metadata")))
    metadata["warnings"][0]["code"] = "novel"
    np.savez(path, **content, metadata=json.dumps(metadata))
    assert Trajectory.load(path).warnings == (CodedWarning(WarningCode.UNKNOWN, "so so", {}),)
    no_chain = {name: value for name, value in metadata.items() if name != "chain"}
    no_intervals = {name: value for name, value in content.items() if name != "contact_intervals"}
    for arrays_left, said in ((content, no_chain), (no_intervals, metadata)):
        np.savez(path, **arrays_left, metadata=json.dumps(said))
        with pytest.raises(ValueError, match=r"torn\.npz: not a trajectory"):
            Trajectory.load(path)


def test_a_file_with_damaged_bytes_is_refused_in_a_sentence(collision, tmp_path):
    collision.save(tmp_path / "a.npz")
    content = (tmp_path / "a.npz").read_bytes()
    refusals = []
    for at in range(100, len(content), len(content) // 40):
        damaged = bytes(255 - byte for byte in content[at : at + 4])
        (tmp_path / "b.npz").write_bytes(content[:at] + damaged + content[at + 4 :])
        try:
            Trajectory.load(tmp_path / "b.npz")
        except ValueError as error:
            refusals.append(str(error))
    assert len(refusals) > 20
    assert all("not a trajectory" in refusal for refusal in refusals)


def test_two_that_write_one_file_are_not_in_each_others_way(collision, tmp_path):
    path = tmp_path / "one.npz"
    with output_file(path) as first, output_file(path) as second:
        assert first != second
        assert first.parent == second.parent == tmp_path
    collision.save(path)
    assert list(tmp_path.iterdir()) == [path]
    assert Trajectory.load(path).steps == collision.steps


def test_failed_write_leaves_the_old_file(collision, tmp_path, monkeypatch):
    path = tmp_path / "one.npz"
    path.write_bytes(b"old")
    monkeypatch.setattr(np, "savez_compressed", Mock(side_effect=OSError(28, "No space left on device")))
    with pytest.raises(OSError, match="No space"):
        collision.save(path)
    assert path.read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [path]


def test_folder_appears_whole_or_not_at_all(tmp_path):
    target = tmp_path / "frames"
    with pytest.raises(RuntimeError, match="no ink"), output_folder(target) as temporary:  # noqa: PT012
        (temporary / "1.png").write_bytes(b"one")
        raise RuntimeError("no ink")
    assert list(tmp_path.iterdir()) == []
    with output_folder(target) as temporary:
        (temporary / "1.png").write_bytes(b"one")
        assert not target.exists()
    assert [path.name for path in target.iterdir()] == ["1.png"]


@pytest.mark.parametrize("name", ["film.mp4", "f" * 251 + ".mp4"], ids=["usual", "longest"])
def test_an_output_file_has_the_usual_permissions(name, tmp_path):
    (tmp_path / "usual").write_bytes(b"")
    with output_file(tmp_path / name) as temporary:
        assert temporary.suffix == ".mp4"
        temporary.write_bytes(b"film")
    assert (tmp_path / name).stat().st_mode == (tmp_path / "usual").stat().st_mode


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="this system has no pipes with names")
def test_a_pipe_stays_and_the_whole_file_goes_through_it(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    reader = os.open(tmp_path / "pipe", os.O_RDWR | os.O_NONBLOCK)
    with output_file(tmp_path / "pipe") as temporary:
        temporary.write_bytes(b"film")
    assert os.read(reader, 9) == b"film"
    os.close(reader)
