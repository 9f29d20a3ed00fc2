"""`softcradle compare`: its numbers against the truth, the nearest contact, the names of sides, refusals."""

import pytest
from softcradle.sandbox.draw.number_format import MINUS, number_text
from softcradle.sandbox.studies.compare.sides import MOST_SIDES, short_text

PAIR = ["one-on-four", "--contact", "power_law(1,0.1)", "--contact", "draft_gear(5,0.2)"]


def test_one_scene_with_contacts_comes_first_and_equal_contacts_once(compared):
    content = compared(*PAIR)
    assert [side["name"] for side in content["sides"]] == ["power_law(1, 0.1)", "draft_gear(5, 0.2)"]
    assert [side["contact"] for side in content["sides"]] == ["power_law(1, 0.1)", "draft_gear(5, 0.2)"]
    soft, gear = (side["measures"] for side in content["sides"])
    assert soft["rigidity"] < gear["rigidity"]
    assert content["versions"]


def test_the_nearest_contact_is_one_more_side(compared, tmp_path):
    path = tmp_path / "x.html"
    content = compared(
        "draft-gear-one-on-three", "--match", "--contact", "hertz(1e6)", "-o", str(path), "--size", "480x270"
    )
    names = [side["name"] for side in content["sides"]]
    assert names[:2] == ["draft_gear(770, 0.0177)", "hertz(1e+06)"]
    assert names[2] == f"nearest: {short_text(content['match']['contact'])}"  # no raw digits in the film
    assert content["match"]["near"]
    assert content["match"]["residual"] < 0.05
    given, _, nearest = (side["measures"] for side in content["sides"])
    assert nearest["contact_time"] == pytest.approx(given["contact_time"], rel=0.02)
    assert nearest["peak_force"] == pytest.approx(given["peak_force"], rel=0.1)
    text = path.read_text()
    assert content["match"]["sentence"].partition(" in this collision")[0] in text


def test_where_no_contact_is_near_a_sentence_says_so(compared):
    match = compared("hertz-cradle", "--match")["match"]
    assert not match["near"]
    assert match["ends"] == ["precompression"]
    assert match["sentence"].startswith("No draft gear comes near hertz(")
    assert "lies at the end of the range searched" in match["sentence"]
    outcome = compared("one-on-four", "--match", "outcome")["match"]
    assert outcome["distance"] == "outcome"


def test_scenes_lanes_and_the_same_scene_twice(compared):
    assert [s["name"] for s in compared("galilean")["sides"]] == ["four on one", "one on four"]
    names = [s["name"] for s in compared("one-on-four", "one-on-four", "two-on-two")["sides"]]
    assert names == ["one-on-four", "one-on-four (2)", "two-on-two"]
    a, b = (s["measures"] for s in compared("galilean")["sides"])
    assert a["restitution"] == pytest.approx(b["restitution"], rel=1e-6)  # Galilean invariance
    assert a["peak_force"] == pytest.approx(b["peak_force"], rel=1e-6)


def test_couplers_are_compared(compared):
    gears, solid = (side["measures"] for side in compared("train-shunting", "train-solid")["sides"])
    assert solid["peak_force"] > 1.5 * gears["peak_force"]
    assert (solid["speed_ratio"], solid["spread_variable"]) == (None, None)


def test_another_method_is_named_and_measured(compared):
    by_step, default = compared(*PAIR, "--method", "conserving"), compared(*PAIR)
    assert {side["method"] for side in by_step["sides"]} == {"conserving"}
    for a, b in zip(by_step["sides"], default["sides"], strict=True):
        assert a["measures"]["final_velocity"] == pytest.approx(b["measures"]["final_velocity"], abs=2e-3)


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["one-on-four"], "has nothing to be compared with"),
        (["one-on-four", "no-such"], "there is no scene 'no-such'"),
        (["one-on-four", "two-on-two", "--contact", "hertz(1)"], "--contact changes one scene, but 2 are given"),
        (["one-on-four", "--contact", "hertz(-1)"], "stiffness must be greater than 0"),
        (["one-on-four", "--contact", "herz(1)"], "did you mean 'hertz'?"),
        (["one-on-four", "two-on-two", "-o", "x.pdf"], "the name must end in .html, .json, .mp4"),
        (["one-on-four", "two-on-two", "-o", "no/such/folder/x.html"], "no/such/folder"),
        (["one-on-four", "two-on-two", "-o", "x.json", "-o", "x.json"], "given twice"),
        (["one-on-four", "two-on-two", "--size", "10x10"], "out of range"),
        (["one-on-four", "two-on-two", "--method", "vrlet", "-o", "x.json"], "unknown method"),
        (["one-on-four", "driven-cluster", "-o", "x.json"], "driven-cluster: no two neighbours approach"),
        (["mixed", "--match", "-o", "x.json"], "mixed: matching needs a chain whose contacts are all alike"),
        (["galilean", "--match"], "--match needs one scene with one lane"),
        (["one-on-four", "two-on-two", "--match"], "--match needs one scene with one lane"),
        (["one-on-four", "--match", "shape"], "invalid choice: 'shape'"),
        (["one-on-four"] * (MOST_SIDES + 1), f"at most {MOST_SIDES}"),
    ],
)
def test_refusals(refused, tmp_path, monkeypatch, arguments, sentence):
    monkeypatch.chdir(tmp_path)
    assert sentence in refused(*arguments)
    assert [path for path in tmp_path.rglob("*") if path.is_file()] == []


def test_numbers_have_up_to_five_digits():
    assert [number_text(v) for v in (None, 0.0, 1e-15, 0.5, -0.25, 2e-5, 1234.4, 8e4, 123456.0)] == [
        "-", "0", "0", "0.5000", f"{MINUS}0.2500", "2.00·10⁻⁵", "1234", "8.00·10⁴", "1.23·10⁵",
    ]  # fmt: skip
