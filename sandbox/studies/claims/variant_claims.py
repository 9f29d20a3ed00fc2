"""Statements on variants of the set-up: Sec. V, Appendices A and C."""

from __future__ import annotations

import numpy as np
from softcradle.physics import Chain, cluster_on_cluster, draft_gear, hertz, one_on
from softcradle.physics.analysis.closed_forms import rigid_collision
from softcradle.sandbox.studies.claims.claim import Claim, verdict_of
from softcradle.sandbox.studies.claims.turning_points import turning_points
from softcradle.sandbox.studies.data_table import Array, Table
from softcradle.sandbox.studies.figures import disorder_figure, variant_figure, wave_figure
from softcradle.sandbox.studies.figures.solved_cases import ALPHA, N, full_motion, soft_chain, start_velocity

GEAR = draft_gear(770.0, 0.0177)  # spring constant [N/m] and pre-compression [m] of Appendix C
GEAR_MASS = 0.396  # [kg]


def _outcome(chain: Chain, strikers: int = 1) -> Array:
    """(n+1,) velocities after the collision at unit speed."""
    return full_motion(chain, start_velocity(chain, strikers), samples=2).final_velocity


def _distance_from_rigid(velocity: Array, strikers: int = 1) -> float:
    """Largest difference of `velocity` (n+1,) from that of two rigid bodies of equal beads."""
    return float(np.abs(velocity - rigid_collision(np.ones(len(velocity)), strikers)).max())


def robust() -> Claim:
    """Secs. III, V: heterogeneity."""
    table = disorder_figure.outcomes()
    load, spread = disorder_figure.loads_and_spreads(table, disorder_figure.SOFT)
    light, heavy = spread[load < 0.84], spread[load > 1.0]
    cradle = table["kind"] == disorder_figure.CRADLE
    first, last = (cradle & (table["bead"] == bead) for bead in (0, disorder_figure.TARGETS))
    momentum = table["mass"][last] * table["v"][last] / table["mass"][first]
    load_decides = bool(light.max() < 0.01 and heavy.min() > 0.1)
    return Claim(
        "robust",
        "rigid-like behaviour is robust against heterogeneity if all exponents are small; in the usual cradle the "
        "pulse is highly perturbed by it",
        "Secs. III, V",
        f"{disorder_figure.CHAINS} random chains of {disorder_figure.TARGETS} targets, masses and strengths between 1/2 and 2, "
        f"exponents between 1/50 and 1/30: the targets' velocities spread by at most {100 * light.max():.2f} % in "
        f"{light.size} chains whose contacts are strong enough, but by {100 * heavy.min():.0f} to "
        f"{100 * heavy.max():.0f} % in {heavy.size} in which an inner contact has to pass on more than its f0, "
        "that is f0_(0,1) (m_(i+1) + ... + m_n) / (m_1 + ... + m_n) > f0_(i,i+1): there no exponent is small "
        f"enough. In the cradle the last bead takes {100 * momentum[1:].min():.0f} to "
        f"{100 * momentum[1:].max():.0f} % of the momentum, {100 * momentum[0]:.1f} % in the homogeneous one",
        "full equations, the same masses and strengths for both",
        verdict_of(bool(spread.max() < 0.1), load_decides and momentum[0] > 0.95 and momentum[1:].min() < 0.8),
        {
            "light": float(light.max()), "heavy": float(heavy.min()), "alike": float(spread[0]),
            "least momentum": float(momentum[1:].min()), "momentum alike": float(momentum[0]),
        },
    )  # fmt: skip


def hooke_interface() -> Claim:
    """App. A (iii): a linear spring between striker and cluster."""
    distance = _distance_from_rigid(_outcome(variant_figure.INTERFACE_CHAIN))
    without = _distance_from_rigid(_outcome(soft_chain(N, ALPHA)))
    return Claim(
        "hooke-interface",
        "a truncated Hooke spring between striker and cluster works as well",
        "App. A (iii), data not shown",
        f"velocities are within {distance:.4f} of those of a rigid cluster: better than without ({without:.3f}), "
        "because the force of a linear spring falls to 0 gradually",
        "one on 4, k = 1, inner alpha = 1/10",
        verdict_of(distance < without),
        {"off": distance, "off without": without},
    )


def second_mode() -> Claim:
    """App. A (ii): cluster on cluster."""
    table, strikers = variant_figure.clusters(), variant_figure.STRIKERS
    chain = variant_figure.CLUSTERS_CHAIN
    intervals = full_motion(chain, start_velocity(chain, strikers), samples=2).contact_intervals
    closed = (table["t"] > 0.05) & (table["t"] < 0.95 * min(spans[0][1] for spans in intervals))
    names = [f"f{i}{i + 1}" for i in range(chain.contacts)]
    ratios = [table[f"{name} model"][closed] / table[f"{name} full"][closed] for name in names]
    errors = [float(np.abs(ratio - 1.0).max()) for ratio in ratios]
    modes, largest = max(errors[strikers - 2 : strikers + 1]), max(errors)
    return Claim(
        "second-mode",
        "cluster on cluster needs but one more evanescent mode, for the hitting cluster",
        "App. A (ii)",
        f"3 on 5, alpha = 1/14: the model's forces are within {modes:.1e} for Phi, psi and psi-bar, within "
        f"{largest:.1e} for all",
        "model of four beads against the full equations, t = 0.05 to 95 % of the time until the first contact opens",
        verdict_of(modes < 0.01 and largest < 0.03),
        {"modes": modes, "all": largest},
    )


def exchanged() -> Claim:
    """App. A (i): striker and target exchanged."""
    table = variant_figure.exchange()
    difference = max(float(np.abs(table[f"v{i} seen"] - table[f"v{i}"]).max()) for i in range(N + 1))
    return Claim(
        "exchanged",
        "by Galilean invariance the roles of striker and cluster can be exchanged",
        "App. A (i)",
        f"four on one, seen from the strikers and mirrored, is one on four: velocities differ by {difference:.0e} at most",
        "full equations, alpha = 1/10, t = 0 ... 3",
        verdict_of(difference < 1e-7),
        {"difference": difference},
    )


def waves_need_prestress() -> Claim:
    """Secs. I and V: fast waves, prestress, evanescence."""
    table = wave_figure.roads()
    # stiff springs: while the striker pushes; it has left by 1.6
    counts = {"soft": _turns(table, "soft"), "springs": _turns(table, "springs", 1.6)}
    counts["prestressed"] = _turns(table, "prestressed")
    late = table["t springs"] > 2.0
    means = np.array([table[f"v{i} springs"][late].mean() for i in range(1, N + 1)])
    rigid = np.abs(means - 0.4).max()
    return Claim(
        "waves",
        "stiff springs reach the rigid body through fast waves; soft contacts have no oscillating modes unless "
        "prestressed",
        "Secs. I and V",
        f"while the striker pushes, the force in the middle of the cluster has {counts['soft']} turning point without "
        f"prestress, {counts['springs']} with stiff springs (targets then move within {rigid:.3f} of 0.4 on average); "
        f"under a prestress of {wave_figure.SOFT_PRESTRESS} the soft chain oscillates when struck lightly: "
        f"{counts['prestressed']} turning points",
        f"one on 4; springs of 400, held together by a steady force of {wave_figure.SPRING_PRESTRESS:.0f}",
        verdict_of(counts["soft"] == 1 and min(counts["springs"], counts["prestressed"]) > 5 and rigid < 0.02),
        {name: float(count) for name, count in counts.items()} | {"rigid": float(rigid)},
    )


def _turns(table: Table, name: str, until: float = np.inf) -> int:
    """Turning points of the force in the middle of the cluster, up to the time `until`."""
    return turning_points(table[f"f23 {name}"][table[f"t {name}"] < until])


def draft_gears() -> Claim:
    """App. C: the experiment without friction."""
    three = _distance_from_rigid(_outcome(one_on(3, GEAR, GEAR_MASS)))
    pairs = _distance_from_rigid(_outcome(cluster_on_cluster(2, 2, GEAR, GEAR_MASS), 2), 2)
    distance = max(three, pairs)
    cradle = float(_outcome(one_on(3, hertz(1e6), GEAR_MASS))[-1])
    return Claim(
        "draft-gears",
        "pre-compressed springs give rigid-like behaviour; without the pistons the last bead is kicked out",
        "App. C",
        f"at 1.0 m/s one on three and two on two come out as two rigid bodies within {distance:.1e}; no inner contact is "
        "ever loaded, so there is no evanescent profile to look for. With pistons locked (Hertz) the last bead takes "
        f"{100 * cradle:.0f} % of the velocity",
        "k = 770 N/m, 17.7 mm, 0.396 kg, no friction; touching contacts carry the force that holds the beads together",
        verdict_of(distance < 1e-6 and cradle > 0.9),
        {"off": distance, "cradle": cradle},
    )


MEASUREMENTS = (robust, hooke_interface, second_mode, exchanged, waves_need_prestress, draft_gears)
