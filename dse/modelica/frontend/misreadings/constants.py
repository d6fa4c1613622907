"""Constants of packages that the front-end mixes up: found in the text of what a model uses, and refused."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence

from dse.errors import Location, Problem
from dse.modelica.frontend.source_text import arguments, inside, occurring, place
from dse.modelica.frontend.sources import SourceText
from dse.modelica.frontend.used_classes import Used

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
    words = {word for text in used.texts for body in _bodies(text, called) for word in re.findall(r"\w+", body)}
    for name in sorted(constants(used.texts) & words):
        changed = re.compile(rf"[(,]\s*(?:(?:each|final)\s+)*({re.escape(name)})\s*=(?!=)")
        for _, _, where in occurring(used.texts, changed):
            what = f"constant '{name}' is changed here and read by a function, where the front-end mixes up its values"
            yield Problem(what, where, "make it an input of the function")


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
            field = re.compile(rf"\b{re.escape(name)}\s*(?:\[[^\]]*\])?\s*\.\s*\w")
            if match[1].rpartition(".")[2] in records and any(field.search(text.text) for text in used.texts):
                what = f"reading fields of the package's constant '{name}', a record, is not supported"
                yield Problem(
                    what, place(source, start), "let a record in the model be it as a whole, and read that one"
                )
