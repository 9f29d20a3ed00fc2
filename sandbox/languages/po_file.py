"""Catalogues: the entries of a .po file, and the same entries in the format that Python's gettext reads."""

from __future__ import annotations

import ast
import struct
from collections.abc import Mapping
from pathlib import Path

MAGIC, REVISION = 0x950412DE, 0  # of the compiled format
HEADER = 7  # numbers of four bytes at its begin
CONTEXT, FORM = "\x04", "\x00"  # what follows the context of a message; what separates its plural forms


def read_entries(path: Path) -> dict[str, str]:
    """Messages and translations as gettext's compiled files name them; those that are fuzzy or empty are left out.

    A message has its context before CONTEXT and its plural after FORM; translations have a FORM between theirs.
    """
    entries: dict[str, str] = {}
    for block in path.read_text(encoding="utf-8").split("\n\n"):
        lines = [line.strip() for line in block.splitlines()]
        if any(line.startswith("#,") and "fuzzy" in line for line in lines):
            continue
        fields = _fields([line for line in lines if line and not line.startswith("#")])
        forms = [text for keyword, text in fields.items() if keyword.startswith("msgstr")]
        if "msgid" in fields and all(forms):
            message = FORM.join(fields[key] for key in ("msgid", "msgid_plural") if key in fields)
            context = fields["msgctxt"] + CONTEXT if "msgctxt" in fields else ""
            entries[context + message] = FORM.join(forms)
    return entries


def _fields(lines: list[str]) -> dict[str, str]:
    """Texts by keyword: msgid, msgstr, msgstr[0] and so on; a text goes on in the lines below it."""
    fields: dict[str, str] = {}
    keyword = ""
    for line in lines:
        text = line
        if not line.startswith('"'):
            keyword, _, text = line.partition(" ")
            fields[keyword] = ""
        fields[keyword] += ast.literal_eval(text)
    return fields


def compiled(entries: Mapping[str, str]) -> bytes:
    """The entries as a file in the format .mo: a table of messages, a table of translations, and their texts."""
    pairs = sorted((message.encode(), translation.encode()) for message, translation in entries.items())
    count = len(pairs)
    tables = 4 * HEADER
    texts, place = b"", tables + 16 * count
    rows: list[tuple[int, int]] = []
    for text in (*(message for message, _ in pairs), *(translation for _, translation in pairs)):
        rows.append((len(text), place + len(texts)))
        texts += text + b"\0"
    header = struct.pack("<7I", MAGIC, REVISION, count, tables, tables + 8 * count, 0, place)
    return header + b"".join(struct.pack("<2I", *row) for row in rows) + texts
