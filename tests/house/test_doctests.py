"""Every example in a docstring runs, under the name that users import it by."""

import doctest
from importlib import import_module

import pytest

from tests.helpers.paths import module_name, source_files

FLAGS = doctest.NORMALIZE_WHITESPACE | doctest.ELLIPSIS


MODULES = [module_name(path) for path in source_files() if ">>> " in path.read_text(encoding="utf-8")]


@pytest.mark.parametrize("name", MODULES)
def test_examples_run(name):
    failed, tried = doctest.testmod(import_module(name), optionflags=FLAGS)
    assert tried > 0
    assert failed == 0
