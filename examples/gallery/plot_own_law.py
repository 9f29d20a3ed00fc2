"""A user-defined contact law ==========================

Chains of Toda's exponential springs carry solitons. Here the springs only push. A striker hits ten beads and sends a
pulse through the row. The pulse keeps its shape, and the last bead leaves with nearly all of the momentum. If the same
chain has soft contacts, the ten beads move like one body.
"""

import math

import matplotlib.pyplot as plt

from softcradle import one_on, power_law, simulate


class Toda:
    """A contact with an exponential repulsive force."""

    def __init__(self, stiffness, steepness):
        self.stiffness, self.steepness = stiffness, steepness

    def force(self, overlap):
        """Return the force [N] at an overlap [m]."""
        return self.stiffness * math.expm1(self.steepness * overlap)


laws = {"Toda": Toda(1.0, 5.0), "power law, alpha = 1/20": power_law(1.0, 1 / 20)}
start = [1.0] + [0.0] * 10
runs = {
    name: simulate(one_on(10, law), start, method="conserving", step=0.01)
    for name, law in laws.items()
}

# %%
# The method ``conserving`` keeps the energy up to round-off with any contact law.

for name, run in runs.items():
    change = abs(run.ledger / run.ledger[0] - 1).max()
    print(f"{name}: energy changes by {change:.0e} of itself")

# %% The forces over time show a travelling pulse for the Toda law. For the power law they show steps in all contacts at
# once.

figure, panels = plt.subplots(1, 2, figsize=(9, 3.6), layout="constrained")
for axes, (name, run) in zip(panels, runs.items(), strict=True):
    for contact in range(10):
        colour, label = plt.cm.viridis(contact / 10), f"{contact}-{contact + 1}"
        axes.plot(run.time, run.force[:, contact], color=colour, label=label)
    axes.set(title=name, xlabel="time [s]", ylabel="contact force [N]")
handles = panels[1].get_legend_handles_labels()
figure.legend(*handles, loc="outside lower center", ncols=10, fontsize=8)
plt.show()
