"""The case that most tests of the work-precision chart use."""

import pytest
from softcradle.sandbox.studies.precision.cases import CASE_DEFINITIONS


@pytest.fixture(scope="session")
def definitions():
    return {definition.name: definition for definition in CASE_DEFINITIONS}


@pytest.fixture(scope="session")
def case(definitions):
    return definitions["one-on-4"].solve()
