"""
A cradle in a pymunk Space
==========================

Five balls, the first of which comes in at 1 m/s, at the sixty steps a second of a game. ``SoftChain`` keeps the energy at
this step; pymunk's own collisions, of the same balls, do not make a cradle.
"""

import matplotlib.pyplot as plt
import pymunk

from softcradle import SoftChain, hertz

RADIUS, STEP = 0.5, 1 / 60


def balls(space):
    """Five balls in a row, just touching."""
    found = [pymunk.Body(1, float("inf")) for _ in range(5)]
    for k, ball in enumerate(found):
        ball.position = 2 * RADIUS * k, 0
    found[0].velocity = 1, 0
    space.add(*found)
    return found


def played(space, row, steps=150):
    """Velocities after every step."""
    found = []
    for _ in range(steps):
        space.step(STEP)
        found.append([ball.velocity.x for ball in row])
    return found


soft, rigid = pymunk.Space(), pymunk.Space()
soft_row, rigid_row = balls(soft), balls(rigid)
soft.add(*SoftChain(soft_row, hertz(100.0), 2 * RADIUS))
for ball in rigid_row:
    shape = pymunk.Circle(ball, RADIUS)
    shape.elasticity = 1.0
    rigid.add(shape)

# %%
# The last ball of the soft row leaves with 0.99 m/s, as it does in SciPy's solution of the same chain.

figure, panels = plt.subplots(1, 2, figsize=(9, 3.2), sharey=True, layout="constrained")
for axes, (name, space, row) in zip(
    panels, [("SoftChain", soft, soft_row), ("pymunk's collisions", rigid, rigid_row)], strict=True
):
    for k, curve in enumerate(zip(*played(space, row), strict=True)):
        axes.plot([STEP * (n + 1) for n in range(len(curve))], curve, label=f"ball {k}")
    axes.set(title=name, xlabel="time [s]")
panels[0].set_ylabel("velocity [m/s]")
panels[1].legend(fontsize=7)
plt.show()
print("energy, soft:", round(sum(0.5 * ball.velocity.length**2 for ball in soft_row), 6))
print("energy, rigid:", round(sum(0.5 * ball.velocity.length**2 for ball in rigid_row), 6))
