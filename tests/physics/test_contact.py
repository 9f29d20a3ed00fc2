"""Tests of the contact law. The force is the derivative of the energy. The overlap is the inverse function of the
force. Each push determines one overlap.
"""

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from softcradle.physics import Contact, draft_gear, hertz, hooke, power_law, step_force
from softcradle.physics.analysis.closed_forms import one_on_one
from softcradle.physics.contact import is_closed
from softcradle.physics.numerics import law_kernels as kernel

preloads = st.one_of(st.just(0.0), st.floats(1e-3, 1e3))
stiffnesses = st.floats(1e-3, 1e3)
exponents = st.one_of(st.sampled_from([0.1, 1 / 14, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0]), st.floats(0.02, 3.0))
contacts = st.one_of(st.builds(Contact, preloads, stiffnesses, exponents), st.builds(step_force, st.floats(1e-3, 1e3)))
overlaps = st.floats(-12.0, 2.0).map(lambda power: 10.0**power)


def row(contact):
    return contact.preload, contact.stiffness, contact.exponent


@given(contacts, overlaps)
def test_force_is_the_slope_of_energy(contact, overlap):
    width = 1e-4 * overlap
    slope = (contact.energy(overlap + width) - contact.energy(overlap - width)) / (2.0 * width)
    # The allowed difference consists of the truncation error (width**2 / 6 times the third derivative) and the
    # round-off of the difference quotient.
    assert slope == pytest.approx(contact.force(overlap), rel=1e-7)


@given(contacts, overlaps)
def test_overlap_undoes_force(contact, overlap):
    assume(contact.stiffness > 0.0)
    force = contact.force(overlap)
    # Factor by which the subtraction of the preload amplifies the relative round-off.
    lost = 1.0 + contact.preload / (contact.stiffness * overlap**contact.exponent)
    assume(lost < 1e6)
    assert contact.overlap(force) == pytest.approx(overlap, rel=4e-15 * lost * max(1.0, 1.0 / contact.exponent))


@given(contacts, st.floats(0.0, 1.0), st.floats(0.0, 1e3))
def test_a_preload_is_carried_without_overlap(contact, part, distance):
    assert contact.overlap(part * contact.preload) == 0.0
    assert contact.force(-distance) == 0.0
    assert contact.energy(-distance) == 0.0


@given(contacts, overlaps)
def test_the_law_is_a_preloaded_power_by_kernels_too(contact, overlap):
    """Compare the contact law with its formula, in Python and in the kernels. Some exponents and the stiffness 0 have
    separate formulas in the kernels.
    """
    preload, stiffness, exponent = row(contact)
    force = preload + stiffness * overlap**exponent
    energy = preload * overlap + stiffness * overlap ** (1.0 + exponent) / (1.0 + exponent)
    assert [contact.force(overlap), kernel.force(*row(contact), overlap)] == pytest.approx([force] * 2, rel=5e-15)
    assert [contact.energy(overlap), kernel.energy(*row(contact), overlap)] == pytest.approx([energy] * 2, rel=5e-15)
    assert kernel.force(*row(contact), -overlap) == kernel.energy(*row(contact), -overlap) == 0.0
    assert kernel.force(*row(contact), 0.0) == contact.force(0.0)


def test_named_constructors():
    assert row(power_law(2.0, 0.1)) == (0.0, 2.0, 0.1)
    assert row(draft_gear(770.0, 0.0177)) == (770.0 * 0.0177, 770.0, 1.0)
    assert row(hertz(3.0)) == (0.0, 3.0, 1.5)
    assert row(hooke(3.0)) == (0.0, 3.0, 1.0)
    assert row(step_force(3.0))[:2] == (3.0, 0.0)
    assert step_force(2.0).overlap([1.0, 2.0, 2.1]).tolist() == [0.0, 0.0, math.inf]
    # This is Eq. (C1) of the paper.
    assert draft_gear(770.0, 0.0177).force(0.01) == pytest.approx(770.0 * (0.0177 + 0.01))


def test_arrays_keep_their_shape_and_scalars_are_floats():
    contact, overlap = Contact(1.0, 2.0, 0.5), np.array([[-1.0, 0.0, 0.25], [1.0, 4.0, 9.0]])
    assert contact.force(overlap).tolist() == [[0.0, 0.0, 2.0], [3.0, 5.0, 7.0]]
    for method in (contact.force, contact.energy, contact.overlap):
        assert type(method(2.0)) is float
        assert method(overlap).shape == (2, 3)
        assert [method(d) for d in overlap.ravel()] == method(overlap).ravel().tolist()


def test_a_contact_is_closed_if_it_overlaps_or_pushes_or_pulls():
    overlap = [-1.0, -1.0, 0.0, 0.0, 0.5, 0.5, 0.0]
    force = [0.0, -4.0, 0.0, 0.5, 0.0, 0.5, -0.5]
    assert is_closed(overlap, force).tolist() == [False, True, False, True, True, True, True]


@pytest.mark.parametrize("loss", [0.0, 0.75])
@pytest.mark.parametrize("exponent", [1e-6, 0.1, 1.0, 1.5, 10.0])
def test_a_contact_of_a_contact_time(exponent, loss):
    contact = Contact.by_contact_time(0.05, mass=0.7, speed=3.0, exponent=exponent, loss=loss)
    assert one_on_one(contact, 0.7, 3.0).contact_time == pytest.approx(0.05, rel=1e-13)
    assert (contact.preload, contact.exponent, contact.loss) == (0.0, exponent, loss)


@pytest.mark.parametrize(
    ("make", "sentence"),
    [
        (lambda: hooke(1.0, damping=5.0), "hooke takes stiffness and loss, not damping: `loss` is the part"),
        (lambda: draft_gear(1.0, 0.1, restitution=0.5), "takes stiffness, precompression and loss, not restitution"),
        (lambda: hooke(1.0, 0.1, 0.2), "takes from 1 to 2 positional arguments but 3 were given"),
    ],
)
def test_an_unknown_keyword_lists_those_that_there_are(make, sentence):
    with pytest.raises(TypeError, match=sentence):
        make()


def test_a_hertz_contact_from_material_and_radius():
    """Compare with Hertz's formula for an aluminium sphere on a flat wall and for two spheres of different materials."""
    k = Contact.of_spheres(70e9, 0.33, (0.1, math.inf)).stiffness
    assert k == pytest.approx(4.0 / 3.0 * 70e9 / (2.0 * (1.0 - 0.33**2)) * math.sqrt(0.1), rel=1e-14)
    law = Contact.of_spheres((210e9, 70e9), (0.3, 0.33), (0.01, 0.02), loss=0.19)
    e = 1.0 / ((1.0 - 0.3**2) / 210e9 + (1.0 - 0.33**2) / 70e9)
    assert law.stiffness == pytest.approx(4.0 / 3.0 * e * math.sqrt(0.01 * 0.02 / 0.03), rel=1e-14)
    assert (law.preload, law.exponent, law.loss) == (0.0, 1.5, 0.19)


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        ((0.0, 0.3, 0.1), "young must be a finite number > 0, not 0.0"),
        ((1e9, 0.6, 0.1), "poisson must be from -1 to 0.5, not 0.6"),
        ((1e9, 0.3, math.inf), "two flat walls"),
        ((1e9, 0.3, [0.1, 0.2, 0.3]), "radius must be one number or a pair, not"),
    ],
)
def test_no_hertz_contact_from_a_material_that_is_not_one(arguments, sentence):
    with pytest.raises(ValueError, match=sentence):
        Contact.of_spheres(*arguments)
