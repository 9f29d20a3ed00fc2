"""Mistakes of users: one sentence, exit code 2, no file left, no traceback."""

import re
from pathlib import Path

import pytest
from softcradle.sandbox.cli.main import main

GOOD = """
title = "one on two"
[[lanes]]
mass = [1.0, 1.0, 1.0]
contact = {law = "power_law", f0 = 1.0, alpha = 0.1}
velocity = [1.0, 0.0, 0.0]
"""


def changed(old: str, new: str) -> str:
    assert old in GOOD
    return GOOD.replace(old, new)


BAD_FILES = {
    "unknown key": (GOOD + "gapp = 1", r"\[0\]: unknown key 'gapp' \(did you mean 'gap'\?\); allowed: label"),
    "unknown key at the top": ("titel = 1\n" + GOOD, r"unknown key 'titel' \(did you mean 'title'\?\)"),
    "missing key": (changed("velocity = [1.0, 0.0, 0.0]", ""), r"lanes\[0\]: key 'velocity' is missing"),
    "negative mass": (changed("mass = [1.0", "mass = [-1.0"), r"lanes\[0\]\.mass\[0\] must be greater than 0, not -1"),
    "mass NaN": (changed("mass = [1.0", "mass = [nan"), r"lanes\[0\]\.mass\[0\] must be greater than 0, not nan"),
    "velocity NaN": (changed("velocity = [1.0", "velocity = [nan"), r"velocity\[0\] must be a finite number, not nan"),
    "alpha 0": (changed("alpha = 0.1", "alpha = 0"), r"lanes\[0\]\.contact\.alpha must be greater than 0, not 0"),
    "alpha negative": (changed("alpha = 0.1", "alpha = -0.1"), r"contact\.alpha must be greater than 0, not -0\.1"),
    "alpha NaN": (changed("alpha = 0.1", "alpha = nan"), r"contact\.alpha must be a finite number, not nan"),
    "fraction by zero": (changed("alpha = 0.1", 'alpha = "1/0"'), r"contact\.alpha: must not divide by zero"),
    "f0 as text": (changed("f0 = 1.0", 'f0 = "strong"'), r"contact\.f0 must be a number, not 'strong'"),
    "unknown law": (
        changed('"power_law"', '"pover_law"'),
        r"contact: unknown law 'pover_law' \(did you mean 'power_law'\?\)",
    ),
    "no law": (changed('law = "power_law", ', ""), r"contact: key 'law' is missing"),
    "velocities too short": (changed(", 0.0]\n", "]\n"), r"lanes\[0\]: velocity is a list of 2, but 3 beads need 3"),
    "gaps too long": (GOOD + "gap = [1, 1, 1]", r"lanes\[0\]: gap is a list of 3, but 3 beads need 2"),
    "contacts too few": (
        changed("{law", "[{law").replace("0.1}", "0.1}]"),
        r"contact is a list of 1, but 3 beads need 2",
    ),
    "empty chain": (
        changed("mass = [1.0, 1.0, 1.0]", "mass = []").replace("[1.0, 0.0, 0.0]", "[]"),
        r"at least 2 beads, not 0",
    ),
    "no lanes": ('title = "none"\nlanes = []', r"lanes: a scene needs at least one lane"),
    "walls side by side": (changed("mass = [1.0, 1.0,", "mass = [inf, inf,"), r"lanes\[0\]: two walls side by side"),
    "walls at both ends": (changed("mass = [1.0, 1.0, 1.0]", "mass = [inf, 1.0, inf]"), r"the scene needs a duration"),
    "unknown method": ('method = "verlett"\n' + GOOD, r"method: unknown method 'verlett' \(did you mean 'verlet'\?\)"),
    "step 0": ("step = 0\n" + GOOD, r"step must be greater than 0, not 0"),
    "duration negative": ("duration = -1\n" + GOOD, r"duration must be greater than 0, not -1"),
    "a million million beads": (changed("mass = [1.0, 1.0, 1.0]", "beads = 1000000000000"), r"less than or equal to"),
    "not TOML": (changed("mass = [1.0", "mass = [1.0 1.0"), r"not valid TOML: .*\(at line 4, column \d+\)"),
}


def refused(capsys: pytest.CaptureFixture[str], arguments: list[str]) -> str:
    """Run the command, require a refusal, and return its one sentence."""
    assert main(arguments) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert re.fullmatch(r"softcradle: .+\n", err)
    return err.removeprefix("softcradle: ").rstrip()


@pytest.mark.parametrize(("text", "sentence"), BAD_FILES.values(), ids=BAD_FILES)
def test_bad_scene_file(text, sentence, tmp_path, capsys):
    path = tmp_path / "bad.toml"
    path.write_text(text, encoding="utf-8")
    refusal = refused(capsys, ["run", str(path), "-o", str(tmp_path / "out.npz")])
    assert refused(capsys, ["check", str(path)]) == refusal
    assert refusal.startswith(f"{path}: ")
    assert re.search(sentence, refusal)
    assert list(tmp_path.iterdir()) == [path]


BAD_ARGUMENTS = {
    "unknown scene": (["run", "one-on-fuor"], r"there is no scene 'one-on-fuor'; did you mean one-on-four"),
    "missing file": (["run", "nowhere/own.toml"], r"there is no file nowhere/own\.toml"),
    "folder as file": (["run", "."], r"cannot read \.: "),
    "unknown command": (["rnu"], r"there is no command 'rnu'; did you mean run\?"),
    "unknown option": (["run", "mixed", "--stepp", "1"], r"unrecognized arguments: --stepp 1"),
    "no scene": (["run"], r"required: SCENE"),
    "unknown method": (["run", "mixed", "--method", "verlett"], r"did you mean 'verlet'. there are auto, euler"),
    "step 0": (["run", "mixed", "--step", "0"], r"--step: must be a number > 0, not '0'"),
    "step NaN": (["run", "mixed", "--step", "nan"], r"--step: must be a number > 0, not 'nan'"),
    "duration inf": (["run", "mixed", "--duration", "inf"], r"--duration: must be a number > 0, not 'inf'"),
    "one sample": (["run", "mixed", "--samples", "1"], r"--samples: must be a whole number from 2"),
    "too many samples": (["run", "mixed", "--samples", "9" * 12], r"--samples: must be a whole number from 2"),
    "tolerance for a step": (["run", "mixed", "--method", "verlet", "--tolerance", "1e-3"], r"takes a step"),
    "size": (["render", "mixed", "-o", "x.mp4", "--size", "wide"], r"--size: must be WIDTHxHEIGHT"),
    "frames a second": (["render", "mixed", "-o", "x.mp4", "--fps", "0"], r"--fps: must be a number > 0"),
    "unknown data format": (["run", "mixed", "-o", "out.xls"], r"cannot write out\.xls: run writes \.npz or \.csv"),
    "no such folder": (["run", "mixed", "-o", "nowhere/out.npz"], r"there is no folder .*nowhere"),
    "unwritable folder": (["run", "mixed", "-o", "/proc/out.npz"], r"cannot write /proc/out\.npz: nothing can|denied"),
}


@pytest.mark.parametrize(("arguments", "sentence"), BAD_ARGUMENTS.values(), ids=BAD_ARGUMENTS)
def test_bad_arguments(arguments, sentence, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert re.search(sentence, refused(capsys, arguments))
    assert list(tmp_path.iterdir()) == []


def test_existing_output_survives_a_refused_run(tmp_path, capsys):
    path = tmp_path / "out.npz"
    path.write_bytes(b"old")
    assert "takes a step" in refused(
        capsys, ["run", "mixed", "-o", str(path), "--method", "verlet", "--tolerance", "0.1"]
    )
    assert path.read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [path]
    (tmp_path / "out.csv").mkdir()
    assert "it is a folder" in refused(capsys, ["run", "mixed", "-o", str(tmp_path / "out.csv")])


def test_check_reports_every_problem_of_every_file(tmp_path, capsys):
    path, film, good = tmp_path / "two.toml", tmp_path / "film.toml", tmp_path / "good.toml"
    film.write_bytes(b"\xff\xfe\x00")
    assert "not a text file in UTF-8" in refused(capsys, ["check", str(film)])
    good.write_text(GOOD, encoding="utf-8")
    assert main(["check", str(good)]) == 0
    capsys.readouterr()
    path.write_text(changed("mass = [1.0, 1.0", "mass = [-1.0, -2.0"), encoding="utf-8")
    assert main(["check", str(path), "mixed", "nope"]) == 2
    out, err = capsys.readouterr()
    assert out.startswith("mixed: ok")
    assert [line.count("mass") for line in err.splitlines()] == [1, 1, 0]
    assert "there is no scene 'nope'" in err.splitlines()[2]


def test_interrupted_run_leaves_no_file(tmp_path, monkeypatch, capsys):
    def interrupt(*_arguments: object, **_keywords: object) -> None:
        assert len(list(tmp_path.iterdir())) == 1  # the file is opened before the run
        raise KeyboardInterrupt

    monkeypatch.setattr("softcradle.sandbox.cli.commands.run.run_scene", interrupt)
    assert main(["run", "mixed", "-o", str(tmp_path / "out.csv")]) == 130
    assert capsys.readouterr().err == "softcradle: interrupted\n"
    assert list(Path(tmp_path).iterdir()) == []
