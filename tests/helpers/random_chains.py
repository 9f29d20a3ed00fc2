"""Random chains with start velocities, each generated from a seed. Some chains do not dissipate energy. Other chains
have friction and loss.
"""

import math
from dataclasses import replace

import numpy as np
from hypothesis import strategies as st
from softcradle.physics import Chain, Contact, draft_gear, hertz, hooke, power_law, step_force
from softcradle.physics.numerics.elementary import power


def ten_to(exponents):
    """Return 10**x, computed by the package's own power function. The last digits of NumPy's power function depend on
    the processor, so the chains would differ between machines.
    """
    found = [power(10.0, float(one)) for one in np.atleast_1d(exponents)]
    return np.array(found) if np.ndim(exponents) else found[0]


LAWS = (
    lambda draw: power_law(draw(), 1 / 14),
    lambda draw: power_law(draw(), 0.1 * math.sqrt(draw())),
    lambda draw: hooke(draw()),
    lambda draw: hertz(draw()),
    lambda draw: step_force(draw()),
    lambda draw: draft_gear(draw(), 0.1 * draw()),
    lambda draw: Contact(draw(), draw(), min(3.0, 0.3 * draw())),
    lambda draw: Contact(0.0, draw(), min(3.0, 0.5 * draw())),
)


def random_collision(seed, most):
    """Return the chain and the start velocities of a random collision without dissipation. The chain has at most one
    wall.

    The beads form up to three clusters with one velocity per cluster, or every bead has a different velocity. The chain
    is generated from a seed. Lists that Hypothesis draws contain many repetitions, and most of their beads fly apart.
    """
    rng = np.random.default_rng(seed)
    n = int(rng.integers(1, most + 1))

    def strength():
        return ten_to(rng.uniform(-1, 1))

    def law():
        return LAWS[rng.integers(len(LAWS))](strength)

    mass = ten_to(rng.uniform(-2, 2, n + 1)) if rng.random() < 0.5 else np.full(n + 1, strength())
    contacts = law() if rng.random() < 0.5 else [law() for _ in range(n)]
    cluster = np.sort(rng.integers(0, 3, n + 1))
    fastest_first = -np.sort(-rng.uniform(-1, 1, 3))
    velocity = fastest_first[cluster] if rng.random() < 0.7 else rng.uniform(-1, 1, n + 1)
    gap = np.where(np.diff(cluster) > 0, rng.choice([0.0, 0.1, 1.0], n), 0.0)
    if rng.random() < 0.3:
        wall = int(rng.choice([0, n]))
        mass[wall], velocity[wall] = math.inf, 0.0
    return Chain(mass, contacts, gap), velocity


def collisions(most=40):
    """Return a Hypothesis strategy of random collisions with up to `most` contacts."""
    return st.integers(0, 2**32 - 1).map(lambda seed: random_collision(seed, most))


def random_dissipative(seed, most=6):
    """Return a random chain with friction, and its start velocities. Masses and contact laws are mixed. The chain has
    losses and gaps, and sometimes a wall or an external force.
    """
    draw = np.random.default_rng(seed)
    n = int(draw.integers(1, most + 1))
    mass = ten_to(draw.uniform(-1, 1, n + 1))
    if draw.random() < 0.2:
        mass[-1] = math.inf
    kinds = [
        lambda: power_law(ten_to(draw.uniform(-1, 1)), float(draw.choice([0.05, 0.1, 0.3]))),
        lambda: draft_gear(ten_to(draw.uniform(0, 3)), ten_to(draw.uniform(-3, 0))),
        lambda: hertz(ten_to(draw.uniform(0, 4))),
        lambda: Contact(draw.uniform(0, 2), draw.uniform(0.1, 10), float(draw.choice([0.1, 0.5, 1, 1.5]))),
    ]
    laws = [replace(kinds[int(draw.integers(4))](), loss=float(draw.choice([0, 0.3, 0.8, 0.95]))) for _ in range(n)]
    gap = np.where(draw.random(n) < 0.7, 0.0, draw.uniform(0, 0.1, n))
    drive = np.where(np.isfinite(mass), draw.normal(size=n + 1), 0.0) if draw.random() < 0.2 else None
    velocity = np.where(np.isfinite(mass), draw.normal(size=n + 1), 0.0)
    return Chain(mass, laws, gap, drive, float(draw.choice([0.001, 0.01, 0.1, 0.5]))), velocity
