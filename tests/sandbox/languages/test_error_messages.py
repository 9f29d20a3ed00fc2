"""Tests of the error messages that the window can show.

Each message must have an error code or be a translated sentence, and all translations must exist.
"""

import ast
import math
import pickle
import tomllib
from functools import cache, partial

import pytest
from softcradle.physics import Chain, Contact, Coupler, power_law, simulate
from softcradle.physics.messages import InputError, Message, message_of
from softcradle.sandbox.files import output_file
from softcradle.sandbox.languages import LANGUAGES, error_words, message_words, use_language
from softcradle.sandbox.scene_runs import load_scene
from softcradle.sandbox.user_error import UserError
from softcradle.scenes import SceneError, load, parse

from tests.helpers.paths import ROOT
from tools.update_catalogues import is_translated, read_catalogue

CODES = [code for code in LANGUAGES if code != "en"]
# Modules whose errors the window never shows. Their functions are called only by Python programs, or their errors
# report a wrong installation.
API_ONLY = ("analysis", "batch", "numerics", "pymunk_contacts", "__init__.py", "ensemble_runs.py", "extras.py")
# Modules of the sandbox whose errors the window can show. The modules in IMPOSSIBLE report only programming errors,
# which a user cannot cause.
USED_BY_WINDOW = (
    "session",
    "film",
    "page",
    "draw",
    "story",
    "window",
    "files.py",
    "scene_runs.py",
    "measured_table.py",
)
IMPOSSIBLE = {"display.py", "page.py"}
# Exceptions whose text the window shows to the user. Any other exception is a programming error.
SHOWN = {
    "ValueError",
    "UserError",
    "GaveUpError",
    "SceneError",
    "OSError",
    "RuntimeError",
    "PermissionError",
    "FileExistsError",
}
CHECKED = ("magnitude", "real_number", "number_array", "whole_number", "require_kind")


def name_of(call):
    return call.func.id if isinstance(call.func, ast.Name) else getattr(call.func, "attr", "")


def is_text(node):
    return isinstance(node, ast.JoinedStr | ast.BinOp) or (
        isinstance(node, ast.Constant) and isinstance(node.value, str)
    )


def sources(folder):
    for path in sorted((ROOT / folder).rglob("*.py") if (ROOT / folder).is_dir() else [ROOT / folder]):
        yield path, ast.parse(path.read_text(encoding="utf-8"))


def raised_texts(path, tree):
    """Yield the source line of each error that the window can show and whose text lacks an error code."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Raise) and isinstance(node.exc, ast.Call) and name_of(node.exc) in SHOWN:
            arguments = node.exc.args[:1]
            listed = arguments[0].elts if arguments and isinstance(arguments[0], ast.List) else arguments
            if any(map(is_text, listed)):
                yield f"{path.relative_to(ROOT)}:{node.lineno}"


@cache
def messages():
    """Return the code, the text template and the source line of each message with an error code."""
    found = []
    for folder in ("physics", "scenes", "sandbox"):
        for path, tree in sources(folder):
            for node in ast.walk(tree):
                if isinstance(node, ast.Call) and name_of(node) in ("Message", "InputError") and len(node.args) > 1:
                    code, template = node.args[:2]
                    if path.name not in ("messages.py", "scene_errors.py") or isinstance(template, ast.Constant):
                        found.append((code, template, f"{path.relative_to(ROOT)}:{node.lineno}"))
    return found


def test_physics_and_scenes_raise_no_bare_text():
    wrong = [
        place
        for folder in ("physics", "scenes")
        for path, tree in sources(folder)
        for place in raised_texts(path, tree)
    ]
    assert [place for place in wrong if not place.removeprefix("physics/").startswith(API_ONLY)] == []


def test_parts_used_by_the_window_raise_no_bare_text():
    wrong = [place for part in USED_BY_WINDOW for path, tree in sources(f"sandbox/{part}") for place in raised_texts(path, tree)
             if path.name not in IMPOSSIBLE]  # fmt: skip
    assert wrong == []


def test_codes_and_templates_are_constants():
    assert len(messages()) > 120
    assert [
        place
        for code, template, place in messages()
        if not all(isinstance(one, ast.Constant) for one in (code, template))
    ] == []


def test_each_code_has_one_template():
    templates = {}
    for code, template, _ in messages():
        templates.setdefault(code.value, set()).add(template.value)
    assert {code: found for code, found in templates.items() if len(found) > 1} == {}


def test_nouns_of_messages_are_marked():
    wrong = []
    for folder in ("physics", "scenes"):
        for path, tree in sources(folder):
            calls = (
                node for node in ast.walk(tree) if isinstance(node, ast.Call) and name_of(node) in CHECKED and node.args
            )
            for call in calls:
                what = call.args[0]
                if isinstance(what, ast.JoinedStr) or (isinstance(what, ast.Constant) and " " in str(what.value)):
                    wrong.append(f"{path.relative_to(ROOT)}:{call.lineno}")
    assert [place for place in wrong if not place.removeprefix("physics/").startswith(API_ONLY)] == []


@pytest.mark.parametrize("language", CODES)
def test_each_message_is_translated(language):
    known = {message.id for message in read_catalogue(language) if message.id and is_translated(message)}
    assert sorted({template.value for _, template, _ in messages()} - known) == []


def test_an_error_has_a_code_and_an_english_text():
    with pytest.raises(
        ValueError, match=r"contact exponent must be from 1e-06 to 10, not 99\.0; its limit 0 is"
    ) as raised:
        Contact(1.0, 1.0, 99.0)
    assert isinstance(raised.value, InputError)
    assert raised.value.code == "exponent"
    assert raised.value.values["given"] == 99.0
    again = pickle.loads(pickle.dumps(raised.value))
    assert (again.code, str(again), dict(again.values)) == (
        raised.value.code,
        str(raised.value),
        dict(raised.value.values),
    )


def test_an_error_that_is_raised_again_keeps_its_code():
    with pytest.raises(UserError) as raised:
        load_scene("one-on-for")
    message = message_of(raised.value)
    assert isinstance(message, Message)
    assert message.code == "near_scene"
    use_language("de")
    assert error_words(raised.value).startswith("unbekannte Szene 'one-on-for'; meinten Sie one-on-four")


def test_numbers_in_errors_have_the_decimal_mark_of_the_language():
    use_language("fr")
    with pytest.raises(ValueError, match="loss") as raised:
        Contact(1.0, 1.0, 1.0, loss=1.5)
    assert "non 1,5" in error_words(raised.value)


MISTAKES = (
    lambda: Contact(1.0, 1.0, 95.0),
    lambda: Contact(0.0, 0.0, 1.0),
    lambda: Contact(1.0, 1.0, 1.0, loss=1.5),
    lambda: Contact(-1.0, 1.0, 1.0),
    lambda: Contact(0.0, 1e40, 1.0),
    lambda: Chain([1.0, -1.0], power_law(1.0, 0.1)),
    lambda: Chain([math.inf, math.inf], power_law(1.0, 0.1)),
    lambda: Coupler(power_law(1.0, 0.5), slack=0.1),
    lambda: simulate(Chain([1.0, 1.0], power_law(1.0, 0.1)), [1e-40, 0.0]),
    lambda: simulate(Chain([1.0, 1.0], power_law(1.0, 0.1), drive=[1.0, 0.0]), [1.0, 0.0]),
    *(partial(load, name) for name in ("one-on-for", "zzz", "zzz.toml", ".")),
)
ROW = '[[lanes]]\nbeads = [1, 4]\nvelocity = 1.0\ncontact = {law = "power_law", f0 = 1.0, alpha = 0.1}\n'
WRONG_SCENES = (
    "title = ",
    'title = "x"',
    "title = 3\nlanes = []",
    'title = "x"\n[[lanes]]\nbeads = [1, 4]\napproach = "far"\n[lanes.contact]\nlaw = "hertz"',
    'title = "x"\nlanes = 3',
    'title = "x"\n[[lanes]]\nbeads = [1, 4]\ncontact = {law = "power_law", f0 = 1.0}',
    f'title = "x"\nview = 3\n{ROW}',
    f'title = "x"\n[view]\nlabels = 3\n{ROW}',
    f'title = "x"\nduration = -1\n{ROW}',
    f'title = "x"\nmethod = "eurler"\n{ROW}',
    f'title = "x"\nstep = 0.1\nmethod = "accurate"\n{ROW}',
    f'title = "x"\ngravity = 9.81\n{ROW}',
    f'title = "x"\n{ROW}restitution = 0.9\nmu = 0.1\nslow = 2.0\n',
    f'title: "x"\n{ROW}'.replace("0.1}", "0,1}"),
    'title = "x"\n' + ROW.replace("power_law", "spring"),
    'title = "x"\n' + ROW.replace("[1, 4]", "[1, 4, 2]"),
    'title = "x"\n' + ROW.replace("1.0\n", "[1.0, 0.0]\n"),
)
ENGLISH = {"must", "there", "be", "not", "two", "unknown", "allowed", "write", "missing", "the", "give"}


@pytest.mark.parametrize("language", CODES)
@pytest.mark.parametrize("mistake", [*MISTAKES, *(partial(parse, text, "mine.toml") for text in WRONG_SCENES)])
def test_mistakes_are_reported_in_the_language(language, mistake):
    with pytest.raises(ValueError, match=r".") as raised:
        mistake()
    use_language(language)
    problems = raised.value.problems if isinstance(raised.value, SceneError) else [message_of(raised.value)]
    for problem in problems:
        assert isinstance(problem, Message), problem
        translated = message_words(problem)
        assert translated != problem
        assert not ENGLISH & set(translated.replace("'", " ").replace(":", " ").split()), translated
    named = getattr(mistake, "args", ())[-1:]  # The last argument of the exception is the name of a scene or of a file.
    assert all(name in translated for name in named)


def test_an_unwritable_file_is_reported_in_the_language(tmp_path):
    use_language("de")
    with pytest.raises(UserError) as raised, output_file(tmp_path):
        pass
    assert error_words(raised.value) == f"{tmp_path} lässt sich nicht schreiben: es ist ein Ordner"


def test_examples_of_wrong_scenes_are_read_as_toml_or_not():
    assert tomllib.loads(f'title = "x"\n{ROW}')["lanes"][0]["beads"] == [1, 4]
    assert parse(f'title = "x"\n{ROW}').lanes[0].velocity == (1.0, 0.0, 0.0, 0.0, 0.0)
