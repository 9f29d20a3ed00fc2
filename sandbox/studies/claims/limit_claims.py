"""Statements on the limit alpha -> 0, and on where rigid-like behaviour ends: Sec. IV."""

from __future__ import annotations

import math

import numpy as np
from softcradle.physics.analysis.measures import depth_law
from softcradle.sandbox.studies.claims.claim import Claim, verdict_of
from softcradle.sandbox.studies.data_table import Table, rows_where
from softcradle.sandbox.studies.figures import driven_figure, rigidity_figure, scaling_figure
from softcradle.sandbox.studies.figures.solved_cases import ALPHA, N, full_one_on, model_one_on


def _rate(table: Table, n: int, column: str, power: float = 0.0) -> float:
    """Slope of the logarithm of `column` * alpha**power against 1/(n alpha), for alpha <= 1/50."""
    rows = rows_where(table, n=n)
    soft = rows["alpha"] <= 1.0 / 50.0
    alpha = rows["alpha"][soft]
    return float(np.polyfit(1.0 / (n * alpha), np.log(rows[column][soft] * alpha**power), 1)[0])


def amplitude_of_psi() -> Claim:
    """Scaling (i): the amplitude of psi."""
    table = scaling_figure.scalings()
    rates = {n: _rate(table, n, "max psi") for n in scaling_figure.SIZES}
    exact = {n: n * math.log((n - 1) / n) for n in rates}
    agrees = all(abs(rates[n] / exact[n] - 1.0) < 0.05 for n in rates)
    return Claim(
        "amplitude",
        "for alpha -> 0 the maximum of psi decreases as exp(-1/(n alpha))",
        "Sec. IV (i)",
        "log(max psi) falls with 1/(n alpha) at the rate "
        + ", ".join(f"{rate:.3f} for n = {n}" for n, rate in rates.items())
        + "; not -1 but n log((n-1)/n), that is max psi ~ ((n-1)/n)**(1/alpha), which is the paper's law for large n "
        "only",
        "full equations, 1/alpha = 50 ... 200",
        verdict_of(all(abs(rate + 1.0) < 0.05 for rate in rates.values()), agrees),
        {f"n={n}": rate for n, rate in rates.items()} | {f"exact n={n}": rate for n, rate in exact.items()},
    )


def contact_duration() -> Claim:
    """Scaling (ii): the duration of contact."""
    table = scaling_figure.scalings()
    last = {n: float(rows_where(table, n=n)["contact time"][-1]) for n in scaling_figure.SIZES}
    stays = all(abs(last[n] / scaling_figure.contact_time_limit(n) - 1.0) < 0.02 for n in last)
    response = {n: _rate(table, n, "response time", 0.5) / (n * math.log((n - 1) / n)) for n in scaling_figure.SIZES}
    follows = all(abs(rate - 0.5) < 0.02 for rate in response.values())
    return Claim(
        "contact-duration",
        "the duration of contact of the striker decreases as exp(-1/(2 n alpha)) / sqrt(alpha)",
        "Sec. IV (ii)",
        "the contact time tends to 2n/(n+1): "
        + ", ".join(f"{time:.4f} for n = {n}" for n, time in last.items())
        + " at alpha = 1/200. What does scale so is the response time of the inner contact, (df/dpsi)**(-1/2) (and the "
        f"period of a driven cluster): {'yes' if follows else 'no'}, sqrt(alpha) times it goes as max psi to the power "
        + ", ".join(f"{rate:.3f}" for rate in response.values()),
        "full equations, 1/alpha = 5 ... 200; limit of a step force",
        verdict_of(not stays),
        {f"n={n}": time for n, time in last.items()} | {f"response n={n}": rate for n, rate in response.items()},
    )


def bound_on_consistency() -> Claim:
    """The bound on Eq. (8) after (ii)."""
    shares, peaks = [], {}
    for k in (10, 20, 50, 100):
        end = 0.95 * model_one_on(N, 1.0 / k, samples=2).returns(0)
        found = model_one_on(N, 1.0 / k, end, tuple(np.geomspace(1e-60, end, 2001)[:-1].tolist()))
        left_side = depth_law(N, 1.0 / k)[1] * np.abs(found.acceleration[:, 1])
        bound = math.exp(-1.0 / (N / k)) / k
        shares.append(float(left_side[found.time > 0.05 * found.time[-1]].max() / bound))
        peaks[k] = float(found.acceleration[:, 1].max())
    largest = max(shares)
    limit = (N - 1) / (4.0 * N)
    return Claim(
        "bound-on-consistency",
        "the left side of Eq. (8) is bounded by alpha exp(-(i-1)/(n alpha)) for i >= 2",
        "Sec. IV, after (ii)",
        f"in the middle of the contact it is at most {largest:.2f} of the bound; but at its very start psi'' "
        "passes "
        + ", ".join(f"{value:.3f} at 1/{k}" for k, value in peaks.items())
        + f", towards (n-1)/(4n) = {limit:.4f} whatever alpha, where the factor alpha is missing",
        "mode-coupling model, one on 4, i = 2, from t = 1e-60 on",
        verdict_of(largest <= 1.0 and all(value < 2.0 / k for k, value in peaks.items()), largest <= 1.0),
        {"middle": largest} | {f"peak 1/{k}": value for k, value in peaks.items()},
    )


def above_one_over_n() -> Claim:
    """Sec. IV: where rigid-like behaviour ends."""
    cases = ((4, 1 / 30), (4, 1 / 20), (4, ALPHA), (10, ALPHA), (30, ALPHA))
    deviation = {}  # by n and alpha, in ascending order of n alpha
    for n, alpha in sorted(cases, key=lambda case: case[0] * case[1]):
        velocity = rigidity_figure.outcome(n, alpha)[1:] * (n + 1) / 2
        deviation[n, alpha] = float(np.abs(velocity - 1.0).max())
    values = list(deviation.values())
    grows = bool((np.diff(values) > 0.0).all())
    lost = all(value > 1.0 for (n, alpha), value in deviation.items() if n * alpha >= 1.0)
    return Claim(
        "above-1/n",
        "for alpha > 1/n there is no rigid-body like behaviour, even with alpha << 1; for alpha << 1/n there is",
        "Sec. IV",
        "largest deviation of a target from the velocity of a rigid cluster, as a part of it: "
        + ", ".join(f"{value:.3g} at n alpha = {n * alpha:.2g} (n = {n})" for (n, alpha), value in deviation.items()),
        "velocities when every contact is open",
        verdict_of(grows and lost and values[0] < 0.01),
        {f"n={n}, n alpha={n * alpha:.3g}": value for (n, alpha), value in deviation.items()},
    )


def no_energy_inside() -> Claim:
    """Sec. IV: the energy that the cluster stores during the collision."""
    shares, forces = {}, {}
    for k in (10, 20, 50, 200):
        found = full_one_on(N, 1.0 / k)
        inner = zip(found.chain.contact[1:], found.overlap.T[1:], strict=True)
        stored = sum((np.asarray(contact.energy(overlap)) for contact, overlap in inner), np.zeros(1))
        shares[k], forces[k] = float(stored.max() / 0.5), float(found.force[:, 1].max())
    falls = bool((np.diff(list(shares.values())) < 0.0).all())
    return Claim(
        "no-energy-inside",
        "as alpha -> 0 the cluster stores no energy during the collision, while the forces remain finite",
        "Sec. IV",
        "largest energy inside, of the striker's: "
        + ", ".join(f"{share:.1e} at 1/{k}" for k, share in shares.items())
        + f"; largest f12 there {', '.join(f'{force:.3f}' for force in forces.values())}, towards (n-1)/n",
        "full equations, one on 4",
        verdict_of(falls and shares[200] < 1e-20 and abs(forces[200] - 0.75) < 0.01),
        {f"share 1/{k}": share for k, share in shares.items()} | {f"f12 1/{k}": force for k, force in forces.items()},
    )


def periodic() -> Claim:
    """Sec. V: the driven cluster."""
    table = driven_figure.scan()
    period = np.abs(table["period full"] / table["period model"] - 1.0)
    amplitude = np.abs(table["amplitude full"] / table["amplitude model"] - 1.0)
    remainder = table["least psi after 5 periods"]
    pair, longer = table["n"] == 2, table["n"] > 2
    paper = (table["n"] == N) & np.isclose(table["alpha"], ALPHA)
    soft = longer & (table["n"] * table["alpha"] < 0.3)
    return Claim(
        "driven-periodic",
        "a steady force on the first bead excites a time-periodic evanescent mode on top of a uniform acceleration",
        "Sec. V, data not shown",
        "for n = 2 exactly so. For n = 4, alpha = 1/10 period and amplitude are within "
        f"{100 * period[paper][0]:.2f} % and {100 * amplitude[paper][0]:.2f} % of the model's, and after five "
        f"periods psi returns to {100 * remainder[paper][0]:.1f} % of its amplitude instead of 0: the mode leaks into "
        f"the deeper contacts, the less the smaller n alpha (at most {100 * remainder[soft].max():.2g} % below n "
        "alpha = 0.3)",
        "full equations against the closed form of the model, n = 2, 3, 4, alpha = 1/5 ... 1/20, five periods",
        verdict_of(bool(remainder[longer].max() < 1e-3), bool(remainder[pair].max() < 1e-3 and remainder[soft].max() < 0.01)),
        {
            "period": float(period[paper][0]), "amplitude": float(amplitude[paper][0]), "left": float(remainder[paper][0]),
            "left n=2": float(remainder[pair].max()), "worst period": float(period.max()),
            "left soft": float(remainder[soft].max()),
        },
    )  # fmt: skip


MEASUREMENTS = (amplitude_of_psi, contact_duration, bound_on_consistency, above_one_over_n, no_energy_inside, periodic)
