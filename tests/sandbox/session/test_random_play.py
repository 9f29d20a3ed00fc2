"""Random play: whatever the inputs and their order, no exception, no NaN, bounded memory, and a balanced ledger."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from softcradle.sandbox.session import Session
from softcradle.sandbox.session.random_play import RandomPlayer, check_invariants, main, play_at_random, read_all

from softcradle import scenes

NAMES = scenes.names()


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_a_while_of_random_play(name):
    seconds = 30.0 if name.startswith("train") else 60.0  # their frames cost several times those of others
    session = Session(scenes.load(name), memory=400_000, budget=np.inf)
    player = play_at_random(session, seconds, seed=NAMES.index(name) + 100)
    assert player.frames > 1000, "it was played"
    assert player.given > 1.5 * seconds
    assert player.refused < 0.1 * player.given


@given(seed=st.integers(0, 2**32), name=st.sampled_from(NAMES))
@settings(max_examples=40)
def test_random_inputs_one_frame_after_the_other(seed, name):
    session = Session(scenes.load(name), memory=100_000)
    player = RandomPlayer(session, seed)
    for _ in range(30):
        player.act()
        session.step_frames(2)
        check_invariants(session)
    read_all(session)


@given(seed=st.integers(0, 2**32))
@settings(max_examples=30)
def test_the_chosen_method_balances_the_ledger_whatever_is_edited(seed):
    session = Session(scenes.load("mixed"))
    player = RandomPlayer(session, seed)
    for _ in range(40):
        item = player.random_input()
        if type(item).__name__ in ("SetMethod", "SetStep"):
            continue
        try:
            session.apply(item)
        except ValueError:
            continue
        session.step_frames(3)
        health = session.health(0)
        assert health.energy_error is None or health.energy_error < 1e-6
        assert health.momentum_error is None or health.momentum_error < 1e-9


@given(seed=st.integers(0, 2**32), name=st.sampled_from(NAMES))
@settings(max_examples=40)
def test_the_scene_of_any_session_reads_back_as_its_start(seed, name):
    session = Session(scenes.load(name))
    player = RandomPlayer(session, seed)
    for _ in range(15):
        player.act()
    again = Session(scenes.parse(session.to_scene().to_toml()))
    session.restart()
    for one, other in zip(session.lanes, again.lanes, strict=True):
        assert one.chain.mass == other.chain.mass
        assert one.chain.contact == other.chain.contact
        assert one.chain.drive == other.chain.drive
        assert np.allclose(one.state.overlap, other.state.overlap, rtol=1e-12, atol=1e-12)
        assert np.allclose(one.velocity, other.velocity, rtol=1e-12, atol=1e-12)


def test_the_same_seed_gives_the_same_inputs():
    def run():
        session = Session(scenes.load("one-on-four"), budget=np.inf)
        play_at_random(session, 10.0, seed=7)
        return session.recording

    first, second = run(), run()
    assert first.inputs == second.inputs
    assert first.hashes == second.hashes


def test_the_command_prints_a_line_for_each_scene(capsys):
    assert main(["--hours", "0.001", "--seed", "3"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split(":")[0] for line in lines] == list(NAMES)
