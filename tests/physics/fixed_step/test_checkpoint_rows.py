"""Checkpoints: however long a run is they fit, at even distances, from its start on."""

from __future__ import annotations

import numpy as np
from softcradle.physics import Chain, State, hertz
from softcradle.physics.fixed_step.checkpoints import COUNT, DUE, FIRST_SPACING, SPACING, Checkpoints, keep_checkpoint
from softcradle.physics.numerics.records import COUNTERS, STEP

from tests.helpers.plain_kernels import only_plain, records_of

pytestmark = only_plain

ROWS = 6


def test_every_second_one_goes_where_the_rows_are_full():
    chain = Chain([1.0, 2.0, 1.0], hertz(5.0))
    _, _, motion = records_of(chain, State.at_start(chain, [1.0, 0.0, 0.0]))
    wide, narrow = np.zeros((ROWS, 2)), np.zeros((ROWS, 2))
    plan = np.array([0, 0, FIRST_SPACING])
    kept = Checkpoints(np.zeros(ROWS), wide.copy(), wide.copy(), narrow, wide.copy(), np.zeros((ROWS, 4)), plan)
    counter = np.zeros(COUNTERS, dtype=np.int64)
    for step in range(200):
        counter[STEP] = step
        if step >= plan[DUE]:
            motion.overlap[:] = motion.rate[:] = motion.force[:] = float(step)
            motion.anchor[:] = motion.taken[:] = float(step)
            keep_checkpoint(0.1 * step, motion, kept, counter)
        count = plan[COUNT]
        assert 1 <= count <= ROWS
        steps = np.arange(count) * plan[SPACING]
        assert kept.time[:count].tolist() == [0.1 * k for k in steps]
        for rows in (kept.overlap, kept.rate, kept.anchor, kept.force, kept.taken):
            assert (rows[:count] == steps[:, None]).all()
    assert plan[SPACING] == 64
