"""Tests of contact laws that are written as a line of text. The tests check reading, writing and error messages."""

import pytest
from hypothesis import given
from hypothesis import strategies as st
from softcradle.scenes import SceneError, parse
from softcradle.scenes.contact_kinds import KINDS
from softcradle.scenes.contact_table import law_of, read_law
from softcradle.scenes.contact_text import contact_from, contact_text

from softcradle import physics


def test_names_numbers_and_fractions():
    for arguments in ("(2, 1/14)", "_law( f0 = 2 , alpha = 1/14 ) ", "(2, alpha=1/14)", "_law(2.0,1 / 14)"):
        assert contact_from(f" power{arguments}").contact() == physics.power_law(2.0, 1 / 14)
    assert contact_text(physics.draft_gear(770.0, 0.0177)) == "draft_gear(770, 0.0177)"
    rounded = next(one for k in range(1, 99) if law_of(one := physics.Contact(k / 10.0, 0.7, 1.0)).law == "preloaded")
    # Only the text contains the rounded number. No precompression gives exactly these digits.
    assert contact_text(rounded).startswith("draft_gear(0.7, ")


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("power_law", "must be a law with its numbers, such as power_law(1, 1/10)"),
        ("pwer_law(1, 2)", "unknown law 'pwer_law' (did you mean 'power_law'?)"),
        ("power_law(1)", "contact 'power_law(1)': key 'alpha' is missing"),
        ("power_law(1, soft)", "alpha must be a number, not 'soft'"),
        ("power_law(1, inf)", "alpha must be a finite number, not inf"), ("power_law(1, 1/0)", "must not divide by zero"),
        ("power_law(1, f0=2)", "f0 is given twice"), ("power_law(1, beta=2)", "unknown key 'beta'"),
        ("hertz(1, loss=1)", "loss must be less than 1"), ("hertz(1, 2)", "the numbers of hertz are stiffness, and loss=..."),
        ("draft_gear(true, 1)", "stiffness must be a number, not True"),
    ],
)  # fmt: skip
def test_refusals(text, sentence):
    with pytest.raises(SceneError) as error:
        contact_from(text)
    assert sentence in str(error.value)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.law)
def test_a_contact_is_read_by_its_present_and_former_name(kind):
    numbers = {name: 0.25 + k for k, name in enumerate(kind.numbers)}
    expected, lossy = kind.constructor(**numbers), kind.constructor(**numbers, loss=0.25)
    assert law_of(lossy).model_dump() == {"law": kind.law, **numbers, "loss": 0.25}
    arguments = ", ".join(map(str, numbers.values()))
    for contact, text in ((expected, f"{kind.law}({arguments})"), (lossy, f"{kind.law}({arguments}, loss=0.25)")):
        assert contact_from(text).contact() == contact
        assert contact_text(contact_from(text)) == contact_text(contact) == text
    for name in filter(None, (kind.law, kind.former)):
        assert read_law({"law": name, **numbers}).contact() == expected
        assert contact_from(f"{name}({arguments})").contact() == expected
        file = "\n".join([f'law = "{name}"', *(f"{key} = {value}" for key, value in numbers.items())])
        scene = parse(f'title = "t"\n[[lanes]]\nvelocity = [1, 0]\n[lanes.contact]\n{file}')
        assert scene.lanes[0].chain().contact == (expected,)
        assert f'law = "{kind.law}"' in scene.to_toml()


SIZE = st.floats(1e-9, 1e9)


@given(SIZE | st.just(0.0), SIZE, st.floats(0.01, 3.0) | st.sampled_from([1.0, 1.5]), st.floats(0.0, 0.9))
def test_the_table_of_any_contact_gives_exactly_its_numbers(preload, stiffness, exponent, loss):
    contact = physics.Contact(preload, stiffness, exponent, loss)
    assert law_of(contact).contact() == contact
    assert law_of(physics.Contact(preload + 1.0, 0.0, exponent)).contact() == physics.step_force(preload + 1.0)
    gear = physics.draft_gear(stiffness, preload)
    assert (law_of(gear).law, law_of(gear).contact()) == ("draft_gear" if preload else "hooke", gear)
