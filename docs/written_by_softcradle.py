"""Parts of the documentation that softcradle writes: lists of methods, scenes and commands, measured tables, scene pages."""

from __future__ import annotations

import argparse
import tomllib
import warnings
from collections.abc import Iterator, Sequence
from dataclasses import fields
from html import escape
from pathlib import Path
from shutil import copyfile

import numpy as np
from softcradle.physics.analysis.collision import CollisionMeasures, ContactMeasures
from softcradle.physics.simulation import solve
from softcradle.sandbox.cli.main import COMMANDS
from softcradle.sandbox.page import render_page
from softcradle.sandbox.page.data import can_be_computed
from softcradle.sandbox.story.numbers import scientific
from softcradle.sandbox.studies.verify import verified
from softcradle.sandbox.window import gallery
from softcradle.scenes.contact_kinds import KINDS

from softcradle import METHODS, one_on, power_law, scenes

STEPS_A_CONTACT = (8, 64, 512)  # steps per contact of fixed-step methods in the measured table
ROUND_OFF = 1e-8  # a number of order 1 below this value is only its error
GALLERY_PICTURES = Path(gallery.__file__).parent / "pictures" / "light"  # made by `make screenshots`
PROJECT = tomllib.loads((Path(__file__).parent.parent / "pyproject.toml").read_text(encoding="utf-8"))
SITE = PROJECT["tool"]["softcradle"]["release"]["site"]  # empty until the site has an address
CONTACT_TIME = 1.8  # s, that the striker of one on four touches at alpha = 1/10


def write_all(folder: Path) -> None:
    """Write every part into `folder`. Unchanged parts keep their time stamp, so Sphinx reads few files again."""
    folder.mkdir(exist_ok=True)
    (folder / "static").mkdir(exist_ok=True)
    parts = {
        "methods": methods(),
        "scenes": catalogue(),
        "experiments": experiments(),
        "laws": laws(),
        "errors": errors(),
        "commands": commands(),
        "verified": checked(),
        "measures": measures(),
    }
    for name, lines in parts.items():
        text, path = "\n".join(lines) + "\n", folder / f"{name}.md"
        if not path.exists() or path.read_text(encoding="utf-8") != text:
            path.write_text(text, encoding="utf-8")
    live = folder / "static" / "live"
    live.mkdir(exist_ok=True)
    for scene in scenes.names():
        address = f"{SITE}/_static/live/{scene}.html" if SITE else ""
        render_page(scenes.load(scene), live / f"{scene}.html", address=address)
        if SITE:  # the picture in previews of links
            copyfile(GALLERY_PICTURES / f"{scene}.png", live / f"{scene}.png")
    pictures = folder / "static" / "pictures"
    pictures.mkdir(exist_ok=True)
    for picture in GALLERY_PICTURES.glob("*.png"):
        copyfile(picture, pictures / picture.name)


def table(titles: Sequence[str], rows: Sequence[Sequence[str]]) -> Iterator[str]:
    """A table in Markdown."""
    yield f"| {' | '.join(titles)} |"
    yield f"|{'---|' * len(titles)}"
    for row in rows:
        yield f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in row)} |"


def methods() -> Iterator[str]:
    """The methods."""
    rows = [
        [
            f"`{m.name}`",
            str(m.order),
            "tolerance" if m.adaptive else "step",
            "yes" if m.set_valued else "no",
            m.summary,
        ]
        for m in METHODS
    ]
    return table(["method", "order", "takes", "a preload may rest at 0", "what it is"], rows)


def catalogue() -> Iterator[str]:
    """The scenes."""
    loaded = [(name, scenes.load(name)) for name in scenes.names()]
    return table(
        ["scene", "title", "its page", "where in the paper"],
        [
            [_live(name), scene.title, "live" if can_be_computed(scene) else "recorded", scene.source]
            for name, scene in loaded
        ],
    )


def _live(name: str) -> str:
    """The name of a scene as a link to its page."""
    return f'<a href="_static/live/{name}.html"><code>{name}</code></a>'


def experiments() -> Iterator[str]:
    """Yield the gallery of all scenes: picture, title and first sentence of each, as HTML."""
    yield '<div class="experiments">'
    for name in scenes.names():
        scene = scenes.load(name)
        first = scene.text.replace("\n", " ").split(". ")[0].strip().rstrip(".")
        kind = "live" if can_be_computed(scene) else "recorded"
        yield f'<a href="_static/live/{name}.html"><img src="_static/pictures/{name}.png" alt="" loading="lazy">'
        yield f"<strong>{escape(scene.title)}</strong> <small>{kind}</small><span>{escape(first)}.</span></a>"
    yield "</div>"


def laws() -> Iterator[str]:
    """The contact laws."""
    return table(
        ["law", "its numbers"], [[f"`{kind.law}`", ", ".join(f"`{n}`" for n in kind.numbers)] for kind in KINDS]
    )


def errors() -> Iterator[str]:
    """Errors of the final velocities of one on four by every method, against the default one at a tolerance of 1e-12."""
    chain, start = one_on(4, power_law(1.0, 0.1)), [1.0, 0.0, 0.0, 0.0, 0.0]
    truth = solve(chain, start, tolerance=1e-12, samples=2).final_velocity
    rows = []
    for method in METHODS:
        if method.name == "scipy":
            continue
        found = [
            solve(chain, start, method=method.name, samples=2, **setting)
            for setting in (
                [{"tolerance": t} for t in (1e-4, 1e-6, 1e-8)]
                if method.adaptive
                else [{"step": CONTACT_TIME / count} for count in STEPS_A_CONTACT]
            )
        ]
        apart = [float(np.abs(run.final_velocity - truth).max()) for run in found]
        rows.append([f"`{method.name}`", *(scientific(error, 0) for error in apart), str(found[-1].steps)])
    titles = ["method", "8 steps a contact, or 10⁻⁴", "64, or 10⁻⁶", "512, or 10⁻⁸", "steps of the last"]
    return table(titles, rows)


def checked() -> Iterator[str]:
    """Yield the numbers known from other sources, with source and result of softcradle, as `softcradle verify` prints them."""
    rows = [
        [
            row.known.name,
            f"{row.known.value:.10g}",
            row.known.source,
            _found(row.found),
            scientific(row.error, 0),
            scientific(row.known.allowed, 0) if row.known.allowed else "0",
        ]
        for row in verified()
    ]
    return table(["number", "known", "source", "found", "error", "met up to"], rows)


def _found(value: float) -> str:
    """A number to ten digits; one of round-off to one."""
    return f"{value:.10g}" if value == 0.0 or abs(value) > ROUND_OFF else scientific(value, 0)


def measures() -> Iterator[str]:
    """The numbers of a collision and of its contacts."""
    found = [
        field for kind in (CollisionMeasures, ContactMeasures) for field in fields(kind) if "title" in field.metadata
    ]
    rows = {field.metadata["title"]: [field.metadata["unit"], field.metadata["meaning"]] for field in reversed(found)}
    return table(["measure", "unit", "what it means"], [[title, *row] for title, row in reversed(rows.items())])


def commands() -> Iterator[str]:
    """The help of every command."""
    for command in COMMANDS:
        parser = argparse.ArgumentParser(prog=f"softcradle {command.name}", description=f"{command.help}.".capitalize())
        command.load().add_arguments(parser)
        yield from (f"## softcradle {command.name}", "", "```text", parser.format_help().rstrip(), "```", "")


if __name__ == "__main__":
    with warnings.catch_warnings():
        write_all(Path(__file__).parent / "_made")
