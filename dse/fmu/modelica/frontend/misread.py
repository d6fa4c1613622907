"""What the front-end is known to flatten wrongly without a word: found in the sources, and refused."""

from __future__ import annotations

import re
from collections.abc import Iterator

from dse.errors import Problem
from dse.fmu.modelica.frontend.result import FrontEndResult
from dse.fmu.modelica.frontend.sources import SourceText
from dse.fmu.modelica.frontend.text import code, found

_PREFIXES = r"(?:(?:each|final|replaceable|encapsulated|partial|pure|impure)\s+)*"
_KINDS = "class|model|block|record|connector|type|package|function"


def misread(result: FrontEndResult) -> Iterator[Problem]:
    """Each construct of the model's sources that rumoca 0.10.2 takes for something else."""
    yield from _redeclared_with_changes(result)
    yield from _functions_of_one_name(result)
    yield from _changed_constants(result)


_REDECLARED = re.compile(rf"\bredeclare\s+{_PREFIXES}(?:{_KINDS})\s+(\w+)\s*=\s*[\w.]+\s*(?:\[[^\]]*\])?\s*\(")


def _redeclared_with_changes(result: FrontEndResult) -> Iterator[Problem]:
    """The modifications of a redeclared class are dropped."""
    for _, match, where in found(result.sources.values(), _REDECLARED):
        what = f"the redeclaration of class '{match[1]}' modifies what it takes, which the front-end does not see"
        yield Problem(what, where, "declare a class that extends it with these modifications, and redeclare to that")


def _functions_of_one_name(result: FrontEndResult) -> Iterator[Problem]:
    """Functions are kept under the name they are called by, so that two of one name become one."""
    texts = list(result.sources.values())
    tops = {name for source in texts for name in _top(source)}
    for function in result.dae["storage"]["functions"]:
        name = str(function["name"])
        if "." in name and name.split(".", maxsplit=1)[0] in tops:
            continue
        last = name.rsplit(".", maxsplit=1)[-1]
        declared = re.compile(
            rf"\b(?:function|record)\s+(?:extends\s+)?({re.escape(last)})\b(?<!end {re.escape(last)})"
        )
        aliased = re.compile(rf"\bimport\s+({re.escape(last)})\s*=")
        places = [where for pattern in (declared, aliased) for _, _, where in found(texts, pattern)]
        if len(places) > 1:
            what = f"the function '{name}' may be one of {len(places)}, which the front-end cannot tell apart"
            yield Problem(what, places[0], f"call it by its full name; another is declared at {places[1]}")


def _top(source: SourceText) -> Iterator[str]:
    text = code(source.text)
    within = re.search(r"\bwithin\b\s*([\w.]*)\s*;", text)
    if within is not None and within[1]:
        yield within[1].split(".", maxsplit=1)[0]
        return
    first = re.search(rf"\b(?:{_KINDS})\s+(\w+)", text)
    if first is not None:
        yield first[1]


def _changed_constants(result: FrontEndResult) -> Iterator[Problem]:
    """A constant that one class changes has the same value in all functions that read it."""
    texts = list(result.sources.values())
    called = {str(function["name"]).rsplit(".", maxsplit=1)[-1] for function in result.dae["storage"]["functions"]}
    if not called:
        return
    words = {word for text in texts for body in _bodies(text, called) for word in re.findall(r"\w+", body)}
    declared = re.compile(r"\bconstant\s+[\w.]+\s*(?:\[[^\]]*\])?\s*(\w+)")
    for name in sorted({match[1] for _, match, _ in found(texts, declared)} & words):
        changed = re.compile(rf"[(,]\s*(?:(?:each|final)\s+)*({re.escape(name)})\s*=(?!=)")
        for _, _, where in found(texts, changed):
            what = f"constant '{name}' is changed here and read by a function, where the front-end mixes up its values"
            yield Problem(what, where, "make it an input of the function")


def _bodies(source: SourceText, names: set[str]) -> Iterator[str]:
    text = code(source.text)
    for match in re.finditer(r"\bfunction\s+(?:extends\s+)?(\w+)", text):
        if match[1] in names:
            end = re.compile(rf"\bend\s+{re.escape(match[1])}\s*;").search(text, match.end())
            yield text[match.end() : end.start() if end else match.end()]
