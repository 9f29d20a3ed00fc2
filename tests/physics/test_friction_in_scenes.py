"""Friction and loss in scenes, files and the session: kept, checked, and booked."""

import pytest
from softcradle.physics import Trajectory, simulate
from softcradle.sandbox.trajectory_summary import summarise
from softcradle.scenes import parse

SCENE = """
title = "Wagons"
[[lanes]]
beads = [1, 2]
mass = 80e3
contact = {law = "draft_gear", stiffness = 2e7, precompression = 0.01, loss = 0.8}
velocity = 1.5
approach = 0.1
friction = 0.002
"""


def test_scene_and_files_keep_friction_and_loss(tmp_path):
    scene = parse(SCENE)
    assert parse(scene.to_toml()) == scene
    lane = scene.lanes[0]
    chain = lane.chain()
    assert chain.friction == 0.002
    assert {contact.loss for contact in chain.contact} == {0.8}
    found = simulate(chain, lane.velocity, method="conserving")
    found.save(tmp_path / "wagons.npz")
    read = Trajectory.load(tmp_path / "wagons.npz")
    assert read.chain == chain
    assert (read.ledger == found.ledger).all()
    assert read.absorbed_by_contacts[-1] > 0.0
    found.to_csv(tmp_path / "wagons.csv")
    header, *rows = (tmp_path / "wagons.csv").read_text().splitlines()
    assert header.endswith("absorbed by contacts [J],absorbed by bed [J]")
    assert float(rows[-1].split(",")[-1]) == pytest.approx(found.absorbed_by_bed[-1])
    summary = summarise("", found)
    assert summary.energy_error < 1e-12
    assert summary.absorbed_by_contacts == found.absorbed_by_contacts[-1]
    assert summary.momentum_error is None
