"""
Figure 2 of the paper: the mode-coupling model
==============================================

The mode-coupling equations (8) describe a collision of one bead on four by two numbers: Phi, the overlap of the striker
and the cluster, and psi, the evanescent mode inside the cluster. Panel (a) shows both. Panel (b) compares the four
contact forces of the model (dashed) with those of the full equations of motion (3). Panel (c) shows their relative
difference, and panel (d) how the forces begin.
"""

import matplotlib.pyplot as plt
import numpy as np
from softcradle.physics.analysis.mode_coupling import mode_coupling

from softcradle import one_on, power_law, simulate

chain, start = one_on(4, power_law(1.0, 0.1)), [1, 0, 0, 0, 0]
times = np.linspace(0.0, 2.3, 1001)
full = simulate(chain, start, duration=2.3, samples=times)
model = mode_coupling(chain, start, duration=2.3, samples=times)

figure, ((a, b), (c, d)) = plt.subplots(2, 2, figsize=(8, 6), layout="constrained")
a.plot(times, model.phi, label="Phi")
a.plot(times, model.psi, label="psi")
a.set(title="(a) modes", ylim=(-0.1, 0.53))
a.legend()

b.plot(times, full.force)
b.set_prop_cycle(None)  # Use the same colours for the model.
b.plot(times, model.trajectory.force, "--")
b.set(title="(b) forces", ylim=(0, 1.1))

# Relative difference during the contact of the striker, without the first and last 2 %, where the forces are almost 0.
_, end = full.contact_intervals[0][0]
inside = (times > 0.02 * end) & (times < 0.98 * end)
c.plot(
    times[inside], 1e3 * (1 - model.trajectory.force[inside, :2] / full.force[inside, :2])
)
c.set(title="(c) relative difference / 1e-3", ylim=(-1.4, 1.4))

early = np.logspace(-12, 0, 241)
d.loglog(
    early, simulate(chain, start, duration=1.0, samples=early, tolerance=1e-11).force
)
d.set(title="(d) first moments")
for axes in (a, b, c, d):
    axes.set_xlabel("t")
plt.show()
