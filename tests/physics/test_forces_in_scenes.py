"""Friction, loss, drives, forces and brakes in scenes, files and summaries: kept, checked, and booked."""

import pytest
from softcradle.physics import TimedForce, simulate
from softcradle.sandbox.trajectory_summary import summarise
from softcradle.scenes import parse

SCENE = """
title = "Wagons"
duration = 2.0
[[lanes]]
beads = [1, 2]
mass = 80e3
contact = {law = "draft_gear", stiffness = 2e7, precompression = 0.01, loss = 0.8}
velocity = 1.5
approach = 0.1
friction = 0.002
drive = [1.0, 0.0, "1/2"]
forces = [{beads = 0, time = [0, "1/2", 1], force = [0, 2, 0]}]
brakes = [{beads = [1, 2], time = [1, 1.5], force = [0, 3]}]
"""


def test_a_scene_has_what_acts_on_its_beads_and_its_tables_book_what_is_absorbed(tmp_path):
    scene = parse(SCENE)
    assert parse(scene.to_toml()) == scene
    chain = scene.lanes[0].chain()
    assert chain.friction == 0.002
    assert {contact.loss for contact in chain.contact} == {0.8}
    assert chain.drive == (1.0, 0.0, 0.5)
    assert chain.forces == (TimedForce(0, [0.0, 0.5, 1.0], [0.0, 2.0, 0.0]),)
    assert chain.brakes == (TimedForce([1, 2], [1.0, 1.5], [0.0, 3.0]),)
    found = simulate(chain, scene.lanes[0].velocity, 2.0, method="conserving")
    assert found.absorbed_by_contacts[-1] > 0.0
    found.to_csv(tmp_path / "wagons.csv")
    header, *rows = (tmp_path / "wagons.csv").read_text().splitlines()
    assert header.endswith("absorbed by contacts [J],absorbed by bed [J]")
    assert float(rows[-1].split(",")[-1]) == pytest.approx(found.absorbed_by_bed[-1])
    summary = summarise("", found)
    assert summary.energy_error < 1e-12
    assert summary.absorbed_by_contacts == found.absorbed_by_contacts[-1]
    assert summary.momentum_error is None
