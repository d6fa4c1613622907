"""Which variables a model's code writes: of ports that are variables of their own, these are outputs.

Patterns here look a bounded way ahead, or at what no other match has looked at: the time they take grows as the text.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

_COMMENT = re.compile(r"/\*.*?(?:\*/|\Z)|//[^\n]*", re.DOTALL)
_ONCE = re.compile(r"\w_(?:initialize|terminate)\s{0,200}\([^;{()]*\)\s{0,200}\{")
_ELEMENT = r"\s{0,200}\[[^][;{}]*(?:\[[^][;{}]*\][^][;{}]*)*\]"
_PLACE = rf"([A-Za-z_]\w*+)(?:{_ELEMENT})*+(?:\.\w++)*+"
_ASSIGNED = re.compile(rf"(?<![\w.>])(?={_PLACE}\s{{0,200}}(?:[-+*/|&^%]?=(?!=)|<<=|>>=|\+\+|--))")
_STEPPED = re.compile(rf"(?:\+\+|--)(?={_PLACE})")
_COPIED = re.compile(r"mem(?:cpy|set)\s{0,200}\(([\w\s*)&(]{0,400})")


def written(code: str) -> frozenset[str]:
    """What anything is assigned to, to a member or element of it, or copied there.

    Functions that run once and only set them to zero at first do not count.
    """
    text = "".join(_without_once(_COMMENT.sub("", code)))
    names = {found[1] for pattern in (_ASSIGNED, _STEPPED) for found in pattern.finditer(text)}
    return frozenset(names.union(name for found in _COPIED.finditer(text) for name in re.findall(r"\w+", found[1])))


def _without_once(text: str) -> Iterator[str]:
    """*text* without the bodies of functions that run once."""
    at = 0
    for found in _ONCE.finditer(text):
        if found.start() < at:
            continue
        end = text.find("\n}", found.end())
        if end < 0:
            break
        yield text[at : found.end()]
        at = end
    yield text[at:]
