"""Tests of the function `sweep`, which runs a simulation for many parameter values.

The resulting Dataset must be bitwise equal for every executor, chunk size and resumption. Failed points must be marked.
The tests also check full disks and output files.
"""

import errno
import os
import signal
import sys
from concurrent.futures import Executor, ThreadPoolExecutor
from functools import partial
from itertools import product
from threading import Lock, current_thread, main_thread
from unittest.mock import Mock

import numpy as np
import pytest
from loky.backend.process import LokyProcess
from softcradle.physics import Chain, one_on, power_law, simulate
from softcradle.physics.analysis.collision import collide, measured
from softcradle.sandbox.sweeps import Measure, grid, listed, run_sweep, store, sweep
from softcradle.sandbox.sweeps.dataset import reasons_of, write_dataset
from softcradle.sandbox.sweeps.executors import MANY, QUEUED, here, place_of
from softcradle.sandbox.sweeps.run_sweep import drop_kept, map_points, sweep_status
from softcradle.sandbox.sweeps.store import Store, identity, partial_folder
from softcradle.sandbox.sweeps.work import Outcome, PointStatus, Work, packed, sweep_work
from softcradle.sandbox.user_error import StudyError

from tests.helpers.own_process import python
from tests.helpers.paths import ROOT
from tests.helpers.swept import logged, numbers

xr = pytest.importorskip("xarray")
zarr = pytest.importorskip("zarr")
pytest.importorskip("h5netcdf")

A = np.linspace(0.0, 1.0, 21)
GRID = grid({"a": A, "n": [1, 2, 3]})
ONE_BY_ONE = {"executor": "here", "chunk_seconds": 0.0}


@pytest.fixture(scope="module")
def alone():
    return sweep(numbers, GRID, executor="here", units={"product": "m"})


def test_results_have_their_place_and_failures_their_reason(alone):
    assert alone["product"].dims == ("a", "n")
    np.testing.assert_array_equal(alone["product"][:18], np.outer(A[:18], [1, 2, 3]))
    np.testing.assert_array_equal(alone["powers"].sel(n=3)[4], A[4] ** np.arange(3))
    assert np.isnan(alone["powers"].sel(n=2)[4, 2])
    assert alone["product"].attrs["units"] == "m"
    own = sweep(lambda k: {"contact_time": k}, {"k": [1]}, executor="here", units={"contact_time": "ms"})
    # The given unit replaces the unit of the built-in measure with the same name.
    assert own["contact_time"].attrs == {"units": "ms"}
    assert {"softcradle", "numpy", "python", "scipy", "source", "study"} <= alone.attrs.keys()
    failed = A > 0.9
    assert (alone["status"].to_numpy() == np.where(failed, PointStatus.REFUSED, PointStatus.DONE)[:, None]).all()
    assert alone["reason"].sel(n=2)[-1] == "a must be at most 0.9, not 1"
    assert (alone["reason"][:18] == "").all()
    assert np.isnan(alone["product"].to_numpy()[failed]).all()
    assert alone["status"].attrs["flag_meanings"].split()[PointStatus.REFUSED] == "refused"


def test_non_numbers_are_marked_and_booleans_kept(tmp_path):
    found = sweep(lambda k: {"y": [1.0, "one", np.array([1j])][k]}, {"k": range(3)}, executor="here")
    refused = "'y' must be a number or a list of numbers, not "
    assert found["reason"].values.tolist() == ["", f"{refused}'one'", f"{refused}array([0.+1.j])"]
    with sweep(lambda k: {"y": k}, {"k": [False, True]}, executor="here", output=tmp_path / "x.nc") as found:
        assert (found["k"].dtype, found["y"].values.tolist()) == (bool, [0.0, 1.0])


@pytest.mark.parametrize(
    "kind", ["threads", "executor", "one by one", pytest.param("processes", marks=pytest.mark.slow)]
)
@pytest.mark.parametrize("output", [None, "x.zarr", "x.nc"])
def test_it_is_equal_however_it_is_computed(kind, output, alone, tmp_path):
    path = tmp_path / output if output else None
    options = {"output": path, "units": {"product": "m"}}
    with ThreadPoolExecutor(2) as pool:
        own = {"executor": {"executor": pool, "chunk_seconds": 1e-4}, "one by one": ONE_BY_ONE}
        settings = own.get(kind, {"executor": kind, "workers": 3, "chunk_seconds": 1e-5})
        found = sweep(numbers, GRID, **settings, **options)
    assert found.load().identical(alone)
    assert [p.name for p in tmp_path.iterdir()] == ([output] if output else [])
    found.close()


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="no signal is blocked there")
def test_no_process_is_begun_in_the_thread_that_hears_an_interruption(monkeypatch):
    """Check that no child process is started in the main thread, which receives Ctrl+C.

    An interruption could leave such a process half started and print a traceback. A child process must also ignore
    interruptions while it starts.
    """
    begun, start = [], LokyProcess.start

    def noted(process):
        begun.append((current_thread() is main_thread(), signal.pthread_sigmask(signal.SIG_BLOCK, ())))
        start(process)

    monkeypatch.setattr(LokyProcess, "start", noted)
    sweep(numbers, {"a": [0.5], "n": [1]}, executor="processes", workers=1)
    assert begun == [(False, {signal.SIGINT})]


DEADLY = """
import sys
from softcradle.sandbox.sweeps import grid, sweep
from tests.helpers.swept import deadly
few = grid({"a": [0.5, 0.25], "n": [3, 2]})
found = sweep(deadly, few, output=sys.argv[1], executor=sys.argv[2], workers=2, chunk_seconds=1e-3)
print(*(found[name].to_numpy().ravel().tolist() for name in ("status", "product")), found["reason"].to_numpy()[0, 0])
"""


@pytest.mark.slow
def test_a_point_that_kills_its_process_is_marked(tmp_path):
    """Check that a point that kills its process is marked as failed.

    The executor "auto" computes the first points in the main process. The main process writes a note about the current
    point. The next start of the sweep reads this note.
    """
    x, y = (str(tmp_path / name) for name in ("x.nc", "y.nc"))
    options = {"check": False, "timeout": 300, "PYTHONPATH": str(ROOT)}
    died, *others = (python("-c", DEADLY, *words, **options) for words in ((x, "auto"), (x, "auto"), (y, "processes")))
    assert died.returncode == -signal.SIGKILL
    for done in others:
        assert done.stdout == "[6, 0, 0, 0] [nan, 1.0, 0.75, 0.5] the process that computed it died, 3 times\n"
        assert "point 0 is lost" in done.stderr
    assert sorted(str(path) for path in tmp_path.iterdir()) == [x, y]


@pytest.mark.parametrize("fresh", [True, False])
@pytest.mark.parametrize("replaced", [[0.7], [0.5, 0.6]], ids=["another study", "the same study"])
def test_a_fresh_sweep_keeps_the_old_output_until_it_is_done(replaced, fresh, tmp_path, monkeypatch, caplog):
    log = tmp_path / "log"
    monkeypatch.setenv("SWEPT_LOG", str(log))
    stop = Mock(side_effect=[None, KeyboardInterrupt])
    output, before, points = tmp_path / "x.zarr", {"a": replaced, "n": [1]}, {"a": [0.5, 0.6], "n": [1]}
    sweep(logged, before, output=output, executor="here").close()
    log.unlink()
    other = Store(partial_folder(output), "a study that was given up", 1)
    other.keep(packed(0, [Outcome({"y": 1.0})]))
    other.close()
    with pytest.raises(KeyboardInterrupt):
        sweep(logged, points, output=output, fresh=True, progress=stop, **ONE_BY_ONE)
    assert f"1 point is kept in {output}.partial; the same sweep goes on from there" in caplog.text
    assert zarr.open_group(output)["product"][:].ravel().tolist() == replaced
    told = "and no sweep is at it, the same command goes on"
    assert sweep_status(logged, points, (), output) == (0, f"1 of 2 points are in {output}.partial, {told}")
    with sweep(logged, points, output=output, fresh=fresh, **ONE_BY_ONE) as found:
        assert found["product"].values.ravel().tolist() == [0.5, 0.6]
    assert len(log.read_text().splitlines()) == 2
    assert sorted(path.name for path in tmp_path.iterdir()) == ["log", "x.zarr"]


def test_a_dataset_that_cannot_be_written_leaves_the_one_before(tmp_path, monkeypatch):
    output = tmp_path / "x.zarr"
    sweep(numbers, {"a": [0.5], "n": [1]}, output=output, executor="here").close()
    new = sweep(numbers, {"a": [0.7], "n": [1]}, executor="here")
    # This mock writes no file, so there is nothing to move to the output path.
    gone = Mock(side_effect=lambda folder, **_: folder.rmdir())
    for written in (Mock(side_effect=OSError(errno.ENOSPC, "full")), gone):
        with monkeypatch.context() as patched:
            patched.setattr(xr.Dataset, "to_zarr", written)
            with pytest.raises(OSError, match=r"full|No such file|cannot find"):
                write_dataset(new, output)
        assert zarr.open_group(output)["product"][:].tolist() == [[0.5]]
    write_dataset(new, output)
    assert zarr.open_group(output)["product"][:].tolist() == [[0.7]]
    assert list(tmp_path.iterdir()) == [output]


def test_an_invalid_output_path_is_rejected_early(tmp_path):
    (tmp_path / "x.zarr").touch()
    (tmp_path / "x.nc").mkdir()
    (tmp_path / "link.zarr").symlink_to(tmp_path / "x.nc")
    (tmp_path / "link.nc").symlink_to(tmp_path / "other")
    sentences = {"x.zarr": "x.zarr: it is a file", "x.nc": "x.nc: it is a folder", "link.zarr": "x.nc: it is a folder"}
    if hasattr(os, "mkfifo"):
        os.mkfifo(tmp_path / "pipe.nc")
        sentences["pipe.nc"] = "it is a pipe"
    for name, sentence in (sentences | {"link.nc": "must end in .zarr or .nc, not .*other"}).items():
        with pytest.raises(StudyError, match=sentence):
            sweep(lambda a: pytest.fail("computed"), {"a": [1]}, output=tmp_path / name, executor="here", fresh=True)


def test_an_output_link_is_followed(tmp_path):
    (tmp_path / "far").mkdir()
    for name in ("x.zarr", "x.nc"):
        (tmp_path / name).symlink_to(tmp_path / "far" / name)
        for a in (0.5, 0.7):
            with sweep(numbers, {"a": [a], "n": [1]}, output=tmp_path / name, executor="here", fresh=True) as found:
                assert found["product"].item() == a
        assert (tmp_path / name).is_symlink()
    assert sorted(path.name for path in (tmp_path / "far").iterdir()) == ["x.nc", "x.zarr"]


def test_a_failed_point_ends_a_study_and_is_repeated(tmp_path):
    kept, points = tmp_path / "kept", grid({"a": [0.5, 0.95], "n": [2]})
    for _ in range(2):
        with pytest.raises(StudyError, match=r"^a 0.95, n 2: a must be at most 0.9, not 0.95; 1 point is kept in"):
            map_points(numbers, points, kept, executor="here", chunk_seconds=0.0)
    # A different study starts from the beginning.
    (row,) = map_points(numbers, grid({"a": [0.5], "n": [3]}), kept, executor="here")
    assert (row["product"], partial_folder(kept).is_dir()) == (1.5, True)
    drop_kept(kept)
    assert list(tmp_path.iterdir()) == []


def test_points_of_a_study_arrive_one_by_one(monkeypatch):
    """Check that the first point of a study is not computed in the main process.

    Otherwise the other processor cores would wait for the slowest point.
    """
    begun, taken = [], []
    options = {"workers": 2, "chunk_seconds": 0.0, "each": lambda number, row: taken.append((number, row["product"]))}
    monkeypatch.setattr(run_sweep, "processes_or_threads", lambda work, _: begun.append(work) or here(work))
    for alike in (True, False):
        assert len(map_points(numbers, grid({"a": [0.5], "n": [2, 3]}), alike=alike, **options)) == 2
        assert len(begun) == (not alike)
    assert taken == [(0, 1.0), (1, 1.5)] * 2


class Holder:
    def __init__(self, held: object) -> None:
        self.held = held

    def call(self, a: float) -> dict[str, object]:
        return {"y": self.held}


@pytest.mark.parametrize(
    "make",
    [
        lambda n: partial(numbers, np.array([1.0 + 1e-10 * n, 2.0])),
        lambda n: partial(partial(numbers, n), 1),
        lambda n: Holder(n).call,
        lambda n: Holder([one_on(n, power_law(1.0, 0.5))]).call,
        lambda n: eval(f"lambda a: {'a' * n}"),  # The source text of a function entered at a Python prompt is unknown.
        lambda n: numbers if n == 4 else logged,
    ],
)
def test_functions_with_other_text_or_other_bound_values_are_other_studies(make):
    assert identity(make(4)) == identity(make(4)) != identity(make(8))


def test_another_version_of_a_function_is_another_study(tmp_path):
    factor, output = [1.0], tmp_path / "x.zarr"

    def scaled(a):
        return {"y": factor[0] * a}

    for version, factor[0], expected in ((1, 1.0, 3.0), (1, 2.0, 3.0), (2, 2.0, 6.0)):
        with sweep(scaled, {"a": [3.0]}, output=output, executor="here", version=version, fresh=version == 2) as found:
            assert found["y"].item() == expected
    with pytest.raises(StudyError, match="holds another study, or one by another version"):
        sweep(scaled, {"a": [3.0]}, output=output, executor="here", version=3)


def test_one_sweep_at_a_time(tmp_path):
    first = Store(tmp_path / "kept", "study", 3)
    with pytest.raises(StudyError, match="kept is being written by another sweep"):
        Store(tmp_path / "kept", "study", 3)
    first.close()
    Store(tmp_path / "kept", "study", 3).close()


def test_a_damaged_store_is_reported(tmp_path):
    first = Store(tmp_path / "kept", "study", 3)
    first.keep(packed(0, [Outcome({"y": 1.0})]))
    first.close()
    (tmp_path / "kept" / "points" / "y" / "0").write_bytes(b"no chunk")
    with pytest.raises(StudyError, match=r"cannot read .*kept .*: delete it"):
        Store(tmp_path / "kept", "study", 3)


def test_a_full_disk_loses_no_points(tmp_path, monkeypatch, alone, caplog):
    output = tmp_path / "x.zarr"
    options = {"executor": "here", "output": output, "units": {"product": "m"}}
    full = OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
    # Writing the third point fails because the disk is full.
    monkeypatch.setattr(store, "fsync", Mock(side_effect=[*[None] * 7, full, *[None] * 999]))
    with pytest.raises(StudyError, match=r"cannot write .*x.zarr.partial: no space left on device; 2 points are kept"):
        sweep(numbers, GRID, chunk_seconds=0.0, **options)
    assert [path.name for path in tmp_path.iterdir()] == ["x.zarr.partial"]
    for over, units in ({"a": [0.1], "n": [1]}, {"product": "m"}), (GRID, {"product": "mm"}):
        with pytest.raises(StudyError, match=r"x.zarr.partial was begun for another study"):
            sweep(numbers, over, executor="here", output=output, units=units)
    # This file imitates an interrupted write.
    (tmp_path / "x.zarr.partial" / "points" / "product" / "0.123.partial").write_bytes(b"1234")
    begun: list[int] = []
    options["executor"] = "threads"
    with sweep(numbers, GRID, progress=lambda _, done, __: begun.append(done), **options) as found:
        assert found.load().identical(alone)
    assert begun[0] == 2
    assert f"2 of 63 points are in {output}.partial and not computed again" in caplog.text
    assert list(tmp_path.iterdir()) == [output]


@pytest.mark.parametrize(
    ("methods", "fineness"), [(["accurate", "auto"], {"tolerance": 1e-3}), (["conserving"], {"step": 1e-3})]
)
def test_a_swept_scene_agrees_with_simulate(methods, fineness):
    over = {"lanes.0.contact.alpha": [0.5, 1.5], "lanes.0.beads.1": [2, 3], "method": methods}
    (name, value), *_ = fineness.items()
    measures = ["final_velocity", "rigidity", "contact_time", "peak_force", "contact_peak_force"]
    found = sweep("one-on-four", over | {name: [value]}, measures, executor="here").squeeze(name)
    assert found["final_velocity"].dims == (*over, "bead")
    assert found["final_velocity"].attrs["units"] == "m/s"
    for alpha, n, method in product(*over.values()):
        point = found.sel(dict(zip(over, (alpha, n, method), strict=True)))
        chain = Chain([1.0] * (n + 1), power_law(1.0, alpha), [1.0] + [0.0] * (n - 1))
        start, fine = (chain, [1] + [0] * n), {"method": method, **fineness}
        run, collision = simulate(*start, **fine, samples=2), measured(collide(*start, **fine))
        np.testing.assert_array_equal(point["final_velocity"][: n + 1], run.final_velocity)
        ((closed, opened),) = run.contact_intervals[0]
        assert point["contact_time"].item() == pytest.approx(opened - closed, rel=1e-12)
        assert point["rigidity"] == np.ptp(run.final_velocity[1:]) / run.final_velocity[1:].mean()
        assert point["peak_force"] == collision.peak_force
        assert point["contact_peak_force"][:n].values.tolist() == [one.peak_force for one in collision.contacts]


@pytest.mark.parametrize(
    "settings",
    [{"duration": 0.5, "tolerance": 1e-6}, {"duration": 3.0, "method": "verlet", "step": 0.01}, {"tolerance": 1e-3}],
)
def test_a_trajectory_is_measured_like_its_scene(settings):
    measures = ["end", "peak_force", "momentum", "energy_inside", "rigidity_at_detachment", "steps"]
    start = one_on(2, power_law(1.0, 1.0)), [1.0, 0.0, 0.0]
    makes = lambda k: simulate(*start, **settings), lambda k: (*start, settings)
    both = [sweep(make, {"k": [0]}, measures, executor="here") for make in makes]
    for name in measures:
        np.testing.assert_array_equal(*(found[name] for found in both), err_msg=name)
    cut = sweep(lambda k: simulate(*start, samples=[0.0, 0.5]), {"k": [0]}, ["end"], executor="here")
    assert cut["reason"].item() == "the samples of a Trajectory that is measured must begin and end with its run"


def test_a_measure_that_cannot_be_taken_leaves_the_others():
    def share(run):
        if run.start.velocity[0] == 0.5:
            raise RuntimeError("half")
        return 1.0

    measures = ["final_velocity", "rigidity", Measure("share", "", "of the speed", "", share), "contact_turns"]
    found = sweep("one-on-four", {SPEED: [1.0, 0.5, -1.0]}, measures, executor="here")
    apart = (
        "rigidity, contact_turns: no two neighbours approach each other at the start: there is no collision to measure"
    )
    assert found["reason"].values.tolist() == ["", "share: RuntimeError: half", apart]
    assert (found["status"] <= PointStatus.SEPARATED).all()
    assert np.isfinite(found["final_velocity"]).all()
    assert np.isnan(found["rigidity"]).values.tolist() == [False, False, True]
    assert np.isnan(found["share"]).values.tolist() == [False, True, False]
    assert np.isnan(found["contact_turns"]).any("contact").values.tolist() == [False, False, True]
    assert sorted(reasons_of(found)) == [(apart, 1), ("share: RuntimeError: half", 1)]


def test_a_run_that_cannot_be_is_refused_whatever_is_measured():
    start, known = (one_on(2, power_law(1.0, 1.0)), [1.0, 0.0, 0.0]), Measure("known", "", "", "", lambda _: 1.0)
    found = sweep(lambda k: (*start, {"tolerance": k}), {"k": [1e-3, -1.0]}, [known, "end"], executor="here")
    assert found["status"].values.tolist() == [PointStatus.SEPARATED, PointStatus.REFUSED]
    assert np.isnan(found["known"]).values.tolist() == [False, True]


def test_a_measure_that_no_point_has_is_there_without_numbers():
    none = sweep("one-on-four", {SPEED: [-1.0, -2.0]}, ["rigidity", "contact_turns", "end"], executor="here")
    assert list(none.data_vars)[:3] == ["rigidity", "contact_turns", "end"]
    assert (none["rigidity"].dims, none["contact_turns"].shape) == ((SPEED,), (2, 4))
    assert np.isnan(none["contact_turns"]).all()
    one = sweep("weak-contact", {SPEED: [-1.0]}, ["rigidity", "restitution", "closings"], executor="here")
    # The array contains one value for each of the two rows of beads.
    assert np.isnan(one["rigidity"]).values.tolist() == [[True, False]]
    refused = sweep(lambda k: [k], {"k": [1]}, ["rigidity", "final_velocity"], executor="here")
    assert np.isnan(refused["rigidity"].item())
    # The array of final velocities is missing, because the number of beads is unknown.
    assert "final_velocity" not in refused


@pytest.mark.parametrize(
    ("scene", "over", "wrong"),
    [
        (
            "one-on-four",
            {"lanes.0.approach": [1.0, -0.5, np.nan, 1.0, 1.0], "lanes.0.mass.2": [1.0, 1.0, 1.0, np.inf, 2.0]},
            {
                1: "approach must be greater than or equal to 0, not -0.5",
                2: "approach must be a finite number, not nan",
            },
        ),
        (
            "train-solid",
            {"lanes.0.contact.push.loss": [0.5, 2.0, 0.7], "duration": [0.1] * 3},
            {1: "contact.push.loss must be less than 1, not 2.0"},
        ),
        ("one-on-four", {"lanes.0.beads.1": [4, 2.5, 4]}, {1: "beads[1] must be a whole number, not 2.5"}),
        ("one-on-four", {"lanes.0.beads.1": [4, 4.0, 4]}, {1: "beads[1] must be a whole number, not 4.0"}),
    ],
)
def test_every_value_of_a_list_is_checked(scene, over, wrong):
    found = sweep(scene, listed(over), ["end"], executor="here")
    told = {number: f"the scene: lanes[0].{reason}" for number, reason in wrong.items()}
    assert {number: reason for number, reason in enumerate(found["reason"].values) if reason} == told
    assert np.flatnonzero(np.isnan(found["end"])).tolist() == [*wrong]
    assert all(found[path].dtype == np.float64 for path in over)


@pytest.mark.parametrize(
    ("arguments", "options", "sentence"),
    [
        ((numbers, {"status": [1]}), {}, "a parameter cannot be called 'status'"),
        (("one-on-four", {"lanes.0.mass": [1.0]}), {}, "needs at least one measure"),
        (("one-on-four", {"lanes.0.mass": [1.0, -1.0]}, ["end"]), {}, "mass must be greater than 0, not -1"),
        ((numbers, GRID), {"output": "nowhere/x.nc"}, "there is no folder"),
        ((numbers, GRID), {"executor": "nobody"}, "executor must be auto, here, threads, processes"),
        ((numbers, GRID), {"workers": 0}, "workers must be at least 1, not 0"),
        (
            (partial(numbers, n=Lock()), GRID),
            {"executor": "processes"},
            "cannot compute this: cannot pickle '_thread.lock",
        ),
        ((numbers, {"a": [True, 2]}), {"output": "x.nc"}, "a: an output takes .* or all texts, not bool, int"),
        ((lambda a: {"v/c": a}, {"a": [1]}), {"output": "x.zarr"}, "a measure cannot be called 'v/c'"),
        ((lambda a: {"a": a}, {"a": [1]}), {"output": "x.zarr"}, "a measure cannot be called 'a'"),
        ((lambda a: {"y": [a], "y_item": a}, {"a": [1]}), {"output": "x.zarr"}, "a measure cannot be called 'y_item'"),
        (
            (lambda a: {"y": a if a else [a]} if a < 2 else pytest.fail("late"), {"a": range(3)}),
            ONE_BY_ONE,
            "a number at one point and a list at another",
        ),
    ],
)
def test_invalid_sweeps_are_rejected_early(arguments, options, sentence, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(ValueError, match=sentence):
        sweep(*arguments, **options)
    assert list(tmp_path.iterdir()) == []


def test_an_executor_of_the_caller_is_given_as_much_as_it_has_workers():
    work = sweep_work(numbers, GRID, ())
    with ThreadPoolExecutor(32) as pool:
        for executor, workers, room in ((pool, None, 32), (pool, 3, 3), (Executor(), None, MANY)):
            place = place_of(work, executor, None, workers)
            assert place is not None
            assert place.room() == QUEUED * room


SCRIPT = """
import os
from softcradle.sandbox.sweeps import sweep
def where(k):
    return {"process": os.getpid(), "helped": helper(k)}
helper = lambda k: 2 * k
found = sweep(where, {"k": range(8)}, executor="processes", workers=2)
print(os.getpid() in found["process"].values.tolist(), found["helped"].values.tolist())
"""


@pytest.mark.slow
@pytest.mark.parametrize("words", [["script.py"], ["-m", "script"], ["-c", SCRIPT]], ids=["script", "module", "prompt"])
def test_a_function_of_the_script_itself_gets_processes(words, tmp_path):
    (tmp_path / "script.py").write_text(SCRIPT)
    done = python(*words, check=False, cwd=tmp_path, timeout=300, PYTHONPATH=str(ROOT))
    assert done.stdout == "False [0.0, 2.0, 4.0, 6.0, 8.0, 10.0, 12.0, 14.0]\n", done.stderr


def test_a_function_that_cannot_be_sent_gets_threads(monkeypatch, caplog):
    monkeypatch.setattr(run_sweep, "WORTH_PROCESSES", 0.0)
    monkeypatch.setattr(run_sweep, "TRIED_HERE", 0.0)
    lock = Lock()
    found = sweep(lambda k: {"double": 2 * k + lock.locked()}, {"k": range(5)}, workers=2)
    assert found["double"].values.tolist() == [0, 2, 4, 6, 8]
    why = "other processes cannot compute this: cannot pickle '_thread.lock' object"
    assert f"computed in threads of this process: {why}" in caplog.text


SPEED = "lanes.0.velocity.0"


@pytest.mark.parametrize(
    ("scene", "over", "computed_alone"),
    [
        ("draft-gear-one-on-three", {"lanes.0.mass.0": [0.5, 0.7, -1.0, 1.0, 2.0], SPEED: [0.5, 1.0, 2.0]}, 3),
        ("one-on-four", {"lanes.0.contact.alpha": [0.1, 0.11, 0.12, 0.4], SPEED: [1.0, 1.1]}, 0),
        ("one-on-four", {SPEED: [1.0, 1.2, 1.4, 1.6], "lanes.0.beads.1": [3, 4]}, 0),
        ("one-on-four", {SPEED: [-1.0, 0.0, 1.0, 2.0]}, 0),
    ],
    ids=["gears, and a mass that cannot be", "motions of several runs", "chains of two shapes", "no blow to measure"],
)
def test_points_computed_together_have_the_same_digits(scene, over, computed_alone, monkeypatch):
    measures = ("final_velocity", "velocity_error", "end", "steps", "evaluations", "rigidity")
    work = sweep_work(scene, grid(over), measures)
    columns = {path: values.tolist() for path, values in work.points.columns(0, work.points.count).items()}
    points = [dict(zip(columns, values, strict=True)) for values in zip(*columns.values(), strict=True)]
    alone, beside = packed(0, [*map(work.outcome, points)]), packed(0, work._at_once(points))
    for name, column in alone.columns.items():
        np.testing.assert_array_equal(beside.columns[name], column, err_msg=name)
    # Points with the same shape are computed together, even if other points are between them. Invalid points are
    # computed one by one.
    asked = []
    monkeypatch.setattr(Work, "outcome", lambda _, values: asked.append(values))
    work._at_once(points)
    assert len(asked) == computed_alone
