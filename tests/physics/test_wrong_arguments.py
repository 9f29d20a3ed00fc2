"""Tests of wrong arguments. Each wrong argument must raise a ValueError with one sentence that contains the name of the
argument. The sentence must not contain internal names.
"""

import math
import warnings
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pymunk
import pytest
from softcradle.physics import METHODS, Chain, ChainBatch, Coupler, OwnLaw, cluster_on_cluster, ensemble_ends, one_on
from softcradle.physics.analysis.closed_forms import critical_speed, one_on_one
from softcradle.physics.analysis.matching import match
from softcradle.physics.analysis.mode_coupling import mode_coupling
from softcradle.physics.checked_input import LARGEST, SMALLEST
from softcradle.physics.contact import LEAST_EXPONENT, MOST_EXPONENT, Contact, draft_gear, hertz, power_law, step_force
from softcradle.physics.simulation import solve

from softcradle import SoftChain, SoftContact, State, TimedForce, advance, ensemble, simulate, stable_step

LAW = power_law(1.0, 0.1)
CHAIN, START = one_on(4, LAW), [1, 0, 0, 0, 0]
STATE = State.at_start(CHAIN, START)
BODY, *BODIES = (pymunk.Body(1, 1) for _ in range(4))
ONES, WALLED = np.ones((3, 3)), [[math.inf, 1, math.inf]]
BATCH = ChainBatch(ONES, 0.0, 1.0, 0.5)
CONTACT = SoftContact(*BODIES[:2], (0, 0), (0, 0), 1, LAW)
STILL = [pymunk.Body(body_type=kind) for kind in (pymunk.Body.STATIC, pymunk.Body.KINEMATIC)]
PAIR = BODY, (0, 0), (0, 0), 1, LAW  # All arguments of SoftContact except the first body.
ROW = SoftChain(BODIES, LAW, 1)
GEAR = draft_gear(2.0, 0.1, loss=0.1)
RUBS, TRAIN = Chain([1, 1], hertz(1.0), friction=0.1), Chain([1, 1], Coupler(LAW, LAW))
BETWEEN, PISTON = Chain([math.inf, 1, math.inf], LAW, 0.1), Chain([1, math.inf], LAW, 0.1, friction=0.05)
DRIVEN, FALSE = Chain([1, 1], LAW, drive=[1, 0]), Chain([1, 1], OwnLaw(lambda d: d, lambda d: d**2))
RANGE = r"must be|can be computed"
NO_BACK = "'yoshida4' steps back in time.*take 'conserving'"


class Spring:
    def force(self, overlap: float) -> float:
        return overlap


MISTAKES: dict[str, tuple[Callable[[], object], str]] = {
    "a number for a contact": (lambda: one_on(4, 0.1), "contact must be a Contact or a list of them"),
    "a text for a contact": (lambda: Chain([1, 1], "hertz"), "contact must be a Contact .*; not 'hertz'"),
    "a list with no contact": (lambda: Chain([1, 1, 1], [LAW, 0.1]), "every contact must be a Contact, not 0.1"),
    "half a bead": (lambda: one_on(4.5, LAW), "the number of targets must be a whole number, not 4.5"),
    "too many beads": (lambda: one_on(10**9, LAW), "at most 10000000 beads, not 1000000001"),
    "a list for a chain": (lambda: simulate([1, 2], START), r"chain must be a Chain, not \[1, 2\]"),
    "ragged masses": (lambda: Chain([1, [2, 3]], LAW), "mass must be a number or a list of numbers"),
    "no masses": (lambda: Chain(None, LAW), "a chain needs a list of at least 2 masses, not None"),
    "one drive": (lambda: Chain([1, 1], LAW, drive=3), "2 masses need 2 drive forces, not 3"),
    "a NumPy friction": (lambda: Chain([1, 1], LAW, friction=np.float64(-1.0)), "friction must be .* >= 0, not -1.0$"),
    "no number": (lambda: power_law(None, 0.1), "contact stiffness must be a number, not None"),
    "a text for a number": (lambda: draft_gear("770", 0.1), "draft gear stiffness must be a number, not '770'"),
    "a preload below 0": (lambda: Contact(-1.0, 1.0, 1.0), "preload must be a finite number >= 0, not -1.0"),
    "an exponent of 0": (lambda: power_law(1.0, 0.0), r"not 0.0; its limit 0 is step_force\(f0\)"),
    "an exponent of 10.1": (lambda: Contact(0.0, 1.0, 10.1), "exponent must be from 1e-06 to 10, not 10.1"),
    "no force at all": (lambda: power_law(0.0, 0.1), "both 0: the contact would never push"),
    "a precompression below 0": (lambda: draft_gear(1.0, -0.1), "precompression must be a finite number >= 0"),
    "a loss of all": (lambda: hertz(1.0, loss=1.0), "loss must be >= 0 and below 1, not 1.0"),
    "a loss below 0": (lambda: hertz(1.0, loss=-0.1), "loss must be >= 0 and below 1, not -0.1"),
    "a loss of nan": (lambda: hertz(1.0, loss=math.nan), "loss must be"),
    "a contact of no time": (lambda: Contact.by_contact_time(0.0, 0.5, 1.0), "duration must be a finite number > 0, not 0.0"),
    "an endless speed": (lambda: Contact.by_contact_time(0.05, 0.5, math.inf), "speed must be"),
    "too short a contact": (lambda: Contact.by_contact_time(1e-30, 0.5, 1.0, 10.0), "stiffness must be from"),
    "velocities as text": (lambda: simulate(CHAIN, "fast"), "velocity must be a number or a list of numbers, not 'fast'"),
    "one velocity": (lambda: simulate(CHAIN, 1.0), "5 beads need 5 velocities, not 1.0"),
    "below round-off": (lambda: simulate(CHAIN, START, tolerance=1e-20), "tolerance must be at least 1e-16"),
    "too many samples": (lambda: simulate(CHAIN, START, samples=10**9), "samples must be from 2 .* to 20020000"),
    "half a sample": (lambda: simulate(CHAIN, START, samples=10.5), "samples must be a whole number, not 10.5"),
    "a Method": (lambda: simulate(CHAIN, START, method=METHODS[0]), "method must be a name such as 'accurate', not a Method"),
    "a misspelt method": (lambda: simulate(CHAIN, START, method="verlt"), "did you mean 'verlet'. there are auto, euler"),
    "no state": (lambda: advance(CHAIN, None, 0.1), "state must be a State, not None"),
    "the state of another chain": (lambda: advance(one_on(3, LAW), STATE, 0.1), "the state has 4 contacts, the chain 3"),
    "one chain for an ensemble": (lambda: ensemble(CHAIN, START), "ensemble takes a list of chains"),
    "no workers": (lambda: ensemble([CHAIN], [START], workers=0), "workers must be at least 1, not 0"),
    "a list for a stable chain": (lambda: stable_step([1], START), r"chain must be a Chain, not \[1\]"),
    "too few velocities": (lambda: stable_step(CHAIN, [1, 0]), r"5 beads need 5 velocities, not \[1, 0\]"),
    "one body twice": (lambda: SoftContact(BODY, BODY, (0, 0), (0, 0), 1, LAW), "two different bodies"),
    "no body": (lambda: SoftContact(BODY, 5, (0, 0), (0, 0), 1, LAW), "b must be a Body, not 5"),
    "no anchor": (lambda: SoftContact(*BODIES[:2], None, (0, 0), 1, LAW), "anchor_a must be two finite numbers, not None"),
    "an anchor nowhere": (lambda: SoftContact(*BODIES[:2], (0, 0), (math.nan, 0), 1, LAW), "anchor_b must be two finite"),
    "a touching distance of 0": (lambda: SoftContact(*BODIES[:2], (0, 0), (0, 0), 0, LAW), "touching_distance"),
    "substeps without a mass": (lambda: SoftContact(pymunk.Body(), *PAIR).substeps(0.1, 1), "no mass or moment yet"),
    "chains of no Space": (lambda: SoftChain.of(None), "space must be a Space, not None"),
    "a removal from no Space": (lambda: ROW.remove_from(None), "space must be a Space, not None"),
    "a removal of a list": (lambda: ROW.remove_from(pymunk.Space(), BODIES), r"every body must be a Body, not \["),
    "a chain of numbers": (lambda: SoftChain([1, 2], LAW, 1), "every body must be a Body, not 1"),
    "a chain of one body": (lambda: SoftChain(BODY, LAW, 1), "bodies must be a Sequence"),
    "two bodies that never move": (lambda: SoftChain(STILL, LAW, 1), "bodies 0 and 1 are not"),
    "a state of another row": (lambda: ROW.restore(SoftChain(BODIES[:2], LAW, 1).state), "of 2 bodies is none of"),
    "no state of a row": (lambda: SoftChain(BODIES, LAW, 1).restore(7), "state must be a SoftChainState, not 7"),
    "a list of one body": (lambda: SoftChain([BODY], LAW, 1), "at least 2 different bodies"),
    "a contact too few": (lambda: SoftChain(BODIES, [LAW], 1), "one Contact for all or 2"),
    "a number for all contacts": (lambda: SoftChain(BODIES, 3.0, 1), "one Contact for all or 2"),
    "a coupler in a SoftChain": (lambda: SoftChain(BODIES, Coupler(LAW, LAW), 1), "takes no Coupler.*simulate.*'conserving'"),
    "a function in a SoftChain": (lambda: SoftChain(BODIES, [LAW, abs], 1), "takes Contacts, no other laws.*a SoftContact"),
    "an own law in a SoftChain": (lambda: SoftChain(BODIES, OwnLaw(abs), 1), "takes Contacts, no other laws.*a SoftContact"),
    "substeps of no time": (lambda: ROW.substeps(0.0, 1.0), "dt must be a finite number > 0, not 0.0"),
    "substeps without an error": (lambda: ROW.substeps(0.1, 1.0, 0.0), "error must be a finite number > 0, not 0.0"),
    "a distance too few": (lambda: SoftChain(BODIES, LAW, [1.0]), "one or 2 finite numbers"),
    "a distance of 0": (lambda: SoftChain(BODIES, LAW, 0.0), "finite numbers > 0"),
    "a SoftChain by euler": (lambda: SoftChain(BODIES, LAW, 1, method="euler"), "one of conserving, not 'euler'"),
    "one bead": (lambda: Chain([1], LAW), "at least 2 masses"),
    "a mass below 0": (lambda: Chain([1, -1], LAW), r"every mass \(inf is a wall\) must be a finite number > 0, not -1"),
    "two walls": (lambda: Chain([math.inf, math.inf], LAW), "two walls side by side"),
    "two contacts for one": (lambda: Chain([1, 1], [LAW, LAW]), "one contact for all or 1 contacts, not 2"),
    "two gaps for one": (lambda: Chain([1, 1], LAW, [0.1, 0.1]), "one gap for all or 1 gaps"),
    "a gap that is no number": (lambda: Chain([1, 1], LAW, math.nan), "every gap must be a number up to 1e.30, not nan"),
    "a drive that is no number": (lambda: Chain([1, 1], LAW, drive=[math.nan, 0]), "drive"),
    "no target": (lambda: one_on(0, LAW), "at least one bead, not 0"),
    "one mass in a list": (lambda: cluster_on_cluster(2, 2, LAW, [1.0]), "one mass for all or 4 masses, not .1.0."),
    "a velocity that is none": (lambda: State.at_start(one_on(1, LAW), [1, math.nan]), "every velocity must be finite"),
    "an endless duration": (lambda: simulate(CHAIN, START, math.inf), "duration must be a finite number >= 0, not inf"),
    "a frame below 0": (lambda: advance(CHAIN, STATE, -1), "duration must be .* >= 0, not -1"),
    "one push for all": (lambda: advance(CHAIN, replace(STATE, push=np.ones(1)), 0.1), "5 masses need 5 push forces, not array"),
    "no steps": (lambda: advance(CHAIN, STATE, 0.1, most_steps=0), "most_steps must be at least 1"),
    "auto for a frame": (lambda: advance(CHAIN, STATE, 0.1, "auto"), "'auto' is for simulate"),
    "a frame to a tolerance of nan": (lambda: advance(CHAIN, STATE, 0.1, "accurate", tolerance=math.nan), "tolerance must be"),
    "auto with a step": (lambda: simulate(CHAIN, START, method="auto", step=0.1), "'auto' chooses its own steps"),
    "auto without an error": (lambda: simulate(CHAIN, START, method="auto", tolerance=0), "tolerance must be a finite"),
    "a step of 0": (lambda: simulate(CHAIN, START, step=0.0), "step must be a finite number > 0, not 0.0"),
    "a step for scipy": (lambda: simulate(CHAIN, START, method="scipy", step=0.1), "method 'scipy' chooses its own steps"),
    "one sample": (lambda: simulate(CHAIN, START, samples=1), r"from 2 \(start and end\) to 20020000 of these beads, not 1"),
    "an empty list of samples": (lambda: simulate(CHAIN, START, samples=[]), "a list of 1 to 20020000 times"),
    "samples that go back": (lambda: simulate(CHAIN, START, samples=[1.0, 0.5]), "ascending"),
    "a sample before the start": (lambda: simulate(CHAIN, START, samples=[-1.0, 0.5]), ">= 0"),
    "a sample after the end": (lambda: simulate(CHAIN, START, 2.0, samples=[0.5, 3.0]), "within the duration 2.0"),
    "a tiny time": (lambda: simulate(CHAIN, START, samples=[0.0, 1e-310]), "must be 0 or at least 1e-100 s, not 1e-310"),
    "no end between walls": (lambda: simulate(BETWEEN, [0, 1, 0]), "two walls may never come apart: give a duration"),
    "no end of a piston on a bed": (lambda: simulate(PISTON, [0, -0.5]), "a duration"),
    "batch: no end of a piston on a bed": (lambda: ensemble_ends(ChainBatch.of([PISTON]), [0, -0.5]), "a duration"),
    "no end of a drive": (lambda: simulate(DRIVEN, [0, 0]), "duration"),
    "one list for two chains": (lambda: ensemble([CHAIN] * 2, [START]), "2 chains need 2 lists of velocities, not 1"),
    "three steps for two": (lambda: ensemble([CHAIN] * 2, [START] * 2, step=[1, 2, 3]), "2 steps or one for all, not 3"),
    "a number that pushes": (lambda: Coupler(3.0), "coupler push must be a Contact, not 3.0"),
    "a text that pulls": (lambda: Coupler(LAW, "x"), "coupler pull must be a Contact, not 'x'"),
    "a slack below 0": (lambda: Coupler(LAW, slack=-1.0), "coupler slack must be a finite number >= 0, not -1.0"),
    "a travel of 0": (lambda: Coupler(LAW, travel=0.0, stop=1e8), "coupler travel must be a finite number > 0"),
    "a force on nothing": (lambda: TimedForce([], 0.0, 1.0), "beads"),
    "a force on one twice": (lambda: TimedForce([0, 0], 0.0, 1.0), "each once"),
    "a force on bead -1": (lambda: TimedForce([-1], 0.0, 1.0), "beads"),
    "times that go back": (lambda: TimedForce(0, [1.0, 0.5], [1.0, 1.0]), "ascend"),
    "a time before the start": (lambda: TimedForce(0, [-1.0], 1.0), "times"),
    "three forces at two times": (lambda: TimedForce(0, [0.0, 1.0], [1.0, 2.0, 3.0]), "2 forces"),
    "a force that is no number": (lambda: TimedForce(0, 0.0, math.nan), "number"),
    "a force on a wall": (
        lambda: Chain([1, math.inf], LAW, forces=TimedForce([0, 1], 0.0, 1.0)),
        "forces act on bead 1, but it is a wall",
    ),
    "a brake on a wall": (lambda: Chain([math.inf, 1], LAW, brakes=TimedForce(0, 0.0, 1.0)), "brakes act on bead 0"),
    "a force on a bead too many": (lambda: Chain([1, 1], LAW, forces=TimedForce(4, 0.0, 1.0)), "forces act on bead 4"),
    "a brake that drives": (lambda: Chain([1, 1], LAW, brakes=TimedForce(0, 0.0, -1.0)), "brake must be >= 0"),
    "a number for forces": (lambda: Chain([1, 1], LAW, forces=3.0), "TimedForce"),
    "a substep of no step": (lambda: CONTACT.substeps(0.0, 1.0), "dt must be"),
    "a substep at a speed below 0": (lambda: CONTACT.substeps(0.1, -1.0), "speed must be"),
    "no closed form": (lambda: one_on_one(Contact(1.0, 1.0, 1.5), 1.0, 1.0), "no closed form for a preload with exponent 1.5"),
    "a critical speed without gears": (lambda: critical_speed(step_force(1.0), [1.0, 1.0, 1.0], 1), "needs draft gears"),
    "modes of a bead between": (lambda: mode_coupling(CHAIN, [0, 1, 0, 0, 0], 1.0), "one cluster that strikes another"),
    "modes of beads that fly": (lambda: mode_coupling(CHAIN, [0, 0, 0, 1, 1], 1.0), "one cluster that strikes another"),
    "modes on a bed": (lambda: mode_coupling(replace(CHAIN, friction=0.1), START, 1.0), "no bed and no brakes"),
    "modes of what loses": (lambda: mode_coupling(one_on(4, power_law(1, 0.1, loss=0.2)), START, 1.0), "no loss, no bed"),
    "modes at a wall": (lambda: mode_coupling(Chain([1, 1, 1, math.inf], LAW), [1, 0, 0, 0], 1), "bead 3 is a wall"),
    "modes of a driven cluster": (lambda: mode_coupling(replace(CHAIN, drive=[0, 0, 0, 0, -0.3]), START, 1.0), "or driven"),
    "modes of gears": (lambda: mode_coupling(one_on(3, draft_gear(2.0, 0.1)), [1, 0, 0, 0], 1.0), "1 has a preload"),
    "modes with a gap": (lambda: mode_coupling(Chain([1] * 3, LAW, [0.5, 0.1]), [1, 0, 0], 1.0), "contact 1 has a gap"),
    "modes of a driven end": (lambda: mode_coupling(replace(CHAIN, drive=START[::-1]), [0] * 5, 1.0), "on the first bead"),
    "a match of a step": (lambda: match(one_on(1, step_force(1.0)), [1, 0]), "between power laws"),
    "a match by a shape": (lambda: match(one_on(2, LAW), [1, 0, 0], distance="shape"), "unknown distance 'shape'"),
    "a match of beads that are driven": (lambda: match(Chain([1, 1], LAW, 0.0, [1.0, 0.0]), [1, 0]), "no drive"),
    "a match between walls": (lambda: match(Chain([math.inf, 1, math.inf], LAW, 0.5), [0, 1, 0]), "second wall"),
    "no end of a train that pulls": (lambda: simulate(TRAIN, [1, 0], method="conserving"), "never comes apart: give a duration"),
    "couplers as power laws": (lambda: TRAIN.power_law_rows, "contact 0-1 is a Coupler: this takes"),
    "a coupler for a body": (lambda: SoftContact(*BODIES[:2], (0, 0), (0, 0), 1, TRAIN.contact[0]), "a coupler pulls"),
    "loss by yoshida4": (lambda: simulate(one_on(1, GEAR), [1, 0], method="yoshida4"), NO_BACK),
    "a frame of friction by yoshida4": (lambda: advance(RUBS, State.at_start(RUBS, [1, 0]), 0.1, "yoshida4"), NO_BACK),
    "too slow": (lambda: simulate(CHAIN, [1e-300, 0, 0, 0, 0]), RANGE),
    "too fast": (lambda: simulate(CHAIN, [1e308, 0, 0, 0, 0]), RANGE),
    "too light": (lambda: one_on(4, LAW, 1e-300), RANGE),
    "too far": (lambda: Chain([1, 1], LAW, gap=1e300), RANGE),
    "too driven": (lambda: Chain([1, 1], LAW, drive=[1e300, 0]), RANGE),
    "too together": (lambda: simulate(one_on(4, power_law(SMALLEST, 0.1), LARGEST), [LARGEST, 0, 0, 0, 0]), RANGE),
    "batch: couplers": (lambda: ChainBatch.of([TRAIN]), "not couplers: take ensemble"),
    "batch: own laws": (lambda: ChainBatch.of([Chain([1, 1], Spring())]), "not laws of your own: take ensemble"),
    "batch: forces": (lambda: ChainBatch.of([Chain([1, 1], LAW, forces=TimedForce(0, [0, 1], [0, 1]))]), "forces over time"),
    "batch: brakes": (lambda: ChainBatch.of([Chain([1, 1], LAW, brakes=TimedForce(0, 0, 1))]), "not brakes: take ensemble"),
    "batch: lengths": (lambda: ChainBatch.of([one_on(1, LAW), one_on(2, LAW)]), "of one length, not of 1 and 2"),
    "batch: no chains": (lambda: ChainBatch.of([]), "at least one chain"),
    "batch: one row": (lambda: ChainBatch([1, 1], 0, 1, 1), r"of shape \(chains, beads\), not \(2,\)"),
    "batch: a shape": (lambda: ChainBatch(ONES, 0, [1, 2, 3, 4], 1), r"stiffness must fit the shape \(3, 2\)"),
    "batch: no number": (lambda: ChainBatch(ONES, 0, math.nan, 1), "stiffness must be 0 or from 1e-30 to 1e"),
    "batch: no force": (lambda: ChainBatch(ONES, 0, 0, 1), "would never push"),
    "batch: an exponent": (lambda: ChainBatch(ONES, 0, 1, 11), "exponent must be from 1e-06 to 10, not 11.0"),
    "batch: a mass": (lambda: ChainBatch(0 * ONES, 0, 1, 1), "every mass"),
    "batch: two walls": (lambda: ChainBatch(math.inf * ONES, 0, 1, 1), "two walls side by side"),
    "batch: a loss": (lambda: ChainBatch(ONES, 0, 1, 1, loss=1), "loss must be >= 0 and below 1, not 1.0"),
    "batch: no batch": (lambda: ensemble_ends([one_on(2, LAW)], [1, 0, 0]), "batch must be a ChainBatch"),
    "batch: auto": (lambda: ensemble_ends(BATCH, [1, 0, 0], method="auto"), "'auto' is for simulate"),
    "batch: pymunk": (lambda: ensemble_ends(BATCH, [1, 0, 0], method="pymunk"), "not 'pymunk': take ensemble"),
    "batch: a step": (lambda: ensemble_ends(BATCH, [1, 0, 0], step=1.0), "chooses its own steps"),
    "batch: steps": (lambda: ensemble_ends(BATCH, [1, 0, 0], None, "verlet", [1, 2]), "3 chains need 3 steps or one"),
    "batch: no step": (lambda: ensemble_ends(BATCH, [1, 0, 0], None, "verlet", 0.0), "every step must be a finite number > 0"),
    "batch: a tolerance": (lambda: ensemble_ends(BATCH, [1, 0, 0], tolerance=0.0), "tolerance must be a finite number > 0"),
    "batch: speeds": (lambda: ensemble_ends(BATCH, [1, 0]), r"3 chains of 3 beads need velocities of shape \(3, 3\) or \(3,\)"),
    "batch: a velocity": (lambda: ensemble_ends(BATCH, [1, 0, math.nan]), "every velocity must be a finite number"),
    "batch: workers": (lambda: ensemble_ends(BATCH, [1, 0, 0], workers=0), "workers must be at least 1, not 0"),
    "batch: friction": (lambda: ensemble_ends(ChainBatch.of([RUBS]), [1, 0], method="yoshida4"), "carries neither bed"),
    "batch: a drive": (lambda: ensemble_ends(ChainBatch.of([DRIVEN]), [0, 0]), "a driven chain may never come apart"),
    "batch: walls": (lambda: ensemble_ends(ChainBatch(WALLED, 0, 1, 1), [0, 1, 0]), "two walls may never come apart"),
    "batch: a depth": (lambda: ensemble_ends(ChainBatch(ONES, 0, 1e-30, 1e-3), [1e30, 0, 0]), "would be pressed by about"),
    "own law: no number": (
        lambda: simulate(Chain([1] * 4, lambda d: d if d < 0.72 else math.nan), [0.5, 0.5, -0.5, -0.5], method="verlet"),
        # Two beads together press the contact further than a single bead would.
        "gave no number in the course of the motion",
    ),
    "own law: a pull": (lambda: simulate(Chain([1, 1], lambda d: d - 0.1), [1, 0]), "the force -0.1 N .* only pushes"),
    "own law: a weak law": (lambda: simulate(Chain([1, 1], lambda d: math.exp(-d)), [9, 0]), "never stores the energy"),
    "own law: another energy": (lambda: simulate(FALSE, [1, 0], method="conserving"), "energy is not the integral"),
    "own law: no law": (lambda: OwnLaw(3.0), "must be a function or have a method force"),
    "own law: a Contact": (lambda: OwnLaw(LAW), "a chain takes .* as it is"),
    "own law: a Coupler": (lambda: OwnLaw(Coupler(LAW)), "a chain takes .* as it is"),
    "own law: a class": (lambda: OwnLaw(Spring), "must be a function or have a method force"),
    "own law: no energy": (lambda: OwnLaw(lambda d: d, 3.0), "the energy of a law must be a function"),
    "own law: power laws": (lambda: one_on(4, Spring()).power_law_rows, "contact 0-1 has the user-defined law 'Spring'"),
}  # fmt: skip


@pytest.mark.parametrize(("mistake", "sentence"), MISTAKES.values(), ids=MISTAKES)
def test_a_mistake_is_named(mistake, sentence):
    with pytest.raises(ValueError, match=sentence) as found:
        mistake()
    text = str(found.value)
    assert "\n" not in text
    assert "np." not in text
    assert "dtype" not in text
    assert len(text) < 250


@pytest.mark.parametrize("method", ["accurate", "conserving"])
@pytest.mark.parametrize("seed", range(20))
def test_accepted_chains_give_finite_results(method, seed):
    """Simulate chains with random numbers over 20 orders of magnitude. The result must be finite, or the run must
    report an early stop.
    """
    draw = np.random.default_rng(seed)
    f0, mass, speed = 10.0 ** draw.uniform(-10.0, 10.0, 3)
    alpha = 10.0 ** draw.uniform(math.log10(LEAST_EXPONENT), math.log10(MOST_EXPONENT))
    try:
        found = solve(one_on(2, power_law(f0, alpha), mass), [speed, 0, 0], method=method, samples=2)
    except ValueError as error:
        assert "can be computed" in str(error)  # noqa: PT017 - a refusal is one of the two things that may happen
        return
    assert np.isfinite(found.final_velocity).all()
    assert found.status.gave_up or abs(found.ledger[-1] / found.ledger[0] - 1.0) < 1e-3


@pytest.mark.parametrize(
    ("chain", "tolerance", "sentence"),
    [
        (CHAIN, 2, "a tolerance of 2 leaves the velocities open"),
        (Chain([1] * 5, hertz(1e3), friction=20.0), 1e-8, "a coefficient of friction of 20"),
    ],
)
def test_unusual_arguments_give_a_warning(chain, tolerance, sentence):
    with pytest.warns(RuntimeWarning, match=sentence):
        simulate(chain, START, tolerance=tolerance)


def test_usual_numbers_are_no_warning():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        simulate(one_on(3, draft_gear(770, 0.0177), mass=0.396), [0.9, 0, 0, 0])
        simulate(CHAIN, START, tolerance=1e-3)
        simulate(Chain([1, 1], Contact(1.0, 1.0, 0.5)), [0, 0], duration=1.0)
