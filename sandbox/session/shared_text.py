"""Shared text: a scene as one line of letters, to be sent in a message and pasted into another window."""

from __future__ import annotations

import base64
import binascii
import zlib

from softcradle.sandbox.languages import _
from softcradle.scenes import Scene, parse

PREFIX = "softcradle:"
MOST_BYTES = 2**20  # of a scene's text: more is no scene


def shared_text(scene: Scene) -> str:
    """The scene as text."""
    packed = zlib.compress(scene.to_toml().encode(), 9)
    return PREFIX + base64.urlsafe_b64encode(packed).decode().rstrip("=")


def is_shared_text(text: str) -> bool:
    """Whether `text` may be a shared scene."""
    return text.strip().startswith(PREFIX)


def scene_from_text(text: str) -> Scene:
    """The scene that :func:`shared_text` wrote; spaces and line breaks in it do no harm. ValueError where it is none."""
    letters = "".join(text.split()).removeprefix(PREFIX)
    try:
        packed = base64.urlsafe_b64decode(letters + "=" * (-len(letters) % 4))
        unpacker = zlib.decompressobj()
        toml = unpacker.decompress(packed, MOST_BYTES)
        complete = unpacker.eof
    except (binascii.Error, zlib.error, ValueError):
        complete, toml = False, b""
    if not complete:
        raise ValueError(_("the text is not a whole scene: copy all of it, from 'softcradle:' to its end"))
    return parse(toml.decode(errors="replace"), _("the pasted scene"))
