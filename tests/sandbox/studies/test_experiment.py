"""Tests of the scenes for the paper's experiment, in which beads slide with friction, and of the scenes with trains.

The tests also check the fit of the friction coefficient.
"""

import json
import math
from itertools import product

import numpy as np
import pytest
from scipy.optimize import brentq
from softcradle.physics import simulate
from softcradle.sandbox.studies import experiment
from softcradle.sandbox.studies.experiment import PISTON, PRECOMPRESSION, STIFFNESS, Apparatus, piston_deficits

from softcradle import scenes

GEAR_TRAVEL = 0.083  # Travel of one draft gear [m]. A coupling between two wagons has two gears.


def test_scenes_of_the_experiment_have_the_fitted_values():
    (fit, _) = experiment.fit_friction(0.5)
    for name, strikers in (("experiment-one-on-three", 1), ("experiment-two-on-two", 2)):
        lane = scenes.load(name).lanes[0]
        chain = lane.chain()
        assert chain.mass == experiment.MASS
        assert chain.friction == pytest.approx(fit.friction, rel=2e-2)
        lost = experiment.deficits(strikers, 0.5, float(chain.friction), chain.loss[0])
        assert experiment.MOMENTUM_DEFICIT[0] <= lost.momentum <= experiment.MOMENTUM_DEFICIT[1]
        assert experiment.ENERGY_DEFICIT[0] <= lost.energy <= experiment.ENERGY_DEFICIT[1]
        found = simulate(chain, lane.velocity, 1.5)
        assert (found.velocity[-1] == 0.0).all()
        # The targets come to rest without separating from each other.
        assert np.ptp(found.position[-1, strikers:]) < 1e-6
        assert found.absorbed_by_bed[-1] + found.absorbed_by_contacts[-1] == pytest.approx(found.ledger[0], rel=1e-9)


def test_the_fit_of_friction_is_the_root_of_the_deficit(softcradle, tmp_path):
    """Compare the friction coefficient found by `fit` with the result of a root search.

    The fit is run both as a Python function and as a command.
    """
    root = brentq(lambda friction: experiment.deficits(1, 0.5, friction).momentum - 0.075, 0.0, 1.0, xtol=1e-13)
    assert experiment.friction_for(0.075, 1, 0.5) == pytest.approx(root, rel=1e-9)
    (tmp_path / "one.toml").write_text(experiment.collision_scene(1, 0.5, 0.01).to_toml(), encoding="utf-8")
    words = ("--goal", "missing momentum = 5..10 %", "--free", "lanes.0.friction=0..1", "--json")
    found = json.loads(softcradle("fit", str(tmp_path / "one.toml"), *words).out)["values"]["lanes.0.friction"]
    low, high = (experiment.friction_for(part, 1, 0.5) for part in experiment.MOMENTUM_DEFICIT)
    assert found["value"] == pytest.approx(root, rel=1e-9)
    assert found["error"] == pytest.approx(0.5 * (high - low), rel=0.02)


@pytest.mark.parametrize("name", ["train-shunting", "train-cut"])
def test_draft_gears_of_the_train_have_the_data_of_railways(name):
    lane = scenes.load(name).lanes[0]
    coupling = lane.chain().contact[0]
    assert 2.0e6 <= float(coupling.force(2 * GEAR_TRAVEL)) <= 2.3e6
    assert 45e3 <= coupling.loss * float(coupling.energy(2 * GEAR_TRAVEL)) / 2 <= 62e3
    assert coupling.loss >= 0.8
    assert 2e5 <= coupling.preload <= 5e5
    found = simulate(lane.chain(), lane.velocity, 2.5, "conserving")
    assert found.overlap.max() < 2 * GEAR_TRAVEL
    assert np.ptp(found.ledger) < 1e-10 * found.ledger[0]
    struck = int(np.argmax(np.diff(lane.velocity) != 0.0))
    peaks = found.force.max(axis=0)
    assert (np.diff(peaks[struck:]) < 0.0).all()  # The peak force decreases from one gear to the next along the train.
    assert (np.diff([intervals[0][0] for intervals in found.contact_intervals[struck:]]) > 0.0).all()


def test_caught_pistons_take_energy_and_no_momentum():
    """Check the energy that is lost when loose pistons of 20 g are caught, without friction.

    In the collision of one bead with three, the pistons take 9.2 % of the energy. Each of the two catches takes the
    fraction m_p/(m + m_p).
    """
    setup = Apparatus(STIFFNESS, PRECOMPRESSION, 0.0)
    momentum, energy = piston_deficits(1, 0.5, setup, PISTON, 0.0)
    assert abs(momentum) < 1e-12
    share = PISTON / (experiment.MASS[0] + PISTON)
    assert energy == pytest.approx(2.0 * share, rel=0.06)
    moments, lines = (piston_deficits(1, 0.5, setup, 1e-9, window) for window in (0.0, 0.02))
    assert moments == pytest.approx((0.0, 0.0), abs=1e-8)
    # The deficits measured with the frame rate of the camera agree with the exact ones, because no friction slows the
    # beads.
    assert lines == pytest.approx(moments, abs=1e-7)


@pytest.mark.usefixtures("one_core")
def test_the_experiment_command_reports_fits_and_pistons(softcradle, tmp_path, monkeypatch):
    """Check the results of the command `softcradle experiment`.

    One friction coefficient explains the momentum deficits of both experiments but not the energy deficits. Loose
    pistons explain both. The error of v_c follows from v_c being proportional to sqrt(k) Delta0.
    """
    found = experiment.compute_experiment()
    monkeypatch.setattr(experiment, "compute_experiment", lambda **_: found)
    shown = softcradle("experiment", "-o", str(tmp_path / "x.json")).out
    assert "1.013 ± 0.004 m/s" in shown
    assert "pistons of 20 g" in shown
    printed = json.loads((tmp_path / "x.json").read_text(encoding="utf-8"))
    assert json.loads(softcradle("experiment", "--json", "-o", str(tmp_path / "x.json")).out) == printed
    assert set(printed) == {"fits", "pistons", "critical speeds", "open", "versions"}
    cases = set(product(experiment.STRIKERS, experiment.SPEEDS))
    assert {(fit["experiment"], fit["speed"]) for fit in printed["fits"]} == cases
    for fit in printed["fits"]:
        assert experiment.MOMENTUM_DEFICIT[0] <= fit["deficits"]["momentum"] <= experiment.MOMENTUM_DEFICIT[1]
        assert f"energy deficits of {100.0 * fit['deficits']['energy']:.0f} %" in printed["open"]
    pistons = {(one["experiment"], one["speed"], one["window"]): one for one in printed["pistons"]}
    for case in cases:
        momentum, energy = (pistons[*case, 0.0][kind] for kind in ("momentum", "energy"))
        assert experiment.MOMENTUM_DEFICIT[0] <= momentum["value"] <= experiment.MOMENTUM_DEFICIT[1]
        assert experiment.ENERGY_DEFICIT[0] <= energy["value"] <= experiment.ENERGY_DEFICIT[1]
        assert 0.005 < momentum["error"] < 0.02
        # With a time window of 0.04 s, the deficit is larger because the beads continue to slide.
        assert pistons[*case, 0.04]["momentum"]["value"] > momentum["value"]
    found = printed["critical speeds"]["one on three"]
    parts = 0.5 * experiment.STIFFNESS_ERROR / STIFFNESS, experiment.PRECOMPRESSION_ERROR / PRECOMPRESSION
    assert found["value"] == pytest.approx(1.013, abs=1e-3)
    assert found["error"] == pytest.approx(found["value"] * math.hypot(*parts), rel=0.01)
