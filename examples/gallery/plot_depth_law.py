"""How deep a blow goes ====================

Inside a cluster of soft beads, the overlap decreases by powers of ten from contact to contact. This is the evanescent
mode, and Eq. (7) of the paper gives the overlaps. The figure compares Eq. (7) with a simulated collision of one bead on
six, at the time of the largest overlap of the struck contact. The smaller the exponent alpha is, the better they agree.
"""

import matplotlib.pyplot as plt
import numpy as np
from softcradle.physics.analysis.measures import depth_law

from softcradle import one_on, power_law, simulate

figure, axes = plt.subplots(figsize=(6, 3.6), layout="constrained")
depth = np.arange(1, 6)
for look, alpha in (("C0s", 1 / 2), ("C1o", 1 / 5), ("C2^", 1 / 10)):
    chain = one_on(6, power_law(1.0, alpha))
    run = simulate(chain, [1, 0, 0, 0, 0, 0, 0], samples=2001)
    deepest = run.overlap[np.argmax(run.overlap[:, 0])]
    found = deepest[1:] / deepest[1]
    axes.semilogy(depth, found, look, fillstyle="none", label=f"alpha = {alpha:g}")
    axes.semilogy(depth, depth_law(6, alpha), look[:2], linewidth=1)
axes.set(xlabel="contact inside the cluster", ylabel="overlap / first one inside")
axes.set_xticks(depth)
axes.legend(title="marks: simulated, lines: Eq. (7)")
plt.show()
