"""Statements on variants of the set-up: Sec. V, Appendices A and C."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from softcradle.physics import cluster_on_cluster, draft_gear, hertz, one_on, power_law
from softcradle.sandbox.studies.claims import Claim, judged
from softcradle.sandbox.studies.figures import disorder_figure as disorder
from softcradle.sandbox.studies.figures import variant_figure as variants
from softcradle.sandbox.studies.figures import wave_figure as waves
from softcradle.sandbox.studies.figures.solved_cases import ALPHA, N, Table, solved, start

GEAR = draft_gear(770.0, 0.0177)  # spring constant [N/m] and pre-compression [m] of Appendix C
GEAR_MASS = 0.396  # [kg]


def robust() -> Claim:
    """Heterogeneity."""
    table = disorder.outcomes()
    load, soft = disorder.loads_and_spreads(table, disorder.SOFT)
    light, heavy = soft[load < 0.84], soft[load > 1.0]
    usual = table["kind"] == disorder.CRADLE
    first, last = (usual & (table["bead"] == bead) for bead in (0, disorder.TARGETS))
    momentum = table["mass"][last] * table["v"][last] / table["mass"][first]
    parted = bool(light.max() < 0.01 and heavy.min() > 0.1)
    return Claim(
        "robust",
        "rigid-like behaviour is robust against heterogeneity if all exponents are small; in the usual cradle the "
        "pulse "
        "is highly perturbed by it",
        "Secs. III, V",
        f"{disorder.CHAINS} random chains of {disorder.TARGETS} targets, masses and strengths between 1/2 and 2, "
        f"exponents "
        f"between 1/50 and 1/30: the targets' velocities spread by at most {100 * light.max():.2f} % in {light.size} "
        f"chains "
        f"whose contacts are strong enough, but by {100 * heavy.min():.0f} to {100 * heavy.max():.0f} % in "
        f"{heavy.size} in "
        "which an inner contact has to pass on more than its f0, that is f0_(0,1) (m_(i+1) + ... + m_n) / (m_1 + ... "
        "+ m_n) "
        "> f0_(i,i+1): there no exponent is small enough. In the cradle the last bead takes "
        f"{100 * momentum[1:].min():.0f} to {100 * momentum[1:].max():.0f} % of the momentum, "
        f"{100 * momentum[0]:.1f} % in "
        "the homogeneous one",
        "full equations, the same masses and strengths for both",
        judged(bool(soft.max() < 0.1), parted and momentum[0] > 0.95 and momentum[1:].min() < 0.8),
        {
            "light": float(light.max()), "heavy": float(heavy.min()), "alike": float(soft[0]),
            "least momentum": float(momentum[1:].min()), "momentum alike": float(momentum[0]),
        },
    )  # fmt: skip


def hooke_interface() -> Claim:
    """App. A (iii)."""
    velocity = solved(variants.INTERFACE, start(variants.INTERFACE), samples=2).final_velocity
    off = float(np.abs(velocity - [-0.6, 0.4, 0.4, 0.4, 0.4]).max())
    alone = solved(one_on(N, power_law(1.0, ALPHA)), start(variants.INTERFACE), samples=2).final_velocity
    worse = float(np.abs(alone - [-0.6, 0.4, 0.4, 0.4, 0.4]).max())
    return Claim(
        "hooke-interface",
        "a truncated Hooke spring between striker and cluster works as well",
        "App. A (iii), data not shown",
        f"velocities are within {off:.4f} of those of a rigid cluster: better than without ({worse:.3f}), because a "
        f"linear "
        "spring lets go gently",
        "one on 4, k = 1, inner alpha = 1/10",
        judged(off < worse),
        {"off": off, "off without": worse},
    )


def second_mode() -> Claim:
    """App. A (ii)."""
    table = variants.clusters()
    ends = solved(variants.CLUSTERS, start(variants.CLUSTERS, variants.STRIKERS), samples=2).contact_intervals
    inside = (table["t"] > 0.05) & (table["t"] < 0.95 * min(span[0][1] for span in ends))
    kept = range(variants.STRIKERS - 2, variants.STRIKERS + 1)
    off = {i: _off(table, f"f{i}{i + 1}", inside) for i in range(variants.STRIKERS + variants.TARGETS - 1)}
    modes, rest = max(off[i] for i in kept), max(off.values())
    return Claim(
        "second-mode",
        "cluster on cluster needs but one more evanescent mode, for the hitting cluster",
        "App. A (ii)",
        f"3 on 5, alpha = 1/14: the model's forces are within {modes:.1e} for Phi, psi and psi-bar, within "
        f"{rest:.1e} for all",
        "model of four beads against the full equations, t = 0.05 to 95 % of the time until the first contact opens",
        judged(modes < 0.01 and rest < 0.03),
        {"modes": modes, "all": rest},
    )


def _off(table: Table, name: str, rows: NDArray[np.bool_]) -> float:
    return float(np.abs(table[f"{name} model"][rows] / table[f"{name} full"][rows] - 1.0).max())


def exchanged() -> Claim:
    """App. A (i)."""
    table = variants.exchange()
    off = max(float(np.abs(table[f"v{i} seen"] - table[f"v{i}"]).max()) for i in range(N + 1))
    return Claim(
        "exchanged",
        "by Galilean invariance the roles of striker and cluster can be exchanged",
        "App. A (i)",
        f"four on one, seen from the strikers and mirrored, is one on four: velocities differ by {off:.0e} at most",
        "full equations, alpha = 1/10, t = 0 ... 3",
        judged(off < 1e-7),
        {"difference": off},
    )


def waves_need_prestress() -> Claim:
    """Secs. I and V: fast waves, prestress, evanescence."""
    table = waves.roads()
    turns = {kind: _turns(table, kind) for kind in waves.UNTIL}
    late = table["t springs"] > 2.0
    rigid = np.abs(np.array([table[f"v{i} springs"][late].mean() for i in range(1, N + 1)]) - 0.4).max()
    return Claim(
        "waves",
        "stiff springs reach the rigid body through fast waves; soft contacts have no oscillating modes unless "
        "prestressed",
        "Secs. I and V",
        f"while the striker pushes, the force in the middle of the cluster turns {turns['soft']} time without "
        f"prestress, {turns['springs']} times with stiff springs (targets then move within {rigid:.3f} of 0.4 on "
        f"average); "
        f"under a prestress of {waves.SOFT_PRESTRESS} the soft chain rings when tapped: {turns['prestressed']} turns",
        f"one on 4; springs of 400, held together by a steady force of {waves.SPRING_PRESTRESS:.0f}",
        judged(turns["soft"] == 1 and turns["springs"] > 5 and turns["prestressed"] > 5 and rigid < 0.02),
        {kind: float(count) for kind, count in turns.items()} | {"rigid": float(rigid)},
    )


def _turns(table: Table, kind: str) -> int:
    """Turning points of the middle force: while the striker pushes; of a prestressed chain all along."""
    until = 1.6 if kind != "prestressed" else np.inf
    force = table[f"f23 {kind}"][table[f"t {kind}"] < until]
    change = np.sign(np.diff(force))
    return int((np.diff(change[change != 0.0]) != 0).sum()) + (1 if kind == "soft" else 0)


def draft_gears() -> Claim:
    """App. C: the experiment without friction."""
    speed = 1.0
    one, two = one_on(3, GEAR, GEAR_MASS), cluster_on_cluster(2, 2, GEAR, GEAR_MASS)
    three = solved(one, _at(speed, start(one)), samples=2).final_velocity
    pairs = solved(two, _at(speed, start(two, 2)), samples=2).final_velocity
    locked = one_on(3, hertz(1e6), GEAR_MASS)
    cradle = solved(locked, _at(speed, start(locked)), samples=2).final_velocity
    off = max(float(np.abs(three - [-0.5, 0.5, 0.5, 0.5]).max()), float(np.abs(pairs - [0.0, 0.0, 1.0, 1.0]).max()))
    return Claim(
        "draft-gears",
        "pre-compressed springs give rigid-like behaviour; without the pistons the last bead is kicked out",
        "App. C",
        f"at {speed} m/s one on three and two on two come out as two rigid bodies within {off:.1e}; no inner contact "
        f"is ever "
        f"pressed, so there is no evanescent profile to look for. With pistons locked (Hertz) the last bead takes "
        f"{100 * cradle[-1]:.0f} % of the velocity",
        "k = 770 N/m, 17.7 mm, 0.396 kg, no friction; touching contacts carry what keeps them together",
        judged(off < 1e-6 and cradle[-1] > 0.9),
        {"off": off, "cradle": float(cradle[-1])},
    )


def _at(speed: float, velocity: tuple[float, ...]) -> tuple[float, ...]:
    return tuple(speed * v for v in velocity)


CLAIMS = (robust, hooke_interface, second_mode, exchanged, waves_need_prestress, draft_gears)
