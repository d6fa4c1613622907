"""Names that stand where a model gets its shape: conditions of components, sizes, ranges, sample times.

Trying other values finds most uses that the front-end makes of a parameter, but not a threshold that no trial crosses.
So whatever is written in such a place counts as used, with all it is computed from: by name, rather too many than one
too few.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator

from dse.modelica.frontend.result import FrontEndResult
from dse.modelica.frontend.source_text import arguments, inside, value
from dse.modelica.frontend.used_classes import used

_WORD = re.compile(r"[A-Za-z_]\w*|'(?:[^'\\]|\\.)*'")
# A component's condition ends with the declaration; those of equations and expressions have a "then".
_CONDITION = re.compile(r"(?<!\bend )\bif\b((?:(?!\bthen\b|\bif\b)[^;])+);")
# A type's name and a variable's, or a type with its size; what stands before an index is an operator or a bracket.
_SIZE = re.compile(
    r"(?<![\w.])(?!(?:and|or|not|then|else|elseif|if|in|each)\b)[A-Za-z_][\w.]*(?:\s+[A-Za-z_]\w*)?\s*(\[)"
)
_NAME_AFTER = re.compile(r"\s*(?!(?:and|or|not|then|else|elseif|if|in|loop|for)\b)[A-Za-z_]")
_INDEX = re.compile(r"(?<=[\w\])'])\s*(\[)")
_RANGE = re.compile(r"\bin\b([^;]*?)(?:\bloop\b|[)};])")
_SIZED = re.compile(r"\b(fill|ones|zeros|identity|linspace|sample|Clock)\s*(\()")
_ASKED = re.compile(r"\bsize\s*\([^()]*\)")
_COMPUTED = re.compile(r"[<>(]|\bif\b|==")


def shaping(result: FrontEndResult) -> frozenset[str]:
    """The parameters whose names say that the shape of the model may depend on them."""
    texts = [source.text for source in used(result.sources.values(), result.model)]
    of_any_type, whole = _written(texts)
    types = result.flat["variable_type_names"]
    parameters = {
        variable["name"]: _last(variable["name"])
        for variable in result.dae["storage"]["variables"]
        if variable["role"] in ("parameter", "constant")
    }
    here = {
        word
        for name, word in parameters.items()
        if word in of_any_type or (word in whole and types.get(name) != "Real")
    }
    words = here | _made_of(texts, here, set(parameters.values()))
    return frozenset(
        name
        for name, word in parameters.items()
        if word in words and (word not in whole - of_any_type or types.get(name) != "Real")
    )


def _last(name: str) -> str:
    return re.sub(r"\[[^\]]*\]", "", name).rpartition(".")[2]


def _written(texts: Iterable[str]) -> tuple[set[str], set[str]]:
    """Names in such places; and those that can matter there only if they are no Real: alone in a size or an index."""
    of_any_type: set[str] = set()
    whole: set[str] = set()
    for text in texts:
        for match in _CONDITION.finditer(text):
            of_any_type.update(_WORD.findall(match[1]))
        for place in _sizes(text):
            # The size of an array is fixed with its declaration; its elements do not matter.
            rest = _ASKED.sub("", place)
            (of_any_type if _COMPUTED.search(rest) else whole).update(_WORD.findall(rest))
        for match in _SIZED.finditer(text):
            if match[1] in ("sample", "Clock"):
                of_any_type.update(_WORD.findall(inside(text, match.start(2))))
    return of_any_type, whole


def _sizes(text: str) -> Iterator[str]:
    for match in _SIZE.finditer(text):
        size = inside(text, match.start(1))
        follows = _NAME_AFTER.match(text, match.start(1) + len(size) + 2)
        if match[0].split("[")[0].split()[1:] or follows:
            yield size
    for match in _INDEX.finditer(text):
        if _COMPUTED.search(index := inside(text, match.start(1))):
            yield index
    for match in _RANGE.finditer(text):
        yield match[1]
    for match in _SIZED.finditer(text):
        given = inside(text, match.start(2))
        parts = [given[start:end] for start, end in arguments(given)]
        yield from {"fill": parts[1:], "linspace": parts[2:]}.get(match[1], parts)


def _made_of(texts: list[str], names: set[str], parameters: set[str]) -> set[str]:
    """Which *parameters* the values given to *names* are written with, and what those are given, and so on."""
    given: dict[str, set[str]] = {}
    for text in texts:
        for match in _GIVEN.finditer(text):
            given.setdefault(match[1], set()).update(_WORD.findall(value(text, match.end())))
    found: set[str] = set()
    pending = list(names)
    while pending:
        new = given.get(pending.pop(), set()) & parameters - found
        found |= new
        pending += new
    return found


_GIVEN = re.compile(r"([A-Za-z_]\w*)\s*(?:\[[^\]]*\]\s*)?(?:\([^()]*\)\s*)?=(?!=)")
