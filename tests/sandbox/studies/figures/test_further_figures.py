"""Tests of the figures that are not in the paper. These figures show limits, parameter scans, variants of the chain,
and trains.

The tables of the figures must agree with their captions.
"""

import numpy as np
import pytest
from softcradle.sandbox.studies.data_table import rows_where
from softcradle.sandbox.studies.figures import coupler, disorder, rigidity, scaling, train, variant, wave
from softcradle.sandbox.studies.paper import DRIVE
from softcradle.scenes import load

from tests.sandbox.studies.figures.conftest import columns, forces

pytestmark = pytest.mark.slow  # These tests are slow because computing a table takes up to a minute.


# Step of 1/alpha between two samples of a velocity curve. With this step, linear interpolation is wrong by less than
# 0.005, even if the curve is jagged. An error of 0.005 is half the width of a line. With a step of 0.4, the error is
# larger.
DENSE = 0.11


def test_the_spread_vanishes_with_alpha(tables):
    for n in rigidity.SPREAD_SIZES:
        points = rows_where(tables("spread"), n=n)
        assert points["spread"][-1] > 0.5
        assert points["spread"][0] < 0.05
        assert (points["v striker"][0], points["v last"][0]) == pytest.approx(rigidity.rigid_outcome(n), abs=0.01)
        assert np.abs(np.diff(1.0 / points["alpha"])).max() < DENSE
    error = tables("spread")["velocity error"]
    assert (error > 0.0).all()
    assert error.max() < 1e-3


def test_rigid_like_behaviour_ends(tables):
    four = rows_where(tables("softness"), n=4)
    inverse = 1.0 / np.unique(four["alpha"])
    assert np.abs(np.diff(inverse[inverse > 4.0])).max() < DENSE
    cradle = rows_where(four, alpha=max(rigidity.LOSS_ALPHAS))["v"]
    assert cradle[-1] > 0.99
    assert np.abs(cradle[:-1]).max() < 0.1
    last = [rows_where(tables("softness"), n=n, alpha=0.1)["v over rigid"][-1] for n in rigidity.LONG_SIZES]
    assert (np.diff(last) > 0.0).all()
    assert last[-1] > 2.0


def test_limits_of_small_alpha(tables):
    for n in scaling.SIZES:
        points = rows_where(tables("scalings"), n=n)
        assert (np.diff(points["max psi"]) < 0.0).all()
        assert points["contact time"][-1] == pytest.approx(scaling.contact_time_limit(n), rel=0.02)
        assert np.isfinite(points["contact time"]).all()
        # The ratio of psi to its limit is tested only roughly. Psi itself varies by dozens of orders of magnitude with
        # the number of beads.
        assert 0.1 < points["max psi"][-1] / scaling.psi_limit(n, 1 / 200) < 10.0
        response = points["response time"] * np.sqrt(points["alpha"]) * (n / (n - 1)) ** (0.5 / points["alpha"])
        assert response[-2] == pytest.approx(response[-1], rel=0.05)


def test_in_train_forces_decrease_along_the_train(tables):
    table, coupling = tables("envelopes"), load(train.SOLID).lanes[0].chain().contact[0]
    for number, (struck, last) in enumerate(((1, 10), (5, 14))):
        blows = rows_where(table, train=number, coupling=struck)
        assert (np.diff(blows["force"]) > 0.0).all()
        # The travel of the coupler is sufficient up to a speed of 2.5 m/s.
        assert (blows["travel"] <= 1e3 * coupling.travel).sum() == 5
        for speed in train.SPEEDS:
            behind = rows_where(table, train=number, speed=speed)["force"][struck - 1 : last]
            assert (np.diff(behind) <= 1e-9).all()
    # A draft gear does not yield below its preload, so the force is at least the preload.
    forces = np.maximum(coupling.preload, coupling.force(1e-3 * table["travel"]))
    np.testing.assert_allclose(np.maximum(table["force"], 1e-3 * coupling.preload), 1e-3 * forces, rtol=5e-3)


def test_a_driven_cluster_oscillates_like_the_model(tables):
    table = tables("driven")
    np.testing.assert_allclose(table["V"], DRIVE / wave.SHOWN_BEADS * table["t"], atol=1e-9)
    psi, model = table["psi full"], table["psi model"]
    assert np.abs(psi - model).max() < 0.2 * model.max()
    assert (np.diff(np.sign(np.diff(psi))) < 0).sum() == wave.PERIODS
    beads = np.column_stack([table[f"v{i} - V"] for i in (1, 2, 3, 4)])
    np.testing.assert_allclose(beads.sum(axis=1), 0.0, atol=1e-9)
    # The velocities of beads 2 to 4 differ little in comparison with the oscillation of the first bead.
    assert np.ptp(beads[:, 1:], axis=1).max() < 0.1 * np.ptp(beads[:, 0])
    table = tables("driven-scan")
    np.testing.assert_allclose(table["period full"], table["period model"], rtol=0.06)
    np.testing.assert_allclose(table["amplitude full"], table["amplitude model"], rtol=0.03)
    own = rows_where(table, n=4, alpha=0.1)
    assert own["period full"] / own["period model"] == pytest.approx([1.0059], abs=2e-4)
    assert own["psi at the fifth return"] < 2e-5


def test_spreads_collapse_onto_one_curve(tables):
    table = tables("collapse")
    thresholds = {n: scaling.threshold(table, n, "n alpha") for n in scaling.COLLAPSE_SIZES}
    assert (np.diff(list(thresholds.values())) < 0.0).all()
    for n, found in thresholds.items():
        assert found == pytest.approx(float(scaling.threshold_law(np.array(n), 1.0 / 0.87)), rel=0.1)
        points = rows_where(table, n=n)
        assert (points["spread"][points["n alpha"] > 1.2 * found] > scaling.THRESHOLD).all()


def test_inner_contacts_ring_at_the_frequency_of_their_branch(tables):
    table = tables("ringing")
    rows = np.isfinite(table["period"])
    assert rows.sum() >= 15
    np.testing.assert_allclose(table["period"][rows], table["period of the branch"][rows], rtol=0.06)


def test_the_softer_the_slower_the_gear_that_does_the_same(tables):
    table = tables("equivalence")
    four = rows_where(table, n=4)
    at_tenth = int(np.argmin(np.abs(four["alpha"] - 0.1)))
    assert four["V over v_c"][at_tenth] == pytest.approx(1.26, abs=0.08)
    assert np.nanmax(table["apart"]) < 0.07
    # The best ratio must be inside the scanned range. At the end of the range, the true optimum could be outside.
    assert np.nanmax(table["V over v_c"]) < coupler.RATIOS[-1]


def test_disorder_breaks_the_cradle_and_weak_clusters(tables):
    table = tables("disorder")
    load, spreads = disorder.loads_and_spreads(table, disorder.SOFT)
    # If the contacts are strong enough, the cluster moves almost like a rigid body.
    assert spreads[load < 0.84].max() < 0.01
    assert spreads[load > 1.0].min() > 0.1  # If the contacts are too weak, the velocities of the cluster differ.
    assert disorder.loads_and_spreads(table, disorder.CRADLE)[1].min() > 0.5
    homogeneous = rows_where(table, kind=disorder.CRADLE, chain=0)["v"]
    last = [rows_where(table, kind=disorder.CRADLE, chain=k)["v"][-1] for k in range(1, disorder.CHAINS + 1)]
    assert homogeneous[-1] > 0.98
    assert np.std(last) > 0.1


def test_the_model_follows_cluster_on_cluster(tables):
    both = variant.STRIKERS + variant.TARGETS - 1
    for name, count, begin, end, apart in (("clusters", both, 0.1, 3.7, 0.01), ("interface", 4, 0.2, 2.2, 0.02)):
        table = tables(name)
        inside = (table["t"] > begin) & (table["t"] < end)
        model, full = (forces(table, kind, count)[inside] for kind in ("model", "full"))
        np.testing.assert_allclose(model, full, rtol=apart)
    assert columns(table, "v", 5)[-1] == pytest.approx([-0.6, 0.4, 0.4, 0.4, 0.4], abs=0.01)
    assert table["t"][table["f12 full"] > 0.0][-1] < table["t"][table["f01 full"] > 0.0][-1]


def test_only_evanescent_clusters_carry_no_waves(tables):
    table = tables("roads")
    turns = {kind: (np.diff(np.sign(np.diff(table[f"f23 {kind}"]))) != 0).sum() for kind in wave.STRUCK_CLUSTERS}
    assert turns["soft"] <= 2
    assert turns["springs"] > 10
    assert turns["prestressed"] > 4
    for kind, prestress in (("springs", wave.SPRING_PRESTRESS), ("prestressed", wave.SOFT_PRESTRESS)):
        # The total force of each contact stays positive, so no contact opens.
        assert all((table[f"f{i}{i + 1} {kind}"] > -prestress).all() for i in (1, 2, 3))
    late = table["t springs"] > 2.0
    assert np.column_stack([table[f"v{i} springs"][late].mean() for i in range(1, 5)]) == pytest.approx(0.4, abs=0.02)


def test_pulse_has_the_speed_of_the_solitary_wave(tables):
    table = tables("pulse")
    velocity = columns(table, "v", wave.PULSE_TARGETS + 1)
    arrival = table["t"][np.argmax(velocity, axis=0)]
    assert 10.0 / (arrival[22] - arrival[12]) == pytest.approx(0.840509, rel=5e-3)
    assert velocity[:, 15:25].max(axis=0) == pytest.approx(0.681631, rel=2e-3)
    assert velocity[-1, -1] > 0.95
