"""Statements on the mode-coupling model: Secs. III and IV, Fig. 2."""

from __future__ import annotations

import numpy as np
from softcradle.physics.analysis.measures import depth_bound, depth_law
from softcradle.sandbox.studies.claims.claim import Claim, verdict_of
from softcradle.sandbox.studies.claims.turning_points import turning_points
from softcradle.sandbox.studies.figures import coupling_figure
from softcradle.sandbox.studies.figures.solved_cases import (
    ALPHA,
    SOFTER_ALPHA,
    N,
    full_one_on,
    model_one_on,
    opening_time,
)


def depth_inequality() -> Claim:
    """The inequality below Eq. (8)."""
    sizes, alphas = range(2, 31), (1.0 / 5.0, 1.0 / 10.0, 1.0 / 30.0)
    worst = max(float((depth_law(n, a) / depth_bound(n, a)).max()) for n in sizes for a in alphas)
    at_four = depth_law(4, ALPHA)[1] / depth_bound(4, ALPHA)[1]
    return Claim(
        "depth-bound",
        "((n-i)/(n-1))**(1/alpha) <= exp(-(i-1)/(n alpha))",
        "Sec. III",
        f"largest ratio of the two sides {worst:.3g}, 1 at i = 1 only; at n = 4, alpha = 1/10, i = 2 it is "
        f"{at_four:.3g}",
        "n = 2 ... 30, alpha = 1/5, 1/10, 1/30, all i",
        verdict_of(worst <= 1.0),
        {"largest ratio": worst, "ratio at 4": float(at_four)},
    )


def not_potential() -> Claim:
    """The remark after Eq. (10)."""
    found = model_one_on(N, ALPHA, 2.5, 2001, 1e-12)
    modes = found.reduced
    masses = np.array(modes.chain.mass)
    energy = modes.kinetic_energy + modes.contact_energy
    drift = float(np.abs(energy / energy[0] - 1.0).max())
    inverse = 1.0 / masses
    matrix = np.diag(inverse[:-1] + inverse[1:]) - np.diag(inverse[1:-1], 1) - np.diag(inverse[1:-1], -1)
    asymmetry = float(np.abs(matrix - matrix.T).max())
    equal = np.array_equal(matrix, np.array([[2.0, -1.0], [-1.0, N / (N - 1.0)]]))
    return Claim(
        "non-potential",
        "the non-potential structure of Eq. (7) opposes an interpretation in terms of Newtonian mechanics",
        "Sec. IV, remark after Eq. (10)",
        "Eq. (7) is q'' = -L grad V with a symmetric L, which is Newton's equation of three beads of masses 1, 1, "
        f"n-1 with the contacts f01 and f12; its energy q'.L^-1.q'/2 + V is constant to {drift:.0e}. Only with "
        "unit masses for Phi and psi themselves would there be no potential",
        "the matrix of Eq. (7) against that of the three-bead chain; energy of the solution at tolerance 1e-12",
        verdict_of(not (equal and asymmetry == 0.0 and drift < 1e-9)),
        {"energy drift": drift, "asymmetry": asymmetry, "matrix is that of three beads": float(equal)},
    )


def phi_first() -> Claim:
    """Fig. 2a: which mode returns first."""
    delays = {}
    for n, alpha in ((4, ALPHA), (4, SOFTER_ALPHA), (4, 1.0 / 20.0), (4, 1.0 / 50.0), (3, ALPHA)):
        found = model_one_on(n, alpha, samples=2)
        delays[n, round(1 / alpha)] = found.returns(1) - found.returns(0)
    at_four = [delays[4, k] for k in (10, 14, 20, 50)]
    falls = bool((np.diff(np.abs(at_four)) < 0.0).all())
    return Claim(
        "phi-first",
        "Phi returns to zero before psi, and the discordance vanishes as alpha -> 0",
        "Sec. IV, Fig. 2a",
        f"psi is later by {at_four[0]:.4f} in the paper's case, at 1/14, 1/20, 1/50 by {at_four[1]:.4f}, "
        f"{at_four[2]:.1e}, {at_four[3]:.1e}; but for n = 3, alpha = 1/10 psi returns first, by {-delays[3, 10]:.4f}",
        "mode-coupling model, one on four and one on three",
        verdict_of(at_four[0] > 0.0 and falls and delays[3, 10] > 0.0, at_four[0] > 0.0 and falls),
        {f"n={n}, 1/{k}": delay for (n, k), delay in delays.items()},
    )


def within_a_thousandth() -> Claim:
    """Fig. 2c."""
    table = coupling_figure.discrepancies()
    time, f01, f12 = table["t"], np.abs(table["f01"]), np.abs(table["f12"])
    separation = time[-1] + table["time to separation"][-1]
    fraction = time[f01 > 1e-3][0] / separation
    largest = float(f12.max())
    return Claim(
        "within-1e-3",
        "the model reproduces the full f01 and f12 within 1e-3 over the entire collision",
        "Sec. IV, Fig. 2c",
        f"f12: at most {largest:.1e} from the first touch to the separation of the striker. f01: within 1e-3 for the "
        f"first {100 * fraction:.1f} % of it; then the relative error grows without bound, because the model's "
        f"striker separates {_separation_delay():.1e} later than the true one, whose force is then zero",
        "one on 4, alpha = 1/10, times down to 1e-8 of the contact time from both ends",
        verdict_of(max(largest, f01.max()) < 1e-3, largest < 1e-3 and fraction > 0.9),
        {"f12": largest, "fraction of f01": float(fraction), "f01 at the end": float(f01.max())},
    )


def _separation_delay() -> float:
    """How much later the striker separates in the model than in the full equations."""
    return model_one_on(N, ALPHA, samples=2).returns(0) - opening_time(N, ALPHA)


def no_oscillation() -> Claim:
    """Sec. IV: no sign of fine oscillations."""
    table = coupling_figure.discrepancies()
    inner = (table["t"] > 1e-3 * table["t"][-1]) & (table["t"] < 0.999 * table["t"][-1])
    turns = {name: turning_points(table[name][inner]) for name in ("f01", "f12")}
    forces = full_one_on(N, ALPHA).force[1:-1]
    force_turns = [turning_points(force[force > 0.0]) for force in forces.T]
    return Claim(
        "no-oscillation",
        "there is no sign of fine oscillations",
        "Sec. IV, Fig. 2c",
        f"the discrepancies of f01 and f12 have {turns['f01']} and {turns['f12']} turning points while the striker "
        f"pushes; each full force rises once and falls once (turns {', '.join(map(str, force_turns))})",
        "turning points of the samples, one on 4, alpha = 1/10",
        verdict_of(max(turns.values()) <= 1 and max(force_turns) == 1),
        {"turns of the discrepancies": sum(turns.values()), "most turns of a force": max(force_turns)},
    )


def slopes() -> Claim:
    """Fig. 2d: the initial rise."""
    times = np.logspace(-40.0, -1.0, 40)
    force = model_one_on(N, ALPHA, 1.0, tuple(times.tolist())).reduced.force
    slope = np.diff(np.log(force), axis=0) / np.diff(np.log(times))[:, None]
    centres = np.sqrt(times[1:] * times[:-1])
    agrees = np.abs(slope - [ALPHA, ALPHA * (2.0 + ALPHA)]) < 1e-3
    last = [float(centres[rows][-1]) for rows in agrees.T]
    decades = [int(rows.sum()) for rows in agrees.T]
    late_slope = float(np.interp(-4.0, np.log10(centres), slope[:, 1]))
    return Claim(
        "slopes",
        "initially f01 ~ t**alpha and f12 ~ t**(alpha (2 + alpha)), here 0.1 and 0.21",
        "caption of Fig. 2d",
        f"slopes within 1e-3 over {decades[0]} and {decades[1]} decades from 1e-40 on, up to t = {last[0]:.0e} for "
        f"f01 and {last[1]:.0e} for f12: the correction to f12 is of relative order t**(alpha (1 + alpha)) = "
        f"t**0.11 and decays slowly; at t = 1e-4 its slope is {late_slope:.3f}",
        "mode-coupling model, slopes over one decade each",
        verdict_of(min(last) > 1e-3, min(decades) >= 10),
        {"decades of f01": decades[0], "decades of f12": decades[1], "last f12": last[1], "slope at 1e-4": late_slope},
    )


def consistency_example() -> Claim:
    """The worked example of Eq. (8)."""
    prefactor = (2.0 / 3.0) ** 10
    found = model_one_on(N, ALPHA, None, 4001)
    separation = found.returns(0)
    closed = (found.time > 0.0) & (found.time < separation)
    time, acceleration = found.time[closed] / separation, np.abs(found.acceleration[closed, 1])
    small = time[prefactor * acceleration <= 1.05e-3]
    middle = acceleration[(time > 0.05) & (time < 0.95)]
    after = np.abs(found.acceleration[found.time > separation, 1]).max()
    return Claim(
        "consistency-example",
        "[(4-i)/3]**10 <= 0.02 and psi'' ~ 0.1, so the left side of Eq. (8) is below about 1e-3",
        "Sec. IV",
        f"(2/3)**10 = {prefactor:.4f}; |psi''| is {middle.min():.3f} to {middle.max():.2f} in the "
        f"middle 90 % of the contact, {acceleration.max():.2f} at most near its end, and {after:.2f} after the striker has "
        f"left; the left side is at most {prefactor * middle.max():.1e} in the middle 90 %, and below 1e-3 "
        f"from {100 * small[0]:.0f} % to {100 * small[-1]:.0f} %",
        "mode-coupling model, one on 4, alpha = 1/10",
        verdict_of(prefactor * acceleration.max() <= 1e-3, prefactor <= 0.02 and prefactor * middle.max() < 5e-3),
        {
            "prefactor": prefactor, "largest bend in the middle": float(middle.max()),
            "largest bend": float(acceleration.max()), "left side in the middle": float(prefactor * middle.max()),
            "from": float(small[0]), "to": float(small[-1]), "after": float(after),
        },
    )  # fmt: skip


MEASUREMENTS = (
    depth_inequality,
    not_potential,
    phi_first,
    within_a_thousandth,
    no_oscillation,
    slopes,
    consistency_example,
)
