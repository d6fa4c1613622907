"""Names that stand where a model gets its shape: conditions of components, sizes, ranges, sample times.

Trying other values finds most uses that the front-end makes of a parameter, but not a threshold that no trial crosses.
So whatever is written in such a place counts as used, with all it is computed from: by name, rather too many than one
too few.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence

from dse.modelica.frontend.result import FrontEndResult
from dse.modelica.frontend.syntax import Forest, Tree
from dse.modelica.frontend.used_classes import used

_SIZED = {"fill": 1, "linspace": 2, "ones": 0, "zeros": 0, "identity": 0}
"""Functions, and how many of their arguments come before sizes."""
_ASKED = re.compile(r"\bsize \( [^()]* \)")
_COMPUTED = {"<", ">", "<=", ">=", "<>", "==", "(", "if"}


def shaping(result: FrontEndResult) -> frozenset[str]:
    """The parameters whose names say that the shape of the model may depend on them. Raises DseError."""
    trees = Forest(used(result.sources.values(), result.model)).trees
    of_any_type, whole = places(trees)
    types = result.flat["variable_type_names"]
    parameters = {
        variable["name"]: re.sub(r"\[[^\]]*\]", "", variable["name"]).rpartition(".")[2]
        for variable in result.dae["storage"]["variables"]
        if variable["role"] in ("parameter", "constant")
    }
    here = {
        word
        for name, word in parameters.items()
        if word in of_any_type or (word in whole and types.get(name) != "Real")
    }
    words = here | made_of(trees, here, set(parameters.values()))
    return frozenset(
        name
        for name, word in parameters.items()
        if word in words and (word not in whole - of_any_type or types.get(name) != "Real")
    )


def places(trees: Iterable[Tree]) -> tuple[set[str], set[str]]:
    """Names in such places; and those that can matter there only if they are no Real: alone in a size or an index."""
    of_any_type: set[str] = set()
    whole: set[str] = set()
    for tree in trees:
        for element in tree.elements:
            words = tree.words[element.named : element.end] if element.kind == "component" else []
            if "if" in words:
                condition = words[len(words) - words[::-1].index("if") :]
                of_any_type.update(condition if "then" not in condition else ())
        for bracket, word in enumerate(tree.words[1:], 1):
            if word == "(" and tree.words[bracket - 1] in ("sample", "Clock"):
                of_any_type.update(tree.words[bracket + 1 : tree.closing[bracket]])
        for place in _sizes(tree):
            # The size of an array is fixed with its declaration; its elements do not matter.
            rest = _ASKED.sub("", " ".join(place)).split()
            (whole if _COMPUTED.isdisjoint(rest) else of_any_type).update(rest)
    return of_any_type, whole


def _sizes(tree: Tree) -> Iterator[Sequence[str]]:
    declared = set(tree.sizes)
    for number, word in enumerate(tree.words):
        before = tree.words[number - 1] if number else ""
        if word == "[":
            inside = tree.words[number + 1 : tree.closing[number]]
            is_index = before[-1:].isalnum() or before[-1:] in ("_", "'", ")", "]")
            if number in declared or (is_index and not _COMPUTED.isdisjoint(inside)):
                yield inside
        elif word == "in":
            yield tree.words[number + 1 : tree.until(number + 1, "loop", ",", ";")]
        elif word == "(" and before in _SIZED:
            yield from list(tree.parts(number))[_SIZED[before] :]


def made_of(trees: Iterable[Tree], names: set[str], parameters: set[str]) -> set[str]:
    """Which *parameters* the values given to *names* are written with, and what those are given, and so on."""
    given: dict[str, set[str]] = {}
    for tree in trees:
        for number, word in enumerate(tree.words):
            if word == "=":
                named = number - 1
                while tree.words[named] in ")]":
                    named = tree.closing[named] - 1
                value = tree.words[number + 1 : tree.until(number + 1, ",", ";")]
                given.setdefault(tree.words[named], set()).update(value)
    found: set[str] = set()
    pending = list(names)
    while pending:
        new = given.get(pending.pop(), set()) & parameters - found
        found |= new
        pending += new
    return found
