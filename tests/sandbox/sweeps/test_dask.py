"""Tests of a parameter sweep on a real Dask cluster.

A worker and the scheduler are killed during the sweep, and the sweep must resume.
"""

import os
import socket
import subprocess
import sys
from pathlib import Path

import pytest
from softcradle.sandbox.sweeps import executors, sobol, sweep
from softcradle.sandbox.user_error import StudyError

from tests.helpers.paths import ROOT
from tests.helpers.swept import LOG, logged

json_load_robust = pytest.importorskip("distributed.utils").json_load_robust
# Dask keeps threads and connections open, and the test interrupts connections on purpose. The test therefore runs in a
# separate process.
pytestmark = [pytest.mark.own_process, pytest.mark.filterwarnings("ignore")]

COUNT = 300
POINTS = sobol({"a": (0.0, 1.0), "n": (1, 4, "whole")}, COUNT, seed=5)
QUICK = {"COMM__TIMEOUTS__CONNECT": "20s", "SCHEDULER__WORKER_TTL": "120s", "SCHEDULER__ALLOWED_FAILURES": "3"}


class Cluster:
    """A Dask scheduler and two workers, each in its own process.

    The scheduler uses a free port and writes its address into a file.
    """

    def __init__(self, folder: Path) -> None:
        self._place = folder / "scheduler.json"
        self.processes: list[subprocess.Popen[bytes]] = []
        self.begin()

    def start(self, *words: str) -> subprocess.Popen[bytes]:
        environment = os.environ | {f"DASK_DISTRIBUTED__{name}": value for name, value in QUICK.items()}
        command, options = [sys.executable, *words], {"env": environment | {"PYTHONPATH": str(ROOT)}}
        self.processes.append(subprocess.Popen(command, stdout=subprocess.DEVNULL, **options))
        return self.processes[-1]

    def begin(self) -> None:
        self._place.unlink(missing_ok=True)
        near = ("--scheduler-file", str(self._place), "--host", "127.0.0.1", "--no-dashboard")
        self.start("-m", "distributed.cli.dask_scheduler", *near, "--port", "0")
        self.address = json_load_robust(self._place, timeout=120.0)["address"]
        of_one = ("--nthreads", "1", "--no-nanny", "--death-timeout", "120")
        for _ in range(2):
            self.worker = self.start("-m", "distributed.cli.dask_worker", *near, *of_one)

    def kill(self) -> None:
        for process in self.processes:
            process.kill()
            process.wait()


@pytest.fixture
def cluster(tmp_path, monkeypatch):
    monkeypatch.setenv(LOG, str(tmp_path / "log"))
    found = Cluster(tmp_path)
    yield found
    found.kill()


@pytest.mark.slow
def test_killed_and_resumed_it_is_equal_bit_for_bit(cluster, tmp_path, caplog):
    """Check that a sweep gives bitwise the same result after interruptions.

    First a worker is killed, then the scheduler and all workers. The same sweep is then continued.
    """
    output, log, kept = tmp_path / "swept.zarr", tmp_path / "log", tmp_path / "swept.zarr.partial"
    reached: list[int] = []

    def strike(what: str, done: int, count: int) -> None:
        reached.append(done)
        if done > 0.4 * count and cluster.worker.poll() is None:
            cluster.worker.kill()
        if done > 0.6 * count:
            cluster.kill()

    options = {"output": output, "chunk_seconds": 0.05}
    lost = rf"^lost the scheduler at {cluster.address}; \d+ point(s are| is) kept in .*partial; the"
    with pytest.raises(StudyError, match=lost):
        sweep(logged, POINTS, progress=strike, scheduler=cluster.address, **options)
    assert reached[0] < 0.6 * COUNT < reached[-1] < COUNT
    cluster.begin()
    log.unlink()
    found = sweep(logged, POINTS, scheduler=cluster.address, **options).load()
    assert f"{reached[-1]} of {COUNT} points are in {kept} and not computed again" in caplog.text
    assert not kept.exists()
    assert len(set(log.read_text().splitlines())) == COUNT - reached[-1]
    alone = sweep(logged, POINTS, executor="here")
    for name in alone.variables:
        assert found[name].dtype.kind in (alone[name].dtype.kind, "T", "O")
    assert found.identical(alone)


def test_no_scheduler_is_told_at_once(tmp_path, monkeypatch):
    monkeypatch.setattr(executors, "CONNECT", 0.1)
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        address = f"tcp://127.0.0.1:{free.getsockname()[1]}"
        with pytest.raises(StudyError, match=f"no Dask scheduler answers at '{address}'"):
            sweep(logged, POINTS, output=tmp_path / "x.zarr", scheduler=address)
    # Without the early check, Dask would fail after half a minute with a traceback.
    monkeypatch.setattr("distributed.Client", None)
    with pytest.raises(StudyError, match="no Dask scheduler at 'nonsense': missing port number"):
        sweep(logged, POINTS, output=tmp_path / "x.zarr", scheduler="nonsense")
    assert list(tmp_path.iterdir()) == []
