"""A process of its own for the runs: a kernel that goes on for ever can only be stopped with its process."""

from __future__ import annotations

import multiprocessing
import signal
from collections.abc import Sequence
from dataclasses import replace
from multiprocessing.connection import Connection
from typing import Any

from softcradle.physics import Chain, Contact

from benchmarks.golden.golden_run import ADAPTIVE, Run, Table, answer, hexed, written


class Worker:
    """Answers runs in a forked process, which ends by itself when one of them takes more than `limit` [s]."""

    def __init__(self) -> None:
        self._start()

    def _start(self) -> None:
        context = multiprocessing.get_context("fork")  # the kernels that `warm_up` has loaded are there at once
        self.connection, other = context.Pipe()
        self.process: Any = context.Process(target=_serve, args=(other,), daemon=True)
        self.process.start()
        other.close()

    def __call__(self, run: Run, limit: float) -> Table:
        """The answer, or that it was slow."""
        self.connection.send((run, limit))
        try:
            found: Table = self.connection.recv()
        except (EOFError, ConnectionResetError):
            self.process.join()
            killed = self.process.exitcode == -signal.SIGPROF
            status = "slow" if killed else f"error: the process ended with {self.process.exitcode}"
            self._start()
            return {"status": status}
        return found


def _serve(connection: Connection) -> None:
    signal.signal(signal.SIGPROF, signal.SIG_DFL)  # ends the process
    while True:
        try:
            run, limit = connection.recv()
        except EOFError:
            return
        signal.setitimer(signal.ITIMER_PROF, limit)
        found = answer(run)
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        connection.send(found)


def warm_up(methods: Sequence[str]) -> None:
    """Load or compile every kernel before a clock runs."""
    laws = [Contact(0.0, 1.0, 0.1), Contact(0.5, 100.0, 1.0)]
    lossy = [replace(law, loss=0.5) for law in laws]
    for contacts, friction in ((laws, 0.0), (lossy, 0.0), (laws, 0.1), (lossy, 0.1)):
        for drive in (None, [0.1, 0.0, 0.0]):
            chain = written(Chain([1.0, 2.0, 1.0], contacts, 0.0, drive, friction), [1.0, 0.0, 0.0])
            for method in methods:
                step = None if method in ADAPTIVE else 0.01
                answer(Run(chain, method, 0.5, step))
                answer(Run(chain, method, 0.5, step, {"1": hexed([0.1, 0.0, 0.0]), "9": None}))
