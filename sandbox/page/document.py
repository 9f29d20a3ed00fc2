"""The document of a page: one HTML file with its style, scripts and kernels inside, which may load nothing."""

from __future__ import annotations

import base64
import gzip
import json
import re
from collections.abc import Sequence
from html import escape
from typing import Any

from softcradle.physics.version import version
from softcradle.sandbox.files import resource

SCRIPTS = (
    "words", "numbers", "bodies", "loupes", "stage", "chart", "kernel", "row", "live", "recorded", "address",
    "ending", "page", "controls",
)  # fmt: skip
# A browser refuses whatever is not inside the file.
POLICY = (
    "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline' 'wasm-unsafe-eval'; img-src data:; "
    "base-uri 'none'; form-action 'none'"
)


def document(title: str, parts: Sequence[str], data: object, computed: bool = False) -> str:
    """The whole page with the `data` of its player; empty `parts` of its main content are left out.

    A page that is `computed` carries the kernels.
    """
    style = resource("page/page.css").read_text(encoding="utf-8")
    script = "\n".join(_script(name) for name in SCRIPTS)
    body = "\n".join(part for part in parts if part)
    return (
        '<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        f'<meta http-equiv="Content-Security-Policy" content="{POLICY}">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f'<meta name="generator" content="softcradle {escape(version())}">\n'
        f'<title>{escape(title)}</title>\n<link rel="icon" href="data:,">\n<style>\n{style}</style>\n</head>\n'
        f"<body>\n<main>\n{body}\n</main>\n"
        f'<script type="application/json" id="data">{json_text(data)}</script>\n{_kernels() if computed else ""}'
        f'<script>\n"use strict";\n{script}</script>\n</body>\n</html>\n'
    )


def _script(name: str) -> str:
    """A script without lines of comment and indentation, a sixth of its length."""
    text = resource(f"page/{name}.js").read_text(encoding="utf-8")
    return re.sub(r"^\s*(//.*|/\*\*(.|\n)*?\*/)?[ \t]*\n?", "", text, flags=re.MULTILINE)


def _kernels() -> str:
    """The kernels of fixed steps, as text that the page's script unpacks."""
    packed = gzip.compress(resource("page/kernels.wasm").read_bytes(), 9, mtime=0)
    return f'<script type="application/octet-stream" id="kernels">{base64.b64encode(packed).decode()}</script>\n'


def paragraph(text: str) -> str:
    """What happens, in a few sentences; the script shows them in the reader's language."""
    return f'<p class="text" id="text">{escape(text)}</p>'


def question(text: str) -> str:
    """What is asked before the page is played, if anything."""
    return f'<p class="text"><strong>{escape(text)}</strong></p>' if text else ""


def note(text: str, warning: bool = False) -> str:
    """A sentence in small letters."""
    return f'<p class="note{" warning" if warning else ""}">{escape(text)}</p>'


def table(titles: Sequence[str], rows: Sequence[Sequence[str]], caption: str, hints: Sequence[str] = ()) -> str:
    """A table; the first cell of each row is its heading, `hints` explain these."""
    head = "".join(f'<th scope="col">{escape(title)}</th>' if title else "<td></td>" for title in titles)
    lines = []
    for k, (first, *cells) in enumerate(rows):
        hint = f' title="{escape(hints[k])}"' if hints and hints[k] else ""
        body = "".join(f"<td>{escape(cell)}</td>" for cell in cells)
        lines.append(f'<tr><th scope="row"{hint}>{escape(first)}</th>{body}</tr>')
    name = escape(caption)
    return (
        f'<div class="scroll" tabindex="0" role="region" aria-label="{name}"><table><caption>{name}</caption>'
        f"<thead><tr>{head}</tr></thead><tbody>{''.join(lines)}</tbody></table></div>"
    )


def footer() -> str:
    """The last line of the page, with the version."""
    return f"<footer>{escape(f'made with softcradle {version()}')}</footer>"


def json_text(content: Any) -> str:
    """JSON inside a script element, in which no text may look like markup."""
    text = json.dumps(content, separators=(",", ":"), allow_nan=False, ensure_ascii=False)
    return text.replace("<", "\\u003c")
