"""Messages about common syntax errors of TOML files. A message contains the line of the error and its correction.

The text is repaired to find further errors. A repair is used only if the parser then gets further. A hint therefore
never contradicts the parser.

Tests: tests/scenes/test_file_mistakes.py
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Callable, Iterator
from itertools import islice
from typing import Any, NamedTuple

from softcradle.physics.messages import Message

# Largest number of syntax errors reported for one file. A file with more errors is probably not a scene file.
MOST_ERRORS = 20
# Largest number of characters of a line that a message shows.
MOST_SHOWN = 60
# Number of lines above an error that are searched for an open bracket.
MOST_LINES_UP = 50

POSITION = re.compile(r" \(at (?:line (\d+), column (\d+)|end of document)\)$")
STRING = re.compile(r'"(?:\\.|[^"\\])*"|\'[^\']*\'|#.*')
TYPOGRAPHIC = dict.fromkeys("“”„‟«»", '"') | dict.fromkeys("\u2018\u2019\u201a\u201b", "'")
NUMBER = r"[-+]?\d[\d_]*(?:\.\d+)?(?:[eE][-+]?\d+)?"
# Lookahead pattern for the end of a value: a comma, a closing bracket, a comment or the end of the line.
END = r"(?=\s*(?:[,}\]#]|$))"
BRACKETS = {"[": "]", "{": "}"}


class Repair(NamedTuple):
    """Repaired line, and a hint about the error in it."""

    line: str
    hint: Message


def read_toml(text: str) -> tuple[dict[str, Any] | None, list[str]]:
    """Return the table in `text`, and a sentence for each syntax error.

    The table is read from the repaired text. The result is None if an error could not be repaired.
    """
    problems: list[str] = []
    while len(problems) < MOST_ERRORS:
        error = _syntax_error(text)
        if isinstance(error, dict):
            return error, problems
        lines = text.split("\n")
        twice = re.fullmatch(r"Cannot declare \('(\w+)',\) twice", error.words)
        if twice:
            hint = Message("double_brackets", "write [[{table}]] in double brackets, once for each", table=twice[1])
            problems.append(_sentence(hint, lines, error.line))
            double = re.sub(rf"(?m)^\s*\[\s*{twice[1]}\s*\]", f"[[{twice[1]}]]", text)
            if double == text:
                break
            text = double
            continue
        repaired = next(_working_repairs(lines, error), None)
        if repaired is None:
            problems.append(_sentence(error.plain_hint(), lines, error.line, error.column))
            break
        at, repair = repaired
        problems.append(_sentence(repair.hint, lines, at))
        lines[at] = repair.line
        text = "\n".join(lines)
    return None, problems


class SyntaxProblem(NamedTuple):
    """First error that the parser finds: its message, and its line and column, both counted from 0."""

    words: str
    line: int
    column: int

    def plain_hint(self) -> str:
        """Return a hint about the error. For an unknown error, return the English message of the parser."""
        if self.words.startswith("Unclosed"):
            bracket = "}" if "inline table" in self.words else "]"
            return Message("open_bracket", "a closing {bracket} is missing in this line or above it", bracket=bracket)
        if self.words == "Cannot overwrite a value":
            return Message("key_twice", "a key is given twice in the same table")
        return self.words[:1].lower() + self.words[1:]


def _syntax_error(text: str) -> dict[str, Any] | SyntaxProblem:
    """Return the table in `text`, or the first syntax error if there is one."""
    try:
        return tomllib.loads(text)
    except RecursionError:
        return SyntaxProblem("too many nested brackets", 0, 0)
    except ValueError as error:
        words = str(error)
    lines = text.split("\n")
    found = POSITION.search(words)
    if found is None:
        return SyntaxProblem(words, 0, 0)
    if found[1] is None:
        return SyntaxProblem(words[: found.start()], len(lines) - 1, len(lines[-1]))
    return SyntaxProblem(words[: found.start()], int(found[1]) - 1, int(found[2]) - 1)


def _sentence(hint: str, lines: list[str], line: int, column: int | None = None) -> str:
    """Return the hint together with the number and the text of its line."""
    shown = lines[line].strip()
    shown = shown if len(shown) <= MOST_SHOWN else shown[: MOST_SHOWN - 3] + "..."
    text = f": {shown}" if shown else ""
    if column is None:
        return Message("toml", "not valid TOML: {hint} (line {line}{text})", hint=hint, line=line + 1, text=text)
    return Message(
        "toml_column",
        "not valid TOML: {hint} (line {line}, column {column}{text})",
        hint=hint,
        line=line + 1,
        column=column + 1,
        text=text,
    )


def _working_repairs(lines: list[str], error: SyntaxProblem) -> Iterator[tuple[int, Repair]]:
    """Yield the repairs with which the parser gets further, each with the number of its line."""
    for at, repair in _possible_repairs(lines, error):
        changed = [*lines[:at], repair.line, *lines[at + 1 :]]
        left = _syntax_error("\n".join(changed))
        longer = len(repair.line) - len(lines[at]) if at == error.line else 0
        if isinstance(left, dict) or (left.line, left.column) > (error.line, error.column + longer):
            yield at, repair


def _possible_repairs(lines: list[str], error: SyntaxProblem) -> Iterator[tuple[int, Repair]]:
    """Yield possible repairs of the line with the error.

    Then yield possible repairs of a line above it that contains an open bracket.
    """
    for repairs in REPAIRS:
        for repair in repairs(lines[error.line]):
            if repair.line != lines[error.line]:
                yield error.line, repair
    above = range(error.line, max(-1, error.line - MOST_LINES_UP), -1)
    for at in islice((at for at in above if _open_brackets(lines[at])), 1):
        closing = "".join(BRACKETS[bracket] for bracket in reversed(_open_brackets(lines[at])))
        hint = Message("missing_bracket", "a closing {bracket} is missing", bracket=closing)
        yield at, Repair(_before_comment(lines[at], closing), hint)
    if error.words == "Cannot overwrite a value":
        twice = Message("this_key_twice", "this key is given twice in the same table")
        yield error.line, Repair("#" + lines[error.line], twice)


def _masked(line: str) -> str:
    """Return the line with placeholders for all characters of quoted text and comments. The length of the line does not
    change.
    """
    return STRING.sub(lambda found: found[0][0] + "_" * (len(found[0]) - 2) + found[0][-1], line)


def _edited(line: str, pattern: str, change: Callable[[re.Match[str]], str]) -> tuple[str, re.Match[str] | None]:
    """Replace each match of `pattern` outside of quotes. Return the new line and the first match."""
    found = list(re.finditer(pattern, _masked(line)))
    for match in reversed(found):
        line = line[: match.start()] + change(match) + line[match.end() :]
    return line, found[0] if found else None


def _before_comment(line: str, end: str) -> str:
    """Return the line with the text `end` inserted after its last value, before any comment."""
    comment = re.search(r"\s*(?:#.*)?$", _masked(line))
    at = len(line) if comment is None else comment.start()
    return line[:at] + end + line[at:]


def _open_brackets(line: str) -> list[str]:
    """Return the brackets that the line opens but does not close."""
    left: list[str] = []
    for sign in re.sub("#.*", "", _masked(line)):
        if sign in BRACKETS:
            left.append(sign)
        elif left and sign == BRACKETS[left[-1]]:
            left.pop()
    return left


def _typographic_quotes(line: str) -> Iterator[Repair]:
    changed, found = _edited(line, "[" + "".join(TYPOGRAPHIC) + "]", lambda match: TYPOGRAPHIC[match[0]])
    if found:
        yield Repair(changed, Message("straight_quotes", 'use straight quotes " instead of typographic ones'))


def _colon(line: str) -> Iterator[Repair]:
    changed, found = _edited(line, r"^(\s*[\w-]+)\s*:\s*", lambda match: f"{match[1]} = ")
    if found:
        yield Repair(changed, Message("equals_sign", "write key = value, with an equals sign"))


def _capital_bool(line: str) -> Iterator[Repair]:
    changed, found = _edited(line, rf"(=\s*)(True|False){END}", lambda match: match[1] + match[2].lower())
    if found:
        yield Repair(changed, Message("small_letters", "write {value} in small letters", value=found[2].lower()))


def _decimal_comma(line: str) -> Iterator[Repair]:
    changed, found = _edited(
        line, rf"(=\s*[-+]?\d+),(\d+(?:[eE][-+]?\d+)?)\b{END}", lambda match: f"{match[1]}.{match[2]}"
    )
    if found:
        number = f"{found[1].lstrip('= ')}.{found[2]}"
        yield Repair(changed, Message("decimal_point", "write {number}, with a decimal point", number=number))


def _fraction(line: str) -> Iterator[Repair]:
    changed, found = _edited(line, rf"([=,\[]\s*)(\d+\s*/\s*\d+){END}", lambda match: f'{match[1]}"{match[2]}"')
    if found:
        yield Repair(changed, Message("quoted_fraction", 'put a fraction in quotes: "{fraction}"', fraction=found[2]))


def _unit(line: str) -> Iterator[Repair]:
    pattern = rf"([=,\[]\s*{NUMBER})\s*([^\W\d_]|%)[\w/*^.²³⁻¹·%-]*(?:\s[\w/*^²³⁻¹·]+)*{END}"
    changed, found = _edited(line, pattern, lambda match: match[1])
    if found:
        number = found[1].lstrip("=,[ ")
        unit = found[0][len(found[1]) :].strip()
        hint = Message(
            "no_unit",
            "write the number without the unit {unit!r} (all numbers are in kg, m, s, N): {number}",
            unit=unit,
            number=number,
        )
        yield Repair(changed, hint)


def _missing_comma(line: str) -> Iterator[Repair]:
    pattern = r"""(?<=[\d\w"'\]}])\s+(?=[-+]?[\w"'\[{])"""
    changed, found = _edited(line, pattern, lambda match: ", ")
    if found and re.search(r"[\[{]", _masked(line)):
        yield Repair(changed, Message("comma", "put a comma between two values"))


def _in_quotes(text: str) -> Message:
    """Return a hint that `text` must be put in quotes."""
    return Message("quoted_text", 'put text in quotes: "{text}"', text=text)


def _text_without_quotes(line: str) -> Iterator[Repair]:
    whole = re.fullmatch(r"(\s*[\w.-]+\s*=\s*)([^\s\"'\[{#][^\"#]*?)(\s*(?:#.*)?)", line)
    if whole:
        yield Repair(f'{whole[1]}"{whole[2]}"{whole[3]}', _in_quotes(whole[2]))
    pattern = rf"([=,\[]\s*)([^\W\d][^\"',=\[\]{{}}#]*?){END}"
    changed, found = _edited(line, pattern, lambda match: f'{match[1]}"{match[2]}"')
    if found:
        yield Repair(changed, _in_quotes(found[2]))


def _missing_quote(line: str) -> Iterator[Repair]:
    hint = Message("missing_quote", "a quote is missing")
    rest = re.sub(r'"(?:\\.|[^"\\])*"', lambda found: "_" * len(found[0]), line)
    at = rest.rfind('"')
    if at < 0:
        return
    for end in re.finditer(r"\s*(?=[,}\]#]|$)", line[at:]):  # The closing quote is missing.
        yield Repair(line[: at + end.start()] + '"' + line[at + end.start() :], hint)
    start = re.search(r"[=,\[]\s*(?=[^=,\[\"]*$)", line[:at])
    if start:  # The opening quote is missing.
        yield Repair(line[: start.end()] + '"' + line[start.end() :], hint)


# The order matters. A repair of a special mistake must come before a general repair that would also change the line.
REPAIRS = (
    _typographic_quotes,
    _colon,
    _capital_bool,
    _decimal_comma,
    _fraction,
    _unit,
    _missing_comma,
    _missing_quote,
    _text_without_quotes,
)
