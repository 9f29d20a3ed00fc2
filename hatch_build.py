"""Build of the package: a description without links into the repository, the addresses of a release, and compiled
catalogues of messages.
"""

from __future__ import annotations

import re
import tomllib
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface
from hatchling.metadata.plugin.interface import MetadataHookInterface


class Description(MetadataHookInterface):
    """Hook that hatchling calls for every wheel and source archive."""

    def update(self, metadata: dict[str, Any]) -> None:
        """Set the description and the addresses."""
        readme = Path(self.root, "README.md").read_text(encoding="utf-8")
        metadata["readme"] = {"content-type": "text/markdown", "text": without_files(readme)}
        pyproject = tomllib.loads(Path(self.root, "pyproject.toml").read_text(encoding="utf-8"))
        metadata["urls"] = addresses(pyproject["tool"]["softcradle"]["release"])


class Catalogues(BuildHookInterface[Any]):
    """Hook that hatchling calls for every wheel: it compiles the catalogues of messages."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Compile each .po file to a .mo file next to it, which only the wheel contains."""
        from babel.messages.mofile import write_mo
        from babel.messages.pofile import read_po

        for path in Path(self.root, "sandbox", "languages").glob("*/LC_MESSAGES/*.po"):
            with path.open("rb") as source, path.with_suffix(".mo").open("wb") as file:
                write_mo(file, read_po(source, locale=path.parts[-3]))
        build_data["artifacts"].append("*.mo")


def addresses(release: dict[str, str]) -> dict[str, str]:
    """Return the links of the package on an index, from the addresses that are known."""
    links = {"Documentation": release["site"], "Repository": release["repository"]}
    if release["doi"]:
        links["DOI"] = f"https://doi.org/{release['doi']}"
    return {name: address for name, address in links.items() if address}


def without_files(text: str) -> str:
    """Return the Markdown `text` without pictures from files, and with the words of links to files only."""
    pictures = re.sub(r"^!\[[^\]]*\]\((?!https?:)[^)]*\)\n\n?", "", text, flags=re.MULTILINE)
    return re.sub(r"(?<!!)\[([^\]]*)\]\((?!https?:|#)[^)]*\)", r"\1", pictures)
