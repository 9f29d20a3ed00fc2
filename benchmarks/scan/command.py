"""``python -m benchmarks scan``: solve random chains, count the verdicts, and store the results on disk.

A reference solution takes seconds per chain. The repository contains the reference solutions of thousands of chains.
Other reference solutions are stored in one file and used again by later scans; ``--keep`` adds them to the repository.
Verdicts are stored in another file. An interrupted scan therefore continues from its last verdict; ``--fresh`` starts
again. The chains are the points of a sweep. Both files are written while points arrive. If a process dies, its chain is
tried again.
"""

from __future__ import annotations

import argparse
import gzip
import json
import math
import os
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from functools import partial
from itertools import product
from pathlib import Path
from typing import Any

from rich.console import Console
from softcradle.physics.atomic_files import output_file
from softcradle.physics.methods import refusal_of
from softcradle.physics.version import version
from softcradle.sandbox.console import ProgressShown
from softcradle.sandbox.sweeps import listed
from softcradle.sandbox.sweeps.executors import Where
from softcradle.sandbox.sweeps.run_sweep import map_points

from benchmarks.json_lines import append, lines
from benchmarks.reports import Report
from benchmarks.scan.chain_points import Entry, chain_numbers, compiled, entries
from benchmarks.scan.families import FAMILIES, motion
from benchmarks.scan.verdict import SLOW, RunVerdict

SEEDS_SHOWN = 8  # Largest number of failed chains that a row of the table lists.
TRUTHS = "truths.jsonl"  # Name of the file in the folder with the reference solutions.
KEPT = Path(__file__).with_name("truths.jsonl.gz")  # File with the reference solutions of the repository.


def parser() -> argparse.ArgumentParser:
    """Return the parser of the command line."""
    found = argparse.ArgumentParser(prog="python -m benchmarks scan", description=__doc__)
    found.add_argument("--count", type=int, default=100, help="chains of each family (default 100)")
    found.add_argument("--first", type=int, default=0, metavar="SEED", help="the first seed (default 0)")
    found.add_argument("--families", nargs="+", choices=list(FAMILIES), default=list(FAMILIES))
    found.add_argument("--method", default="accurate", help="a method that takes a tolerance (default accurate)")
    found.add_argument("--tolerance", type=float, default=1e-8)
    found.add_argument("--jobs", type=int, default=2, help="processes (default 2)")
    found.add_argument("--folder", type=Path, default=Path("out/scan"), help="where truths and verdicts are kept")
    found.add_argument("--fresh", action="store_true", help="judge every chain anew; truths are kept")
    found.add_argument("--keep", action="store_true", help="add the truths of these chains to those of the repository")
    found.add_argument("--markdown", type=Path, metavar="FILE", help="write the table there too, for the documentation")
    found.add_argument("--require", action="store_true", help="exit with 1 if an error is undetected")
    return found


def main(arguments: list[str]) -> int:
    """Run the scan, and print one row for each family of chains."""
    args = parser().parse_args(arguments)
    args.folder.mkdir(parents=True, exist_ok=True)
    truths = _truths(args)
    if args.fresh:
        _verdicts(args).unlink(missing_ok=True)
    known = {(entry["family"], entry["seed"]): entry for entry in lines(_verdicts(args))}
    wanted = list(product(range(args.first, args.first + args.count), args.families))
    carried = [task for task in wanted if not refusal_of(args.method, motion(*task[::-1]).chain)]
    _compute([task for task in carried if task[::-1] not in known], truths, known, args)
    found = [known[family, seed] for seed, family in carried]
    report = _report(found, args.families, f"{args.method} at {args.tolerance:g}")
    if len(carried) < len(wanted):
        report.notes.append(
            f"method {args.method!r} refuses {len(wanted) - len(carried)} of the chains, which are left out"
        )
    report.notes.append(_how_it_was_made(args))
    report.show(Console(width=200))
    if args.keep:
        _keep(_truths(args))
    if args.markdown is not None:
        with output_file(args.markdown) as temporary:
            temporary.write_text(report.markdown(), encoding="utf-8")
    return int(args.require and any(entry["verdict"] == RunVerdict.UNDETECTED for entry in found))


def _truths(args: argparse.Namespace) -> dict[str, Entry]:
    """Return all known reference solutions by the key of their chain."""
    return {entry["key"]: entry for path in (KEPT, args.folder / TRUTHS) for entry in lines(path)}


def _keep(truths: Mapping[str, Entry]) -> None:
    """Write the reference solutions of all chains that the families generate now. Equal solutions give an equal file."""
    chains = sorted({(family, int(seed)) for family, seed, _ in (key.split("/") for key in truths)})
    keys = (motion(family, seed).key for family, seed in chains)
    text = "\n".join(json.dumps(truths[key]) for key in keys if key in truths)
    with output_file(KEPT) as temporary:
        temporary.write_bytes(gzip.compress(text.encode(), mtime=0))


def _compute(
    wanted: Sequence[tuple[int, str]],
    truths: Mapping[str, Entry],
    known: dict[tuple[str, int], Entry],
    args: argparse.Namespace,
) -> None:
    """Judge the chains with the given (seed, family). Each result is written as soon as it arrives."""
    if not wanted:
        return
    seeds, families = zip(*wanted, strict=True)
    points = listed({"family": families, "seed": seeds})
    keys = [motion(family, seed).key for seed, family in wanted]
    function = partial(chain_numbers, {key: truths[key] for key in keys if key in truths}, args.method, args.tolerance)

    def keep(number: int, row: Mapping[str, Any]) -> None:
        truth, entry = entries(row, families[number], seeds[number])
        if truth is not None:
            append(args.folder / TRUTHS, truth)
        append(_verdicts(args), entry)
        known[entry["family"], entry["seed"]] = entry

    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
        # Each process uses one core. NumPy reads this variable in processes that start after this line.
        os.environ[name] = "1"
    where: Where = "here" if args.jobs <= 1 else "processes"
    # Fill the kernel cache on disk first. Otherwise each of the processes that start together would compile all
    # kernels.
    compiled()
    with ProgressShown("chains") as progress:
        # Each chain is a chunk, so that an interrupted scan keeps every finished chain.
        map_points(
            function, points, None, lambda _, done, count: progress.tell("chains", done, count), args.jobs,
            executor=where, each=keep, chunk_seconds=0.0,
        )  # fmt: skip


def _verdicts(args: argparse.Namespace) -> Path:
    """Return the path of the file with the verdicts for this method and tolerance."""
    folder: Path = args.folder
    return folder / f"{args.method}-{args.tolerance:g}.jsonl"


def _report(entries: list[Entry], families: Iterable[str], title: str) -> Report:
    rows = []
    for family in (*families, "all"):
        own = [entry for entry in entries if family in (entry["family"], "all")]
        counts = [sum(entry["verdict"] == verdict for entry in own) for verdict in RunVerdict]
        times = sorted(entry["seconds"] for entry in own)
        slow = sum(entry["slow"] for entry in own)
        bad = [entry for entry in own if entry["verdict"] in (RunVerdict.UNDETECTED, RunVerdict.GAVE_UP)]
        worst = sorted(bad, key=lambda entry: -entry["error"])[:SEEDS_SHOWN] if family != "all" else []
        seeds = ", ".join(
            f"{entry['seed']}{'' if entry['verdict'] == RunVerdict.UNDETECTED else '!'}" for entry in worst
        )
        middle = f"{1e3 * times[len(times) // 2]:.2g}" if times else "-"
        rows.append(
            [family, str(len(own)), *map(str, counts), str(slow), middle, f"{max(times, default=math.nan):.2g}", seeds]
        )
    sources = Counter(entry["truth"] for entry in entries)
    columns = ["family", "chains", *RunVerdict, f"over {SLOW:g} s", "median [ms]", "worst [s]", "seeds (! gave up)"]
    paths = sum(one["path"] for one in entries)
    notes = [
        f"positions and contact times are judged in {paths} of the {len(entries)} chains",
        "chains by source of the reference solution: "
        + ", ".join(f"{count} by {source}" for source, count in sources.items()),
    ]
    return Report(f"Random chains, {title}", columns, rows, notes, entries)


def _how_it_was_made(args: argparse.Namespace) -> str:
    """Return the command that writes the same table, and the version of the code that wrote it."""
    options = [
        f"--{name} {getattr(args, name)}"
        for name in ("first", "method", "tolerance")
        if getattr(args, name) != parser().get_default(name)
    ]
    if args.families != list(FAMILIES):
        options.append(f"--families {' '.join(args.families)}")
    command = " ".join(["python -m benchmarks scan", f"--count {args.count}", *options])
    return f"made by `{command}`, softcradle {version()}"
