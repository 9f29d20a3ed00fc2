"""One step of `conserving` for a row of bodies that someone else's step moves, where contacts have loss; see row."""

from __future__ import annotations

from softcradle.physics.numerics.contact_law import energy
from softcradle.physics.numerics.dissipative_solve import BEAD_ROWS, SOLVER_ROWS, dry_forces, keeps
from softcradle.physics.numerics.jit import jit
from softcradle.physics.pymunk_contacts.chain_step import along, closing_rate

ROW_ROWS = SOLVER_ROWS + 7 + BEAD_ROWS  # rows (n,) of scratch memory


@jit
def solve_lossy_row(
    h, law, loss, absorbed, mobility, expected, velocity, direction, outside, overlap, rate, force, work
):  # fmt: skip
    """As `solve_row`, for contacts with `loss` (n,); what they keep is added to `absorbed` (1,)."""
    n = overlap.size
    diagonal, free, end, given = (
        work[SOLVER_ROWS],
        work[SOLVER_ROWS + 1],
        work[SOLVER_ROWS + 2],
        work[SOLVER_ROWS + 3],
    )
    coupling = work[SOLVER_ROWS + 4 : SOLVER_ROWS + 6].reshape(2 * n)
    beads = work[SOLVER_ROWS + 6 :]
    nothing = coupling[:0]
    for i in range(n):
        diagonal[i] = along(i, direction, i, mobility[i]) + along(i, direction, i, mobility[i + 1])
        coupling[i] = along(i - 1, direction, i, mobility[i]) if i > 0 else 0.0
        given[i] = closing_rate(i, direction, expected) - closing_rate(i, direction, velocity) + outside[i]
        free[i] = h * rate[i] + 0.5 * h * given[i]
        end[i] = overlap[i] if overlap[i] > 0.0 else overlap[i] + free[i]
    coupling[n] = 0.0
    used = dry_forces(
        h, law, loss, diagonal, coupling, nothing, nothing, free, overlap, rate, end, force, beads, work
    )  # fmt: skip
    for i in range(n):
        own = diagonal[i] * force[i]
        if keeps(loss[i], overlap[i], rate[i]):
            fall = energy(law[i, 0], law[i, 1], law[i, 2], overlap[i])
            fall -= energy(law[i, 0], law[i, 1], law[i, 2], end[i])
            absorbed[0] += force[i] * (end[i] - overlap[i]) + fall
        held = keeps(loss[i], overlap[i], rate[i]) and end[i] == work[6, i]
        if held:
            rate[i] = 0.0
        elif max(abs(overlap[i]), abs(end[i])) < h * h * own:  # the finer number of the two
            rate[i] = 2.0 * (end[i] - overlap[i]) / h - rate[i]
        else:
            own -= coupling[i] * force[i - 1] if i > 0 else 0.0
            own -= coupling[i + 1] * force[i + 1] if i < n - 1 else 0.0
            rate[i] += given[i] - h * own
        overlap[i] = end[i]
    return used >= 0
