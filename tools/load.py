"""The suite again and again, on a machine with nothing else to do or with every processor busy: is it green each time?

python -m tools.load 10                 # make test ten times
python -m tools.load 5 --busy           # five times, beside a process for each processor that never rests
python -m tools.load 3 --run "make test-all"
"""

import argparse
import os
import shlex
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager

REST = "while True: pass"


@contextmanager
def busy_processors(count: int) -> Iterator[None]:
    """So many processes that never rest, for a while."""
    processes = [subprocess.Popen([sys.executable, "-c", REST]) for _ in range(count)]
    try:
        yield
    finally:
        for process in processes:
            process.kill()
            process.wait()


def main() -> int:
    """Run, print a line for each time, and fail where one failed."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("times", type=int)
    parser.add_argument("--busy", action="store_true", help="keep every processor busy beside it")
    parser.add_argument("--run", default="make test", help="the command")
    args = parser.parse_args()
    failed = 0
    with busy_processors((os.cpu_count() or 1) * args.busy):
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
