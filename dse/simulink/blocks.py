"""What the text of a model's code tells of its blocks: their names in comments, and which ports it writes."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping

_SYSTEM = re.compile(r"'(<(?:Root|S\d+)>)'\s*:\s*'([^'\n]+)'")
_PORT = re.compile(r"'<Root>/[^']+'")
_TOLD = re.compile(rf"(Inport|Outport): ({_PORT.pattern})")
_BLOCK = re.compile(r"'(<(?:Root|S\d+)>)/([^'\n]+)'")


def systems(header: str) -> dict[str, str]:
    """The paths of the model's systems by their marks (``<S1>``), from the text of its header."""
    return dict(_SYSTEM.findall(header))


def block_of(comment: str, known: Mapping[str, str]) -> str:
    """The first block a comment names, with its path where its system is *known*; "" if it names none."""
    found = _BLOCK.search(comment)
    if found is None:
        return ""
    system = known.get(found[1], "" if found[1] == "<Root>" else found[1])
    return f"{system}/{found[2]}".removeprefix("/")


class Writing:
    """Which variables a model's *code* writes, but for functions that only set them to zero at first."""

    def __init__(self, code: str) -> None:
        self._told = set(_TOLD.findall(code))
        self._written = written(code)

    def of(self, name: str, comment: str) -> bool:
        """Whether *name*, which has that *comment*, is written.

        The code's comments may say where the model's port is; else that anything is assigned to it, to one of its
        members or elements, or copied there.
        """
        port = _PORT.search(comment)
        says = [(kind, port[0]) in self._told for kind in ("Inport", "Outport")] if port else [False, False]
        if any(says) and not all(says):
            return says[1]
        return name in self._written


# Which variables a model's code writes: of ports that are variables of their own, these are outputs.
#
# Patterns here look a bounded way ahead, or at what no other match has looked at: the time they take grows as the text.


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
