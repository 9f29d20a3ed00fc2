"""Long runs hand back now and then, so that signals are heard: their digits are those of a run that never pauses."""

import numpy as np
import pytest
from softcradle.physics import Chain, Coupler, State, advance, draft_gear, hooke, one_on, power_law, simulate
from softcradle.physics.fixed_step import runner

SOFT = power_law(1.0, 0.1)
CASES = {
    "one on three": (one_on(3, SOFT), {}),
    "samples at its end": (one_on(3, SOFT), {"samples": 2}),
    "samples between": (one_on(3, SOFT), {"duration": 4.0, "samples": [0.1, 0.11, 0.5, 3.97]}),
    "a bed": (one_on(3, SOFT), {"friction": 0.02, "duration": 6.0}),
    "loss": (Chain([1.0] * 3, power_law(1.0, 0.5, loss=0.3), gap=[0.0, 0.1]), {"samples": 11}),
    "walls": (Chain([np.inf, 1.0, 2.0, np.inf], hooke(9.0), gap=[0.1, 0.0, 0.3]), {"duration": 9.0}),
    "gears": (Chain([1.0] * 4, draft_gear(100.0, 0.05), gap=[0.0, 0.02, 0.0]), {}),
    "couplers": (Chain([1.0] * 3, Coupler(hooke(9.0), hooke(9.0), slack=0.05)), {"duration": 4.0}),
}


def digits(chain: Chain, velocity: list[float], method: str, options: dict[str, object]) -> list[object]:
    found = simulate(chain, velocity, method=method, step=0.013, **{"samples": 9, **options})
    arrays = found.time, found.overlap, found.velocity, found.force, found.final_velocity
    return [array.tobytes() for array in arrays] + [found.contact_intervals, found.steps, found.evaluations]


@pytest.mark.filterwarnings("ignore::RuntimeWarning")  # steps are large, so that few are enough
@pytest.mark.parametrize("method", ["verlet", "conserving"])
@pytest.mark.parametrize("name", CASES)
def test_the_digits_of_a_run_do_not_depend_on_its_pauses(name, method, monkeypatch):
    chain, options = CASES[name]
    options = dict(options)
    if "friction" in options:
        chain = Chain(chain.mass, chain.contact, chain.gap, friction=options.pop("friction"))
    velocity = [0.0] * (chain.contacts + 1)
    velocity[1 if np.isinf(chain.mass[0]) else 0] = 1.0
    whole = digits(chain, velocity, method, options)
    for steps in (1, 2, 7, 50):
        monkeypatch.setattr(runner, "PAUSE", steps * chain.contacts)
        assert digits(chain, velocity, method, options) == whole


def test_a_long_row_pauses_too(monkeypatch):
    chain = Chain([1.0] * 71, [power_law(1.0 + 0.01 * k, 0.3) for k in range(70)])
    velocity, options = [1.0] + [0.0] * 70, {"duration": 2.0}
    whole = digits(chain, velocity, "verlet", options)
    monkeypatch.setattr(runner, "PAUSE", 3 * 70)
    assert digits(chain, velocity, "verlet", options) == whole


def test_frames_of_live_use_pause_too(monkeypatch):
    def played() -> bytes:
        chain = one_on(3, SOFT)
        state = State.at_start(chain, [1, 0, 0, 0])
        for _ in range(20):
            advance(chain, state, 0.1, "conserving", step=0.003)
        return state.overlap.tobytes() + state.rate.tobytes()

    whole = played()
    monkeypatch.setattr(runner, "PAUSE", 4)
    assert played() == whole
