"""What the front-end is known to flatten wrongly without a word: found in the sources the model uses, and refused."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence

from dse.errors import Location, Problem
from dse.modelica.frontend.lost_redeclarations import lost_redeclarations
from dse.modelica.frontend.modifications import NO_TYPES, misread_modifications
from dse.modelica.frontend.result import FrontEndResult
from dse.modelica.frontend.source_text import (
    CLASS_KINDS,
    PREFIXES,
    SourceText,
    arguments,
    inside,
    occurring,
    place,
)
from dse.modelica.frontend.used_classes import Used, used


def misread(result: FrontEndResult) -> Iterator[Problem]:
    """Each construct of the classes the model uses that rumoca 0.10.2 takes for something else."""
    read = used(result.sources.values(), result.model)
    names = [str(function["name"]) for function in result.dae["storage"]["functions"]]
    yield from misread_modifications(read)
    yield from lost_redeclarations(read)
    yield from _functions_of_one_name(read, names)
    yield from mixed_up_constants(read, result.model, [name.rpartition(".")[2] for name in names])
    yield from _outer_classes(read)


def _functions_of_one_name(read: Used, names: list[str]) -> Iterator[Problem]:
    """Functions are kept under the name they are called by, so that two of one name become one."""
    tops = {name for source in read.texts for name in _top(source)}
    for name in names:
        if "." in name and name.split(".", maxsplit=1)[0] in tops:
            continue
        last = name.rsplit(".", maxsplit=1)[-1]
        declared = re.compile(
            rf"\b(?:function|record)\s+(?:extends\s+)?({re.escape(last)})\b(?<!end {re.escape(last)})"
        )
        aliased = re.compile(rf"\bimport\s+({re.escape(last)})\s*=")
        places = [where for pattern in (declared, aliased) for _, _, where in occurring(read.texts, pattern)]
        if len(places) > 1:
            what = f"the function '{name}' may be one of {len(places)}, which the front-end cannot distinguish"
            yield Problem(what, places[0], f"call it by its full name; another is declared at {places[1]}")


def _top(source: SourceText) -> Iterator[str]:
    within = re.search(r"\bwithin\b\s*([\w.]*)\s*;", source.text)
    if within is not None and within[1]:
        yield within[1].split(".", maxsplit=1)[0]
        return
    first = re.search(rf"\b(?:{CLASS_KINDS})\s+(\w+)", source.text)
    if first is not None:
        yield first[1]


_OUTER = re.compile(rf"\bouter\s+{PREFIXES}({CLASS_KINDS})\b")


def _outer_classes(read: Used) -> Iterator[Problem]:
    """The class that is inner is not looked for."""
    for _, match, where in occurring(read.texts, _OUTER):
        what = f"an outer {match[1]}, for which the front-end does not take the inner one, is not supported"
        yield Problem(what, where, "make the class replaceable, and redeclare it")


# Constants of packages that the front-end mixes up: found in the text of what a model uses, and refused.


_LIST = re.compile(r"\bconstant\s+([\w.]+)\s*(?:\[[^\]]*\])?\s*([^;]*);")
_DECLARED = re.compile(r"\s*(\w+)")


def mixed_up_constants(used: Used, model: str, called: Iterable[str]) -> Iterator[Problem]:
    """Each change of a constant that rumoca 0.10.2 takes for a change of another, or for none.

    *called*: the last words of the names of all functions the model calls.
    """
    seen: set[Location] = set()
    rules = (_read_by_functions(used, set(called)), _of_the_base(used, model), _redeclared(used), _records(used))
    for problem in (problem for rule in rules for problem in rule):
        if problem.where is not None and problem.where not in seen:
            seen.add(problem.where)
            yield problem


def constants(texts: Iterable[SourceText]) -> set[str]:
    """The names of all constants declared in *texts*."""
    return {name for _, match, _ in occurring(texts, _LIST) for name, _ in _listed(match)}


def _listed(match: re.Match[str]) -> Iterator[tuple[str, int]]:
    """Name and place of each constant of one declaration."""
    for start, end in arguments(match[2]):
        declared = _DECLARED.match(match[2], start, end)
        if declared is not None:
            yield declared[1], match.start(2) + declared.start(1)


def _read_by_functions(used: Used, called: set[str]) -> Iterator[Problem]:
    """A constant that one class changes has the same value in all functions that read it."""
    words: set[str] = set()
    for body in (body for text in used.texts for body in _bodies(text, called)):
        words |= set(re.findall(r"\w+", body)) - set(_LOCAL.findall(body))
    for name in sorted(constants(used.texts) & words):
        changed = re.compile(rf"[(,]\s*(?:(?:each|final)\s+)*({re.escape(name)})\s*=(?!=)")
        for _, _, where in occurring(used.texts, changed):
            what = f"constant '{name}' is changed here and read by a function, where the front-end mixes up its values"
            yield Problem(what, where, "make it an input of the function")


_LOCAL = re.compile(
    rf"(?<![\w.])(?<!constant )(?!(?:{NO_TYPES}|constant)\b)[A-Za-z_][\w.]*+(?:\s*+\[[^\]]*\])?+\s+"
    r"(\w+)\s*(?:\[[^\]]*\])?\s*(?:[;(]|=(?!=))"
)


def _bodies(source: SourceText, names: set[str]) -> Iterator[str]:
    for match in re.finditer(r"\bfunction\s+(?:extends\s+)?(\w+)", source.text):
        if match[1] in names:
            end = re.compile(rf"\bend\s+{re.escape(match[1])}\s*;").search(source.text, match.end())
            yield source.text[match.end() : end.start() if end else match.end()]


_CHANGED = re.compile(r"(?:\bextends\s+|=\s*)(?:[\w]+\s*\.\s*)*(\w+)\s*\(")


def _of_the_base(used: Used, model: str) -> Iterator[Problem]:
    """A constant changed in a package made from another changes in that one too, once both are read."""
    names = constants(used.texts)
    packages = {match[1] for _, match, _ in occurring(used.texts, re.compile(r"\b(?:package|class)\s+(\w+)"))}
    for source, match, _ in occurring(used.texts, _CHANGED):
        base = match[1]
        if base not in packages or (base not in model.split(".") and not _is_read(used.texts, base)):
            continue
        text = inside(source.text, match.end() - 1)
        for start, end in arguments(text):
            changed = re.compile(r"\s*(?:(?:each|final)\s+)*(\w+)").match(text, start, end)
            if changed is not None and changed[1] in names:
                what = f"constant '{changed[1]}' of package '{base}' is changed here, and '{base}' is used too, where"
                what += " the front-end mixes up its values"
                yield Problem(
                    what, place(source, match.end() + changed.start(1)), "write two packages that share no base"
                )


def _is_read(texts: Sequence[SourceText], base: str) -> bool:
    """Whether *base* is named but to be declared, extended, constrain, or become another package with changes."""
    name = re.escape(base)
    path = rf"(?:\w+\s*\.\s*)*{name}\b"
    other = rf"\b(?:package|class|end|extends|constrainedby)\s+{path}(?!\s*\.)|=\s*{path}\s*\("
    named = re.compile(rf"(?P<other>{other})|\b{name}\b")
    return any(match["other"] is None for _, match, _ in occurring(texts, named))


_REDECLARED = re.compile(r"\b(redeclare)\s+(?:(?:each|final|replaceable)\s+)*constant\b")


def _redeclared(used: Used) -> Iterator[Problem]:
    """The new declaration is dropped."""
    for _, _, where in occurring(used.texts, _REDECLARED):
        what = "the redeclaration of a constant, which the front-end does not see, is not supported"
        yield Problem(what, where, "give the constant another value by a modification")


def _records(used: Used) -> Iterator[Problem]:
    """What is read of single fields is what the record's class says; the whole record is right."""
    records = {match[1] for _, match, _ in occurring(used.texts, re.compile(r"\brecord\s+(\w+)"))}
    for source, match, _ in occurring(used.packages, _LIST):
        for name, start in _listed(match):
            if match[1].rpartition(".")[2] not in records:
                continue
            field = re.compile(rf"\b{re.escape(name)}\s*(?:\[[^\]]*\])?\s*\.\s*\w")
            if any(field.search(text.text) for text in used.texts):
                what = f"reading fields of the package's constant '{name}', a record, is not supported"
                yield Problem(
                    what, place(source, start), "let a record in the model be it as a whole, and read that one"
                )
