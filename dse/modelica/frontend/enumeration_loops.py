"""Loops and comprehensions over an enumeration, ``for e in Kind loop``, counted by numbers: ``for e in 1:3 loop``.

The front-end takes no type as a range. As an index, a value of an enumeration and its number are the same; the
front-end refuses a number where the enumeration itself is needed.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from functools import partial

from dse.modelica.frontend.source_text import arguments, changed, code, edited

_ENUMERATION = re.compile(r"\btype\s+(\w+)\s*=\s*enumeration\s*\(((?:[^()]|\([^()]*\))*)\)")
_RANGE = re.compile(r"\bin\s+((?:\w+\s*\.\s*)*(\w+))(?=\s*(?:\bloop\b|[,})]))")


def counted(contents: Mapping[str, bytes], others: Mapping[str, bytes]) -> dict[str, bytes]:
    """The files *contents* with such loops counted. The enumerations may be declared in *others* too.

    One that shares its name with an enumeration of another size, or with a variable, is left alone.
    """
    everything = [code(text.decode("utf-8", "replace")) for text in (*others.values(), *contents.values())]
    wanted = {match[2] for text in everything for match in _RANGE.finditer(text)}
    if not wanted:
        return dict(contents)
    sizes: dict[str, set[int]] = {}
    for text in everything:
        for match in _ENUMERATION.finditer(text):
            sizes.setdefault(match[1], set()).add(len(arguments(match[2])))
    variables = re.compile(
        rf"[\w\]]\s+({'|'.join(map(re.escape, sorted(wanted)))})\s*(?:[;\[(,]|=(?!\s*enumeration\b))"
    )
    taken = {match[1] for text in everything for match in variables.finditer(text)}
    counts = {name: sizes[name].pop() for name in wanted - taken if len(sizes.get(name, ())) == 1}
    return changed(contents, partial(_counted, counts))


def _counted(counts: Mapping[str, int], text: str) -> str:
    ranges = [match for match in _RANGE.finditer(code(text)) if match[2] in counts]
    return edited(text, [(*match.span(1), f"1:{counts[match[2]]}") for match in ranges])
