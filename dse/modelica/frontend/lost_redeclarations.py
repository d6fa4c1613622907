"""Redeclarations that the front-end drops without a word: found in the sources that a model uses, and refused.

rumoca 0.10.2 applies a redeclaration in the modifications of a component (`Car a(redeclare Fast engine)`). It drops one

- two modifications deep: `Car a(chassis(redeclare Soft spring))`, of a class, too;
- of a component that the class in `extends` or behind `=` inherits: `extends Car(redeclare Fast engine)`, where `Car`
  has `engine` from a class that it extends itself, or is only another name of one.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

from dse.errors import Problem
from dse.modelica.frontend.source_text import CLASS_KINDS, PREFIXES, inside, place
from dse.modelica.frontend.used_classes import Used

_REDECLARE = re.compile(r"\bredeclare\b")
_COMPONENT = re.compile(rf"redeclare\s+{PREFIXES}(?!(?:{CLASS_KINDS})\b)[\w.]+(?:\s*\[[^\]]*\])?\s+(?P<name>\w+)")
_OF_CLASS = re.compile(r"(?:\bextends\s+|\b(?P<short>\w+)\s*=\s*)(?:\w+\s*\.\s*)*(?P<base>\w+)\s*$")
_NO_TYPE = re.compile(r"\b(?:and|or|not|then|else|in|end|extends|return|when|while|if)$")


def lost_redeclarations(read: Used) -> Iterator[Problem]:
    """Each redeclaration in the classes that are used which rumoca drops."""
    declared: dict[str, str] = {}
    for source in read.texts:
        for match in _REDECLARE.finditer(source.text):
            opened = _opened(source.text, match.start())
            named = _COMPONENT.match(source.text, match.start())
            what = f"the redeclaration of '{named['name']}'" if named else "the redeclaration of a class"
            where = place(source, match.start())
            if len(opened) > 1:
                yield Problem(
                    f"{what} inside another modification, which the front-end does not see, is not supported",
                    where,
                    "declare a class that has the redeclaration, and use that class",
                )
            elif opened and named and (extended := _extended(read, source.text, opened[0])):
                if extended not in declared:
                    declared[extended] = _own_text(read, extended)
                if not _declares(declared[extended], named["name"]):
                    yield Problem(
                        f"{what}, which '{extended}' inherits, and which the front-end does not see, is not supported",
                        where,
                        "redeclare it in `extends` of the class that declares it, or in the declaration of a component",
                    )


def _extended(read: Used, text: str, bracket: int) -> str:
    """The class that is modified at a *bracket* to be extended, or to have another name that is used; else ""."""
    found = _OF_CLASS.search(text, text.rfind(";", 0, bracket) + 1, bracket)
    if found is None:
        return ""
    if found["short"]:
        named = re.compile(rf"\b{re.escape(found['short'])}\b")
        if sum(len(named.findall(source.text)) for source in read.texts) == 1:
            return ""
    return found["base"]


def _opened(text: str, at: int) -> list[int]:
    """The brackets of the statement that are open at a place, from the outermost on."""
    found: list[int] = []
    closed = 0
    for number in range(at - 1, -1, -1):
        letter = text[number]
        if letter == ";":
            break
        if letter in ")}]":
            closed += 1
        elif letter in "({[":
            if closed:
                closed -= 1
            else:
                found.append(number)
    return found[::-1]


def _own_text(read: Used, name: str) -> str:
    """What classes called *name* declare themselves, without all that is in brackets."""
    found = []
    for source in read.texts:
        for match in re.finditer(rf"\b(?:{CLASS_KINDS})\s+{re.escape(name)}\b(?!\s*=)", source.text):
            end = re.compile(rf"\bend\s+{re.escape(name)}\s*;").search(source.text, match.end())
            found.append(_without_brackets(source.text[match.end() : end.start() if end else len(source.text)]))
    return "\n".join(found)


def _without_brackets(text: str) -> str:
    pieces, at = [], 0
    while (start := text.find("(", at)) >= 0:
        pieces.append(text[at : start + 1])
        at = start + 1 + len(inside(text, start))
    return "".join([*pieces, text[at:]])


def _declares(text: str, name: str) -> bool:
    declaration = re.compile(
        rf"(?:[\w\]]\s+|,\s*){re.escape(name)}\b\s*(?=[;,(\[=]|\b(?:constrainedby|if|annotation)\b)"
    )
    return any(not _NO_TYPE.search(text[: match.start() + 1].rstrip()[-12:]) for match in declaration.finditer(text))
