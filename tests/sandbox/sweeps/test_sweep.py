"""Tests of `sweep`: bitwise equal Datasets by any executor, chunks and resumption; marked failures; disks and files."""

import errno
import os
import signal
import sys
from concurrent.futures import Executor, ThreadPoolExecutor
from functools import partial
from importlib.machinery import ModuleSpec
from itertools import product
from multiprocessing.context import SpawnProcess
from threading import Lock, current_thread, main_thread
from types import ModuleType
from unittest.mock import Mock

import numpy as np
import pytest
from softcradle.physics import Chain, OwnLaw, one_on, power_law, simulate
from softcradle.physics.analysis.collision import collide, measured
from softcradle.physics.scales import require_computable
from softcradle.sandbox.sweeps import Measure, grid, listed, run_sweep, store, sweep
from softcradle.sandbox.sweeps.code_digest import code_digest
from softcradle.sandbox.sweeps.dataset import reasons_of, write_dataset
from softcradle.sandbox.sweeps.executors import MANY, QUEUED, here, place_of, unsendable
from softcradle.sandbox.sweeps.run_sweep import drop_kept, map_points, sweep_status
from softcradle.sandbox.sweeps.store import Store, partial_folder
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


@pytest.fixture(scope="module", autouse=True)
def _loop_of_zarr(tmp_path_factory):
    """Use Zarr once. From its first use it keeps a thread with two sockets."""
    zarr.create_group(tmp_path_factory.mktemp("zarr"))


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
    assert own["contact_time"].attrs == {"units": "ms"}  # Not the unit of the built-in measure with this name.
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
    """Check that no process starts in the main thread. An interruption would leave it half started, with a traceback. A
    process must also ignore interruptions while it starts.
    """
    begun, start = [], SpawnProcess.start

    def noted(process):
        begun.append((current_thread() is main_thread(), signal.pthread_sigmask(signal.SIG_BLOCK, ())))
        start(process)

    monkeypatch.setattr(SpawnProcess, "start", noted)
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
    """Check "auto", which computes the first points in this process and leaves a note for the next start."""
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
    other = Store(partial_folder(output), "a study that was given up")
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
    gone = Mock(side_effect=lambda folder, **_: folder.rmdir())  # It leaves no file that could be moved.
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
    (row,) = map_points(numbers, grid({"a": [0.5], "n": [3]}), kept, executor="here")  # Another study starts again.
    assert (row["product"], partial_folder(kept).is_dir()) == (1.5, True)
    drop_kept(kept)
    assert list(tmp_path.iterdir()) == []


def test_points_of_a_study_arrive_one_by_one(monkeypatch):
    """Check that no point of a study is tried in this process first. Otherwise the other cores would wait for the
    slowest point.
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

    def __call__(self, a: float) -> dict[str, object]:
        return {"y": self.held}


@pytest.mark.parametrize(
    "make",
    [
        lambda n: eval(f"lambda a, n={n}: n"),
        lambda n: eval(f"lambda a: [lambda: 1, lambda: {n}]"),
        lambda n: eval("lambda a: N", {"N": n, "__name__": "own"}),
        lambda n: partial(numbers, np.array([1.0 + 1e-10 * n, 2.0])),
        lambda n: lambda a: n,
        lambda n: Holder(n).__call__,
        lambda n: Holder([one_on(n, power_law(1.0, 0.5))]),
        lambda n: OwnLaw(lambda overlap: n * overlap),
    ],
)
def test_functions_with_other_values_are_other_studies(make):
    assert code_digest(make(4)) == code_digest(make(4)) != code_digest(make(8))


def test_how_values_came_about_makes_no_other_study(caplog):
    assert [*{0, 8}] != [*{8, 0}]  # Like sets of texts, whose order differs between processes.
    assert code_digest({0, 8}) == code_digest({8, 0})
    used = one_on(4, power_law(1.0, 0.5))
    require_computable(used, [1.0] * 5)
    assert code_digest(used) == code_digest(one_on(4, power_law(1.0, 0.5)))
    lock = Lock()
    assert code_digest(lock) != code_digest(lock)
    why = "it holds what cannot be compared (TypeError: cannot pickle '_thread.lock'"
    assert f"is not taken up again: {why}" in caplog.text


@pytest.mark.skipif(os.name == "nt", reason="files are locked otherwise there")
def test_one_sweep_at_a_time(tmp_path):
    first = Store(tmp_path / "kept", "study")
    with pytest.raises(StudyError, match="kept is being written by another sweep"):
        Store(tmp_path / "kept", "study")
    first.close()
    Store(tmp_path / "kept", "study").close()
    (tmp_path / "kept" / "0-3.npz").write_bytes(b"no chunk")
    with pytest.raises(StudyError, match=r"cannot read .*0-3.npz: delete it"):
        Store(tmp_path / "kept", "study")


def test_a_full_disk_loses_no_points(tmp_path, monkeypatch, alone, caplog):
    output = tmp_path / "x.zarr"
    options = {"executor": "here", "output": output, "units": {"product": "m"}}
    full = OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
    monkeypatch.setattr(store, "fsync", Mock(side_effect=[None, None, full, *[None] * 99]))
    with pytest.raises(StudyError, match=r"cannot write .*x.zarr.partial: no space left on device; 2 points are kept"):
        sweep(numbers, GRID, chunk_seconds=0.0, **options)
    assert [path.name for path in tmp_path.iterdir()] == ["x.zarr.partial"]
    for over, units in ({"a": [0.1], "n": [1]}, {"product": "m"}), (GRID, {"product": "mm"}):
        with pytest.raises(StudyError, match=r"x.zarr.partial was begun for another study"):
            sweep(numbers, over, executor="here", output=output, units=units)
    (tmp_path / "x.zarr.partial" / ".2-9.123.part.npz").write_bytes(b"1234")  # A chunk whose writing was interrupted.
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
    assert np.isnan(one["rigidity"]).values.tolist() == [[True, False]]  # Values of the two lanes.
    refused = sweep(lambda k: [k], {"k": [1]}, ["rigidity", "final_velocity"], executor="here")
    assert np.isnan(refused["rigidity"].item())
    assert "final_velocity" not in refused  # The number of beads is unknown.


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
        ((lambda a, n: {}, GRID), {"executor": "processes"}, "cannot compute this: put the function into a module"),
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


def test_a_command_that_is_a_package_gets_processes(tmp_path, monkeypatch):
    """Check `python -m package`. Child processes do not run it again, so they cannot import names of its `__main__`."""
    main = ModuleType("__main__")
    main.__file__, main.__spec__ = str(tmp_path / "__main__.py"), ModuleSpec("package.__main__", None)
    (tmp_path / "__main__.py").write_text("main()")
    exec("def own(*_): return {}", vars(main))
    monkeypatch.setitem(sys.modules, "__main__", main)
    assert unsendable(sweep_work(numbers, GRID, ())) == ""
    own = Measure("own", "", "of the package", "", main.own)
    for work in (sweep_work(main.own, GRID, ()), sweep_work(numbers, GRID, [own])):
        assert unsendable(work) == "what is of `__main__` cannot be imported there, put it into a module"


SCRIPT = """
import os
from softcradle.sandbox.sweeps import sweep
def where(k):
    return {"process": os.getpid()}
if GUARD:
    found = sweep(where, {"k": range(8)}, executor="processes", workers=2)
    print(os.getpid() in found["process"].values.tolist())
"""


@pytest.mark.slow
def test_a_function_of_the_script_itself_gets_processes(tmp_path):
    refused = "each would run all of script.py, put what begins the sweep below `if __name__"
    for guard, code, told in (('__name__ == "__main__"', 0, "False\n"), ("True", 1, refused)):
        (tmp_path / "script.py").write_text(SCRIPT.replace("GUARD", guard))
        done = python("script.py", check=False, cwd=tmp_path, timeout=300)
        assert done.returncode == code, done.stderr
        assert told in done.stdout + done.stderr


def test_threads_in_place_of_processes_are_told_of(monkeypatch, caplog):
    monkeypatch.setattr(run_sweep, "WORTH_PROCESSES", 0.0)
    monkeypatch.setattr(run_sweep, "TRIED_HERE", 0.0)
    found = sweep(lambda k: {"double": 2 * k}, {"k": range(5)}, workers=2)
    assert found["double"].values.tolist() == [0, 2, 4, 6, 8]
    assert "computed in threads of this process, one at a time where that is Python: put the function" in caplog.text


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
    # Points of one shape are computed together, even if other points are between them. Invalid points are computed one
    # by one.
    asked = []
    monkeypatch.setattr(Work, "outcome", lambda _, values: asked.append(values))
    work._at_once(points)
    assert len(asked) == computed_alone
