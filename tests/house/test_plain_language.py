"""Tests of the tool that counts sentences which break the language rules."""

import json
import subprocess

import pytest

from tools import plain_language


@pytest.mark.parametrize(
    ("sentence", "rule"),
    [
        ("What is told of hits is of the beads that there are.", "clause as a noun (what ...)"),
        ("Raise ValueError where it is not finite.", "where for if"),
        ("A run that is no longer needed is no run at all.", "is no, is none"),
        ("The rows have labels, too.", "adverb at the end"),
        ("The row stands beside the other row.", "beside"),
    ],
)
def test_a_sentence_in_dialect_breaks_its_rule(sentence, rule):
    assert rule in plain_language.matches(sentence)


@pytest.mark.parametrize(
    "sentence",
    [
        "Return the larger error, or NaN if either is NaN.",
        "Contacts open and close faster than the time step can follow.",
        "The file is no longer read.",
    ],
)
def test_a_plain_sentence_breaks_none(sentence):
    assert plain_language.matches(sentence) == []


def test_python_is_read_without_code_and_examples():
    docstring = '"""First sentence of the module docstring.\n\n>>> what is this code here\n"""\n'
    source = docstring + 'x = "what is a string"\n# a comment of two\n# lines about x\n'
    assert list(plain_language.python_sentences(source)) == [
        (1, "First sentence of the module docstring."),
        (6, "a comment of two lines about x"),
    ]


def test_markdown_is_read_without_code_tables_and_headings():
    code = "```\nwhat is this code now\n```\n"
    source = f"# What is a heading to us\n\nOne sentence of the text here.\n\n{code}\n* an item of a list here\n| what is it |\n"
    assert [text for _, text in plain_language.markdown_sentences(source)] == [
        "One sentence of the text here.",
        "an item of a list here",
    ]


def test_subjects_are_short_and_imperative():
    good = "Report hits only for the current beads"
    long = "Report " + "hits " * 20
    assert plain_language.subject_faults([good]) == []
    assert len(plain_language.subject_faults([long.strip(), "The hits are reported", "Adds a report"])) == 3


@pytest.fixture
def small_repository(tmp_path, monkeypatch):
    """Create a repository with one file, in which two sentences break a rule."""
    (tmp_path / "room").mkdir()
    (tmp_path / "room" / "a.py").write_text("# what is told of this\n\n# a row beside another row here\n")
    for words in (("init", "-q"), ("add", "-A")):
        subprocess.run(["git", *words], cwd=tmp_path, check=True)
    monkeypatch.setattr(plain_language, "ROOT", tmp_path)
    monkeypatch.setattr(plain_language, "LIMITS", tmp_path / "limits.json")
    return tmp_path


def test_limits_only_go_down(small_repository, capsys):
    limits, source = small_repository / "limits.json", small_repository / "room" / "a.py"
    assert plain_language.main(["--lower"]) == 0
    assert json.loads(limits.read_text()) == {"room": 2}
    source.write_text(source.read_text() + "\n# and this one is beside it now\n")
    assert plain_language.main(["--lower"]) == 1
    assert json.loads(limits.read_text()) == {"room": 2}
    assert "room: above its limit" in capsys.readouterr().err
    source.write_text("# A plain comment about the value here.\n")
    assert plain_language.main(["--lower"]) == 0
    assert json.loads(limits.read_text()) == {"room": 0}
