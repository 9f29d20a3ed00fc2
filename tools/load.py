"""The suite again and again, on a machine with nothing else to do or with every processor busy: is it green each time?

python -m tools.load 10                 # make test ten times
python -m tools.load 5 --busy           # five times, beside a process for each processor that never rests
python -m tools.load 5 --beside "python -m benchmarks scan"    # five times, beside a command that is of use meanwhile
python -m tools.load 3 --run "make test-all"
"""

import argparse
import os
import shlex
import signal
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager

NEVER_RESTS = [sys.executable, "-c", "while True: pass"]


@contextmanager
def beside(commands: Sequence[Sequence[str]]) -> Iterator[None]:
    """These commands run, each with the processes that it starts in a group of its own, until this is over."""
    processes = [
        subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.STDOUT, start_new_session=True)
        for command in commands
    ]
    try:
        yield
        for command, process in zip(commands, processes, strict=True):
            if process.poll() is not None:
                raise SystemExit(f"{shlex.join(command)} ended by itself: the last times were not beside it")
    finally:
        for process in processes:
            if process.poll() is None:
                os.killpg(process.pid, signal.SIGKILL)
                process.wait()


def main() -> int:
    """Run, print a line for each time, and fail where one failed."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("times", type=int)
    parser.add_argument("--busy", action="store_true", help="keep every processor busy beside it")
    parser.add_argument("--beside", metavar="COMMAND", help="keep this running beside it")
    parser.add_argument("--run", default="make test", help="the command")
    args = parser.parse_args()
    failed = 0
    commands = [NEVER_RESTS] * (os.cpu_count() or 1) * args.busy
    commands += [shlex.split(args.beside)] if args.beside else []
    with beside(commands):
        for number in range(1, args.times + 1):
            began = time.monotonic()
            done = subprocess.run(shlex.split(args.run), stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
            last = done.stdout.decode(errors="replace").strip().splitlines()[-1:]
            print(
                f"{number}: exit code {done.returncode}, {time.monotonic() - began:.0f} s, {' '.join(last)}", flush=True
            )
            if done.returncode:
                failed += 1
                sys.stdout.buffer.write(done.stdout)
    return int(failed > 0)


if __name__ == "__main__":
    sys.exit(main())
