"""Configuration of Sphinx. softcradle writes tables and scene pages before Sphinx reads the sources."""

from __future__ import annotations

import re
import sys
import tomllib
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))

from docutils import nodes
from latex2mathml.converter import convert
from softcradle.physics.version import version as installed_version
from sphinx.application import Sphinx
from sphinx.writers.html5 import HTML5Translator
from written_by_softcradle import write_all

project = "softcradle"
author = "The softcradle authors"
copyright = (
    f"{author}, MIT licence. After K. Sekimoto et al., A mechanism of macroscopic rigid-body behavior through evanescent "
    "mode, arXiv:1807.04600"
)
version = release = installed_version()

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.viewcode",
    "numpydoc",
    "sphinx_copybutton",
    "sphinx_gallery.gen_gallery",
]
exclude_patterns = ["_made", "measured", "gallery/*.ipynb", "gallery/*.py"]  # parts of other pages, downloads
myst_enable_extensions = ["colon_fence", "dollarmath"]
myst_heading_anchors = 3
nitpicky = True  # a name of the API that leads nowhere is a warning, so an error
default_role = "code"  # names in docstrings stand between single backticks
autodoc_member_order = "bysource"
autodoc_typehints = "none"  # docstrings say what arguments mean, with shape and unit
numpydoc_show_class_members = False  # autodoc lists those that docs/api.md names

copybutton_prompt_text = r">>> |\.\.\. |\$ "  # a copied example contains the input only
copybutton_prompt_is_regexp = True

pyproject = tomllib.loads((Path(__file__).parent.parent / "pyproject.toml").read_text(encoding="utf-8"))
html_baseurl = pyproject["tool"]["softcradle"]["release"]["site"]  # empty until the site has an address
html_theme = "furo"
html_title = f"softcradle {version}"
html_static_path = ["static", "_made/static"]
html_css_files = ["softcradle.css"]

sphinx_gallery_conf = {
    "examples_dirs": "../examples/gallery",
    "gallery_dirs": "gallery",
    "filename_pattern": r"/plot_",
    "abort_on_example_error": True,
    "only_warn_on_example_error": False,
    "show_memory": False,
    "download_all_examples": False,
    "write_computation_times": False,  # what is built is the same on every machine, ...
    "min_reported_time": 3600,  # [s] ... and says nothing of how fast it was
    "plot_gallery": "True",
}
linkcheck_timeout = 20
linkcheck_retries = 2
linkcheck_ignore = [r"https?://localhost.*"]

write_all(Path(__file__).parent / "_made")


def setup(app: Sphinx) -> None:
    """Write equations as MathML, which browsers show without a script and without a network."""
    app.add_html_math_renderer("mathml", (_inline, None), (_block, None))
    app.connect("source-read", _without_last_blank_lines)


html_math_renderer = "mathml"


def _without_last_blank_lines(app: Sphinx, name: str, source: list[str]) -> None:
    """Examples end with a blank line, where the doctest reads the end of the output; pages need none."""
    source[0] = re.sub(r"\n\n```$", "\n```", source[0], flags=re.MULTILINE)


def _inline(translator: HTML5Translator, node: nodes.math) -> None:
    translator.body.append(convert(node.astext()))
    raise nodes.SkipNode


def _block(translator: HTML5Translator, node: nodes.math_block) -> None:
    translator.body.append(f"<p>{convert(node.astext(), display='block')}</p>")
    raise nodes.SkipNode
