"""Count sentences that break the language rules of CONTRIBUTING.md, and compare the counts with limits.

python -m tools.plain_language                    counts for each folder; exit code 1 if one exceeds its limit
python -m tools.plain_language --show FILE ...    every sentence that breaks a rule
python -m tools.plain_language --lower            lower the limits to the present counts; they never rise
python -m tools.plain_language --commits A..B     subjects of commits: length, imperative verb, rules

The rules are regular expressions, so they are guides. They match 1 to 2 % of the sentences of other projects.
"""

from __future__ import annotations

import argparse
import ast
import io
import json
import re
import subprocess
import sys
import tokenize
from collections import Counter
from collections.abc import Iterable, Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
# This file contains the allowed number of matching sentences for each folder.
LIMITS = Path(__file__).with_name("plain_language.json")

# Longest subject of a commit. Hosting sites and `git log --oneline` cut longer subjects.
LONGEST_SUBJECT = 72

# Smallest number of words of a sentence. A text with fewer words counts as a label.
FEWEST_WORDS = 5

RULES = {
    "clause as a noun (what ...)": r"(^|[.:;] )What \w+|(?<!about )(?<!of )\b[Ww]hat (is|are|was|has|had|moves|one|can)\b",
    "is no, is none": r"\b(is|are|was|were|has|have|takes|gives) no (?!longer|more\b|less\b|other\b|later)\w+|\b(is|are) none\b"
    r"|\b(takes|gives|moves|pushes|loses) nothing\b",
    "where for if": r"\b[Ww]here (it|there|they|that|this|a|an|the|no|none|one|what|nothing|its|their"
    r"|`?\w+`? (is|are|does|has|gives|was))\b",
    "meaning after the value": r"^(of|times|in place of|beside|by) [a-z]",
    "adverb at the end": r"\b(too|alone|anew|likewise|beside|besides)([,.;:)]|$)",
    "for in place of because": r", for (it|they|that|then|there|its|their|none|no|this|these|each|what|both|such)\b",
    "of one's own": r"\bof (one's|its|their|your) own\b|\bown laws?\b",
    "beside": r"\bbeside\b",
    "by METHOD": r"\bby (methods? |`?(conserving|accurate|scipy|pymunk|radau|dop853|euler|verlet|yoshida4|auto)`?)",
    "at the most": r"\bat the (most|least)\b|\bas far as\b",
    "pronoun without a noun": r"\b([Oo]nes?|[Tt]hose|[Oo]thers?) (that|which|whose)\b"
    r"|\b(by|with|to|from|of|as|than) (that|those) of\b|^(Those|Others) ",
    "data that speaks": r"\b(tells? of|is told|are told|told (of|by)|speaks? of|blame[sd]?)\b",
}
COMPILED = {name: re.compile(rule) for name, rule in RULES.items()}
NOT_IMPERATIVE = re.compile(r"^(A|An|The|What|Where|Of|One|It|They|No|Its|\w+s|\w+ed) ")


def matches(sentence: str) -> list[str]:
    """Return the names of the rules that `sentence` breaks."""
    return [name for name, rule in COMPILED.items() if rule.search(sentence)]


def sentences(text: str) -> list[str]:
    """Split a text into sentences and drop labels."""
    parts = re.split(r"(?<=[.!?;])\s+(?=[A-Z`\"(])", re.sub(r"\s+", " ", text).strip())
    return [part for part in parts if len(re.findall(r"[A-Za-z]+", part)) >= FEWEST_WORDS]


def python_sentences(source: str) -> Iterator[tuple[int, str]]:
    """Yield line and sentence of each docstring and comment."""
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef | ast.Module):
            for paragraph in re.split(r"\n\s*\n", ast.get_docstring(node) or ""):
                if not paragraph.lstrip().startswith(">>>"):
                    yield from ((node.body[0].lineno, sentence) for sentence in sentences(paragraph))
    block: list[str] = []
    begin = last = 0
    for token in tokenize.generate_tokens(io.StringIO(source).readline):
        if token.type != tokenize.COMMENT or token.string.lstrip("# ").startswith(("noqa", "type:", "fmt:", "pragma")):
            continue
        whole_line = token.line.strip().startswith("#")
        if not (whole_line and block and token.start[0] == last + 1):
            yield from ((begin, sentence) for sentence in sentences(" ".join(block)))
            block, begin = [], token.start[0]
        block.append(token.string.lstrip("# "))
        last = token.start[0]
    yield from ((begin, sentence) for sentence in sentences(" ".join(block)))


def script_sentences(source: str) -> Iterator[tuple[int, str]]:
    """Yield line and sentence of each comment of a script."""
    for number, row in enumerate(source.split("\n"), 1):
        comment = re.search(r"(?:^|\s)//\s*(.*)$|^\s*\*\s+(?!@)(.*)$", row)
        if comment:
            yield from ((number, part) for part in sentences((comment[1] or comment[2] or "").strip("*/ ")))


def markdown_sentences(source: str) -> Iterator[tuple[int, str]]:
    """Yield line and sentence of each paragraph and list item outside code, tables and formulas."""
    fenced, paragraph, begin = False, [], 1
    for number, row in enumerate([*source.split("\n"), ""], 1):
        if row.startswith(("```", "$$")):
            fenced = not fenced
        item = re.match(r"^\s*([-*]|\d+\.)\s", row)
        if fenced or not row.strip() or item or row.startswith(("#", "|", "    ", "![", "```", "$$", ":::")):
            yield from ((begin, sentence) for sentence in sentences(" ".join(paragraph)))
            paragraph, begin = [], number
            if not item or fenced:
                continue
        paragraph.append(re.sub(r"^\s*([-*]|\d+\.)\s", "", row).strip())


def table_sentences(source: str) -> Iterator[tuple[int, str]]:
    """Yield line and sentence of comments and texts of a TOML file."""
    for number, row in enumerate(source.split("\n"), 1):
        for text in re.findall(r"#\s*(.*)$|=\s*\"(.*)\"", row):
            yield from ((number, sentence) for sentence in sentences(" ".join(text)))


def catalogue_sentences(source: str) -> Iterator[tuple[int, str]]:
    """Yield the English sentences of a catalogue of messages, without lines."""
    for block in source.split("\n\n"):
        joined = re.sub(r'"\s*\n\s*"', "", block.split("msgstr")[0])
        for text in re.findall(r'msgid(?:_plural)? "(.*)"', joined):
            yield from ((0, sentence) for sentence in sentences(text.replace("\\n", " ")))


READERS = {
    ".py": python_sentences,
    ".js": script_sentences,
    ".mjs": script_sentences,
    ".md": markdown_sentences,
    ".toml": table_sentences,
    ".po": catalogue_sentences,
}


def broken(names: Iterable[str]) -> Iterator[tuple[str, int, str, list[str]]]:
    """Yield file, line, sentence and broken rules of each sentence in the files `names` that breaks one."""
    for name in names:
        path = ROOT / name
        read = READERS.get(path.suffix)
        if read is None or not path.is_file() or (path.suffix == ".po" and "/de/" not in name):
            continue  # The English messages are the same in every catalogue, so one catalogue is sufficient.
        for line, sentence in read(path.read_text(encoding="utf-8")):
            if found := matches(sentence):
                yield name, line, sentence, found


def folder(name: str) -> str:
    """Return the name of the folder whose limit applies to a file."""
    if name.endswith(".po"):
        return "messages"
    return name.split("/", maxsplit=1)[0] if "/" in name else "top level"


def git(*words: str) -> list[str]:
    """Return the output lines of a git command."""
    done = subprocess.run(["git", *words], cwd=ROOT, capture_output=True, text=True, check=True)
    return done.stdout.splitlines()


def subject_faults(subjects: Iterable[str]) -> list[str]:
    """Return a line for each commit subject that is too long, is not imperative, or breaks a rule."""
    faults = []
    for subject in subjects:
        wrong = matches(subject)
        if len(subject) > LONGEST_SUBJECT:
            wrong.append(f"{len(subject)} characters, at most {LONGEST_SUBJECT}")
        if NOT_IMPERATIVE.match(subject):
            wrong.append("does not start with an imperative verb")
        if wrong:
            faults.append(f"{subject}: {', '.join(wrong)}")
    return faults


def main(arguments: list[str] | None = None) -> int:
    """Run the command and return its exit code."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("files", nargs="*")
    parser.add_argument("--show", action="store_true", help="print the sentences")
    parser.add_argument("--lower", action="store_true", help="lower the limits to the present counts")
    parser.add_argument("--commits", metavar="A..B", help="check the subjects of these commits instead")
    options = parser.parse_args(arguments)
    if options.commits:
        faults = subject_faults(git("log", "--no-merges", "--format=%s", options.commits))
        print("\n".join(faults))
        return 1 if faults else 0
    found = list(broken(options.files or git("ls-files")))
    if options.show:
        print("\n".join(f"{name}:{line}: [{', '.join(rules)}] {sentence}" for name, line, sentence, rules in found))
    if options.files:
        return 0
    counts = Counter(folder(name) for name, *_ in found)
    limits = json.loads(LIMITS.read_text(encoding="utf-8")) if LIMITS.exists() else dict(counts)
    if options.lower:
        limits = {name: min(counts[name], limits.get(name, counts[name])) for name in sorted(counts | Counter(limits))}
        LIMITS.write_text(json.dumps(limits, indent=2) + "\n", encoding="utf-8")
    above = [name for name in counts if counts[name] > limits.get(name, 0)]
    for name in sorted(counts):
        print(f"{name:12} {counts[name]:5} sentences break a rule, limit {limits.get(name, 0)}")
    for name in above:
        print(f"{name}: above its limit; see python -m tools.plain_language --show", file=sys.stderr)
    return 1 if above else 0


if __name__ == "__main__":
    sys.exit(main())
