"""PNG files of surfaces, whole or an error: pygame itself writes what fits on a full disk, and says nothing."""

from __future__ import annotations

from io import BytesIO
from pathlib import Path

import pygame


def png_bytes(surface: pygame.Surface) -> bytes:
    """The surface as a PNG file."""
    encoded = BytesIO()
    pygame.image.save(surface, encoded, "picture.png")
    return encoded.getvalue()


def write_png(surface: pygame.Surface, path: Path) -> None:
    """Write the surface to `path`. Raises OSError where the disk is full."""
    path.write_bytes(png_bytes(surface))
