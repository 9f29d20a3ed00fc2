"""
A contact law of one's own
==========================

Toda's exponential springs carry solitons. Here they only push: a striker on ten beads sends a pulse through the row, which keeps
its shape, and the last bead leaves with nearly all of the momentum. A soft contact of the same chain answers as one body.
"""

import math

import matplotlib.pyplot as plt

from softcradle import one_on, power_law, simulate


class Toda:
    """Exponential repulsion."""

    def __init__(self, stiffness, steepness):
        self.stiffness, self.steepness = stiffness, steepness

    def force(self, overlap):
        """Force [N] at an overlap [m]."""
        return self.stiffness * math.expm1(self.steepness * overlap)


start = [1.0] + [0.0] * 10
runs = {
    "Toda": simulate(one_on(10, Toda(1.0, 5.0)), start, method="conserving", step=0.01),
    "power law, alpha = 1/20": simulate(one_on(10, power_law(1.0, 1 / 20)), start, method="conserving", step=0.01),
}

# %%
# Both keep their energy to round-off, whatever the law.

for name, run in runs.items():
    print(f"{name}: energy changes by {abs(run.ledger / run.ledger[0] - 1).max():.0e} of itself")

# %%
# Forces over time: a pulse that travels, and steps that hold all contacts at once.

figure, panels = plt.subplots(1, 2, figsize=(9, 3.2), layout="constrained")
for axes, (name, run) in zip(panels, runs.items(), strict=True):
    for contact in range(10):
        axes.plot(run.time, run.force[:, contact], color=plt.cm.viridis(contact / 10), label=f"{contact}-{contact + 1}")
    axes.set(title=name, xlabel="time [s]", ylabel="contact force [N]")
panels[1].legend(fontsize=7, ncols=2, title="contact")
plt.show()
