"""Tests of mistakes in scene files. Every problem must be reported with its line or key and with a correction."""

import pytest
from softcradle.scenes import SceneError, load, parse

GOOD = """title = "One on two"
[[lanes]]
mass = [1.0, 1.0, 1.0]
contact = {law = "power_law", f0 = 1.0, alpha = 0.1}
velocity = [1.0, 0.0, 0.0]
"""


def problems_of(text: str) -> list[str]:
    """Return the problems of a scene file with the given text. The name of the file is removed from the messages."""
    with pytest.raises(SceneError) as refused:
        parse(text, "own.toml")
    assert all(problem.startswith("own.toml: ") and "\n" not in problem for problem in refused.value.problems)
    return [problem.removeprefix("own.toml: ") for problem in refused.value.problems]


def problems_with(old: str, new: str) -> list[str]:
    assert old in GOOD
    return problems_of(GOOD.replace(old, new))


SYNTAX = {
    "decimal comma": ("alpha = 0.1", "alpha = 0,1", "write 0.1, with a decimal point (line 4: contact = "),
    "decimal comma of a line": ("[[la", "view.slow = 0,4\n[[la", "write 0.4, with a decimal point (line 2: view.slow = 0,4)"),
    "unit": ('title = "One on two"', 'duration = 0.4 s\ntitle = "t"', "write the number without the unit 's'"),
    "unit with a slash": ("f0 = 1.0", "f0 = 1.0 N/m", "write the number without the unit 'N/m'"),
    "unit in a list": ("mass = [1.0, 1.0, 1.0]", "mass = [1.0 kg, 1.0 kg, 1.0 kg]", "write the number without the unit 'kg'"),
    "quotes of a word processor": ('"power_law"', "„power_law“", 'use straight quotes " instead of typographic ones (line 4: '),
    "quotes of a title": ('"One on two"', "“One on two”", 'use straight quotes " instead of typographic ones (line 1: '),
    "guillemets": ('"One on two"', "«One on two»", 'use straight quotes "'),
    "comma between numbers": ("[1.0, 0.0, 0.0]", "[1.0 0.0, 0.0]", "put a comma between two values (line 5: velocity = "),
    "comma between keys": ('"power_law", f0', '"power_law" f0', "put a comma between two values (line 4: "),
    "closing quote": ('"One on two"', '"One on two', 'a quote is missing (line 1: title = "One on two)'),
    "opening quote": ('"One on two"', 'One on two"', 'a quote is missing (line 1: title = One on two")'),
    "closing quote in a table": ('"power_law"', '"power_law', "a quote is missing (line 4: "),
    "no quotes": ('"One on two"', "One on two", 'put text in quotes: "One on two" (line 1: title = One on two)'),
    "no quotes in a table": ('"power_law"', "power_law", 'put text in quotes: "power_law" (line 4: '),
    "fraction": ("alpha = 0.1", "alpha = 1/10", 'put a fraction in quotes: "1/10" (line 4: '),
    "closing bracket": ("1.0, 1.0, 1.0]", "1.0, 1.0, 1.0", "a closing ] is missing (line 3: mass = [1.0, 1.0, 1.0)"),
    "colon": ("title = ", "title: ", "write key = value, with an equals sign (line 1: "),
    "Python's true": ('title = "One on two"', 'title = "t"\nview.labels = True', "write true in small letters (line 2: "),
    "key twice": ("velocity =", "velocity = [1.0, 0.0, 0.0]\nvelocity =", "this key is given twice in the same table (line 6: "),
}  # fmt: skip


@pytest.mark.parametrize(("old", "new", "hint"), SYNTAX.values(), ids=SYNTAX)
def test_syntax_error_shows_line_and_remedy(old, new, hint):
    (problem,) = problems_with(old, new)
    assert problem.startswith(f"not valid TOML: {hint}")


def test_text_of_title_is_not_taken_for_a_mistake():
    title = '"„Soft“ 0,4 kg: a 1/2 b"  # “1 2”'
    assert parse(GOOD.replace('"One on two"', title)).title == "„Soft“ 0,4 kg: a 1/2 b"
    assert problems_of(GOOD.replace('"One on two"', title).replace("alpha = 0.1", "alpha = 0,1")) == [
        'not valid TOML: write 0.1, with a decimal point (line 4: contact = {law = "power_law", f0 = 1.0, alpha = 0,1})'
    ]


def test_unknown_syntax_error_shows_its_line():
    assert problems_with("velocity = [1.0, 0.0, 0.0]", "velocity = [1.0, 0.0, @]") == [
        "not valid TOML: invalid value (line 5, column 23: velocity = [1.0, 0.0, @])"
    ]


def test_mistakes_in_several_lines_are_all_reported():
    text = """title = One on two
[[lanes]]
beads = 3
mass = 0,4
contact = {law = „powerlaw“, f0 = 1.0 N, alfa = 0.1}
velcity = "fast"
restitution = 0.8
"""
    assert [problem.partition(" (line")[0] for problem in problems_of(text)[:5]] == [
        'not valid TOML: put text in quotes: "One on two"',
        "not valid TOML: write 0.4, with a decimal point",
        'not valid TOML: use straight quotes " instead of typographic ones',
        "not valid TOML: write the number without the unit 'N' (all numbers are in kg, m, s, N): 1.0",
        problems_of(text)[4],
    ]
    rest = " | ".join(problems_of(text)[4:])
    assert "lanes[0]: unknown key 'velcity' (did you mean 'velocity'?)" in rest
    assert "loss = 1 - e**2, here loss = 0.36" in rest
    assert "unknown law 'powerlaw'" in rest
    assert "unknown key 'alfa' (did you mean 'alpha'?)" in rest
    assert "velocity must be a number or a list of numbers, not 'fast'" in rest
    assert "is missing" not in rest
    assert len(problems_of(text)) == 9


def test_one_lane_shows_all_its_mistakes():
    found = problems_of(
        GOOD.replace("[1.0, 1.0, 1.0]", "[1.0, 1.0]\nbeads = 5")
        .replace("f0 = 1.0", "f0 = -1000")
        .replace("alpha", "alfa")
    )
    assert len(found) == 4
    assert any("mass is a list of 2, but 5 beads need 5" in problem for problem in found)
    assert any("velocity is a list of 3, but 5 beads need 5" in problem for problem in found)
    assert any("f0 must be greater than 0, not -1000" in problem for problem in found)
    assert any("unknown key 'alfa' (did you mean 'alpha'?)" in problem for problem in found)


def test_scene_shows_mistakes_beside_those_of_a_lane():
    text = (
        "duration = 1e-40\nmethod = 'verlett'\n"
        + GOOD.replace("f0 = 1.0", "f0 = -1")
        + "[view]\nslow = 1e300\nlength = 0\n"
    )
    found = problems_of(text)
    assert [problem.split()[0] for problem in found] == [
        "lanes[0].contact.f0",
        "duration",
        "method:",
        "view:",
        "view.length",
    ]


@pytest.mark.parametrize(
    ("value", "hint"),
    [
        ("0.8", "loss = 1 - e**2, here loss = 0.36"),
        ("1", "loss = 1 - e**2, here loss = 0"),
        ("0", "loss = 1 - e**2, which must be below 1: a restitution of 0 cannot be computed, 0.01 can"),
        ("1.5", "loss = 1 - e**2 with the restitution e"),
        ('"high"', "loss = 1 - e**2 with the restitution e"),
    ],
)
@pytest.mark.parametrize("place", ["lane", "contact"])
def test_restitution_is_answered_with_the_loss(value, hint, place):
    old = "velocity = [" if place == "lane" else "alpha = 0.1"
    new = f"restitution = {value}\nvelocity = [" if place == "lane" else f"alpha = 0.1, restitution = {value}"
    (problem,) = problems_with(old, new)
    assert f"unknown key 'restitution': give the contact {hint}" in problem


def test_loss_of_a_restitution_is_the_loss_of_that_bounce():
    from softcradle.physics import Chain, hertz, simulate

    run = simulate(Chain([1.0, float("inf")], hertz(1e3, loss=0.36)), [1.0, 0.0])
    assert run.final_velocity[0] == pytest.approx(-0.8, rel=1e-6)


@pytest.mark.parametrize(
    ("lane", "hint"),
    [
        ("gravity = 9.81\n", "drive = mass * 9.81, here drive = [9.81, 9.81, 9.81]"),
        ("gravity = true\n", "drive = mass * 9.81, here drive = [9.81, 9.81, 9.81]"),
        ("g = 2\n", "drive = mass * 2, here drive = [2, 2, 2]"),
    ],
)
def test_gravity_is_answered_with_the_drive(lane, hint):
    (problem,) = problems_with("velocity = [", f"{lane}velocity = [")
    assert problem.endswith(hint)


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        (
            "velocity = [1.0, 0.0, 0.0]",
            'velocity = "fast"',
            "velocity must be a number or a list of numbers, not 'fast'",
        ),
        ("velocity = [1.0, 0.0, 0.0]", 'velocity = [1.0, 0.0, "fast"]', "velocity[2] must be a number, not 'fast'"),
        (
            "velocity = [1.0, 0.0, 0.0]",
            "velocity = 1.0",
            "one velocity for all strikers needs beads = [strikers, targets]",
        ),
        ("mass = [1.0, 1.0, 1.0]", "beads = [1, 2]\nmass = [0,4, 0,4, 0,4]", "decimals are written with a point"),
        ("[[lanes]]", "[lanes]", "write [[lanes]] in double brackets, also for a single lane"),
        ("velocity =", "duration = 1\nvelocity =", "key 'duration' belongs above the first [[lanes]]"),
        ("velocity =", "slow = 10\nvelocity =", "key 'slow' belongs below [view]"),
        ('title = "One on two"', 'title = "t"\nfriction = 0.1', "key 'friction' belongs to a lane, below [[lanes]]"),
        ('"power_law", f0 = 1.0, alpha', '"spring", k', "unknown law 'spring': it is called 'hooke'"),
        ("alpha = 0.1", "alpha = 0.1, damping = 5", "unknown key 'damping': a contact loses energy by its loss"),
    ],
)
def test_wrong_key_or_value_is_answered_with_what_is_meant(old, new, sentence):
    assert sentence in " | ".join(problems_with(old, new))


def test_second_lane_in_single_brackets_is_reported_once():
    lane = GOOD.partition("\n")[2].replace("[[lanes]]", "[lanes]")
    assert problems_of('title = "t"\n' + lane + lane) == [
        "not valid TOML: write [[lanes]] in double brackets, once for each (line 6: [lanes])"
    ]


@pytest.mark.parametrize(
    ("data", "hint"),
    [
        (GOOD.encode("utf-16"), "save it as UTF-8 (it seems to be UTF-16, which Windows calls Unicode)"),
        (GOOD.replace("One", "Stoß").encode("cp1252"), 'save it as UTF-8 (line 1: title = "Stoß on two")'),
        (GOOD.replace("velocity", "# ±1\nvelocity").encode("latin-1"), "save it as UTF-8 (line 5: # ±1)"),
    ],
)
def test_file_in_another_encoding_shows_the_remedy(data, hint, tmp_path):
    path = tmp_path / "own.toml"
    path.write_bytes(data)
    with pytest.raises(SceneError, match="not a text file in UTF-8") as refused:
        load(path)
    assert str(refused.value).endswith(hint)
