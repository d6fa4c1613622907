"""Names that nothing else has yet."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterable
from itertools import count

from dse.expression import KEYWORDS

_TAKEN = frozenset({"absent", "present", "bonds"})


def numbered(name: str, is_taken: Callable[[str], bool]) -> str:
    """*name*, with the first number behind it (``name_2``) that makes it free, if it is taken."""
    if not is_taken(name):
        return name
    return next(free for number in count(2) if not is_taken(free := f"{name}_{number}"))


def free_word(text: str, taken: Collection[str]) -> str:
    """*text* as a word that stands in paths and expressions, with a number if it is taken."""
    plain = re.sub(r"[^A-Za-z0-9_]+", "_", text) or "x"
    if plain[0].isdigit():
        plain = f"x{plain}"
    if plain in KEYWORDS or plain in _TAKEN:
        plain += "_"
    return numbered(plain, taken.__contains__)


def each_named(names: Iterable[str], name: Callable[[str, Collection[str]], str]) -> dict[str, str]:
    """What *name* makes of each of *names* and of what it has made of those before, in alphabetical order."""
    found: dict[str, str] = {}
    for one in sorted(names):
        found[one] = name(one, set(found.values()))
    return found
