"""
A cradle in a pymunk Space
==========================

Five balls, the first of which comes in at 1 m/s, at the sixty steps a second of a game. With ``SoftChain`` the blow takes its
time, and the energy is kept. What pymunk's own collisions do depends on how closely the balls are set.
"""

import matplotlib.pyplot as plt
import pymunk

from softcradle import SoftChain, hertz

RADIUS, STEP = 0.5, 1 / 60


def balls(space, distance):
    """Five balls in a row, their centres at that distance."""
    found = [pymunk.Body(1, float("inf")) for _ in range(5)]
    for k, ball in enumerate(found):
        ball.position = distance * k, 0
    found[0].velocity = 1, 0
    space.add(*found)
    return found


def soft(space):
    """Balls that just touch, with soft contacts."""
    row = balls(space, 2 * RADIUS)
    space.add(*SoftChain(row, hertz(100.0), 2 * RADIUS))
    return row


def hard(space, distance):
    """Balls that pymunk lets collide without loss."""
    row = balls(space, distance)
    for ball in row:
        shape = pymunk.Circle(ball, RADIUS)
        shape.elasticity = 1.0
        space.add(shape)
    return row


def played(make, steps=150):
    """Velocities of the balls after every step."""
    space = pymunk.Space()
    row, found = make(space), []
    for _ in range(steps):
        space.step(STEP)
        found.append([ball.velocity.x for ball in row])
    return found


# %%
# The last ball of the soft row leaves with 0.99 m/s, as it does in SciPy's solution of the same chain. Hard balls that just
# touch hand everything to the last one; set one percent closer, they throw the first one back.

runs = {
    "SoftChain": played(soft),
    "pymunk, just touching": played(lambda space: hard(space, 2 * RADIUS)),
    "pymunk, 1 % closer": played(lambda space: hard(space, 0.99 * 2 * RADIUS)),
}
figure, panels = plt.subplots(1, 3, figsize=(9, 3.4), sharey=True, layout="constrained")
for axes, (name, run) in zip(panels, runs.items(), strict=True):
    for k, curve in enumerate(zip(*run, strict=True)):
        axes.plot([STEP * (n + 1) for n in range(len(curve))], curve, label=f"ball {k}")
    axes.set(title=name, xlabel="time [s]")
panels[0].set_ylabel("velocity [m/s]")
figure.legend(*panels[0].get_legend_handles_labels(), loc="outside lower center", ncols=5)
plt.show()

# %%
# All began with an energy of 0.5 J.

for name, run in runs.items():
    energy = sum(0.5 * speed**2 for speed in run[-1])
    print(f"{name}: {energy:.4f} J, velocities", *(f"{speed:.2f}" for speed in run[-1]))
