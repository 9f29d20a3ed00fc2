"""``python -m benchmarks mutants``: change kernels in one place each, and count what the tests notice.

Every mutant is tried in a copy of the tree, with the kernels as plain Python, by the quick tests of its group; one that takes
far longer than the unchanged source counts as killed. Results are kept, so that a run that was interrupted goes on where it
stopped; those of a source or of tests that have changed since are tried anew.
"""

from __future__ import annotations

import argparse
import json
import random
import tempfile
from collections.abc import Iterator
from hashlib import blake2b
from pathlib import Path
from time import perf_counter
from typing import Any

from rich.console import Console
from softcradle.physics.atomic_files import output_file
from softcradle.physics.version import version

from benchmarks.mutants.equivalent import reason_of
from benchmarks.mutants.groups import GROUPS, Group
from benchmarks.mutants.operators import Mutant, mutants_of
from benchmarks.mutants.trial import ROOT, Trial
from benchmarks.reports import Report


def parser() -> argparse.ArgumentParser:
    """The command line."""
    found = argparse.ArgumentParser(prog="python -m benchmarks mutants", description=__doc__)
    found.add_argument("--of", nargs="+", choices=list(GROUPS), default=list(GROUPS), help="groups (default all)")
    found.add_argument("--count", type=int, default=60, help="mutants of each group (default 60; 0: all)")
    found.add_argument("--seed", type=int, default=1, help="of the draw of mutants (default 1)")
    found.add_argument("--seconds", type=float, default=float("inf"), help="after which no further mutant is tried")
    found.add_argument("--folder", type=Path, default=Path("out/mutants"), help="where results are kept")
    found.add_argument("--markdown", type=Path, metavar="FILE", help="write scores and survivors there")
    return found


def main(arguments: list[str]) -> int:
    """Try mutants, print scores and survivors; the exit code is 1 while mutants are left to try."""
    args = parser().parse_args(arguments)
    args.folder.mkdir(parents=True, exist_ok=True)
    end, reports, complete = perf_counter() + args.seconds, [], True
    for name in args.of:
        group, file = GROUPS[name], args.folder / f"{name}.json"
        wanted = drawn(group, args.count, args.seed)
        stamps = _stamps(group)  # of the files as they are tried: they may change while mutants run
        known = _known(file, group, stamps)
        todo = [item for item in wanted if _key(*item) not in known]
        for key, entry in _tried(group, todo, end):
            known[key] = entry
            _write(file, stamps, known)
        reports.append(_report(name, wanted, known))
        complete &= all(_key(*item) in known for item in wanted)
    console = Console(width=160)
    for report in reports:
        report.show(console)
    if args.markdown is not None and complete:
        with output_file(args.markdown) as temporary:
            temporary.write_text(_markdown(reports, args), encoding="utf-8")
    return int(not complete)


def drawn(group: Group, count: int, seed: int) -> list[tuple[str, Mutant]]:
    """`count` mutants of a group, drawn with `seed` and in the order of their lines; all where count is 0."""
    found = [(source, mutant) for source in group.sources for mutant in mutants_of(_text(source))]
    if not 0 < count < len(found):
        return found
    chosen = random.Random(seed).sample(range(len(found)), count)
    return [found[k] for k in sorted(chosen)]


def _tried(group: Group, todo: list[tuple[str, Mutant]], end: float) -> Iterator[tuple[str, dict[str, Any]]]:
    if not todo or perf_counter() > end:
        return
    with tempfile.TemporaryDirectory() as folder:
        trial = Trial(Path(folder), group)
        try:
            for source, mutant in todo:
                if perf_counter() > end:
                    return
                yield _key(source, mutant), {"killed by": trial.killed_by(source, mutant)}
        finally:
            trial.close()


def _key(source: str, mutant: Mutant) -> str:
    return f"{source}:{mutant.line}:{mutant.start}: {mutant.before} -> {mutant.after}"


def _text(source: str) -> str:
    return (ROOT / source).read_text(encoding="utf-8")


def _line(source: str, mutant: Mutant) -> str:
    return _text(source).splitlines()[mutant.line - 1]


def _stamps(group: Group) -> dict[str, str]:
    """Digests of the sources and the tests of a group: results of others do not count."""
    files = [*group.sources, *sorted({test.split("::")[0] for test in group.tests if test.startswith("tests/")})]
    return {file: blake2b(_text(file).encode(), digest_size=8).hexdigest() for file in files}


def _known(file: Path, group: Group, stamps: dict[str, str]) -> dict[str, dict[str, Any]]:
    """Results of these sources. Where tests have changed, those that killed do so still; survivors are tried again."""
    if not file.exists():
        return {}
    kept = json.loads(file.read_text(encoding="utf-8"))
    same_tests = all(kept["stamps"].get(name) == stamp for name, stamp in stamps.items() if name not in group.sources)
    return {
        key: entry
        for key, entry in kept["mutants"].items()
        if kept["stamps"].get(key.split(":")[0]) == stamps.get(key.split(":")[0]) and (same_tests or entry["killed by"])
    }


def _write(file: Path, stamps: dict[str, str], known: dict[str, dict[str, Any]]) -> None:
    with output_file(file) as temporary:
        temporary.write_text(json.dumps({"stamps": stamps, "mutants": known}, indent=1), encoding="utf-8")


def _report(name: str, wanted: list[tuple[str, Mutant]], known: dict[str, dict[str, Any]]) -> Report:
    tried = [item for item in wanted if _key(*item) in known]
    alive = [item for item in tried if not known[_key(*item)]["killed by"]]
    rows = [
        [
            f"{source}:{mutant.line}",
            f"`{_short(mutant.before)}` to `{_short(mutant.after)}`",
            reason_of(source, _line(source, mutant), mutant),
        ]
        for source, mutant in alive
    ]
    killed, equivalent = len(tried) - len(alive), sum(bool(row[2]) for row in rows)
    share = 100.0 * killed / max(1, len(tried))
    title = f"{name}: {killed} of {len(tried)} mutants killed, {share:.0f} %"
    columns = ["survivor", "change", "why nothing tells it apart"] if rows else []
    data = {"killed": killed, "tried": len(tried), "equivalent": equivalent, "survivors": rows}
    return Report(title, columns, rows, [], {"name": name, **data})


def _short(text: str) -> str:
    return " ".join(text.split())


def _markdown(reports: list[Report], args: argparse.Namespace) -> str:
    rows = []
    for report in reports:
        sources, data = GROUPS[report.data["name"]].sources, report.data
        told_apart = data["tried"] - data["equivalent"]
        counts = [str(data[key]) for key in ("tried", "killed", "equivalent")]
        shares = [f"{100.0 * data['killed'] / max(1, count):.0f} %" for count in (data["tried"], told_apart)]
        rows.append([data["name"], ", ".join(f"`{source}`" for source in sources), *counts, *shares])
    scores = Report(
        "Mutants killed by the quick tests of their room",
        ["group", "of", "tried", "killed", "equivalent", "share of all", "without equivalent ones"],
        rows,
        [f"made by `python -m benchmarks mutants --count {args.count} --seed {args.seed}`, softcradle {version()}"],
    )
    tables = [report.markdown() if report.rows else f"**{report.title}**\n" for report in reports]
    return "\n".join([scores.markdown(), *tables])
