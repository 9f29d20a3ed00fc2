"""The document of a page: one HTML file with its style and script inside, which may load nothing."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape

from softcradle.physics.version import version
from softcradle.sandbox.resources import resource

SCRIPTS = ("motion", "numbers", "bodies", "loupes", "stage", "charts", "contact_strip", "player")
# A browser refuses whatever is not inside the file.
POLICY = "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; img-src data:"


def document(title: str, parts: Sequence[str]) -> str:
    """The whole page; empty `parts` of its main content are left out."""
    style = resource("page/page.css").read_text(encoding="utf-8")
    script = "\n".join(resource(f"page/{name}.js").read_text(encoding="utf-8") for name in SCRIPTS)
    body = "\n".join(part for part in parts if part)
    return (
        '<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        f'<meta http-equiv="Content-Security-Policy" content="{POLICY}">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f'<meta name="generator" content="softcradle {escape(version())}">\n'
        f'<title>{escape(title)}</title>\n<link rel="icon" href="data:,">\n<style>\n{style}</style>\n</head>\n'
        f'<body>\n<main>\n{body}\n</main>\n<script>\n"use strict";\n{script}</script>\n</body>\n</html>\n'
    )


def heading(title: str, source: str) -> str:
    """The title, and where it is in the paper."""
    return f'<h1>{escape(title)}</h1>\n<p class="source">{escape(source)}</p>'


def paragraph(text: str) -> str:
    """What happens, in a few sentences."""
    return f'<p class="text">{escape(text)}</p>' if text else ""


def note(text: str, warning: bool = False) -> str:
    """A sentence in small letters."""
    return f'<p class="note{" warning" if warning else ""}">{escape(text)}</p>'


def table(titles: Sequence[str], rows: Sequence[Sequence[str]], caption: str, hints: Sequence[str] = ()) -> str:
    """A table; the first cell of each row is its heading, `hints` explain these.

    Cells are text, or markup of :func:`live_cell`.
    """
    head = "".join(f'<th scope="col">{escape(title)}</th>' if title else "<td></td>" for title in titles)
    lines = []
    for k, (first, *cells) in enumerate(rows):
        hint = f' title="{escape(hints[k])}"' if hints and hints[k] else ""
        body = "".join(cell if isinstance(cell, LiveCell) else f"<td>{escape(cell)}</td>" for cell in cells)
        lines.append(f'<tr><th scope="row"{hint}>{escape(first)}</th>{body}</tr>')
    name = escape(caption)
    return (
        f'<div class="scroll" tabindex="0" role="region" aria-label="{name}"><table><caption>{name}</caption>'
        f"<thead><tr>{head}</tr></thead><tbody>{''.join(lines)}</tbody></table></div>"
    )


class LiveCell(str):
    """Markup of a cell that the page's script fills with a value at the time shown."""


def live_cell(lane: int, channel: str, index: int) -> LiveCell:
    """A cell for value number `index` of a `channel`: "velocity", "force", "overlap" or "state"."""
    return LiveCell(f'<td class="now" data-now="{channel}" data-lane="{lane}" data-index="{index}"></td>')


def footer(lines: Sequence[str]) -> str:
    """The last lines of the page, the version among them."""
    return f"<footer>{' · '.join(escape(line) for line in (*lines, f'made with softcradle {version()}'))}</footer>"
