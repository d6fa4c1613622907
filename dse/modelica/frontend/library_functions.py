"""Functions of the Modelica Standard Library whose C code is not part of dse: others, in Modelica, in their places.

The library keeps a table in an external object, which a class declares once and gives to functions:
``parameter ExternalCombiTable1D tableID = ExternalCombiTable1D(…, table, columns, smoothness, extrapolation, …)`` and
``y = getTable1DValue(tableID, i, u)``. Here the declaration is left out, the arguments that matter replace the object's
name, and the functions are others that take them. Tables of files have no points, and are refused.

A generator of random numbers draws each result by a call of its own: the front-end refuses a call with several results
in a when-clause, and states whose size is an argument. The hidden state of the impure generator is that of the one
block that draws from it. A seed by the clock of the machine ends the run. Lines stay where they are.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path

from dse.modelica.frontend.source_text import Change, arguments, code, edited, inside

IMPURE_SEED = 715827883
"""The local seed of the impure generator."""
_TYPES = "Modelica.Blocks.Types."
_KINDS = {
    "ExternalCombiTable1D": "tableName fileName table columns smoothness extrapolation",
    "ExternalCombiTable2D": "tableName fileName table smoothness extrapolation",
    "ExternalCombiTimeTable": "tableName fileName table startTime columns smoothness extrapolation shiftTime",
}
_TAKEN = {
    "ExternalCombiTable1D": "table columns smoothness extrapolation",
    "ExternalCombiTable2D": "table smoothness extrapolation",
    "ExternalCombiTimeTable": "table columns smoothness extrapolation startTime shiftTime",
}
_OBJECT = re.compile(rf"\b(?:final\s+)?parameter\s+(?:\w+\.)*({'|'.join(_KINDS)})\s+(\w+)\s*=\s*(?:\w+\.)*\1\s*(\()")
_CLASS = re.compile(r"\b(?:block|model)\s+(\w+)(?!\s*[=.])")


def with_tables(text: str) -> str:
    """*text* of a file of the library with tables in Modelica."""
    if not any(kind in text for kind in _KINDS):
        return text
    clean = code(text)
    changes: list[Change] = []
    for match in _OBJECT.finditer(clean):
        changes.append((match.start(), clean.index(";", match.end()) + 1, ""))
        given = _given(text, match[1], inside(clean, match.start(3)), match.end())
        call = re.compile(rf"[\w.]+\s*(\()\s*(?={re.escape(match[2])}\b)")
        uses = {use.start(): use for part in _users(clean, match.start()) for use in call.finditer(clean, *part)}
        for use in uses.values():
            # The front-end miscounts parameters whose binding is a call with an array, but not a product.
            after = use.end(1) + len(inside(clean, use.start(1))) + 1
            changes += [(use.start(), use.start(), "(1*"), (after, after, ")")]
            changes.append((use.end(), use.end() + len(match[2]), given))
    for name in functions():
        changes += _replaced(clean, name, r"\binput\s+[\w.]*ExternalCombiT")
    return _edited(text, changes)


def _users(clean: str, place: int) -> Iterator[tuple[int, int]]:
    """Start and end of the block or model around *place*, and of those of the file that extend it."""
    start, end = _around(clean, place)
    yield start, end
    named = _CLASS.match(clean, start)
    if named is not None:
        for match in re.finditer(rf"\bextends\s+(?:\w+\.)*{named[1]}\b", clean):
            yield _around(clean, match.start())


def _around(clean: str, place: int) -> tuple[int, int]:
    """Start and end of the innermost block or model around *place*."""
    for match in reversed([*_CLASS.finditer(clean, 0, place)]):
        end = re.compile(rf"\bend\s+{match[1]}\s*;").search(clean, match.end())
        if end is not None and end.end() > place:
            return match.start(), end.start()
    return 0, len(clean)


def _given(text: str, kind: str, listed: str, start: int) -> str:
    """The arguments of the object's constructor, *listed* from *start* on, that the functions take."""
    found = {"extrapolation": f"{_TYPES}Extrapolation.LastTwoPoints", "shiftTime": "0"}
    for name, (begin, end) in zip(_KINDS[kind].split(), arguments(listed), strict=False):
        named = re.match(r"\s*(\w+)\s*=(?!=)", listed[begin:end])
        value = begin + named.end() if named else begin
        found[named[1] if named else name] = text[start + value : start + end].strip()
    return ", ".join(found[name] for name in _TAKEN[kind].split())


@cache
def functions() -> Mapping[str, str]:
    """The other functions, by name, each with those that it needs and that the library does not have."""
    text = re.sub(r"//.*", "", Path(__file__).with_suffix(".mo").read_text(encoding="utf-8"))
    text = re.sub(r"(?<![.\w])(Extrapolation|Smoothness)\b", rf"{_TYPES}\1", text)
    every = re.finditer(r"(?:pure )?function (\w+)\s.*?\bend \1;", text, re.DOTALL)
    found = {match[1]: " ".join(match[0].split()) for match in every}
    for name, others in _OWN.items():
        found[name] = " ".join((found[name], *map(found.pop, others.split())))
    return found


_OWN = {"getTable2DValueNoDer2": "getTable2DLines", "random": "dse_next dse_draw dse_step", "initialState": "dse_start"}


def _replaced(clean: str, name: str, content: str) -> Iterator[Change]:
    """The functions of that name that contain what the pattern *content* finds: what is meant, and no other."""
    whole = re.compile(rf"(?:\b(?:im)?pure\s+)?\bfunction\s+{name}\b.*?\bend\s+{name}\s*;", re.DOTALL)
    return ((*found.span(), functions()[name]) for found in whole.finditer(clean) if re.search(content, found[0]))


def _edited(text: str, changes: list[Change]) -> str:
    lines = ((start, end, " ".join(new.split()) + "\n" * text.count("\n", start, end)) for start, end, new in changes)
    return edited(text, lines)


# What such a function of the package Random contains.
_GENERATORS = {
    "random": r"\bModelicaRandom_xorshift(?:64star|128plus|1024star)\b",
    "initialState": r"\bglobalSeed\b",
    "automaticGlobalSeed": r"\bModelicaRandom_automaticGlobalSeed\b",
    "initializeImpureRandom": r"\bsetInternalState\b",
}
_BOTH = re.compile(
    r"\(\s*([\w.]+)\s*,\s*([\w.]+)\s*\)(\s*:?=\s*(?:\w+\s*\.\s*)*(?:generator|Xorshift\w+)\s*\.\s*)random\s*"
    r"(\(\s*pre\s*\([^()]*\)\s*\))"
)
_IMPURE = re.compile(r"([\w.]+\s*=\s*)(?:\w+\s*\.\s*)*impureRandom\s*\(([^()]*)\)")


def with_random(text: str) -> str:
    """*text* of a file with random numbers that the runtime knows."""
    if "Random" not in text:
        return text
    clean = code(text)
    changes: list[Change] = []
    for name, content in _GENERATORS.items() if "ModelicaRandom_xorshift" in clean else ():
        changes += _replaced(clean, name, content)
    changes += [
        (*found.span(), f"{found[1]}{found[3]}random{found[4]}; {found[2]}{found[3]}dse_next{found[4]}")
        for found in _BOTH.finditer(clean)
    ]
    for found in re.finditer(r"\b(?:block|model)\s+(\w+)\b(?!\s*=).*?\bend\s+\1\s*;", clean, re.DOTALL):
        changes += _own_state(clean, *found.span())
    return _edited(text, changes)


def _own_state(clean: str, start: int, end: int) -> list[Change]:
    """What a block or model needs to draw from a state of its own, at its only call of the generator."""
    calls = [*_IMPURE.finditer(clean, start, end)]
    if len(calls) != 1 or len(re.findall(r"\bimpureRandom", clean[start:end])) > 1:
        return []
    (call,) = calls
    *_, begins = [None, *re.compile(r"(?<!initial\s)\bequation\b").finditer(clean, start, call.start())]
    words = re.findall(r"(end\s+|\b)when\b", clean[begins.end() : call.start()]) if begins else []
    if begins is None or words.count("") <= len(words) / 2:  # an impure function is called in a when-clause
        return []
    generator, state = "Modelica.Math.Random.Generators.Xorshift1024star", "pre(dse_state)"
    declared = f"protected Integer dse_state[33]; parameter Integer dse_seed = {call[2]}; initial equation"
    first = f"{declared} {state} = {generator}.initialState({IMPURE_SEED}, dse_seed); equation"
    drawn = f"{call[1]}{generator}.random({state}); dse_state = {generator}.dse_next({state})"
    return [(*begins.span(), first), (*call.span(), drawn)]
