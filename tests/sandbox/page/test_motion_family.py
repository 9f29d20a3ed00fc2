"""Families of motions: every member is the scene with one parameter changed."""

from __future__ import annotations

import numpy as np
import pytest
from softcradle.sandbox.motion_words import describe
from softcradle.sandbox.page.motion_family import ALPHAS, SPEEDS, family
from softcradle.sandbox.page.shared_page import page_text
from softcradle.sandbox.scene_runs import load_scene
from softcradle.scenes.catalogue import parse

from softcradle import one_on, power_law, simulate


def test_a_family_over_alpha():
    scene = load_scene("one-on-four")
    played = family(scene, "alpha")
    assert len(played.members) == len(ALPHAS)
    assert played.members[played.first].name == "alpha = 1/10"
    for alpha, member in zip(ALPHAS, played.members, strict=True):
        (found,) = member.trajectories
        assert found.chain.contact[0].exponent == pytest.approx(alpha)
    cradle = played.members[-1].trajectories[0]
    alone = simulate(one_on(4, power_law(1.0, 1.0)), [1, 0, 0, 0, 0])
    np.testing.assert_allclose(cradle.final_velocity, alone.final_velocity, atol=1e-6)
    text = page_text(played)
    for k, member in enumerate(played.members):
        shown = text.split(f'<div class="member" data-member="{k}"')[1].split("</div>")[0]
        assert (describe("", member.trajectories[0]) in shown) == (k != played.first)
        assert ("The bead that was hit ends slower" in shown) == (
            k == played.first
        )  # the text of the scene's own alpha


def test_a_family_over_speed():
    played = family(load_scene("draft-gear-one-on-three"), "speed")
    own = played.members[played.first].trajectories[0].velocity[0]
    for factor, member in zip(SPEEDS, played.members, strict=True):
        np.testing.assert_allclose(member.trajectories[0].velocity[0], factor * own)


def test_the_scene_s_own_alpha_is_a_member():
    text = 'title = "x"\n[[lanes]]\nlabel = "alpha = 0.17"\nbeads = [1, 2]\nvelocity = 1.0\n'
    scene = parse(text + 'contact = {law = "power", f0 = 1.0, alpha = 0.17}\n')
    played = family(scene, "alpha", method="conserving")
    assert len(played.members) == len(ALPHAS) + 1
    assert played.members[played.first].name == "alpha = 17/100"
    labels = {member.labels[0] for member in played.members}
    assert labels == {"alpha = 0.17", ""}  # no member bears the alpha of another


def test_all_members_fit_on_the_axes():
    played = family(load_scene("one-on-four"), "speed")
    low, high = played.scales.velocity
    for (motion,) in played.motions:
        assert motion.velocity.min() >= low
        assert motion.velocity.max() <= high
        assert motion.force.max() <= played.scales.force
        assert played.scales.time[0] <= motion.time[0]
        assert motion.time[-1] <= played.scales.time[1]
