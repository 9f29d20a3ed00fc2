"""Minified script of pages. Run python -m tools.page_script to write assets/page.min.js from assets/page/*.js.

Terser (an npm package in package.json) shortens local names, which keeps a page small. Names that the scripts share are
not changed. The first line of the file contains the digest of the sources. A page uses the file only if the digest is
up to date; see `softcradle.sandbox.page.document`.
"""

import subprocess
from pathlib import Path

from softcradle.sandbox.page.document import MINIFIED, digest_line, page_sources

FILE = Path(__file__).parents[1] / "assets" / MINIFIED
TERSER = (
    "npx",
    "--yes",
    "terser@5",
    "--compress",
    "passes=2",
    "--mangle",
    "--ecma",
    "2020",
    "--format",
    "ascii_only=false",
)


def main() -> None:
    """Write the minified script."""
    sources = page_sources()
    done = subprocess.run(TERSER, input=sources, capture_output=True, text=True, check=True)
    FILE.write_text(digest_line(sources) + done.stdout.strip() + "\n", encoding="utf-8")
    print(f"{FILE.name}: {len(sources.encode())} bytes of sources, {FILE.stat().st_size} bytes minified")


if __name__ == "__main__":
    main()
