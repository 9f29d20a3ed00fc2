"""A cradle in a pymunk Space ==========================

A ball hits a row of four balls at 1 m/s, with 60 steps per second as in a game. With ``SoftChain`` the collision lasts
several steps, and the energy is conserved. The result of pymunk's own collisions depends on the distance between the
balls.
"""

import matplotlib.pyplot as plt
import pymunk

from softcradle import SoftChain, hertz

RADIUS, STEP = 0.5, 1 / 60


def balls(space, distance):
    """Add five balls in a row to `space`. `distance` is the distance of their centres [m]."""
    found = [pymunk.Body(1, float("inf")) for _ in range(5)]
    for k, ball in enumerate(found):
        ball.position = distance * k, 0
    found[0].velocity = 1, 0
    space.add(*found)
    return found


def soft(space):
    """Add balls that just touch, with soft contacts."""
    row = balls(space, 2 * RADIUS)
    space.add(*SoftChain(row, hertz(100.0), 2 * RADIUS))
    return row


def hard(space, distance):
    """Add balls with pymunk's own collisions, without loss."""
    row = balls(space, distance)
    for ball in row:
        shape = pymunk.Circle(ball, RADIUS)
        shape.elasticity = 1.0
        space.add(shape)
    return row


def played(make, steps=150):
    """Return the velocities [m/s] of the balls after every step."""
    space = pymunk.Space()
    row, found = make(space), []
    for _ in range(steps):
        space.step(STEP)
        found.append([ball.velocity.x for ball in row])
    return found


# %% The last ball of the soft row leaves with 0.99 m/s, which agrees with SciPy's solution of the same chain. Hard
# balls that just touch pass all momentum to the last ball. If the hard balls are placed 1 % closer, they throw the
# first ball back.

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
# The energy at the start is 0.5 J in all three rows.

for name, run in runs.items():
    energy = sum(0.5 * speed**2 for speed in run[-1])
    print(f"{name}: {energy:.4f} J, velocities", *(f"{speed:.2f}" for speed in run[-1]))
