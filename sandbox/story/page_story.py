"""Limits and words of the description of a motion, written as constants for the scripts of pages.

The document of a page contains the script with these constants. A page therefore always has the limits and words of the
version that wrote it.
"""

from __future__ import annotations

import json
from functools import lru_cache
from typing import Any

from softcradle.sandbox.languages import gettext, in_every_language, pgettext
from softcradle.sandbox.story import ending, live_rules, outcome, sentences
from softcradle.sandbox.story.bodies import BODIES
from softcradle.sandbox.story.page_words import WORDS, WORDS_IN_CONTEXT

BOUNDS = {
    "together": outcome.TOGETHER,
    "resolution": outcome.RESOLUTION,
    "slow": outcome.SLOW,
    "momentum": outcome.STILL_MOMENTUM,
    "energy": outcome.STILL_ENERGY,
    "stands": outcome.AT_REST,
    "equal": outcome.EQUAL,
    "atRest": ending.AT_REST,
    "groups": sentences.MOST_GROUPS,
    "digits": sentences.SPEED_DIGITS,
    "frameRate": live_rules.FRAME_RATE,
    "stepCost": live_rules.CONSERVING_COST,
    "frameCost": live_rules.FRAME_COST,
    "contactSteps": live_rules.CONTACT_STEPS,
    "handFrequency": live_rules.HAND_FREQUENCY,
    "handSpeed": live_rules.HAND_SPEED,
}


@lru_cache
def story_script() -> str:
    """Return the script that defines STORY (bounds by name) and WORDS (texts by language and key)."""
    words = in_every_language(page_words)
    # Each key is written once for all languages, because keys take as many bytes as short words.
    keys = list(next(iter(words.values())))
    texts = {code: [found[key] for key in keys] for code, found in words.items()}
    return (
        f"const STORY = {_script(BOUNDS)};\n"
        f"const WORDS = Object.fromEntries(Object.entries({_script(texts)}).map(([code, texts]) =>\n"
        f"  [code, Object.fromEntries({_script(keys)}.map((key, k) => [key, texts[k]]))]));\n"
    )


def page_words() -> dict[str, str]:
    """Return the words of a page in the current language, by key."""
    found = {key: gettext(text) for key, text in (WORDS | sentences.SENTENCES).items()}
    for context, words in WORDS_IN_CONTEXT.items():
        found |= {key: pgettext(context, text) for key, text in words.items()}
    for kind, body in BODIES.items():
        found |= {f"{kind} {name}": text for name, text in body.words().items()}
    return found | {"more group": sentences.more_groups(1, n="{n}"), "more groups": sentences.more_groups(2, n="{n}")}


def _script(value: Any) -> str:
    """Return a constant as JSON. Characters that could end a script element are escaped."""
    return json.dumps(value, separators=(",", ":"), ensure_ascii=False).replace("<", "\\u003c")
