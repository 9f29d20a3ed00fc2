"""Tests of mistakes of users. The command must print one sentence and return exit code 2. The command must leave no
file and print no traceback.
"""

import re
from pathlib import Path
from unittest.mock import Mock

import pytest
from softcradle.sandbox.cli.arguments import opened_outputs
from softcradle.sandbox.studies.compare.sides import MOST_SIDES
from softcradle.sandbox.user_error import StudyError

from tests.helpers.paths import ROOT

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


LASTS = "duration = 1.0\n" + GOOD
BAD_FILES = {
    "unknown key": (GOOD + "gapp = 1", r"\[0\]: unknown key 'gapp' \(did you mean 'gap'\?\); allowed: label"),
    "missing key": (changed("velocity = [1.0, 0.0, 0.0]", ""), r"lanes\[0\]: key 'velocity' is missing"),
    "mass NaN": (changed("mass = [1.0", "mass = [nan"), r"lanes\[0\]\.mass\[0\] must be greater than 0, not nan"),
    "velocity NaN": (changed("velocity = [1.0", "velocity = [nan"), r"velocity\[0\] must be a finite number, not nan"),
    "no law": (changed('law = "power_law", ', ""), r"contact: key 'law' is missing"),
    "velocities too short": (changed(", 0.0]\n", "]\n"), r"lanes\[0\]: velocity is a list of 2, but 3 beads need 3"),
    "contacts too few": (changed("{law", "[{law").replace("0.1}", "0.1}]"), r"contact is a list of 1, but 3 beads need 2"),
    "empty chain": (changed("mass = [1.0, 1.0, 1.0]", "mass = []").replace("[1.0, 0.0, 0.0]", "[]"), "to 100000 beads, not 0"),
    "a title of blanks": (changed("one on two", " "), r"bad\.toml: title must not be empty$"),
    "no lanes": ('title = "none"\nlanes = []', r"lanes: a scene needs at least one lane"),
    "walls at both ends": (changed("mass = [1.0, 1.0, 1.0]", "mass = [inf, 1.0, inf]"), "two walls may never come apart"),
    "unknown method": ('method = "verlett"\n' + GOOD, r"method: unknown method 'verlett' \(did you mean 'verlet'\?\)"),
    "step 0": ("step = 0\n" + GOOD, r"step must be greater than 0, not 0"),
    "duration of no step": ("duration = 5e-324\n" + GOOD, r"bad\.toml: duration must be from 1e-30 to 1e\+30"),
    "tolerance below round-off": ("tolerance = 1e-20\n" + GOOD, r"bad\.toml: tolerance must be at least 1e-"),
    "a million million beads": (changed("mass = [1.0, 1.0, 1.0]", "beads = 1000000000000"), r"less than or equal to"),
    "two clusters too long": (
        changed("mass = [1.0, 1.0, 1.0]", "beads = [99999, 2]").replace("[1.0, 0.0, 0.0]", "1.0"), "beads, not 100001",
    ),
    "a tolerance for fixed steps": ('method = "verlet"\ntolerance = 1e-4\n' + GOOD, "'verlet' takes a step, not a tolerance"),
    "slow motion without bounds": (GOOD + "[view]\nslow = 1e300", r"view: slow must be from 1e-20 to 1e\+20, not 1e\+300"),
    "a view of for ever": (GOOD + "[view]\nafter = 1e300", r"view: after must be from 1e-30 to 1e\+30, not 1e"),
    "loss negative": (changed("alpha = 0.1", "alpha = 0.1, loss = -1"), r"contact\.loss must be greater than"),
    "friction negative": (GOOD + "friction = -1", r"lanes\[0\]\.friction must be greater than or equal to 0"),
    "a piston on a bed": (changed("mass = [1.0", "mass = [inf") + "friction = 0.1", "from a wall that moves: give a duration"),
    "endless drive": (GOOD + "drive = [1, 0, 0]", "a driven chain may never come apart"),
    "brake on no bead": (LASTS + "brakes = [{beads = [1, 3], time = 0, force = 3}]", "brakes act on bead 3"),
    "a force too few": (LASTS + "forces = [{beads = 0, time = [0, 1, 2], force = [0, 2]}]", "3 times of a force need 3"),
    "not TOML": (changed("mass = [1.0,", "mass = [1.0"), r"not valid TOML: .*\(line 4: mass = \[1.0 1.0, 1.0\]\)"),
}  # fmt: skip


@pytest.mark.parametrize(("text", "sentence"), BAD_FILES.values(), ids=BAD_FILES)
def test_bad_scene_file(text, sentence, tmp_path, refused):
    path = tmp_path / "bad.toml"
    path.write_text(text, encoding="utf-8")
    refusal = refused("run", str(path), "-o", str(tmp_path / "out.npz"))
    assert refused("check", str(path)) == refusal
    assert refusal.startswith(f"{path}: ")
    assert re.search(sentence, refusal)
    assert list(tmp_path.iterdir()) == [path]


STUDY = ROOT / "examples" / "softness-and-size.toml"
REFUSED = [
    ("rnu", "there is no command 'rnu'; did you mean run?"),
    ("list", "did you mean scenes?"),
    ("run", "required: SCENE"),
    ("run one-on-fuor", "unknown scene 'one-on-fuor'; did you mean one-on-four"),
    ("run nowhere/own.toml", "cannot find the file nowhere/own.toml"),
    ("run .", "cannot read .: "),
    ("run mixed --stepp 1", "unrecognized arguments: --stepp 1 (see softcradle run --help)"),
    ("run mixed --method verlett", "did you mean 'verlet'"),
    ("run mixed --step 0", "--step: must be a number from 1e-30 to 1e+30, not '0'"),
    ("run mixed --duration inf", "--duration: must be a number from 1e-30 to 1e+30, not 'inf'"),
    ("run mixed --samples 1", "--samples: must be a whole number from 2"),
    ("run mixed --describe --json", "--json: not allowed with argument --describe"),
    ("run mixed -o out.npz --method verlet --tolerance 0.1", "takes a step"),
    ("run mixed -o out.xls", "cannot write out.xls: run writes .npz or .csv"),
    ("run mixed -o nowhere/out.npz", "nowhere does not exist"),
    ("experiment -o nowhere/out.json", "nowhere does not exist"),
    ("run mixed -o /proc/out.npz", "cannot write /proc/out.npz: "),
    ("run mixed -o a.csv -o no/../a.csv", "the same file is given twice with -o"),
    ("render mixed -o a.mp4 -o b.mp4", "-o/--output: is given twice"),
    ("render mixed -o x.mp4 --slow 1e300", "--slow: must be a number from 1e-30 to 1e+30, not '1e300'"),
    ("render mixed -o x.mp4 --slow 1e20", " frames, more than 100000: choose less slow motion"),
    ("page mixed -o x.html --slow 1e25", "slow motion must be from 1e-20 to 1e+20, not 1e+25"),
    ("render mixed -o x.mp4 --size wide", "--size: must be WIDTHxHEIGHT"),
    ("render mixed -o x.kymograph.png --slow 2", "--slow is for films"),
    ("render one-on-four -o page.html --fps 30", "a page has no frames: --fps is for films"),
    ("render one-on-four -o page.html --method radau --step 1e-3", "chooses its own steps"),
    ("figures 3z", "there is no figure '3z'; there are 1b, 1c"),
    ("figures 2a -o /dev/null", "cannot write to"),
    ("claims nonsense", "there is no claim 'nonsense'; there are rigid-like"),
    ("maps gear", "no map 'gear'; there are power-law, draft-gear"),
    ("maps --points 200", "--points must be two whole numbers from 2 to 2000"),
    ("maps --points 1x20", "--points must be two whole numbers"),
    ("stability beta", "there is no scan 'beta'"),
    ("chart one-on-for", "did you mean"),
    ("chart train-braking --ours --error overlaps -o chart.svg", "no contact yields"),
    ("chart -o chart.txt", "chart writes .png, .pdf, .svg"),
    ("sweep", "a study file is missing"),
    (f"sweep {STUDY} --status -o nowhere/found.nc", "there is no folder "),
    ("sweep nowhere.toml", "cannot read nowhere.toml: no such file"),
    (f"sweep {STUDY} --threads --scheduler tcp://127.0.0.1:1", "--threads is for this machine"),
    (f"sweep {STUDY} --workers 2 --scheduler tcp://127.0.0.1:1", "--workers is for this machine"),
    (f"sweep {STUDY} --status --fresh", "--status computes nothing: --fresh does"),
    ("claims --list --json", "--list computes nothing: --json"),
    ("figures --list --open", "--list computes nothing: --open"),
    ("chart --list one-on-for", "did you mean"),
    ("chart --list --csv", "--list computes nothing: --csv"),
    ("chart --list no-such", "unknown scene 'no-such'"),
    (f"sweep {STUDY} --workers 0", "must be a whole number from 1"),
    ("compare one-on-four", "has nothing to be compared with"),
    ("compare one-on-four no-such", "unknown scene 'no-such'"),
    ("compare one-on-four two-on-two --contact hertz(1)", "--contact changes one scene, but 2 are given"),
    ("compare one-on-four --contact hertz(-1)", "stiffness must be greater than 0"),
    (
        "compare prestressed --contact power_law(1e-3,1/100)",
        "power_law(0.001, 0.01): contact 0-1 would be pressed by about",
    ),
    ("compare one-on-four two-on-two -o x.pdf", "the name must end in .json, .html, .mp4"),
    ("compare one-on-four two-on-two -o no/such/folder/x.html", "no/such/folder"),
    ("compare one-on-four two-on-two -o x.json -o x.json", "given twice"),
    ("compare one-on-four two-on-two -o x.mp4 --size 10x10", "out of range"),
    ("compare one-on-four two-on-two --size 640x480", "--size is for .mp4, .gif: give"),
    ("compare one-on-four two-on-two -o x.json --slow 2", "--slow is for .html, .mp4"),
    ("compare one-on-four two-on-two --json --open", "give one with -o"),
    ("run mixed --open", "--open opens the file that is written: give one with -o, too"),
    ("claims --open", "give one with -o"),
    ("render mixed -o page.html --size 1280x720", "--size is for films and pictures"),
    ("compare one-on-four two-on-two --method vrlet -o x.json", "unknown method"),
    ("compare one-on-four driven-cluster -o x.json", "driven-cluster: no two neighbours approach"),
    ("compare mixed --match -o x.json", "mixed: matching needs a chain whose contacts are all alike"),
    ("compare galilean --match", "--match needs one scene with one lane"),
    ("compare" + (MOST_SIDES + 1) * " one-on-four", f"at most {MOST_SIDES}"),
    ("compare --match force" + MOST_SIDES * " one-on-four", f"at most {MOST_SIDES}"),
]


@pytest.mark.parametrize(("line", "sentence"), REFUSED, ids=[line.replace(f"{ROOT}/", "") for line, _ in REFUSED])
def test_wrong_arguments_of_a_command_are_rejected(line, sentence, tmp_path, monkeypatch, refused):
    monkeypatch.chdir(tmp_path)
    assert sentence in refused(*line.split())
    assert list(tmp_path.iterdir()) == []


def test_a_rejected_command_creates_no_folder(tmp_path, monkeypatch, refused):
    refusing = Mock(side_effect=StudyError("cannot write"))
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("softcradle.sandbox.sweeps.run_sweep.checked_output", refusing)
    refused("sweep", str(STUDY), "--workers", "1")
    assert list(tmp_path.iterdir()) == []
    Path("out").mkdir()
    refused("sweep", str(STUDY), "--workers", "1")
    assert list(tmp_path.iterdir()) == [tmp_path / "out"]
    with opened_outputs([Path("out/chart.png"), Path("out/chart.csv")]) as places:
        for place in places:
            place.touch()
    assert {path.name for path in Path("out").iterdir()} == {"chart.png", "chart.csv"}
    Path("out.csv").mkdir()
    assert "out.csv: it is a folder" in refused("run", "mixed", "-o", "out.csv")


def test_check_reports_every_problem_of_every_file(tmp_path, softcradle, refused):
    path, film = tmp_path / "two.toml", tmp_path / "film.toml"
    film.write_bytes(b"\xff\xfe\x00")
    assert "not a text file in UTF-8" in refused("check", str(film))
    path.write_text(GOOD, encoding="utf-8")
    assert softcradle("check", str(path)).out == f"{path}: ok, 'one on two' with 3 beads\n"
    path.write_text(changed("mass = [1.0, 1.0", "mass = [-1.0, -2.0"), encoding="utf-8")
    out, err = softcradle("check", str(path), "galilean", "nope", code=2)
    assert out == "galilean: ok, 'Who hits whom?' with 5 and 5 beads\n3 files: 1 ok, 2 with problems\n"
    assert [line.count("mass") for line in err.splitlines()] == [1, 1, 0]
    assert "unknown scene 'nope'" in err.splitlines()[2]


def test_check_takes_folders_and_patterns(tmp_path, monkeypatch, softcradle, refused):
    monkeypatch.chdir(tmp_path)
    folder = tmp_path / "class" / "deep"
    folder.mkdir(parents=True)
    (tmp_path / "class" / "a.toml").write_text(GOOD, encoding="utf-8")
    (folder / "b.toml").write_text(changed("mass", "mas"), encoding="utf-8")
    (folder / "notes.txt").write_text("no scene", encoding="utf-8")
    for words in ["class"], ["class/**/*.toml"], ["class", "class/*.toml"]:
        out, err = softcradle("check", *words, code=2)
        assert out.splitlines()[0].endswith("a.toml: ok, 'one on two' with 3 beads")
        assert out.splitlines()[1:] == ["2 files: 1 ok, 1 with problems"]
        assert err.count("\n") == err.count("b.toml") == 1
    (folder / "b.toml").write_text(GOOD, encoding="utf-8")
    assert softcradle("check", "class").out.splitlines()[2] == "2 files: all ok"
    assert "cannot find the file *.toml" in refused("check", "*.toml")
    # The file name "[1].toml" is also a valid search pattern.
    (tmp_path / "[1].toml").write_text(GOOD, encoding="utf-8")
    assert softcradle("check", "[1].toml").out == "[1].toml: ok, 'one on two' with 3 beads\n"
    (tmp_path / "empty").mkdir()
    assert "no file with the ending .toml in the folder empty" in refused("check", "empty")


@pytest.mark.parametrize("compiled", [False, True])
def test_an_interrupted_run_leaves_the_old_file(compiled, tmp_path, monkeypatch, softcradle):
    """Check that Ctrl+C during a run does not change an existing output file.

    With compiled code, pybind11 turns the interruption into an ImportError. The command then printed "initialization
    failed" and returned exit code 2.
    """
    path = tmp_path / "out.csv"
    path.write_bytes(b"old")

    def interrupt(*_, **__):
        # The second file is the temporary output file, which is opened before the run.
        assert len(list(tmp_path.iterdir())) == 2
        if compiled:
            raise ImportError("initialization failed") from KeyboardInterrupt()
        raise KeyboardInterrupt

    monkeypatch.setattr("softcradle.sandbox.cli.commands.run.run_scene", interrupt)
    assert softcradle("run", "mixed", "-o", str(path), code=130).err == "softcradle: interrupted\n"
    assert list(tmp_path.iterdir()) == [path]
    assert path.read_bytes() == b"old"
