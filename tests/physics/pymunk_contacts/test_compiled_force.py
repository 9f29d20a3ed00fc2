"""Compiled callbacks: the same digits as Python ones, shared, and never used where anything is unexpected."""

import pytest
from softcradle.physics import hooke, power_law
from softcradle.physics.pymunk_contacts import compiled_force

from tests.helpers.own_process import python
from tests.helpers.spaces import LAWS, Quadratic, cradle, pair, run

compiled_only = pytest.mark.skipif(bool(compiled_force.unavailable()), reason=compiled_force.unavailable())


@pytest.mark.parametrize("law", LAWS)
@compiled_only
def test_compiled_and_python_give_the_same_digits(law):
    ends = []
    for compiled in (True, False):
        space, bodies, contacts = cradle(law, compiled)
        assert all(contact.native is compiled for contact in contacts)
        run(space)
        ends.append([tuple(body.position) + tuple(body.velocity) for body in bodies])
    assert ends[0] == ends[1]


@compiled_only
def test_many_contacts_share_one_compiled_function():
    before = compiled_force._callback()
    contacts = [cradle(power_law(1.0, 0.1 + 0.01 * i), True)[2] for i in range(50)]
    assert compiled_force._callback() is before
    assert len({id(contact._compiled_law) for row in contacts for contact in row}) == 200


def test_native_true_refuses_what_it_cannot_compile():
    with pytest.raises(RuntimeError, match="not a Contact"):
        pair(law=Quadratic(), native=True)


CHECK_FALLBACK = """
from softcradle.physics import hertz
from softcradle.physics.pymunk_contacts import compiled_force
from tests.helpers.spaces import cradle, run
space, balls, contacts = cradle(hertz(1e4), beads=3)
run(space, 1e-4, 1000)
print(compiled_force.unavailable(), [c.native for c in contacts], [b.velocity.x.hex() for b in balls], sep="|")
try:
    cradle(hertz(1.0), native=True)
except RuntimeError as error:
    print("refused", error)
"""


def test_without_compiler_the_python_callback_gives_the_same_digits():
    without = python("-c", CHECK_FALLBACK, NUMBA_DISABLE_JIT="1").stdout.splitlines()
    reason, used, digits = without[0].split("|")
    assert "NUMBA_DISABLE_JIT" in reason
    assert used == "[False, False]"
    assert without[1].startswith("refused no compiled callback")
    assert "native=None" in without[1]
    usual = python("-c", CHECK_FALLBACK, NUMBA_DISABLE_JIT="0").stdout.splitlines()[0].split("|")
    assert usual[2] == digits


def test_another_memory_layout_is_noticed(monkeypatch):
    """As if pymunk kept something else in the slot: the callback is not used, the contact works."""
    compiled_force._callback.cache_clear()
    monkeypatch.setattr(compiled_force, "LAW_SLOT", 17)
    try:
        assert "another way" in compiled_force.unavailable()
        space, (a, _), contact = pair(0.75, hooke(10.0))
        space.step(1.0)
        assert contact.native is False
        assert a.velocity.x == -2.5
    finally:
        compiled_force._callback.cache_clear()
