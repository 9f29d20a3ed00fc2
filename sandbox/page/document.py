"""Document of a page. A page is one HTML file that contains its style, scripts, kernels and controls. The file loads
nothing else.
"""

import base64
import gzip
import hashlib
import json
import re
from collections.abc import Sequence
from html import escape
from typing import Any

from softcradle.physics.version import version
from softcradle.sandbox.files import resource
from softcradle.sandbox.languages.translation import ENGLISH, LANGUAGES
from softcradle.sandbox.story.page_story import story_script

SCRIPTS = (
    "language", "numbers", "bodies", "loupes", "stage", "chart", "kernel", "row", "live", "recorded", "address",
    "ending", "explain", "qr", "share", "host", "page", "controls",
)  # fmt: skip
# Security policy of the page. With it, the browser loads nothing that is not inside the file.
POLICY = (
    "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline' 'wasm-unsafe-eval'; img-src data:; "
    "base-uri 'none'; form-action 'none'"
)

# The script of the page connects the controls to the motion. The script also translates the texts of the controls into
# the language of the reader.
PACES = (0.05, 0.1, 0.25, 0.5, 1.0, 2.0, 4.0)  # Playback speeds relative to the usual playback speed of the scene.
ICONS = {
    "play": "M8 5v14l11-7z",
    "pause": "M7 5h4v14H7zM13 5h4v14h-4z",
    "back": "M6 5h2.4v14H6zM19 5v14L9.5 12z",
    "ahead": "M15.6 5H18v14h-2.4zM5 5v14l9.5-7z",
    "again": "M12 5V1.5L7 6l5 4.5V7a5.5 5.5 0 1 1-5.4 6.6h-2A7.5 7.5 0 1 0 12 5z",
}
# Icon of the page. The icon shows two overlapping beads and is an SVG file in a data address.
ICON = (
    "data:image/svg+xml,%3Csvg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 32 32'%3E"
    "%3Ccircle cx='11' cy='16' r='10' fill='%230072b2'/%3E%3Ccircle cx='22' cy='16' r='10' fill='%23d08a00'/%3E%3C/svg%3E"
)
LAWS = ("scene", "soft", "gear", "steel")
BESIDE = ("none", "steel", "soft", "gear")
GUESSES = ("last", "together", "spread")
SHOWN = ("forces", "loupes", "balance", "charts")


def document(title: str, text: str, parts: Sequence[str], data: object, computed: bool = False) -> str:
    """Return the complete page with the `data` of its player. `parts` are the parts of its main content. Empty parts
    are omitted.

    `text` describes the page in the preview of a link. If `computed` is True, the page contains the kernels.
    """
    style = re.sub(r"/\*.*?\*/|\s*([{};,])\s*|(?<=:) +", r"\1", resource("page/page.css").read_text(encoding="utf-8"))
    body = "\n".join(part for part in parts if part)
    return (
        '<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        f'<meta http-equiv="Content-Security-Policy" content="{POLICY}">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f'<meta name="generator" content="softcradle {escape(version())}">\n'
        f'<meta name="description" content="{escape(text)}">\n<meta property="og:type" content="website">\n'
        f'<meta property="og:title" content="{escape(title)}">\n<meta property="og:description" content="{escape(text)}">\n'
        f'<title>{escape(title)}</title>\n<link rel="icon" href="{ICON}">\n<style>\n{style}</style>\n</head>\n'
        f"<body>\n<main>\n{body}\n</main>\n"
        f'<script type="application/json" id="data">{json_text(data)}</script>\n{_kernels() if computed else ""}'
        f"<script>\n{story_script()}</script>\n<script>\n{page_script()}</script>\n</body>\n</html>\n"
    )


def with_preview(text: str, address: str) -> str:
    """Return the page `text` with tags for the preview of a link. The tags contain the address of the page and the
    address of its picture. The picture has the same name with the suffix .png.
    """
    picture = f"{address.rpartition('.')[0]}.png"
    tags = "".join(
        f'<meta property="og:{name}" content="{escape(value)}">\n'
        for name, value in (("url", address), ("image", picture))
    )
    return text.replace("<title>", f"{tags}<title>", 1)


MINIFIED = "page.min.js"  # file in assets/ that `python -m tools.page_script` writes


def page_script_text(name: str) -> str:
    """Return the source code of one script."""
    return resource(f"page/{name}.js").read_text(encoding="utf-8")


def page_sources() -> str:
    """Return the source code of all scripts. The order follows their dependencies."""
    return '"use strict";\n' + "\n".join(map(page_script_text, SCRIPTS))


def digest_line(sources: str) -> str:
    """Return the first line of the minified script. This line contains a digest of `sources`."""
    return f"// {hashlib.sha256(sources.encode()).hexdigest()[:16]}\n"


def page_script() -> str:
    """Return the minified script. If the sources have changed since it was written, return the sources instead."""
    sources = page_sources()
    head, _, minified = resource(MINIFIED).read_text(encoding="utf-8").partition("\n")
    return minified if f"{head}\n" == digest_line(sources) else sources


def _kernels() -> str:
    """Return a script element with the compressed kernels of the fixed-step methods. The script of the page unpacks
    them.
    """
    packed = gzip.compress(resource("page/kernels.wasm").read_bytes(), 9, mtime=0)
    return f'<script type="application/octet-stream" id="kernels">{base64.b64encode(packed).decode()}</script>\n'


def note(text: str, warning: bool = False) -> str:
    """Return a paragraph with small text."""
    return f'<p class="note{" warning" if warning else ""}">{escape(text)}</p>'


def table(titles: Sequence[str], rows: Sequence[Sequence[str]], caption: str, hints: Sequence[str] = ()) -> str:
    """Return an HTML table. The first cell of each row is the heading of the row. `hints` are the tooltips of these
    headings.
    """
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


def spoken(language: str, part: str) -> str:
    """Return `part`, marked with its language. The script of the page shows it to readers of this language."""
    return f'<div lang="{language}"{"" if language == ENGLISH else " hidden"}>{part}</div>'


def footer() -> str:
    """Return the last line of the page, which contains the version."""
    return f'<footer><span data-say="made">made with</span> softcradle {escape(version())}</footer>'


def json_text(content: Any) -> str:
    """Return `content` as JSON for a script element. Characters that could be read as HTML are escaped."""
    text = json.dumps(content, separators=(",", ":"), allow_nan=False, ensure_ascii=False)
    return text.replace("<", "\\u003c")


def heading(title: str, source: str) -> str:
    """Return the head of the page. The head contains the title, the section of the paper, the choice of a language, and
    a sentence that is shown if scripts are blocked.
    """
    names = "".join(f'<option value="{code}">{escape(entry.name)}</option>' for code, entry in LANGUAGES.items())
    return (
        f'<header class="top"><div><h1 id="title">{escape(title)}</h1><p class="source" id="source">{escape(source)}</p></div>'
        f'<div class="tools"><button id="link" class="quiet" data-say="share">Share</button>'
        f'<select id="language" class="quiet" data-name="language">{names}</select></div></header>'
        '<p id="notice" class="notice" role="status" hidden></p>'
        '<p id="wait" class="notice">This site blocks the page: download it and open it from your device.</p>'
        "<noscript><p>This page needs JavaScript.</p></noscript>"
    )


def player(question: str, text: str, uniform: bool, alone: bool, moving: bool, lies: bool = True) -> str:
    """Return the player. The player contains the beads, the clock, the texts and the settings of the chain.

    Parameters
    ----------
    question, text : str
        The question above the beads and the text below them.
    uniform : bool
        True if the reader can choose the number of beads and the contact law.
    alone : bool
        True if the reader can compare the chain with a second chain.
    moving : bool
        True if the beads move at the start.
    lies : bool
        True if the beads lie on the ground, which can have friction. False if they hang on strings.
    """
    return (
        '<div class="play" id="play"><div class="tale">'
        f'<p class="lead" id="lead" role="status">{escape(question)}</p>{_guesses()}</div>'
        f'<section class="hero"><div class="bench" id="bench"><div id="lanes" class="lanes"></div>{_transport()}</div>'
        f'{_more(alone)}<p id="words" role="status"></p><p class="text" id="text">{escape(text)}</p>'
        '<p class="ledger" id="energy"></p><div id="charts" class="charts"></div></section>'
        '<section class="settings" id="settings"><h2 class="live-only" data-say="settings">Settings</h2>'
        f"{_settings(uniform, alone, moving, lies)}"
        f'{_shown()}<a id="full" target="_blank" rel="noopener" data-say="full"></a></section></div>'
        f'<p id="said" class="unseen" role="status"></p>{_share()}'
    )


def numbers(tables: str) -> str:
    """Return the section with the numbers. The section first contains live tables, which the script fills. Then the
    recorded `tables` follow in every language.
    """
    return (
        '<details id="numbers"><summary data-say="in numbers">In numbers</summary>'
        '<div id="tables" class="scroll" tabindex="0" role="region" data-name="in numbers"></div>'
        f"{tables}</details>"
    )


def keys() -> str:
    """Return the explanation of keyboard and touch control, for live and for recorded pages."""
    parts = '<p data-say="help"></p><p class="live-only" data-say="help live"></p>'
    return f'<details><summary data-say="keys">Keys and touch</summary>{parts}</details>'


def _guesses() -> str:
    """Return the buttons with possible answers to the question above the beads."""
    buttons = "".join(f'<button id="guess-{kind}" class="wide"></button>' for kind in GUESSES)
    return f'<div id="guesses" class="guesses" role="group" aria-labelledby="lead" hidden>{buttons}</div>'


def _transport() -> str:
    return (
        '<div class="transport" id="transport">'
        '<input type="range" id="time" min="0" max="1000" step="1" value="0" data-name="time"><div class="buttons">'
        + _button("again", "again", "again")
        + _button("toggle", "play", "play", "pause")
        + _button("back", "back", "back")
        + _button("ahead", "ahead", "ahead")
        + '<span id="clock" role="timer"></span><button id="explain" class="wide" data-say="explain" '
        'aria-pressed="false" hidden></button></div></div>'
    )


def _share() -> str:
    """Return the dialog for sharing. The dialog contains the link, the QR code, the code for embedding the page, and
    the files for handing in answers.
    """

    def copied(name: str, word: str, field: str, kind: str) -> str:
        return (
            f'<label id="{name}-label" for="{name}" data-say="{word}"></label>{field}'
            f'<button id="copy-{kind}" class="wide" data-say="copy" aria-labelledby="copy-{kind} {name}-label"></button>'
        )

    link = copied("share-link", "share link", '<input id="share-link" readonly>', "link")
    code = copied("share-code", "share code", '<textarea id="share-code" readonly></textarea>', "code")
    return (
        '<dialog id="share" aria-labelledby="share-title"><div id="share-part"><h2 id="share-title" data-say="share"></h2>'
        f'<div id="share-link-part">{link}</div><p id="share-note"></p>'
        '<canvas id="qr" role="img" data-name="qr"></canvas>'
        f"{code}</div>"
        '<h2 data-say="hand in"></h2><div class="buttons"><button id="save-csv" class="wide" '
        'data-say="save csv"></button><button id="save-png" class="wide" data-say="save png"></button></div>'
        '<details id="csv"><summary id="csv-label" data-say="csv text"></summary>'
        '<textarea id="csv-text" readonly data-name="csv text"></textarea>'
        '<button id="copy-csv" class="wide" data-say="copy" aria-labelledby="copy-csv csv-label"></button>'
        '</details><button id="close" class="wide" data-say="close"></button></dialog>'
    )


def _more(alone: bool) -> str:
    paces = "".join(f'<option value="{pace:g}"></option>' for pace in PACES)
    there = "live-only" if alone else "never"
    return (
        f'<div class="more"><select id="pace" data-name="pace">{paces}</select>'
        f'<button id="contrast" class="wide {there}" aria-pressed="false"></button></div>'
    )


def _button(name: str, word: str, icon: str, second: str = "") -> str:
    """Return a button with an icon. If there is a `second` icon, it replaces the first one while the motion plays."""
    paths = f'<path class="one" d="{ICONS[icon]}"/>' + (f'<path class="two" d="{ICONS[second]}"/>' if second else "")
    return f'<button id="{name}" data-name="{word}"><svg viewBox="0 0 24 24" aria-hidden="true">{paths}</svg></button>'


def _settings(uniform: bool, alone: bool, moving: bool, lies: bool) -> str:
    alpha = "alpha" if alone else "alpha upper"
    parts = [
        _choice("law", LAWS, uniform),
        _slider("alpha", alpha),
        _slider("targets", "targets", uniform),
        _slider("strikers", "strikers", uniform),
        _slider("speed", "speed", moving),
        _choice("beside", BESIDE, alone),
        _slider("friction", "friction", lies),
        _slider("loss", "loss"),
    ]
    return f'<div class="sliders live-only">{"".join(parts)}</div>'


def _slider(name: str, word: str, there: bool = True) -> str:
    ends = (
        '<span class="ends" aria-hidden="true"><span data-say="softest"></span><span data-say="hardest"></span></span>'
    )
    kind = "field" + ("" if there else " never") + (" main" if name == "alpha" else "")
    return (
        f'<div class="{kind}"><label for="{name}" data-say="{word}"></label>'
        f'<span id="{name}-value" class="value" aria-hidden="true"></span><input type="range" id="{name}" step="1">'
        f"{ends if name == 'alpha' else ''}</div>"
    )


def _choice(name: str, options: tuple[str, ...], there: bool) -> str:
    found = "".join(f'<option value="{option}" data-say="{option}"></option>' for option in options)
    return (
        f'<div class="{"field" if there else "field never"}"><label for="{name}" data-say="{name}"></label>'
        f'<select id="{name}">{found}</select></div>'
    )


def _shown() -> str:
    boxes = "".join(
        f'<label><input type="checkbox" id="show-{name}"><span data-say="{name}"></span></label>' for name in SHOWN
    )
    return f'<fieldset><legend data-say="show">Show</legend>{boxes}</fieldset>'
