"""Samples of adaptive runs, computed from stored steps.

If the sample times are known, the samples are computed during the run. Otherwise they are computed after its end.
"""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.adaptive.sampling import sample_steps
from softcradle.physics.adaptive.step_records import Steps, empty_scratch, empty_steps, empty_trial
from softcradle.physics.chain import Chain
from softcradle.physics.kernel_records import chain_and_regime, empty_log, motion_record
from softcradle.physics.kernel_tiers import KernelTiers
from softcradle.physics.numerics.records import KEPT, SAMPLE, SwitchLog
from softcradle.physics.problem import Problem, Record, empty_samples, first_samples

Array = NDArray[np.float64]

# Largest number of rows in a block of stored steps, and largest number of floats in a block. Samples are computed each
# time a block is full. A block of 2**18 floats takes 2 MB.
MOST_ROWS, MOST_NUMBERS = 256, 2**18
MOST_SPARE = 4  # Number of blocks of stored steps that the next run may reuse
# Largest memory [bytes] for the stored steps of a run without a duration. A longer run is repeated to compute its
# samples.
MOST_KEPT = 2**30
NO_STEPS = empty_steps(0, 0, False)  # Empty storage for a run that stores no steps


class KeptSteps:
    """Stored steps of a run, and the samples computed from them.

    Attributes:
        steps: rows that the kernel fills. The array is empty if samples are not wanted.
        known: True if the sample times were known at the start.
        ends: True if the only wanted samples are the start and the end of the run.
        overflows: True if the run had more steps than the memory limit allows.
    """

    def __init__(self, problem: Problem, wanted: float, tiers: KernelTiers, spare: list[Steps]) -> None:
        """Create the memory for the steps.

        `wanted` [m/s] is the error bound of a step. `spare` contains blocks of steps of earlier runs, which can be
        reused.
        """
        self.problem, self.wanted, self.tiers, self.spare = problem, wanted, tiers, spare
        self.known = problem.duration is not None
        self.ends = not (self.known or problem.keeps)
        self.overflows = False
        self._chunks: list[tuple[Steps, int]] = []
        if self.known:
            self._want(problem.sample_times(problem.end))
        # Steps are not stored if only the ends are wanted, or no samples at all.
        needless = self.ends or (self.known and not self.times.size)
        self.steps = NO_STEPS if needless else self._block()

    def _want(self, times: Array) -> None:
        contacts = self.problem.chain.contacts
        self.times, self._log = times, empty_log(contacts, 0)
        self._samples = empty_samples(times, contacts)

    def take(self, log: SwitchLog) -> None:
        """Process the steps that the kernel has stored: compute the samples within them, or keep the steps until the
        end of the run.
        """
        count, log.counter[KEPT] = int(log.counter[KEPT]), 0
        # If the sample times are known, compute the samples now and reuse the block. Otherwise keep the block.
        if self.known:
            self._sample(self.steps, count)
        elif count:
            self._chunks.append((self.steps, count))
            bytes_a_chunk = self.steps.values.nbytes + self.steps.flags.nbytes
            self.overflows = len(self._chunks) * bytes_a_chunk > MOST_KEPT
            if self.overflows:
                self._chunks.clear()
            self.steps = NO_STEPS if self.overflows else self._block()

    def _block(self) -> Steps:
        """Return an empty block of steps. Reuse the block of an earlier run if it has the right shape."""
        chain, none = self.problem.chain, _steps(self.problem.chain, 0)
        wide = none.values.shape[1], none.flags.shape[1]
        while self.spare:
            block = self.spare.pop()
            if block.time.size and (block.values.shape[1], block.flags.shape[1]) == wide:
                return block
        return _steps(chain, min(MOST_ROWS, MOST_NUMBERS // wide[0] + 1))

    def _sample(self, steps: Steps, count: int) -> None:
        """Compute all samples that lie within the first `count` of the `steps`."""
        done = int(self._log.counter[SAMPLE])
        last = steps.time[count - 1] + steps.length[count - 1] if count else -np.inf
        # Number of wanted samples within these steps.
        many = int(np.searchsorted(self.times[done:], last))
        if many == 0:
            return
        work = float(many * self.problem.chain.contacts)  # In plain Python, a sample costs as much as a fixed step.
        kernel: Any = self.tiers.of(sample_steps, work)
        if kernel is not sample_steps:
            self.tiers.spent += work
        kernel(count, self.wanted, *self._memory, tuple(steps), tuple(self._samples), tuple(self._log))

    @cached_property
    def _memory(self) -> Any:
        """Scratch records of the sampling kernel: a chain, its contact modes, a motion and work arrays."""
        chain, motion = self.problem.chain, self.problem.state.copy()
        n = chain.contacts
        mode, held = np.zeros(n, dtype=np.int8), np.zeros(n, dtype=np.int8)
        records = tuple(empty_trial(n)), tuple(empty_scratch(n))
        return *chain_and_regime(chain, motion), motion_record(motion, mode, held), *records

    def record(self, found: Record, times: Array) -> Record:
        """Add samples at `times` to the record `found` of the run. Samples after the end of the run are omitted."""
        if not self.known:
            self._want(times)
            for steps, count in self._chunks:
                self._sample(steps, count)
        # Samples after the last stored step: the beads move with constant velocities. If the run gave up, the samples
        # end at its last step.
        state, done, rows = found.end, int(self._log.counter[SAMPLE]), self.times.size
        if found.status.gave_up:
            rows = max(done, int(np.searchsorted(self.times, state.time, side="right")))
        samples = first_samples(self._samples, rows)
        _, overlap, rate, anchor, force, taken = samples
        left = self.times[done:rows] - state.time
        overlap[done:], rate[done:], force[done:] = state.overlap + np.outer(left, state.rate), state.rate, state.force
        anchor[done:, 0], anchor[done:, 1] = state.anchor[0] + left * state.anchor[1], state.anchor[1]
        taken[done:] = state.taken
        self.spare[:] = [self.steps, *(steps for steps, _ in self._chunks)][:MOST_SPARE]
        return found.with_samples(samples)


def _steps(chain: Chain, rows: int) -> Steps:
    return empty_steps(rows, chain.contacts, chain.dissipative or chain.has_segments)
